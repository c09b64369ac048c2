// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "yaml_pose.hpp"

#include <fmt/format.h>
#include <Eigen/LU>

#include "posemix/io/rigid.hpp"

namespace posemix::internal {
namespace {

/// (R^T R)^-1 of the square root of an information.
Matrix6d covariance_of_root(const YamlValue& value) {
  const std::vector<double> numbers = value.numbers(36);
  const Matrix6d root =
      Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(numbers.data());
  const Eigen::FullPivLU<Matrix6d> factor(root);
  if (!factor.isInvertible()) value.fail("a matrix without an inverse", "one that has an inverse");
  const Matrix6d inverse = factor.inverse();
  Matrix6d covariance = inverse * inverse.transpose();
  symmetrize(covariance);
  return covariance;
}

Eigen::Vector3d deviations(const YamlValue& value) {
  Eigen::Vector3d sd = value.xyz();
  if (!(sd.minCoeff() > 0.0))
    value.fail(fmt::format("{} {} {}", sd.x(), sd.y(), sd.z()), "standard deviations above zero");
  return sd;
}

}  // namespace

StatedPose pose_of(const YamlValue& value) {
  StatedPose stated;
  stated.pose = SE3d(SO3d::exp(value.at("rotation").xyz()), value.at("position").xyz());
  if (!(stated.pose.translation().cwiseAbs().maxCoeff() <= kFarthestPosition))
    value.at("position").fail("a position beyond all scales", "metres");
  const auto position = value.find("position_noise");
  const auto rotation = value.find("rotation_noise");
  if (const auto root = value.find("R")) {
    stated.covariance = covariance_of_root(*root);
  } else if (position && rotation) {
    Vector6d sd;
    sd.head<3>() = deviations(*rotation);
    sd.tail<3>() = deviations(*position);
    stated.covariance = sd.cwiseAbs2().asDiagonal();
  } else if (position || rotation) {
    value.fail(position ? "only position_noise" : "only rotation_noise",
               "both, or neither of them");
  }
  return stated;
}

}  // namespace posemix::internal
