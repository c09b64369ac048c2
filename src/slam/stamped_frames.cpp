// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <iterator>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/base/limits.hpp"
#include "posemix/slam/stamped_slam.hpp"

/// Frames that may hold objects, and objects ahead of the newest stamp.
namespace posemix {

std::size_t StampedSlam::frame_index(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found != names_.end()) return static_cast<std::size_t>(found - names_.begin());
  throw InvalidInput(
      fmt::format("there is no frame '{}', expected one of: {}", name,
                  names_.empty() ? "none" : fmt::format("{}", fmt::join(names_, ", "))));
}

StampAdmission StampedSlam::add_frame(std::string_view name, double stamp_s,
                                      const KnownFrame& frame) {
  const std::size_t index = frame_index(name);
  auto& poses = known_frames_[index];
  validate(frame);
  const StampAdmission admission = admit(stamp_s);
  if (admission == StampAdmission::too_late) {
    ++counts_.too_late;
    return admission;
  }
  if (newest_ && stamp_s < *newest_ - settings_.jump_back_s) reset();
  if (poses.contains(stamp_s)) {
    throw InvalidInput(fmt::format(
        "there is a pose of the frame '{}' at the stamp {:.6f} s already", name, stamp_s));
  }
  const auto added = poses.emplace(stamp_s, frame).first;
  auto& first = first_poses_[index];
  first = std::min(stamp_s, first.value_or(stamp_s));
  // Since the pose before, the frame has moved otherwise now.
  constexpr double kAlways = -std::numeric_limits<double>::infinity();
  double unchanged = kAlways;
  if (added != poses.begin()) {
    const double before = std::prev(added)->first;
    unchanged = stamp_s - before > settings_.history_s ? std::nextafter(stamp_s, kAlways) : before;
  }
  play_again_after(unchanged);
  newest_ = std::max(stamp_s, newest_.value_or(stamp_s));
  ++(admission == StampAdmission::taken ? counts_.taken : counts_.replayed);
  forget_old();
  return admission;
}

std::optional<KnownFrame> StampedSlam::frame_at(std::size_t frame, double stamp_s) const {
  const auto& poses = known_frames_[frame];
  if (poses.empty()) return std::nullopt;
  const auto after = poses.lower_bound(stamp_s);
  if (after == poses.begin()) return after->second;
  const auto before = std::prev(after);
  if (after == poses.end()) return before->second;
  const double interval = after->first - before->first;
  if (after->first != stamp_s && interval > settings_.history_s) return before->second;
  const double part = (stamp_s - before->first) / interval;
  if (part == 1.0) return after->second;
  const KnownFrame& a = before->second;
  const KnownFrame& b = after->second;
  return KnownFrame{a.pose * SE3d::exp(part * (a.pose.inverse() * b.pose).log()),
                    (1.0 - part) * a.covariance + part * b.covariance};
}

std::vector<std::string> StampedSlam::missing_frames() const {
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (now_.slam.moving().may_hold(i) && !first_poses_[i]) missing.push_back(names_[i]);
  return missing;
}

double StampedSlam::begin_s() const {
  constexpr double kNoBegin = std::numeric_limits<double>::infinity();
  double begin = -kNoBegin;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (!now_.slam.moving().may_hold(i)) continue;
    begin = std::max(begin, first_poses_[i] ? *first_poses_[i] - settings_.history_s : kNoBegin);
  }
  return begin;
}

std::optional<PoseDensity> StampedSlam::object_at(std::string_view id, double stamp_s) {
  kStamp.check(stamp_s, "the stamp");
  const auto& now = estimate();
  if (!now) return std::nullopt;
  if (stamp_s < now->stamp_s) {
    throw InvalidInput(
        fmt::format("the stamp is {:.6f} s, expected {:.6f} s or later", stamp_s, now->stamp_s));
  }
  return now_.slam.object_at(now->estimate.index_of(id), stamp_s - now->stamp_s);
}

}  // namespace posemix
