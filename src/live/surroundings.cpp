// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "surroundings.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {

// The window is no longer than what counts as a jump of the clock, so that nothing from before one
// is left.
Surroundings::Surroundings(const LiveSettings& settings)
    : settings_(&settings),
      frames_(settings.stamped.jump_back_s),
      odometry_(nanoseconds(settings.stamped.jump_back_s)) {}

void Surroundings::clear() {
  frames_.clear();
  odometry_ = PoseLine(nanoseconds(settings_->stamped.jump_back_s));
  base_.clear();
  body_.clear();
  cameras_.clear();
}

void Surroundings::add_odometry(const RosTransform& message) {
  const std::string frame = frame_name(message.header.frame);
  if (frame != settings_->node.odom_frame) {
    throw InvalidInput(fmt::format("odometry is in the frame {}, expected odom_frame, {}",
                                   in_quotes(frame), in_quotes(settings_->node.odom_frame)));
  }
  const SE3d pose = pose_of(message.pose);
  base_ = frame_name(message.child);
  odometry_.add(message.header.stamp_ns, pose);
}

void Surroundings::see(const LiveImage& image) {
  if (!body_.empty()) return;
  const LiveNodeSettings& node = settings_->node;
  const std::string& one = node.camera_frame.empty() ? image.frame : node.camera_frame;
  body_ = node.cameras.empty() ? one : node.body_frame;
}

std::optional<ReadyImage> Surroundings::ready(const LiveImage& image, bool is_over) {
  ReadyImage result{image};
  if (!move_to_camera(result.image) || !find_cameras()) return std::nullopt;
  if (!settings_->has_odometry()) return result;
  result.odometry = odometry_at(image.stamp_ns);
  if (result.odometry) return result;
  const LiveNodeSettings& node = settings_->node;
  complaint_ = fmt::format(
      "no odometry at {} ns: {} has no pose of {} in {} (motion.model says how the camera moves "
      "without)",
      image.stamp_ns, node.odometry_topic.empty() ? "/tf" : node.odometry_topic, in_quotes(body_),
      in_quotes(node.odom_frame));
  return is_over ? std::optional(result) : std::nullopt;
}

bool Surroundings::move_to_camera(LiveImage& image) {
  const LiveNodeSettings& node = settings_->node;
  const bool is_rig = !node.cameras.empty();
  if (is_rig && std::ranges::find(node.cameras, image.frame) == node.cameras.end()) {
    complaint_ = fmt::format("an image is of the frame {}, expected one of cameras, '{}'",
                             in_quotes(image.frame), fmt::join(node.cameras, "', '"));
    return false;
  }
  const std::string& camera = is_rig ? image.frame : body_;
  for (LiveDetection& detection : image.detections) {
    if (detection.frame == camera) continue;
    const auto by = frames_.at(camera, detection.frame, image.stamp_ns, node.max_gap_s);
    if (!by) {
      complaint_ = fmt::format("no transform from {} to {} at {} ns", in_quotes(detection.frame),
                               in_quotes(camera), image.stamp_ns);
      return false;
    }
    // Covariances along the object's axes stay as they are.
    for (ObservationComponent& component : detection.components)
      component.pose = *by * component.pose;
    detection.frame = camera;
  }
  return true;
}

bool Surroundings::find_cameras() {
  if (cameras_.size() == settings_->node.cameras.size()) return true;
  std::vector<BodyCamera> found;
  for (const std::string& name : settings_->node.cameras) {
    const auto pose = frames_.at(body_, name, std::numeric_limits<std::int64_t>::max(), 0.0);
    if (!pose) {
      complaint_ = fmt::format("no transform from camera {} to {} in /tf_static", in_quotes(name),
                               in_quotes(body_));
      return false;
    }
    found.push_back({.name = name, .body_camera = *pose});
  }
  cameras_ = std::move(found);
  return true;
}

std::optional<SE3d> Surroundings::odometry_at(std::int64_t stamp_ns) const {
  const LiveNodeSettings& node = settings_->node;
  if (node.odometry_topic.empty())
    return frames_.at(node.odom_frame, body_, stamp_ns, node.max_gap_s);
  const auto pose = odometry_.at(stamp_ns, node.max_gap_s);
  const auto to_body = frames_.at(base_, body_, stamp_ns, node.max_gap_s);
  if (!pose || !to_body) return std::nullopt;
  return *pose * *to_body;
}

}  // namespace posemix::internal
