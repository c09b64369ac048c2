// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
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
      for (const auto& [number, poses] : file.numbered) numbers.insert(number);
    return numbers;
  }
};

/// The frames of the sequence: stamps of the odometry, otherwise of the camera's truth (numbers in
/// a dataset), otherwise of all stamped detections, otherwise frame numbers.
Timeline make_timeline(const CameraFiles& camera, const DetectionFiles& detections,
                       const ObservedRecording& observed) {
  if (!observed.files.empty()) {
    return Timeline(stamps_of(observed.files, camera.odometry ? camera.odometry->poses
                                                              : std::vector<StampedPose>()),
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
      const auto frame = timeline.at_number(number);
      if (!frame) {
        throw InvalidInput(
            fmt::format("{}: got a detection {} frames after the first, where {} has {} frames",
                        file.name, number, timeline.source(), timeline.size()));
      }
      for (const ScoredPose& estimate : estimates)
        candidates[*frame].push_back({file.class_id, estimate.pose, estimate.score});
    }
  }
  return candidates;
}

}  // namespace

Sequence read_recordings(const TomlTable& root, const FileFinder& files, const CameraFiles& camera,
                         const std::vector<std::string>& ids, const ObservedRecording& observed) {
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
  validate(sequence);
  return sequence;
}

}  // namespace posemix::internal
