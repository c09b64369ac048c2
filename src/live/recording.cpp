// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "recording.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "config/sequence_parts.hpp"
#include "posemix/slam/rig.hpp"

namespace posemix::internal {
namespace {

/// The images of one stamp.
struct Frame {
  std::optional<SE3d> odometry = {};
  std::vector<Observation> observations = {};
  std::set<std::string> empty_of = {};
};

std::map<std::int64_t, Frame> by_stamp(const std::deque<RecordedImage>& images) {
  std::map<std::int64_t, Frame> frames;
  for (const RecordedImage& image : images) {
    Frame& frame = frames[image.stamp_ns];
    if (!frame.odometry) frame.odometry = image.odometry;
    frame.observations.insert(frame.observations.end(), image.observations.begin(),
                              image.observations.end());
    if (image.empty_of) frame.empty_of.insert(*image.empty_of);
  }
  return frames;
}

/// Classes of ROS may have any name: what cannot be in the name of a file becomes '_'.
std::map<std::string, std::string> usable_ids(const std::vector<ObjectModel>& models) {
  std::map<std::string, std::string> names;
  std::set<std::string> taken;
  for (const ObjectModel& model : models) {
    std::string name = model.id.substr(0, 90);
    for (char& c : name)
      if (!is_usable_id(std::string(1, c))) c = '_';
    if (!is_usable_id(name)) name = "object";
    const std::string first = name;
    for (int i = 2; !taken.insert(name).second; ++i) name = first + "_" + std::to_string(i);
    names.emplace(model.id, name);
  }
  return names;
}

/// The best pose of every observation as it is from the body.
void add_detections(const std::vector<std::vector<Observation>>& frames,
                    const std::vector<BodyCamera>& cameras, ObjectRecording& object) {
  object.detections.resize(frames.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (const Observation& observation : frames[k]) {
      if (observation.object != object.id || object.detections[k]) continue;
      const SE3d& pose = observation.components[best_component(observation)].pose;
      object.detections[k] = pose_on_body(cameras, observation.camera) * pose;
    }
  }
}

Sequence sequence_of(const LiveRecording& recording, bool has_odometry,
                     const std::map<std::string, std::string>& names) {
  Sequence sequence;
  const std::int64_t start = recording.images().front().stamp_ns;
  for (auto& [stamp_ns, frame] : by_stamp(recording.images())) {
    sequence.stamps.push_back(static_cast<double>(stamp_ns - start) * 1e-9);
    if (has_odometry) sequence.odometry.push_back(frame.odometry);
    sequence.images.emplace_back(frame.empty_of.begin(), frame.empty_of.end());
    auto& observations = sequence.observations.emplace_back(frame.observations);
    for (Observation& observation : observations) {
      observation.stamp_s = sequence.stamps.back();
      const auto name = names.find(observation.object);
      if (name != names.end()) observation.object = name->second;
    }
  }
  return sequence;
}

}  // namespace

void LiveRecording::add(RecordedImage image) {
  if (most_ == 0) return;
  images_.push_back(std::move(image));
  if (images_.size() > most_) images_.pop_front();
}

LiveResult result_of(const LiveRecording& recording, const LiveSettings& settings,
                     std::vector<ObjectModel> models, const std::vector<BodyCamera>& cameras) {
  const auto names = usable_ids(models);
  for (ObjectModel& model : models) {
    // Models of one class share it, whatever their ids become.
    if (model.class_id.empty()) model.class_id = model.id;
    model.id = names.at(model.id);
  }
  Sequence sequence = sequence_of(recording, settings.has_odometry(), names);
  for (const ObjectModel& model : models) {
    sequence.objects.push_back({model.id, {}, {}, {}});
    add_detections(sequence.observations, cameras, sequence.objects.back());
  }
  MultiObjectSlamSettings tracker = settings.tracker;
  tracker.cameras = cameras;
  const std::optional<SE3d>& first = recording.images().front().odometry;
  const SE3d start = settings.starts_at_odometry && first ? *first : settings.start.mean();
  SlamJob job{.name = settings.node.name,
              .method = settings.method,
              .sequence = std::move(sequence),
              .camera_prior = PoseDensity(start, settings.start.covariance()),
              .models = std::move(models),
              .settings = {.motion = settings.motion, .tracker = tracker},
              .trace_hypotheses = settings.trace_hypotheses};
  return {std::move(job), static_cast<double>(recording.images().front().stamp_ns) * 1e-9};
}

}  // namespace posemix::internal
