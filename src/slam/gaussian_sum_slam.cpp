// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/gaussian_sum_slam.hpp"

#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/stopwatch.hpp"
#include "posemix/slam/moving_objects.hpp"
#include "slam/frames.hpp"
#include "slam/motion.hpp"

namespace posemix {
namespace {

GaussianSumFilter make_filter(const PoseDensity& camera, GaussianSumSettings settings,
                              const MotionSettings& motion) {
  Hypothesis start = internal::camera_hypothesis(camera, motion);
  settings.first_object = start.mean().size();
  return {Posterior({{0.0, std::move(start)}}), settings};
}

}  // namespace

GaussianSumSlam::GaussianSumSlam(const PoseDensity& camera, std::vector<ObjectModel> objects,
                                 const GaussianSumSettings& settings, const MotionSettings& motion,
                                 bool record_hypotheses)
    : objects_(std::move(objects)),
      motion_(internal::checked(motion)),
      record_hypotheses_(record_hypotheses),
      filter_(make_filter(camera, settings, motion_)),
      indices_(objects_.size()),
      counts_(objects_.size()),
      estimate_(filter_.summarise()) {
  require_static(objects_.models(), "the Gaussian-sum filter");
  internal::require_not_given(motion_, "the Gaussian-sum filter");
}

FrameEstimate GaussianSumSlam::step(const FrameInput& input) {
  internal::require_plain_detections(input, "the Gaussian-sum filter");
  objects_.check(input);
  const auto detections = internal::all_detections(input, objects_.size());
  const KnownDetections known = known_of(detections);
  filter_.check(known.detections);
  const bool is_first = objects_.frames() == 0;
  objects_.begin(input);
  const Stopwatch frame;
  if (!is_first) {
    const internal::CameraStep moved = internal::camera_step(motion_, input);
    filter_.predict([&moved](Hypothesis hypothesis) {
      return internal::predict(std::move(hypothesis), moved);
    });
  }

  FrameReport report;
  report.statuses.assign(objects_.size(), DetectionStatus::none);
  report.nis.assign(objects_.size(), std::nullopt);
  update_known(known, report);
  add_new(detections, report);

  estimate_ = filter_.summarise();
  report.seconds = frame.seconds();
  FrameEstimate estimate =
      internal::frame_estimate(estimate_, indices_, objects_.ids(), std::move(report));
  if (record_hypotheses_) estimate.hypotheses = internal::snapshots(filter_.posterior());
  return estimate;
}

GaussianSumSlam::KnownDetections GaussianSumSlam::known_of(const Detections& detections) const {
  KnownDetections known;
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    if (!detections[object] || !indices_[object]) continue;
    known.detections.push_back({*indices_[object], *detections[object], &objects_[object].noise});
    known.objects.push_back(object);
  }
  return known;
}

void GaussianSumSlam::update_known(const KnownDetections& known, FrameReport& report) {
  report.update = filter_.update(known.detections);
  for (std::size_t i = 0; i < known.objects.size(); ++i) {
    ++counts_[known.objects[i]];
    report.nis[known.objects[i]] = report.update.nis[i];
    report.statuses[known.objects[i]] = report.update.gated[i]    ? DetectionStatus::gated
                                        : report.update.failed[i] ? DetectionStatus::failed
                                                                  : DetectionStatus::used;
  }
  for (const ReductionReport& reduction : report.update.reductions)
    report.merges += reduction.merges.size();
}

/// Objects seen for the first time enter the map.
void GaussianSumSlam::add_new(const Detections& detections, FrameReport& report) {
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    if (!detections[object] || indices_[object]) continue;
    const ObjectModel& model = objects_[object];
    indices_[object] =
        model.independent_start
            ? filter_.add_independent_object(*detections[object], *model.independent_start)
            : filter_.add_object(*detections[object], model.noise);
    report.statuses[object] = DetectionStatus::started;
    ++counts_[object];
  }
}

}  // namespace posemix
