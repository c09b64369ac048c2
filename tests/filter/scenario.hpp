// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

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

/// A draw of N(0, covariance).
inline Vector6d draw(const Matrix6d& covariance, RandomStream& stream) {
  Eigen::VectorXd white(6);
  stream.fill_normal(white);
  return Eigen::LLT<Matrix6d>(covariance).matrixL() * white;
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

/// A correlated positive definite covariance over `poses` poses, about 0.05 rad and 5 cm.
inline Eigen::MatrixXd correlated_covariance(std::size_t poses, RandomStream& stream) {
  const auto n = static_cast<Eigen::Index>(6 * poses);
  Eigen::MatrixXd root(n, n);
  for (double& value : root.reshaped())
    value = 0.05 * stream.normal() / std::sqrt(static_cast<double>(n));
  return root * root.transpose() + 1e-4 * Eigen::MatrixXd::Identity(n, n);
}

}  // namespace posemix::testing
