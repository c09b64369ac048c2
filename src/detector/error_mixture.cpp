// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/error_mixture.hpp"

#include <cmath>
#include <limits>

#include "posemix/detector/detector_noise.hpp"

namespace posemix {

Vector6d sight_error(const SE3d& estimate, const SE3d& truth) {
  const SO3d to_sight = viewing_ray(estimate).axes.inverse();
  Vector6d error;
  error.head<3>() = to_sight * (estimate.rotation() * truth.rotation().inverse()).log();
  error.tail<3>() = to_sight * Eigen::Vector3d(estimate.translation() - truth.translation());
  return error;
}

SE3d truth_with_error(const SE3d& estimate, const Vector6d& error) {
  const SO3d sight = viewing_ray(estimate).axes;
  const SO3d rotation = SO3d::exp(sight * Eigen::Vector3d(error.head<3>()));
  return SE3d(rotation.inverse() * estimate.rotation(),
              estimate.translation() - sight * Eigen::Vector3d(error.tail<3>()));
}

ErrorMixture::ErrorMixture(Mixture<Gaussian> mixture) : mixture_(std::move(mixture)) {
  for (const auto& component : mixture_.components()) {
    const Eigen::LLT<Matrix6d> factor(component.density.covariance());
    Part part;
    part.mean = component.density.mean().log();
    part.whitening = factor.matrixL().solve(Matrix6d::Identity());
    part.log_factor = component.log_weight - 0.5 * log_det(factor) - 3.0 * kLogTwoPi;
    parts_.push_back(part);
  }
}

double ErrorMixture::log_density(const Vector6d& error) const {
  double largest = -std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const Part& part : parts_) {
    const Vector6d offset = error - part.mean;
    double squared = 0.0;
    for (Eigen::Index i = 0; i < 6; ++i) {
      double z = 0.0;
      for (Eigen::Index j = 0; j <= i; ++j) z += part.whitening(i, j) * offset[j];
      squared += z * z;
    }
    const double term = part.log_factor - 0.5 * squared;
    if (term > largest) {
      sum = sum * std::exp(largest - term) + 1.0;
      largest = term;
    } else if (term > largest - 40.0) {
      sum += std::exp(term - largest);
    }
  }
  return largest + std::log(sum);
}

double ErrorMixture::log_pose_density(const Vector6d& error) const {
  return log_density(error) - SO3d::log_abs_det_left_jacobian(error.head<3>());
}

Vector6d ErrorMixture::sample(RandomStream& stream) const { return mixture_.sample(stream).log(); }

}  // namespace posemix
