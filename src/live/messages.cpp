// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "messages.hpp"

#include <Eigen/Geometry>

#include "posemix/base/error.hpp"

namespace posemix::internal {

SE3d pose_of(const PoseNumbers& numbers) {
  const auto& [tx, ty, tz, qx, qy, qz, qw] = numbers;
  const Eigen::Vector3d translation(tx, ty, tz);
  require(translation.allFinite(), "got a position that is not finite, expected finite metres");
  return SE3d(SO3d::from_stored_quaternion(Eigen::Quaterniond(qw, qx, qy, qz)), translation);
}

PoseNumbers numbers_of(const SE3d& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation().quaternion();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

std::string frame_name(const std::string& frame) {
  const std::size_t first = frame.find_first_not_of('/');
  return first == std::string::npos ? "" : frame.substr(first);
}

}  // namespace posemix::internal
