// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "posemix/lie/pose_covariance.hpp"
#include "study/fiducials/score.hpp"

/// A recording of tags by formulas, without random numbers.
namespace posemix::testing {

/// The other pose of a tag in a camera: its normal is mirrored at the line of sight.
inline SE3d other_pose(const SE3d& camera_tag) {
  const Eigen::Vector3d sight = -camera_tag.translation().normalized();
  const Eigen::Vector3d normal = camera_tag.rotation() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d axis = normal.cross(sight);
  const double angle = std::atan2(axis.norm(), normal.dot(sight));
  const SO3d turn = SO3d::exp(2.0 * angle * axis.normalized());
  return SE3d(turn * camera_tag.rotation(), camera_tag.translation());
}

/// A rig of two cameras that moves before five tags, each seen by both cameras in all of 40 frames
/// at 20 Hz, with two components. The first one of each sighting is true up to an error of 0.3
/// degrees and 3 mm; in every third sighting the other one is heavier.
struct TagRecording {
  TagRecording() {
    for (int i = 0; i < 5; ++i) {
      const SO3d rotation = SO3d::exp({0.0, std::numbers::pi - 0.6 - 0.05 * i, 0.0});
      tags[std::to_string(i)] = SE3d(rotation, {i - 2.0, 0.3 * i - 0.6, 3.0});
    }
    for (int k = 0; k < 40; ++k) {
      const double t = k / 20.0;
      path.push_back({t, SE3d(SO3d::exp({0.0, 0.3 * std::sin(t), 0.1 * t}),
                              {std::cos(2.0 * t), 0.5 * std::sin(2.0 * t), 0.05 * t})});
      for (const auto& [camera, mounting] : cameras) {
        for (const auto& [tag, pose] : tags)
          observe(t, camera, tag, (*path.back().pose * mounting).inverse() * pose);
      }
    }
  }

  std::vector<StampedPose> path = {};  ///< T_map_rig
  CameraPoses cameras = {{"left", SE3d()},
                         {"right", SE3d(SO3d::exp({0.0, 0.2, 0.0}), {0.2, 0.0, 0.0})}};
  std::map<std::string, SE3d> tags = {};  ///< T_map_tag
  std::vector<Observation> observations = {};

 private:
  void observe(double stamp, const std::string& camera, const std::string& tag,
               const SE3d& camera_tag) {
    const auto n = static_cast<double>(observations.size());
    const Eigen::Vector3d turn(std::sin(7 * n), std::sin(11 * n), std::sin(13 * n));
    const Eigen::Vector3d shift(std::sin(17 * n), std::sin(19 * n), std::sin(23 * n));
    const SE3d seen = camera_tag * SE3d(SO3d::exp(0.005 * turn), 0.003 * shift);
    const double weight = observations.size() % 3 == 0 ? 0.3 : 0.7;
    Observation observation;
    observation.object = tag;
    observation.camera = camera;
    observation.stamp_s = stamp;
    const Matrix6d covariance =
        pose_covariance(Eigen::Vector3d::Constant(0.005), Eigen::Vector3d::Constant(0.003));
    observation.components = {{weight, seen, covariance},
                              {1.0 - weight, other_pose(seen), covariance}};
    observations.push_back(observation);
  }
};

}  // namespace posemix::testing
