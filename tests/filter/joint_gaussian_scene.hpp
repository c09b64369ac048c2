// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <vector>

#include "filter/multi_object/joint_gaussian.hpp"
#include "posemix/base/random.hpp"

/// Joint Gaussians of a camera and objects, and detections of them, for the tests of what is done
/// with them.
namespace posemix::testing {

inline Matrix6d random_covariance(double rotation_sd, double translation_sd, RandomStream& stream) {
  Matrix6d root;
  for (double& x : root.reshaped()) x = stream.normal();
  Matrix6d p = root * root.transpose() / 6.0 + 0.2 * Matrix6d::Identity();
  Vector6d sd;
  sd << Eigen::Vector3d::Constant(rotation_sd), Eigen::Vector3d::Constant(translation_sd);
  return sd.asDiagonal() * p * sd.asDiagonal();
}

inline Vector6d random_vector(double scale, RandomStream& stream) {
  Vector6d v;
  for (double& x : v) x = scale * stream.normal();
  return v;
}

struct PairScene {
  internal::JointGaussian joint;
  std::vector<std::size_t> objects;
  double noise = 1.0;  ///< of detections, a factor
};

/// A detection of the object at `index` under two components of the noise and clutter.
inline internal::Explanation explanation(const internal::JointGaussian& joint, std::size_t index,
                                         double noise, RandomStream& stream) {
  internal::Explanation result;
  result.noise_components = 2;
  const bool slow = joint.blocks_of(index) > 1;
  for (const double weight : {0.6, 0.3}) {
    internal::Innovation seen;
    seen.weight = weight;
    seen.residual = random_vector(0.02 * noise, stream);
    seen.noise = random_covariance(0.05 * noise / weight, 0.01 * noise / weight, stream);
    seen.slow_map = SE3d::exp(random_vector(0.3 * noise, stream)).adjoint();
    Eigen::Matrix<double, 6, 18> h;
    h << -Matrix6d::Identity(), Matrix6d::Identity(), seen.slow_map;
    Eigen::Matrix<double, 18, 18> p = Eigen::Matrix<double, 18, 18>::Zero();
    const std::size_t blocks[] = {kCamera, index, index + 1};
    for (std::size_t i = 0; i < (slow ? 3u : 2u); ++i) {
      for (std::size_t k = 0; k < (slow ? 3u : 2u); ++k)
        p.block<6, 6>(offset(i), offset(k)) = joint.covariance(blocks[i], blocks[k]);
    }
    seen.covariance = h * p * h.transpose() + seen.noise;
    result.innovations.push_back(seen);
  }
  result.clutter_probability = 0.1;
  return result;
}

/// Objects with and without a slow error, correlated by detections, and odometry between them.
inline PairScene pair_scene(std::size_t objects, RandomStream& stream, double noise = 1.0) {
  PairScene result{internal::JointGaussian(ConcentratedGaussian<SE3d>(
                       SE3d::exp(random_vector(0.5, stream)), random_covariance(0.3, 1.0, stream))),
                   {},
                   noise};
  internal::JointGaussian& joint = result.joint;
  for (std::size_t k = 0; k < objects; ++k) {
    internal::ConditionalPose object{SE3d::exp(random_vector(0.7, stream)),
                                     {},
                                     internal::Matrix12d::Zero(),
                                     internal::Matrix12x6d::Zero()};
    const Matrix6d camera = joint.covariance(kCamera, kCamera);
    object.covariance.topLeftCorner<6, 6>() =
        camera + random_covariance(0.1 * noise, 0.03 * noise, stream);
    object.cross_covariance.topRows<6>() = camera;
    if (k % 2 == 1) {
      object.slow = random_vector(0.01, stream);
      // Found by a detection with this slow error.
      const Matrix6d slow = random_covariance(0.02, 0.01, stream);
      object.covariance.topLeftCorner<6, 6>() += slow;
      object.covariance.topRightCorner<6, 6>() = -slow;
      object.covariance.bottomLeftCorner<6, 6>() = -slow;
      object.covariance.bottomRightCorner<6, 6>() = slow;
    }
    result.objects.push_back(joint.append(object));
  }
  for (int round = 0; round < 3; ++round) {
    joint.add_noise(kCamera, random_covariance(0.01, 0.005, stream));
    for (const std::size_t index : result.objects)
      joint.update_densely(index, explanation(joint, index, noise, stream), {}, {});
  }
  return result;
}

/// Of moments, relative to the standard deviations, which differ by decades between coordinates.
inline double worst_difference(const internal::JointGaussian& a, const internal::JointGaussian& b) {
  const Eigen::MatrixXd expected = b.covariance();
  const Eigen::VectorXd sd = expected.diagonal().cwiseSqrt();
  const Eigen::MatrixXd difference =
      sd.asDiagonal().inverse() * (a.covariance() - expected) * sd.asDiagonal().inverse();
  double worst = difference.cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < a.size(); ++k) {
    const Vector6d apart =
        a.is_pose(k) ? (a.pose(k) * b.pose(k).inverse()).log() : Vector6d(a.slow(k) - b.slow(k));
    worst = std::max(worst, apart.cwiseQuotient(sd.segment<6>(offset(k))).cwiseAbs().maxCoeff());
  }
  return worst;
}

}  // namespace posemix::testing
