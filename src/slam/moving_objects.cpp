// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/moving_objects.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "filter/world_shift.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/limits.hpp"
#include "slam/semidefinite.hpp"

namespace posemix {

bool is_static(const MotionModels& motion) {
  return std::ranges::all_of(motion.models, [](const ObjectMotion& model) {
    return std::holds_alternative<StaticMotion>(model);
  });
}

std::optional<PutDownMotion> put_down_of(const MotionModels& motion) {
  if (motion.models.size() != 1) return std::nullopt;
  const auto* put_down = std::get_if<PutDownMotion>(&motion.models.front());
  return put_down != nullptr ? std::optional(*put_down) : std::nullopt;
}

bool has_own_track(const MotionModels& motion) {
  return !is_static(motion) && !put_down_of(motion);
}

void require_static(const std::vector<ObjectModel>& models, const std::string& where) {
  for (const ObjectModel& model : models) {
    if (is_static(model.motion)) continue;
    throw InvalidInput(
        fmt::format("{}: object '{}' moves by the model '{}', expected objects that stand still",
                    where, model.id, name_of(model.motion.models.front())));
  }
}

void report_moving(std::size_t object, const MovingObjectEstimate& estimate, bool with_alternatives,
                   FrameEstimate& frame) {
  require(!estimate.hypotheses.empty(), "the estimate of a moving object has no hypothesis");
  const auto entry = [&](auto& entries) -> auto& {
    internal::check_index(object, entries.size(), "object");
    return entries[object];
  };
  const MovingObjectHypothesis& leading = estimate.hypotheses.front();
  entry(frame.objects) = leading.world;
  entry(frame.mode_probabilities) = leading.probability;
  entry(frame.motion_models) = estimate.models;
  entry(frame.twists) = ObjectTwist{leading.twist, leading.twist_covariance};
  if (!with_alternatives) return;
  for (const MovingObjectHypothesis& one : estimate.hypotheses)
    entry(frame.alternatives).push_back({one.probability, one.world.mean(), one.id});
}

std::vector<ObjectHypothesis> hypotheses_of(const MovingObjectEstimate& estimate,
                                            const Matrix6d& camera) {
  std::vector<ObjectHypothesis> list;
  list.reserve(estimate.hypotheses.size());
  for (const MovingObjectHypothesis& one : estimate.hypotheses) {
    list.push_back({.pose = one.world.mean(),
                    .covariance = one.world.covariance(),
                    .cross_covariance = camera,
                    .log_weight = std::log(one.probability),
                    .probability = one.probability,
                    .id = one.id,
                    .detections = one.detections});
  }
  return list;
}

MovingObjects::MovingObjects(const MovingObjectSettings& settings, std::vector<std::string> frames)
    : settings_(settings),
      names_(std::move(frames)),
      may_hold_(names_.size()),
      frames_(names_.size()) {}

void MovingObjects::require_valid(const ObjectModel& model) const {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(fmt::format("object '{}': {}", model.id, why));
  };
  if (!model.detectors.empty()) {
    refuse(
        fmt::format("it moves and has {} noise models of detectors, expected one: a moving "
                    "object is seen by one detector",
                    model.detectors.size() + 1));
  }
  if (model.prior) refuse("it moves and has a prior, expected none");
  for (const ObjectMotion& motion : model.motion.models) {
    const auto* attached = std::get_if<AttachedMotion>(&motion);
    if (attached == nullptr || attached->frame < names_.size()) continue;
    refuse(fmt::format("it may be held by frame {}, expected one of the {} frames of the settings",
                       attached->frame, names_.size()));
  }
  try {
    MovingObjectFilter({model.noise, model.symmetries}, model.motion, settings_);
  } catch (const InvalidInput& error) {
    refuse(error.what());
  }
}

void MovingObjects::expect(const ObjectModel& model) {
  require_valid(model);
  for (const ObjectMotion& motion : model.motion.models)
    if (const auto* attached = std::get_if<AttachedMotion>(&motion))
      may_hold_[attached->frame] = true;
}

void MovingObjects::add(std::size_t object, const ObjectModel& model) {
  expect(model);
  const MovingObjectFilter filter({model.noise, model.symmetries}, model.motion, settings_);
  tracks_.insert_or_assign(object, Track{filter, filter});
}

bool MovingObjects::is_known(std::size_t object) const {
  const auto found = tracks_.find(object);
  return found != tracks_.end() && found->second.filter.observation_count() > 0;
}

void MovingObjects::forget(std::size_t object) { track(object).filter = track(object).unseen; }

std::vector<KnownFrame> MovingObjects::known_frames() const {
  std::vector<KnownFrame> known;
  known.reserve(frames_.size());
  for (const auto& frame : frames_) known.push_back(frame.value_or(KnownFrame()));
  return known;
}

void MovingObjects::require_moving(std::size_t object) const {
  if (!has(object))
    throw InvalidInput(fmt::format("object {} does not move, it has no track of its own", object));
}

const MovingObjectFilter& MovingObjects::filter(std::size_t object) const {
  require_moving(object);
  return tracks_.at(object).filter;
}

