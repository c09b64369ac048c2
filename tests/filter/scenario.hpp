// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"

/// Small scenes for the tests of the filter.
namespace posemix::testing {

inline SE3d pose(double rx, double ry, double rz, double x, double y, double z) {
  Vector6d xi;
  xi << rx, ry, rz, x, y, z;
  return SE3d::exp(xi);
}

inline Matrix6d isotropic(double rotation_sd_deg, double translation_sd_m) {
  return pose_covariance(Eigen::Vector3d::Constant(radians(rotation_sd_deg)),
                         Eigen::Vector3d::Constant(translation_sd_m));
}

/// A noise with one entry that has no mirror image: rounding beside the largest variance, and
/// `share` times as much as those of its row and its column allow.
inline Matrix6d lopsided_noise(double share) {
  Matrix6d upper = isotropic(1.0, 0.01);
  upper(4, 4) = 1e8;
  upper(0, 5) = share * std::sqrt(upper(0, 0) * upper(5, 5));
  return upper;
}

/// Expects that `after`, of a noise, computes with its symmetric part, and refuses one that is
/// negative in some direction.
template <class After>
void expect_the_symmetric_part_to_count(const After& after) {
  const Matrix6d upper = lopsided_noise(1.5);
  Matrix6d symmetric = upper;
  symmetrize(symmetric);
  EXPECT_EQ(after(upper), after(symmetric));
  EXPECT_EQ(after(upper.transpose()), after(symmetric));
  const Matrix6d negative = lopsided_noise(3.0);
  EXPECT_THROW(after(negative), InvalidInput);
  EXPECT_THROW(after(negative.transpose()), InvalidInput);
}

/// A sample of N(0, covariance).
inline Vector6d draw(const Matrix6d& covariance, RandomStream& stream) {
  Eigen::VectorXd white(6);
  stream.fill_normal(white);
  return Eigen::LLT<Matrix6d>(covariance).matrixL() * white;
}

/// Three draws, one by one: the order of the arguments of a call is the compiler's.
inline Eigen::Vector3d normals(RandomStream& stream) {
  Eigen::Vector3d values;
  for (Eigen::Index axis = 2; axis >= 0; --axis) values[axis] = stream.normal();
  return values;
}

/// A point in a cube of side 1 about the origin, likewise.
inline Eigen::Vector3d point_in_cube(RandomStream& stream) {
  Eigen::Vector3d point;
  for (Eigen::Index axis = 2; axis >= 0; --axis) point[axis] = stream.uniform() - 0.5;
  return point;
}

/// The mug of the midway paper (eq. 36): a heavy tail about z.
inline DetectorNoise heavy_tailed_noise(double tail_sd_deg = 12.0) {
  NoiseComponent core{0.7, isotropic(4.0, 0.01)};
  NoiseComponent tail{0.3, pose_covariance({radians(4.0), radians(4.0), radians(tail_sd_deg)},
                                           Eigen::Vector3d::Constant(0.01))};
  return DetectorNoise({core, tail});
}

inline DetectorNoise gaussian_noise(double rotation_sd_deg = 4.0, double translation_sd_m = 0.01) {
  return DetectorNoise({{1.0, isotropic(rotation_sd_deg, translation_sd_m)}});
}

/// A filter whose state is the camera alone.
inline GaussianSumFilter camera_filter(const SE3d& camera, const Matrix6d& covariance,
                                       const GaussianSumSettings& settings = {}) {
  return GaussianSumFilter(
      Posterior({{0.0, Hypothesis(PoseStackd(std::vector<SE3d>{camera}), covariance)}}), settings);
}

/// A camera and an object in the world.
inline const SE3d kCameraPose = pose(0.3, -0.2, 0.5, 0.4, 0.1, -0.6);
inline const SE3d kObject = pose(1.0, 0.4, -0.3, 0.2, 0.8, 0.9);

/// A camera and two objects.
inline PoseStackd three_poses() {
  return PoseStackd(std::vector<SE3d>{kCameraPose, pose(1.0, 0.4, -0.3, 0.2, 0.8, 0.5),
                                      pose(-0.7, 0.2, 1.4, -0.3, 0.5, 0.9)});
}

/// The update by a detection, and that by the same detection turned by half a circle where the
/// noise has this offset.
template <class Update>
std::pair<UpdateResult, UpdateResult> updates_of_both_modes(const SE3d& detected,
                                                            const NoiseComponent& plain,
                                                            const Update& update) {
  const DetectorNoise noise({plain});
  const auto updated = [&](const SE3d& offset) {
    NoiseComponent component = plain;
    component.offset = offset;
    const std::array<const NoiseComponent*, 1> components{&component};
    const Detection detection{1, detected * offset, &noise};
    return update(std::span<const Detection>(&detection, 1),
                  std::span<const NoiseComponent* const>(components));
  };
  return {updated(SE3d()), updated(pose(0.0, 0.0, std::numbers::pi, 0.0, 0.0, 0.0))};
}

/// A correlated positive definite covariance over `poses` poses, about 0.05 rad and 5 cm.
inline Eigen::MatrixXd correlated_covariance(std::size_t poses, RandomStream& stream) {
  const auto n = static_cast<Eigen::Index>(6 * poses);
  Eigen::MatrixXd root(n, n);
  for (double& value : root.reshaped())
    value = 0.05 * stream.normal() / std::sqrt(static_cast<double>(n));
  return root * root.transpose() + 1e-4 * Eigen::MatrixXd::Identity(n, n);
}

}  // namespace posemix::testing
