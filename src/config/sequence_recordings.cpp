// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "sequence_parts.hpp"

namespace posemix::internal {
namespace {

/// All files with detections.
struct DetectionFiles {
  std::vector<std::optional<DetectionFile>> objects;
  std::vector<CandidateFile> candidates;

  std::set<double> stamps() const {
    std::set<double> stamps;
    for (const auto& file : objects) {
      if (!file || !file->stamped) continue;
      for (const StampedPose& pose : *file->stamped) stamps.insert(pose.stamp);
    }
    return stamps;
  }
  std::set<std::int64_t> numbers() const {
    std::set<std::int64_t> numbers;
    for (const auto& file : objects) {
      if (!file) continue;
      for (const auto& [number, pose] : file->numbered) numbers.insert(number);
    }
    for (const CandidateFile& file : candidates)
      for (const std::int64_t number : file.numbers()) numbers.insert(number);
    return numbers;
  }
};

/// The frames of the sequence: stamps of the odometry, otherwise of the camera's truth (numbers in
/// a dataset), otherwise of all stamped detections, otherwise frame numbers.
Timeline make_timeline(const CameraFiles& camera, const DetectionFiles& detections,
                       const ObservedRecording& observed) {
  if (!observed.files.empty()) {
    return Timeline(stamps_of(observed.files, camera),
                    camera.odometry ? "the odometry with the observations" : "the observations");
  }
  const auto& stamped = camera.odometry ? camera.odometry : camera.truth;
  if (stamped) {
    std::set<double> stamps;
    for (const StampedPose& pose : stamped->poses) stamps.insert(pose.stamp);
    if (!stamps.empty()) return Timeline({stamps.begin(), stamps.end()}, stamped->name);
  }
  const std::set<double> stamps = detections.stamps();
  std::set<std::int64_t> numbers;
  if (camera.scene_truth) {
    for (const auto& [number, pose] : camera.scene_truth->poses) numbers.insert(number);
  } else if (!stamps.empty()) {
    return Timeline({stamps.begin(), stamps.end()}, "the detections");
  } else {
    numbers = detections.numbers();
  }
  return Timeline(std::vector<std::int64_t>(numbers.begin(), numbers.end()), camera.frame_period_s,
                  camera.scene_truth ? camera.scene_truth->name : "the detections");
}

Poses camera_truth_on(const Timeline& timeline, const CameraFiles& camera) {
  if (camera.truth) return timeline.select(*camera.truth);
  if (!camera.scene_truth) return {};
  Poses poses(timeline.size());
  for (const auto& [number, pose] : camera.scene_truth->poses)
    if (const auto frame = timeline.at_number(number)) poses[*frame] = pose;
  return poses;
}

std::vector<std::vector<Candidate>> candidates_on(const Timeline& timeline,
                                                  const std::vector<CandidateFile>& files) {
  std::vector<std::vector<Candidate>> candidates(files.empty() ? 0 : timeline.size());
  for (const CandidateFile& file : files) {
    for (const auto& [number, estimates] : file.numbered) {
      const std::size_t frame = timeline.frame_of(number, file.name);
      for (const ScoredPose& estimate : estimates)
        candidates[frame].push_back({file.class_id, estimate.pose, estimate.score});
    }
  }
  return candidates;
}

/// The rows of result files that are mixtures. All other detections that name their object are then
/// observations too, so that a tracker takes in the objects in their order.
void add_mixtures(const DetectionFiles& files, const Timeline& timeline, Sequence& sequence) {
  const auto has_mixtures = [](const auto& file) { return !file.mixtures.empty(); };
  const bool any = std::any_of(files.candidates.begin(), files.candidates.end(), has_mixtures) ||
                   std::any_of(files.objects.begin(), files.objects.end(),
                               [&](const auto& file) { return file && has_mixtures(*file); });
  if (!any) return;
  auto& observations = sequence.observations;
  observations.resize(timeline.size());
  for (std::size_t i = 0; i < files.objects.size(); ++i) {
    const ObjectRecording& recording = sequence.objects[i];
    std::map<std::size_t, Observation> mixtures;
    if (files.objects[i]) {
      for (const auto& [number, mixture] : files.objects[i]->mixtures)
        mixtures.emplace(timeline.frame_of(number, files.objects[i]->name), mixture);
    }
    for (std::size_t frame = 0; frame < timeline.size(); ++frame) {
      if (!recording.detections[frame]) continue;
      const auto mixture = mixtures.find(frame);
      Observation& added = observations[frame].emplace_back(
          mixture == mixtures.end() ? observation_of(*recording.detections[frame])
                                    : mixture->second);
      added.object = recording.id;
      added.class_id.clear();
      added.stamp_s = timeline.stamps()[frame];
    }
  }
  for (const CandidateFile& file : files.candidates) {
    for (const auto& [number, mixtures] : file.mixtures) {
      const std::size_t frame = timeline.frame_of(number, file.name);
      for (const Observation& mixture : mixtures) {
        Observation& added = observations[frame].emplace_back(mixture);
        added.class_id = file.class_id;
        added.stamp_s = timeline.stamps()[frame];
      }
    }
  }
}

}  // namespace

Sequence read_recordings(const TomlTable& root, const FileFinder& files, const CameraFiles& camera,
                         const std::vector<std::string>& ids, const ObservedRecording& observed,
                         const std::vector<FrameFile>& frames) {
  const std::vector<TomlTable> objects = root.find_tables("objects");
  DetectionFiles detections{{}, read_candidates(root, files)};
  for (const TomlTable& object : objects)
    detections.objects.push_back(read_detections(object, files, !observed.files.empty()));
  const Timeline timeline = make_timeline(camera, detections, observed);
  Sequence sequence;
  sequence.stamps = timeline.stamps();
  if (camera.odometry) {
    sequence.odometry = observed.files.empty() ? timeline.select(*camera.odometry)
                                               : interpolated(timeline, camera.odometry->poses);
  }
  sequence.camera_truth = camera_truth_on(timeline, camera);
  sequence.candidates = candidates_on(timeline, detections.candidates);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    ObjectRecording recording;
    recording.id = ids[i];
    const auto& file = detections.objects[i];
    recording.detections = located(objects[i], "detections", [&] {
      return file ? file->on(timeline) : Poses(timeline.size());
    });
    read_object_truth(objects[i], files, timeline, recording);
    sequence.objects.push_back(std::move(recording));
  }
  for (std::size_t i = objects.size(); i < ids.size(); ++i) {
    ObjectRecording recording;
    recording.id = ids[i];
    recording.detections.resize(timeline.size());
    sequence.objects.push_back(std::move(recording));
  }
  add_observations(observed, timeline, sequence);
  add_mixtures(detections, timeline, sequence);
  if (camera.images) sequence.images = camera.images->on(timeline, observed.cameras);
  for (const FrameFile& frame : frames) sequence.known_frames.push_back(frame.on(timeline));
  validate(sequence);
  return sequence;
}

}  // namespace posemix::internal