void MovingObjects::check(const FrameInput& input) const {
  if (!input.frames.empty() && input.frames.size() != names_.size()) {
    throw InvalidInput(fmt::format("frame: {} poses of frames, expected one for each of: {}",
                                   input.frames.size(), fmt::join(names_, ", ")));
  }
  for (std::size_t i = 0; i < input.frames.size(); ++i) {
    if (!input.frames[i]) continue;
    try {
      validate(*input.frames[i]);
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("frame: the frame '{}': {}", names_[i], error.what()));
    }
  }
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (!may_hold_[i] || frames_[i] || (!input.frames.empty() && input.frames[i])) continue;
    throw InvalidInput(fmt::format(
        "frame: '{}', which may hold an object, had no pose so far, expected one from the first "
        "frame on",
        names_[i]));
  }
}

void MovingObjects::begin(double dt, const std::vector<std::optional<KnownFrame>>& frames) {
  kTimeStep.check(dt, "dt");
  if (!frames.empty() && frames.size() != names_.size())
    throw InvalidInput(fmt::format("{} poses of frames, expected none or one for each of the {}",
                                   frames.size(), names_.size()));
  for (const auto& frame : frames)
    if (frame) validate(*frame);
  time_s_ += dt;
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (frames[i]) frames_[i] = frames[i];
  const std::vector<KnownFrame> known = known_frames();
  for (auto& [object, track] : tracks_) track.filter.predict(time_s_, known);
}

// With the gain G = P_before P_predicted^-1 of the error before on that of now, a correction d of
// the camera is one of the error before by G d, and the error has changed by (I - G) d with the
// covariance (I - G) P_now (I - G)^T + P_before - G P_before.
void MovingObjects::follow(const PoseDensity& before, const PoseDensity& predicted,
                           const PoseDensity& now) {
  // In a world whose origin is near the camera, where the covariances keep their digits.
  const internal::WorldShift near = internal::shift_near(now.mean());
  const auto covariance = [&](const PoseDensity& pose) {
    return near.is_none() ? pose.covariance() : near(pose).covariance();
  };
  const Matrix6d p_before = covariance(before);
  const Matrix6d p_now = covariance(now);
  const SE3d predicted_there = near(predicted.mean());
  const Matrix6d gain = covariance(predicted).llt().solve(p_before).transpose();
  const Vector6d corrected = (near(now.mean()) * predicted_there.inverse()).log();
  const Matrix6d rest = Matrix6d::Identity() - gain;
  const Matrix6d added =
      internal::semidefinite(rest * p_now * rest.transpose() + p_before - gain * p_before);
  const SE3d by = SE3d::exp(Vector6d(gain * corrected));
  if (near.is_none()) {
    move_world(by, added, now.covariance());
    return;
  }
  // In the world that is given: S^-1 by S, where S is the shift.
  const internal::WorldShift back = near.inverse();
  Matrix6d added_there = back(added);
  symmetrize(added_there);
  move_world(back(by * near(SE3d())), added_there, now.covariance());
}

// The object is where it is in the world, and the camera, which says where it sees it, is wrong.
void MovingObjects::camera_begins_to_last(const PoseDensity& now) {
  move_world(SE3d(), now.covariance(), now.covariance());
}

void MovingObjects::camera_ceases_to_last(const PoseDensity& before) {
  move_world(SE3d(), before.covariance(), Matrix6d::Zero());
}

void MovingObjects::move_world(const SE3d& by, const Matrix6d& added, const Matrix6d& constant) {
  constant_ = constant;
  for (auto& [object, track] : tracks_) track.filter.move_world(by, added, constant);
}

ObjectUpdateReport MovingObjects::update(std::size_t object, Observation observation,
                                         const KnownCamera& camera) {
  observation.stamp_s = time_s_;
  const MovingObjectReport report =
      track(object).filter.update(observation, camera, known_frames());
  constant_ = camera.constant_covariance;
  return {.started = report.started,
          .changed_leader = report.changed_leader,
          .log_evidence = report.log_evidence,
          .merges = report.merges,
          .inlier_probability = report.inlier_probability,
          .clutter_probability = 1.0 - report.right_probability,
          .nis = report.nis,
          .residual = report.residual};
}

PoseDensity MovingObjects::predicted_detection(std::size_t object,
                                               const KnownCamera& camera) const {
  return filter(object).predicted_detection(camera);
}

void MovingObjects::report(const KnownCamera& camera, bool with_alternatives,
                           FrameEstimate& frame) const {
  for (const auto& [object, track] : tracks_) {
    if (!is_known(object)) continue;
    const MovingObjectEstimate estimate = track.filter.estimate();
    if (estimate.hypotheses.empty()) continue;
    report_moving(object, estimate, with_alternatives, frame);
    internal::check_index(object, frame.relative.size(), "object");
    frame.relative[object] = track.filter.relative(camera);
  }
}

std::vector<ObjectHypothesis> MovingObjects::hypotheses(std::size_t object) const {
  if (!is_known(object)) return {};
  return hypotheses_of(filter(object).estimate(), constant_);
}

double MovingObjects::lost_probability(std::size_t object) const {
  return filter(object).estimate().lost_probability;
}

std::optional<MovingObjectHypothesis> MovingObjects::at(std::size_t object, double dt) const {
  if (!is_known(object)) return std::nullopt;
  const auto hypotheses = filter(object).estimate_at(time_s_ + dt).hypotheses;
  return hypotheses.empty() ? std::nullopt : std::optional(hypotheses.front());
}

}  // namespace posemix
