// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/stamped_slam.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "observation_order.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/limits.hpp"
#include "slam/searched_image.hpp"

namespace posemix {
namespace {

/// The motion between two poses must be one that a filter takes, whatever their rotations.
constexpr double kFarthestOdometry = kFarthestPosition / 4.0;

/// Frames between two checkpoints, at most. A late one is played again with those behind it.
constexpr std::ptrdiff_t kFramesApart = 4;

double stamp_of(const std::optional<EstimateAtStamp>& estimate) {
  return estimate ? estimate->stamp_s : -std::numeric_limits<double>::infinity();
}

/// Takes out checkpoints that are nearer to each other than a part of their age: input is more
/// often a little late than very late.
template <class Checkpoints>
void thin_out(Checkpoints& checkpoints, double interval_s) {
  constexpr double kPartOfAge = 0.5;
  const double now = stamp_of(checkpoints.back().estimate);
  for (std::size_t i = checkpoints.size() - 1; i-- > 1;) {
    const double before = stamp_of(checkpoints[i - 1].estimate);
    const double apart = stamp_of(checkpoints[i + 1].estimate) - before;
    if (apart <= std::min(interval_s, kPartOfAge * (now - before)))
      checkpoints.erase(checkpoints.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void require_positive(double value, const char* name) {
  if (value > 0.0 && std::isfinite(value)) return;
  throw InvalidInput(fmt::format("{} is {} s, expected a positive and finite time", name, value));
}

}  // namespace

StampedSlam::StampedSlam(const PoseDensity& body, std::vector<ObjectModel> objects,
                         const MultiObjectSlamSettings& settings, const MotionSettings& motion,
                         const StampedSlamSettings& stamped, bool record_hypotheses)
    : settings_(stamped),
      has_odometry_(motion.model == MotionModel::odometry || motion.model == MotionModel::given),
      is_given_(motion.model == MotionModel::given),
      initial_{MultiObjectSlam(body, std::move(objects), settings, motion, record_hypotheses)},
      now_(initial_),
      checkpoints_{initial_},
      names_(settings.frames),
      known_frames_(settings.frames.size()),
      first_poses_(settings.frames.size()) {
  require_positive(stamped.history_s, "history_s");
  require_positive(stamped.jump_back_s, "jump_back_s");
  require_positive(stamped.jump_ahead_s, "jump_ahead_s");
  if (stamped.jump_back_s < stamped.history_s) {
    throw InvalidInput(fmt::format("jump_back_s is {}, expected at least history_s, which is {}",
                                   stamped.jump_back_s, stamped.history_s));
  }
  require(stamped.checkpoints > 0, "checkpoints is 0, expected at least 1");
}

StampAdmission StampedSlam::admit(double stamp_s) {
  kStamp.check(stamp_s, "the stamp");
  if (!newest_) return StampAdmission::taken;
  if (stamp_s > *newest_ + settings_.jump_ahead_s) {
    throw InvalidInput(
        fmt::format("the stamp {:.6f} s is more than {} s ahead of the newest before it, {:.6f} s",
                    stamp_s, settings_.jump_ahead_s, *newest_));
  }
  if (stamp_s >= *newest_) return StampAdmission::taken;
  if (stamp_s >= *newest_ - settings_.history_s) return StampAdmission::replayed;
  if (stamp_s >= *newest_ - settings_.jump_back_s) return StampAdmission::too_late;
  if (settings_.on_jump_back == StampJump::refuse) {
    throw InvalidInput(fmt::format(
        "the stamp {:.6f} s is more than {} s before the newest, {:.6f} s: the clock has "
        "jumped back (expected a reset, or on_jump_back = \"reset\")",
        stamp_s, settings_.jump_back_s, *newest_));
  }
  return StampAdmission::taken;
}

void StampedSlam::reset() {
  now_ = initial_;
  checkpoints_ = {initial_};
  frames_.clear();
  odometry_.clear();
  for (auto& poses : known_frames_) poses.clear();
  for (auto& first : first_poses_) first.reset();
  newest_.reset();
  ++counts_.resets;
}

StampAdmission StampedSlam::add(const Observation& observation) {
  now_.slam.check(observation);
  return add_to_frame(observation.stamp_s, [&](Frame& frame) {
    auto& all = frame.observations;
    all.insert(std::upper_bound(all.begin(), all.end(), observation, internal::comes_before),
               observation);
  });
}

StampAdmission StampedSlam::add_image(double stamp_s, const std::string& camera) {
  return add_image(stamp_s, camera, std::nullopt);
}

StampAdmission StampedSlam::add_image(double stamp_s, const std::string& camera,
                                      const std::optional<std::string>& detector) {
  index_of_camera(now_.slam.cameras(), camera);  // which throws for another name
  const std::string name = internal::name_of({camera, detector});
  const auto named = internal::searched_image(now_.slam.cameras(), name);
  if (named.camera != camera || named.detector != detector) {
    throw InvalidInput(fmt::format(
        "an image of camera '{}' by detector '{}' has the name of one of camera '{}', expected "
        "names of cameras without '@'",
        camera, detector.value_or(""), named.camera));
  }
  now_.slam.check_image(name);
  return add_to_frame(stamp_s, [&](Frame& frame) { frame.images.insert(name); });
}

StampAdmission StampedSlam::forget(std::string_view id, std::optional<double> stamp_s) {
  if (!is_object(id)) {
    std::vector<std::string_view> ids;
    for (const ObjectModel& model : now_.slam.objects()) ids.emplace_back(model.id);
    throw InvalidInput(
        fmt::format("there is no object '{}', expected one of: {}", id, fmt::join(ids, ", ")));
  }
  if (!stamp_s && !newest_) return StampAdmission::taken;  // nothing was seen so far
  if (stamp_s && newest_ && *stamp_s > *newest_ + settings_.jump_back_s) {
    // Input that comes after it would seem to have jumped back.
    throw InvalidInput(
        fmt::format("object '{}' is forgotten at the stamp {:.6f} s, expected at most {:g} s after "
                    "the newest input, which is at {:.6f} s",
                    id, *stamp_s, settings_.jump_back_s, *newest_));
  }
  return add_to_frame(stamp_s.value_or(*newest_),
                      [&](Frame& frame) { frame.forgotten.emplace(id); });
}

bool StampedSlam::is_object(std::string_view id) const {
  const auto has_id = [&](const ObjectModel& model) { return model.id == id; };
  if (std::ranges::any_of(now_.slam.objects(), has_id)) return true;
  // Objects on sight are there when their first sighting is played.
  const auto names_it = [&](const Observation& seen) { return seen.object == id; };
  return std::ranges::any_of(frames_, [&](const auto& frame) {
    return std::ranges::any_of(frame.second.observations, names_it);
  });
}

template <class Change>
StampAdmission StampedSlam::add_to_frame(double stamp, const Change& change) {
  const StampAdmission admission = admit(stamp);
  if (admission == StampAdmission::too_late) {
    ++counts_.too_late;
    return admission;
  }
  if (newest_ && stamp < *newest_ - settings_.jump_back_s) reset();
  change(frames_[stamp]);
  play_again_after(std::nextafter(stamp, -std::numeric_limits<double>::infinity()));
  newest_ = std::max(stamp, newest_.value_or(stamp));
  ++(admission == StampAdmission::taken ? counts_.taken : counts_.replayed);
  forget_old();
  return admission;
}

StampAdmission StampedSlam::add_odometry(double stamp_s, const SE3d& odom_body) {
  require(has_odometry_,
          "the motion model has no odometry, expected the model `odometry` or `given`");
  require(odom_body.matrix().allFinite() &&
              odom_body.translation().cwiseAbs().maxCoeff() <= kFarthestOdometry,
          "the pose of the odometry is not finite, or is beyond 2.5e7 m");
  now_.slam.check_camera(odom_body);
  const StampAdmission admission = admit(stamp_s);
  if (admission == StampAdmission::too_late) {
    ++counts_.too_late;
    return admission;
  }
  if (newest_ && stamp_s < *newest_ - settings_.jump_back_s) reset();
  if (odometry_.contains(stamp_s)) {
    throw InvalidInput(
        fmt::format("there is a pose of the odometry at the stamp {:.6f} s already", stamp_s));
  }
  const auto after = odometry_.emplace(stamp_s, odom_body).first;
  frames_[stamp_s].odometry = odom_body;
  // The motion since the pose before is another one now.
  play_again_after(after == odometry_.begin() ? -std::numeric_limits<double>::infinity()
                                              : std::prev(after)->first);
  newest_ = std::max(stamp_s, newest_.value_or(stamp_s));
  ++(admission == StampAdmission::taken ? counts_.taken : counts_.replayed);
  forget_old();
  return admission;
}

const std::optional<EstimateAtStamp>& StampedSlam::estimate() {
  if (!newest_) return now_.estimate;
  // Odometry that may still come for an observation is newer by the history at most, and late by
  // the history at most.
  const double patient = std::nextafter(*newest_ - 2.0 * settings_.history_s,
                                        -std::numeric_limits<double>::infinity());
  play(has_odometry_ ? std::max(newest_odometry().value_or(patient), patient) : *newest_);
  return now_.estimate;
}

const std::optional<EstimateAtStamp>& StampedSlam::finish() {
  if (const auto missing = missing_frames(); newest_ && !missing.empty()) {
    throw InvalidInput(fmt::format(
        "there is no estimate: '{}', which may hold an object, had no pose so far", missing[0]));
  }
  if (newest_) play(*newest_);
  return now_.estimate;
}

std::size_t StampedSlam::waiting() const {
  const bool waits = !missing_frames().empty();
  if (!has_odometry_ && !waits) return 0;
  std::size_t count = 0;
  const auto from = waits ? std::nullopt : newest_odometry();
  for (auto frame = from ? frames_.upper_bound(*from) : frames_.begin(); frame != frames_.end();
       ++frame)
    count += frame->second.observations.size();
  return count;
}

std::optional<double> StampedSlam::newest_odometry() const {
  return odometry_.empty() ? std::nullopt : std::optional(odometry_.rbegin()->first);
}

/// Goes back to the last state that the input after `stamp_s` does not change.
void StampedSlam::play_again_after(double stamp_s) {
  while (checkpoints_.size() > 1 && stamp_of(checkpoints_.back().estimate) > stamp_s)
    checkpoints_.pop_back();
  if (stamp_of(now_.estimate) > stamp_s) now_ = checkpoints_.back();
}

void StampedSlam::play(double until_s) {
  const double interval = settings_.history_s / static_cast<double>(settings_.checkpoints);
  const double begin = begin_s();
  auto frame = now_.estimate && now_.estimate->stamp_s >= begin
                   ? frames_.upper_bound(now_.estimate->stamp_s)
                   : frames_.lower_bound(begin);
  for (; frame != frames_.end() && frame->first <= until_s; ++frame) {
    play_frame(frame->first, frame->second);
    const double last = stamp_of(checkpoints_.back().estimate);
    const auto after = frames_.upper_bound(last);
    if (frame->first < last + interval && std::distance(after, frame) + 1 < kFramesApart) continue;
    checkpoints_.push_back(now_);
    thin_out(checkpoints_, interval);
  }
}

void StampedSlam::play_frame(double stamp_s, const Frame& frame) {
  FrameInput input;
  input.observations = frame.observations;
  input.images.assign(frame.images.begin(), frame.images.end());
  if (now_.estimate) {
    const double before = now_.estimate->stamp_s;
    input.dt = stamp_s - before;
    const auto from = odometry_at(before);
    const auto to = odometry_at(stamp_s);
    if (from && to) input.motion = from->inverse() * *to;
  }
  if (is_given_) input.camera = odometry_at(stamp_s);
  for (std::size_t i = 0; i < names_.size(); ++i) input.frames.push_back(frame_at(i, stamp_s));
  FrameEstimate estimate = now_.slam.step(input);
  for (const std::string& id : frame.forgotten) {
    const auto object = std::ranges::find(*estimate.ids, id);
    if (object == estimate.ids->end())
      continue;  // a sighting of it came before, and is too old now
    now_.slam.forget(static_cast<std::size_t>(object - estimate.ids->begin()), estimate);
  }
  now_.estimate = {stamp_s, std::move(estimate)};
}

std::optional<SE3d> StampedSlam::odometry_at(double stamp_s) const {
  const auto after = odometry_.lower_bound(stamp_s);
  if (after == odometry_.end()) return std::nullopt;
  if (after->first == stamp_s) return after->second;
  if (after == odometry_.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const double interval = after->first - before->first;
  if (interval > settings_.history_s) return std::nullopt;
  const double part = (stamp_s - before->first) / interval;
  return before->second * SE3d::exp(part * (before->second.inverse() * after->second).log());
}

/// What no input changes that can still come: late odometry changes the motion since the pose
/// before it.
void StampedSlam::forget_old() {
  const double oldest = *newest_ - 2.0 * settings_.history_s;
  while (checkpoints_.size() > 1 && stamp_of(checkpoints_[1].estimate) < oldest)
    checkpoints_.pop_front();
  const double begin = begin_s();
  const double played = stamp_of(checkpoints_.front().estimate);
  // What comes before the first poses of frames is never played.
  const auto unused = frames_.lower_bound(std::min(begin, oldest));
  for (auto frame = frames_.begin(); frame != unused; ++frame)
    counts_.too_late += frame->second.observations.size();
  frames_.erase(frames_.begin(), unused);
  frames_.erase(frames_.begin(), frames_.upper_bound(played));
  const double kept = std::isinf(begin) && begin > 0.0 ? oldest : played;
  // The motion up to the first frame that is kept begins at the pose before the checkpoint.
  auto first = odometry_.upper_bound(kept);
  if (first != odometry_.begin()) --first;
  if (first != odometry_.begin()) --first;
  odometry_.erase(odometry_.begin(), first);
  for (auto& poses : known_frames_) {
    auto after = poses.upper_bound(std::min(kept, oldest));
    if (after != poses.begin()) poses.erase(poses.begin(), std::prev(after));
  }
}

}  // namespace posemix
