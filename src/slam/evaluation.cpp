// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/evaluation.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "paired_errors.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"
#include "run_checks.hpp"

namespace posemix {
namespace {

using Poses = std::vector<std::optional<SE3d>>;

const std::optional<SE3d>& entry(const Poses& poses, std::size_t frame) {
  static const std::optional<SE3d> none;
  if (poses.empty()) return none;
  internal::check_index(frame, poses.size(), "frame");
  return poses[frame];
}

const ObjectRecording& recording_of(const Sequence& sequence, std::size_t object) {
  internal::check_index(object, sequence.objects.size(), "object");
  return sequence.objects[object];
}

std::optional<SE3d> mean_of(const std::optional<PoseDensity>& density) {
  return density ? std::optional(density->mean()) : std::nullopt;
}

/// A pose and its truth, the nearest of the equivalent ones.
class NearestErrors {
 public:
  explicit NearestErrors(const ErrorReduction& reduction) : reduction_(reduction) {}

  void add(const std::optional<SE3d>& estimate, const std::optional<SE3d>& truth) {
    if (estimate && truth) sum_.add(estimate, reduction_.nearest(*truth, *estimate));
  }
  PoseErrors errors() const { return sum_.errors(); }

 private:
  const ErrorReduction& reduction_;
  PoseErrorSum sum_;
};

/// Consistency and the mode of one object's estimates, frame by frame.
class ObjectScores {
 public:
  explicit ObjectScores(const ErrorReduction& reduction) : reduction_(reduction) {}

  void add(const PoseDensity& relative, const SE3d& truth,
           const std::optional<double>& probability) {
    const double squared = reduction_.nees(relative, truth);
    const bool right = on_right_mode(relative.mean(), reduction_.nearest(truth, relative.mean()));
    nees_ += squared;
    ++count_;
    if (right) {
      right_nees_ += squared;
      ++right_;
    }
    if (probability) forecasts_.push_back({*probability, right});
  }

  void report(ObjectMetrics& metrics) && {
    const auto right = static_cast<double>(right_);
    const auto dof = static_cast<double>(reduction_.dof());
    metrics.right_mode_frames = right_;
    metrics.forecasts = std::move(forecasts_);
    if (count_ == 0) return;
    metrics.relative_anees = nees_ / (dof * static_cast<double>(count_));
    metrics.right_mode_share = right / static_cast<double>(count_);
    if (right_ > 0) metrics.right_mode_anees = right_nees_ / (dof * right);
  }

