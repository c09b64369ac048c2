// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <utility>

#include "slam/smoothing_moving.hpp"

namespace posemix::internal {
namespace {

/// The entries of the first frames, where there are any.
template <class T>
void keep_first(std::vector<T>& all, std::size_t frames) {
  all.resize(std::min(frames, all.size()));
}

/// The frame from which on every object is the one that it is in the end: the last in which a
/// detection of its class began it. None for those that the filter does not have in the end.
std::vector<std::optional<std::size_t>> beginnings(const std::vector<FrameEstimate>& frames) {
  const std::size_t objects = frames.back().objects.size();
  std::vector<std::optional<std::size_t>> first(objects);
  for (std::size_t j = 0; j < objects; ++j)
    if (frames.back().objects[j]) first[j] = 0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const FrameReport& report = frames[k].report;
    for (const auto* list : {&report.candidates, &report.observations}) {
      for (const CandidateReport& one : *list)
        if (one.status == CandidateStatus::fresh && one.object && first[*one.object])
          first[*one.object] = k;
    }
  }
  return first;
}

/// The observations of one frame under the ids of objects, those of classes by the filter's report.
class NamedFrame {
 public:
  NamedFrame(const std::vector<ObjectModel>& models,
             const std::vector<std::optional<std::size_t>>& beginnings, std::size_t frame)
      : models_(models), beginnings_(beginnings), frame_(frame) {}

  void add(Observation observation, const CandidateReport& report) {
    if (!report.object || !beginnings_[*report.object]) return;
    if (*beginnings_[*report.object] > frame_) return;
    observation.object = models_[*report.object].id;
    observation.class_id.clear();
    observations.push_back(std::move(observation));
  }

  std::vector<Observation> observations = {};

 private:
  const std::vector<ObjectModel>& models_;
  const std::vector<std::optional<std::size_t>>& beginnings_;
  std::size_t frame_;
};

}  // namespace

bool has_detections_of_classes(const Sequence& sequence) {
  return !sequence.candidates.empty() ||
         std::ranges::any_of(sequence.observations, [](const auto& of_frame) {
           return std::ranges::any_of(of_frame,
                                      [](const auto& seen) { return seen.object.empty(); });
         });
}

Sequence named_recording(Sequence sequence, const std::vector<ObjectModel>& models,
                         const std::vector<FrameEstimate>& frames) {
  const std::size_t count = frames.size();
  keep_first(sequence.stamps, count);
  keep_first(sequence.odometry, count);
  keep_first(sequence.images, count);
  keep_first(sequence.observations, count);
  sequence.camera_truth.clear();
  for (ObjectRecording& object : sequence.objects) {
    keep_first(object.detections, count);
    object.relative_truth.clear();
    object.world_truth.clear();
  }
  for (FrameRecording& frame : sequence.known_frames) keep_first(frame.poses, count);
  if (!has_detections_of_classes(sequence)) return sequence;

  const auto begun = beginnings(frames);
  std::vector<std::vector<Observation>> named(count);
  for (std::size_t k = 0; k < count; ++k) {
    const FrameReport& report = frames[k].report;
    NamedFrame of_frame(models, begun, k);
    if (sequence.observations.empty()) {
      for (std::size_t j = 0; j < models.size(); ++j)
        if (const auto& seen = sequence.objects[j].detections[k])
          of_frame.add(observation_of(*seen), {.object = j});
    } else {
      for (std::size_t i = 0; i < report.observations.size(); ++i)
        of_frame.add(sequence.observations[k][i], report.observations[i]);
    }
    for (std::size_t i = 0; i < report.candidates.size(); ++i)
      of_frame.add(observation_of(sequence.candidates[k][i]), report.candidates[i]);
    named[k] = std::move(of_frame.observations);
  }
  sequence.observations = std::move(named);
  sequence.candidates.clear();
  return sequence;
}

}  // namespace posemix::internal
