// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/io/mixture_file.hpp"

/// Random mixtures for the tests of their files.
namespace posemix::testing {

/// A covariance with entries of all sizes: correlated, one pair of denormal numbers, one of
/// negative zeros.
inline Matrix6d awkward_covariance(RandomStream& stream) {
  Matrix6d factor;
  for (double& entry : factor.reshaped()) entry = 0.1 * stream.normal();
  Matrix6d covariance = factor * factor.transpose();
  for (Eigen::Index i = 0; i < 6; ++i) covariance(i, i) += 0.05;
  covariance(0, 5) = 0x1.8p-1060;
  covariance(1, 4) = -0.0;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) covariance(i, j) = covariance(j, i);
  }
  return covariance;
}

inline SE3d awkward_pose(RandomStream& stream) {
  Vector6d xi;
  for (double& entry : xi) entry = stream.normal();
  const SE3d pose = SE3d::exp(xi);
  return SE3d(pose.rotation(), {pose.translation().x(), -0.0, 0x1p-1070});
}

inline ConcentratedPoses awkward_concentrated(std::uint64_t seed, std::size_t components) {
  RandomStream stream(seed);
  std::vector<Component<ConcentratedGaussian<SE3d>>> parts;
  for (std::size_t i = 0; i < components; ++i) {
    const SE3d pose = awkward_pose(stream);
    parts.push_back(
        {-3.0 * stream.uniform(), ConcentratedGaussian<SE3d>(pose, awkward_covariance(stream))});
  }
  return ConcentratedPoses(std::move(parts));
}

inline ProjectedPoses awkward_projected(std::uint64_t seed, std::size_t components) {
  RandomStream stream(seed);
  std::vector<Component<ProjectedGaussian<SE3d>>> parts;
  for (std::size_t i = 0; i < components; ++i) {
    Vector6d mean;
    mean << 0.1 * stream.normal(), -0.0, 0x1p-1074, stream.normal(), -0.0, 1.0 / 3.0;
    const SO3d point = awkward_pose(stream).rotation();
    parts.push_back({-3.0 * stream.uniform(),
                     ProjectedGaussian<SE3d>(point, mean, awkward_covariance(stream))});
  }
  return ProjectedPoses(std::move(parts));
}

/// Every number that a density is made of, as bits.
inline std::vector<std::uint64_t> bits_of(const SO3d& rotation, const Eigen::VectorXd& more,
                                          const Matrix6d& covariance) {
  std::vector<std::uint64_t> bits;
  const auto add = [&](const auto& numbers) {
    for (const double number : numbers) bits.push_back(std::bit_cast<std::uint64_t>(number));
  };
  add(rotation.quaternion().coeffs());
  add(more);
  add(covariance.reshaped());
  return bits;
}

inline std::vector<std::uint64_t> bits_of(const ConcentratedGaussian<SE3d>& density) {
  return bits_of(density.mean().rotation(), density.mean().translation(), density.covariance());
}

inline std::vector<std::uint64_t> bits_of(const ProjectedGaussian<SE3d>& density) {
  return bits_of(density.tangent_point(), density.tangent_mean(), density.covariance());
}

template <class D>
std::vector<std::uint64_t> bits_of(const Mixture<D>& mixture) {
  std::vector<std::uint64_t> bits;
  for (const auto& component : mixture.components()) {
    bits.push_back(std::bit_cast<std::uint64_t>(component.log_weight));
    const auto of_density = bits_of(component.density);
    bits.insert(bits.end(), of_density.begin(), of_density.end());
  }
  return bits;
}

}  // namespace posemix::testing
