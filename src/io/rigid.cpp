// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/rigid.hpp"

#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "posemix/base/error.hpp"

namespace posemix {

void check_position(const SE3d& pose, std::string_view where) {
  const double farthest = pose.translation().cwiseAbs().maxCoeff();
  if (farthest <= kFarthestPosition) return;
  throw InvalidInput(fmt::format("{}: got a position of {:g} m, expected at most {:g} m", where,
                                 farthest, kFarthestPosition));
}

SE3d pose_from_matrix(const Eigen::Matrix4d& matrix, std::string_view where, double tolerance) {
  try {
    return SE3d::from_matrix(matrix, tolerance);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", where, error.what()));
  }
}

SE3d pose_from_numbers(const PoseNumbers& numbers, const LineReader& reader) {
  const auto& [tx, ty, tz, qx, qy, qz, qw] = numbers;
  const Eigen::Quaterniond quaternion(qw, qx, qy, qz);
  const double norm = quaternion.coeffs().stableNorm();
  if (!(std::abs(norm - 1) <= kQuaternionNormTolerance)) {
    reader.fail(fmt::format("a quaternion of norm {:.6g}", norm),
                fmt::format("qx qy qz qw of norm 1 within {:g}", kQuaternionNormTolerance));
  }
  return SE3d(SO3d::from_quaternion(quaternion), Eigen::Vector3d(tx, ty, tz));
}

std::string format_pose(const SE3d& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation().quaternion();
  const std::array<double, 7> numbers{t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
  std::string text;
  for (const double number : numbers) {
    const double without_negative_zero = number + 0.0;
    text += fmt::format("{}{:.12g}", text.empty() ? "" : " ", without_negative_zero);
  }
  return text;
}

}  // namespace posemix
