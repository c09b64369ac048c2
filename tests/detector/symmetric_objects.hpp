// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <numbers>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/detector/symmetry.hpp"

/// Groups of symmetries of different kinds, for tests.
namespace posemix::testing {

inline SE3d pose(double rx, double ry, double rz, double x, double y, double z) {
  Vector6d xi;
  xi << rx, ry, rz, x, y, z;
  return SE3d::exp(xi);
}

inline Matrix6d isotropic(double rotation_sd_deg, double translation_sd_m) {
  Vector6d sd;
  sd << Eigen::Vector3d::Constant(radians(rotation_sd_deg)),
      Eigen::Vector3d::Constant(translation_sd_m);
  return sd.cwiseAbs2().asDiagonal();
}

/// A draw of N(0, covariance).
inline Vector6d draw(const Matrix6d& covariance, RandomStream& stream) {
  Eigen::VectorXd white(6);
  stream.fill_normal(white);
  return Eigen::LLT<Matrix6d>(covariance).matrixL() * white;
}

inline constexpr double kPi = std::numbers::pi;

inline SE3d turn(double degrees, const Eigen::Vector3d& axis,
                 const Eigen::Vector3d& point = Eigen::Vector3d::Zero()) {
  const SO3d rotation = SO3d::exp(radians(degrees) * axis.normalized());
  return SE3d(rotation, point - rotation * point);
}

inline const Eigen::Vector3d kX = Eigen::Vector3d::UnitX();
inline const Eigen::Vector3d kZ = Eigen::Vector3d::UnitZ();
inline const Eigen::Vector3d kOff(0.03, -0.02, 0.01);

/// A group of motions with a name for messages.
struct Case {
  const char* name;
  SymmetryGroup group;
};

inline std::vector<Case> cases() {
  return {
      {"trivial", SymmetryGroup()},
      {"half turn about a line off the origin", SymmetryGroup({turn(180, kZ, kOff)})},
      {"quarter turns", SymmetryGroup({turn(90, kZ), turn(180, kZ), turn(270, kZ)})},
      {"box", SymmetryGroup({turn(180, kX), turn(180, kZ), turn(180, kX.cross(kZ))})},
      {"axis", SymmetryGroup({}, {{kZ, kOff}})},
      {"can", SymmetryGroup({turn(180, kX, kOff)}, {{kZ, kOff}})},
      {"ball", SymmetryGroup({}, {{kX, kOff}, {kZ, kOff}})},
  };
}

inline double cost(const SE3d& pose, const SE3d& reference, const Matrix6d& information) {
  const Vector6d z = (pose.inverse() * reference).log();
  return z.dot(information * z);
}

/// All motions of a group, angles about axes in steps.
inline std::vector<SE3d> sampled(const SymmetryGroup& group, double step_deg) {
  std::vector<SE3d> turns{SE3d()};
  for (const SymmetryAxis& axis : group.axes()) {
    std::vector<SE3d> more;
    for (const SE3d& before : turns)
      for (double angle = 0; angle < 360; angle += step_deg)
        more.push_back(before * turn(angle, axis.direction, axis.point));
    turns = more;
  }
  std::vector<SE3d> all;
  for (const SE3d& element : group.elements())
    for (const SE3d& k : turns) all.push_back(element * k);
  return all;
}

inline Matrix6d random_information(RandomStream& stream) {
  Matrix6d root;
  for (double& entry : root.reshaped()) entry = stream.normal();
  const Matrix6d scale = isotropic(4.0, 0.01).cwiseSqrt();
  const Matrix6d covariance =
      scale * (0.2 * root * root.transpose() + Matrix6d::Identity()) * scale;
  return covariance.inverse();
}

inline SE3d random_motion(const SymmetryGroup& group, RandomStream& stream) {
  const auto& elements = group.elements();
  SE3d motion =
      elements[static_cast<std::size_t>(stream.uniform() * static_cast<double>(elements.size()))];
  for (const SymmetryAxis& axis : group.axes())
    motion = motion * turn(360 * stream.uniform(), axis.direction, axis.point);
  return motion;
}

}  // namespace posemix::testing