 private:
  const ErrorReduction& reduction_;
  double nees_ = 0.0;
  double right_nees_ = 0.0;
  std::size_t count_ = 0;
  std::size_t right_ = 0;
  std::vector<ModeForecast> forecasts_;
};

/// Whether a filter left the detection out or took it for a gross error.
bool is_unexplained(DetectionStatus status) {
  return status == DetectionStatus::gated || status == DetectionStatus::doubted ||
         status == DetectionStatus::birth;
}

std::optional<double> mode_probability(const FrameEstimate& frame, std::size_t object) {
  return frame.mode_probabilities.empty() ? std::nullopt : frame.mode_probabilities[object];
}

/// Existence and health of the object, where the tracker has them.
void add_health(const SlamRun& run, std::size_t object, ObjectMetrics& metrics) {
  const FrameEstimate& last = run.frames.back();
  if (last.healths.empty()) return;
  metrics.existence = last.existences[object];
  metrics.health = last.healths[object];
  metrics.health_shares.assign(words<TrackHealth>.size(), 0.0);
  for (const FrameEstimate& frame : run.frames) {
    // Objects on sight are unknown to earlier frames.
    const TrackHealth health =
        object < frame.healths.size() ? frame.healths[object] : TrackHealth::none;
    metrics.health_shares[static_cast<std::size_t>(health)] +=
        1.0 / static_cast<double>(run.frames.size());
  }
}

ObjectMetrics evaluate_object(const Sequence& sequence, const SlamRun& run, std::size_t object,
                              const ErrorReduction& reduction) {
  ObjectMetrics metrics;
  metrics.id = sequence.objects[object].id;
  NearestErrors world(reduction);
  NearestErrors relative(reduction);
  NearestErrors detection(reduction);
  ConsistencySum world_consistency(reduction);
  ConsistencySum relative_consistency(reduction);
  ObjectScores scores(reduction);
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const FrameEstimate& frame = run.frames[k];
    const auto& detected = sequence.objects[object].detections[k];
    const auto truth = true_relative_pose(sequence, object, k);
    const auto world_truth = true_world_pose(sequence, object, k);
    world.add(mean_of(frame.objects[object]), world_truth);
    world_consistency.add(frame.objects[object], world_truth);
    relative.add(mean_of(frame.relative[object]), truth);
    relative_consistency.add(frame.relative[object], truth);
    detection.add(detected, truth);
    // One that names a class is of the object if the filter says so.
    const bool taken = frame.report.statuses[object] != DetectionStatus::none;
    metrics.detections += detected.has_value() || taken ? 1 : 0;
    metrics.gated += frame.report.statuses[object] == DetectionStatus::gated ? 1 : 0;
    metrics.unexplained += is_unexplained(frame.report.statuses[object]) ? 1 : 0;
    if (frame.relative[object] && truth)
      scores.add(*frame.relative[object], *truth, mode_probability(frame, object));
  }
  metrics.world = world.errors();
  metrics.world_consistency = world_consistency.result();
  metrics.relative = relative.errors();
  metrics.relative_consistency = relative_consistency.result();
  metrics.detection_relative = detection.errors();
  metrics.paired = internal::paired_errors(sequence, run, object, reduction);
  std::move(scores).report(metrics);
  metrics.mode_probability = mode_probability(run.frames.back(), object);
  add_health(run, object, metrics);
  return metrics;
}

double median_or_zero(std::vector<double> values) {
  return values.empty() ? 0.0 : upper_median(std::move(values));
}

Timing timing_of(const SlamRun& run) {
  constexpr double kMicroseconds = 1e6;
  std::vector<double> frame_us;
  std::vector<double> update_us;
  std::vector<double> reduce_us;
  double merges = 0.0;
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const FrameReport& report = run.frames[k].report;
    frame_us.push_back(kMicroseconds * report.seconds);
    update_us.push_back(kMicroseconds * report.update.update_seconds);
    reduce_us.push_back(kMicroseconds * report.update.reduce_seconds);
    merges += static_cast<double>(report.merges);
  }
  const double count = std::max<double>(1.0, static_cast<double>(frame_us.size()));
  return {median_or_zero(std::move(frame_us)), median_or_zero(std::move(update_us)),
          median_or_zero(std::move(reduce_us)), merges / count};
}

void check_fit(const Sequence& sequence, const SlamRun& run,
               std::span<const SymmetryGroup> symmetries) {
  internal::require_fit(sequence, run);
  if (!symmetries.empty() && symmetries.size() != sequence.objects.size()) {
    throw InvalidInput(fmt::format("evaluation: got the symmetries of {} objects, expected {}",
                                   symmetries.size(), sequence.objects.size()));
  }
}

PoseErrors odometry_errors(const Sequence& sequence) {
  PoseErrorSum sum;
  std::optional<SE3d> world_odom;
  for (std::size_t k = 0; k < sequence.stamps.size(); ++k) {
    const auto& odometry = entry(sequence.odometry, k);
    const auto& truth = entry(sequence.camera_truth, k);
    if (!odometry || !truth) continue;
    if (!world_odom) world_odom = *truth * odometry->inverse();
    sum.add(*world_odom * *odometry, truth);
  }
  return sum.errors();
}

}  // namespace

