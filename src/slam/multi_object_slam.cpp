// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/multi_object_slam.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/stopwatch.hpp"
#include "slam/frames.hpp"
#include "slam/motion.hpp"

namespace posemix {
namespace {

MultiObjectFilter make_filter(const PoseDensity& camera, const std::vector<ObjectModel>& objects,
                              MultiObjectSettings settings, const MotionSettings& motion) {
  require_alike_in_class(objects);
  std::vector<ObjectSensor> sensors;
  for (const ObjectModel& object : objects) {
    if (object.independent_start) {
      throw InvalidInput(fmt::format(
          "object '{}' has an independent start, which the multi-object filter does not have",
          object.id));
    }
    sensors.push_back({object.noise, object.symmetries});
  }
  settings.has_odometry = motion.model == MotionModel::odometry;
  return {camera, std::move(sensors), settings};
}

}  // namespace

MultiObjectSlam::MultiObjectSlam(const PoseDensity& camera, std::vector<ObjectModel> objects,
                                 const MultiObjectSlamSettings& settings,
                                 const MotionSettings& motion, bool record_hypotheses)
    : objects_(std::move(objects)),
      settings_(settings),
      motion_(internal::checked(motion)),
      record_hypotheses_(record_hypotheses),
      filter_(make_filter(camera, objects_.models(), settings.filter, motion_)),
      sightings_(objects_.size()) {}

FrameEstimate MultiObjectSlam::step(const FrameInput& input) {
  const bool is_first = objects_.frames() == 0;
  objects_.begin(input);
  const Stopwatch frame;
  if (!is_first) internal::predict(filter_, internal::camera_step(motion_, input));

  FrameReport report;
  report.statuses.assign(objects_.size(), DetectionStatus::none);
  const Stopwatch updates;
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    if (input.detections[object]) update(object, *input.detections[object], report);
  }
  if (!input.candidates.empty()) update_by_candidates(input.candidates, report);
  report.update.update_seconds = updates.seconds();

  FrameEstimate estimate = frame_estimate(std::move(report));
  estimate.report.seconds = frame.seconds();
  return estimate;
}

void MultiObjectSlam::update(std::size_t object, const SE3d& detected, FrameReport& report) {
  const bool known = filter_.is_known(object);
  const ObjectUpdateReport update = filter_.update(object, detected);
  ++sightings_[object].count;
  sightings_[object].last_frame = objects_.frames();
  report.update.log_evidence += update.log_evidence;
  report.merges += update.merges;
  report.statuses[object] = !known                             ? DetectionStatus::started
                            : update.started                   ? DetectionStatus::birth
                            : update.clutter_probability > 0.5 ? DetectionStatus::doubted
                                                               : DetectionStatus::used;
}

void MultiObjectSlam::update_by_candidates(const std::vector<Candidate>& candidates,
                                           FrameReport& report) {
  std::map<std::string, std::vector<std::size_t>> models_of;
  for (std::size_t object = 0; object < objects_.size(); ++object)
    models_of[class_of(objects_[object])].push_back(object);
  std::map<std::string, std::vector<std::size_t>> candidates_of;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    candidates_of[candidates[i].class_id].push_back(i);
  for (auto& [name, members] : candidates_of) {
    std::stable_sort(members.begin(), members.end(), [&](std::size_t a, std::size_t b) {
      return candidates[a].score > candidates[b].score;
    });
  }

  report.candidates.assign(candidates.size(), {.status = CandidateStatus::dropped});
  for (const auto& [name, members] : candidates_of) {
    const auto models = models_of.find(name);
    if (models != models_of.end()) update_class(models->second, candidates, members, report);
  }
}

void MultiObjectSlam::update_class(const std::vector<std::size_t>& models,
                                   const std::vector<Candidate>& candidates,
                                   const std::vector<std::size_t>& members, FrameReport& report) {
  // Which instance each candidate is of, all at once.
  std::vector<std::size_t> instances;
  std::vector<PoseDensity> predicted;
  for (const std::size_t object : models) {
    const auto leading = filter_.leading(object);
    if (!leading) continue;
    instances.push_back(object);
    predicted.push_back(filter_.predicted_detection(object, *leading));
  }
  std::vector<Candidate> of_class;
  of_class.reserve(members.size());
  for (const std::size_t i : members) of_class.push_back(candidates[i]);
  const ObjectModel& model = objects_[models.front()];
  const std::vector<Association> associations =
      associate(predicted, of_class, model.noise.components().front(), model.symmetries,
                settings_.association);

  // The known before the new: a model that was seen in this frame is not used again.
  for (std::size_t i = 0; i < members.size(); ++i) {
    CandidateReport& candidate = report.candidates[members[i]];
    candidate.status = associations[i].status;
    if (candidate.status != CandidateStatus::assigned) continue;
    candidate.object = instances[associations[i].instance];
    update(*candidate.object, associations[i].camera_object, report);
  }
  for (std::size_t i = 0; i < members.size(); ++i) {
    CandidateReport& candidate = report.candidates[members[i]];
    if (candidate.status != CandidateStatus::fresh) continue;
    candidate = new_instance(models);
    if (candidate.object) update(*candidate.object, associations[i].camera_object, report);
  }
}

CandidateReport MultiObjectSlam::new_instance(const std::vector<std::size_t>& models) {
  std::optional<std::size_t> oldest;
  for (const std::size_t object : models) {
    if (!filter_.is_known(object)) return {.status = CandidateStatus::fresh, .object = object};
    const Sightings& seen = sightings_[object];
    if (seen.count >= settings_.confirming_detections || seen.last_frame == objects_.frames())
      continue;
    if (!oldest || seen.last_frame < sightings_[*oldest].last_frame) oldest = object;
  }
  if (!oldest) return {.status = CandidateStatus::dropped};
  filter_.forget(*oldest);
  sightings_[*oldest] = {};
  return {.status = CandidateStatus::fresh, .object = oldest, .recycled = true};
}

FrameEstimate MultiObjectSlam::frame_estimate(FrameReport report) const {
  std::vector<std::optional<std::size_t>> indices;
  for (std::size_t object = 0; object < objects_.size(); ++object)
    indices.push_back(pose_index(object));
  FrameEstimate frame{.camera = filter_.camera(),
                      .objects = {},
                      .relative = {},
                      .pose_indices = std::move(indices),
                      .report = std::move(report),
                      .ids = objects_.ids()};
  for (auto& one : filter_.leading_estimates()) {
    frame.objects.push_back(one ? std::optional(one->world) : std::nullopt);
    frame.relative.push_back(one ? std::optional(one->relative) : std::nullopt);
  }
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    frame.mode_probabilities.push_back(
        frame.objects[object] ? std::optional(filter_.mode_probability(object)) : std::nullopt);
    if (!record_hypotheses_) continue;
    std::vector<ObjectAlternative>& alternatives = frame.alternatives.emplace_back();
    for (const HypothesisMean& hypothesis : filter_.hypothesis_means(object))
      alternatives.push_back({hypothesis.probability, hypothesis.pose, hypothesis.id});
  }
  return frame;
}

}  // namespace posemix