bool on_right_mode(const SE3d& estimate, const SE3d& truth) {
  constexpr double kRotationDeg = 20.0;
  constexpr double kTranslationM = 0.1;
  const double angle = (truth.rotation().inverse() * estimate.rotation()).log().norm();
  return degrees(angle) < kRotationDeg &&
         (estimate.translation() - truth.translation()).norm() < kTranslationM;
}

void PoseErrorSum::add(const std::optional<SE3d>& estimate, const std::optional<SE3d>& truth) {
  if (!estimate || !truth) return;
  const Vector6d error = (*estimate * truth->inverse()).log();
  position_ += (estimate->translation() - truth->translation()).squaredNorm();
  rotation_ += error.head<3>().squaredNorm();
  position_log_ += error.tail<3>().squaredNorm();
  ++count_;
}

PoseErrors PoseErrorSum::errors() const {
  if (count_ == 0) return {};
  const auto rms = [&](double sum) { return std::sqrt(sum / static_cast<double>(count_)); };
  return {rms(position_), degrees(rms(rotation_)), rms(position_log_)};
}

void ConsistencySum::add(const std::optional<PoseDensity>& estimate,
                         const std::optional<SE3d>& truth) {
  if (!estimate || !truth) return;
  const ObservedError error = reduction_(*estimate, *truth);
  nees_.push_back(error.pose.nees() / static_cast<double>(reduction_.dof()));
  rotation_ += error.rotation.nees();
  position_ += error.position.nees();
}

Consistency ConsistencySum::result() const {
  if (nees_.empty()) return {};
  const auto count = static_cast<double>(nees_.size());
  const auto rotations = static_cast<double>(reduction_.rotation_dof());
  Consistency result{mean(nees_), median(nees_), std::nullopt, position_ / (3.0 * count)};
  if (rotations > 0.0) result.rotation_anees = rotation_ / (rotations * count);
  return result;
}

std::optional<SE3d> true_relative_pose(const Sequence& sequence, std::size_t object,
                                       std::size_t frame) {
  const ObjectRecording& recording = recording_of(sequence, object);
  if (const auto& relative = entry(recording.relative_truth, frame)) return relative;
  const auto& world = entry(recording.world_truth, frame);
  const auto& camera = entry(sequence.camera_truth, frame);
  if (!world || !camera) return std::nullopt;
  return camera->inverse() * *world;
}

std::optional<SE3d> true_world_pose(const Sequence& sequence, std::size_t object,
                                    std::size_t frame) {
  const ObjectRecording& recording = recording_of(sequence, object);
  if (const auto& world = entry(recording.world_truth, frame)) return world;
  const auto& relative = entry(recording.relative_truth, frame);
  const auto& camera = entry(sequence.camera_truth, frame);
  if (!relative || !camera) return std::nullopt;
  return *camera * *relative;
}

Metrics evaluate(const Sequence& sequence, const SlamRun& run,
                 std::span<const SymmetryGroup> symmetries) {
  check_fit(sequence, run, symmetries);
  Metrics metrics;
  metrics.frames = run.frames.size();
  PoseErrorSum camera;
  ConsistencySum consistency;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    camera.add(run.frames[k].camera.mean(), entry(sequence.camera_truth, k));
    consistency.add(run.frames[k].camera, entry(sequence.camera_truth, k));
  }
  metrics.camera = camera.errors();
  metrics.camera_consistency = consistency.result();
  metrics.odometry = odometry_errors(sequence);
  for (std::size_t object = 0; object < sequence.objects.size(); ++object) {
    const ErrorReduction reduction(symmetries.empty() ? SymmetryGroup() : symmetries[object]);
    metrics.objects.push_back(evaluate_object(sequence, run, object, reduction));
  }
  metrics.timing = timing_of(run);
  return metrics;
}

Metrics evaluate(const SlamJob& job, const SlamRun& run) {
  std::vector<SymmetryGroup> symmetries;
  symmetries.reserve(job.models.size());
  for (const ObjectModel& model : job.models) symmetries.push_back(model.symmetries);
  return evaluate(job.sequence, run, symmetries);
}

}  // namespace posemix
