// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "simulation_detector.hpp"
#include "simulation_paths.hpp"
#include "simulation_sight.hpp"

namespace posemix {
namespace {

using namespace internal;
using simulation::Pose;
using simulation::Real;
using simulation::Vector3;
using simulation::Vector6;

constexpr Real kBillion = 1e9L;

SimulatedPose rounded(const Pose& pose) {
  const Eigen::Quaternion<Real>& q = pose.rotation().quaternion();
  const Vector3& t = pose.translation();
  SimulatedPose result;
  const std::array<Real, 7> numbers{t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    result.billionths[i] = std::llround(numbers[i] * kBillion);
  }
  std::size_t last = 6;
  while (last > 3 && result.billionths[last] == 0) --last;
  if (result.billionths[last] < 0) {
    for (std::size_t i = 3; i < 7; ++i) result.billionths[i] = -result.billionths[i];
  }
  return result;
}

Real swing(const SimulationSwing& swing, Real t) {
  const Real phase = 2 * std::numbers::pi_v<Real> * static_cast<Real>(swing.waves) * t;
  return swing.mean_m + swing.swing_m * std::sin(phase);
}

/// T_world_camera at `t` from 0 to 1: z towards the target, y down.
Pose camera_at(const SimulationPath& path, Real t) {
  const Real angle = 2 * std::numbers::pi_v<Real> * static_cast<Real>(path.turns) * t;
  const Real range = swing(path.range, t);
  const Real height = swing(path.height, t);
  const Real radius = std::sqrt(range * range - height * height);
  const Vector3 from_target(radius * std::cos(angle), radius * std::sin(angle), height);
  const Vector3 forward = -from_target / range;
  const Vector3 right = Vector3(forward.y(), -forward.x(), 0).normalized();
  SO3<Real>::Matrix axes;
  axes << right, forward.cross(right), forward;
  return {SO3<Real>::from_matrix(axes), path.target_m.cast<Real>() + from_target};
}

std::vector<Pose> camera_path(const SimulationPath& path) {
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < path.frames; ++k) {
    const bool still = path.set_up == SimulationSetUp::still;
    const Real t = still ? Real(0) : static_cast<Real>(k) / static_cast<Real>(path.frames);
    poses.push_back(camera_at(path, t));
  }
  return poses;
}

std::vector<SimulatedPose> odometry(const std::vector<Pose>& camera, const SimulationSd& sd,
                                    double period_s, RandomStream random) {
  std::vector<SimulatedPose> result;
  Pose integrated;
  for (std::size_t k = 0; k < camera.size(); ++k) {
    if (k > 0) {
      const Vector6 error =
          std::sqrt(static_cast<Real>(period_s)) * simulation::draw_error(sd, random);
      integrated = integrated * (camera[k - 1].inverse() * camera[k]) * Pose::exp(error);
    }
    result.push_back(rounded(integrated));
  }
  return result;
}

/// T_world_camera by an arm, with an error of its own in every image.
std::vector<Pose> arm_poses(const std::vector<Pose>& camera, const SimulationSd& sd,
                            RandomStream random) {
  std::vector<Pose> poses;
  poses.reserve(camera.size());
  for (const Pose& pose : camera)
    poses.push_back(pose * Pose::exp(simulation::draw_error(sd, random)));
  return poses;
}

/// What all objects of a recording have in common.
struct Scene {
  std::vector<Pose> camera;
  std::vector<Real> times_s;
  double period_s;
  std::uint64_t seed;
  const SimulationConfig& config;
  simulation::Motions frames;
};

SimulatedObject simulate_object(const SimulationObject& object, const Scene& scene) {
  const auto end_s = static_cast<double>(scene.times_s.back());
  const simulation::ObjectPath path(object, scene.frames, end_s, scene.seed);
  simulation::Detector detector(object, scene.period_s, scene.seed);
  SimulatedObject result{object.id, rounded(path.at(0)), {}, {}, object.class_id};
  for (std::size_t k = 0; k < scene.camera.size(); ++k) {
    const Pose world = path.at(scene.times_s[k]);
    const Pose relative = scene.camera[k].inverse() * world;
    const bool present = path.is_present(scene.times_s[k]);
    result.relative_truth.push_back(rounded(relative));
    result.world_path.push_back(rounded(world));
    result.present.push_back(present);
    const std::optional<Pose> detection = detector.next(relative);
    const bool seen = detection && present &&
                      simulation::is_in_view(scene.config.path.view, relative.translation());
    result.detections.push_back(seen ? std::optional(rounded(*detection)) : std::nullopt);
  }
  const auto same = [&](const SimulatedPose& pose) {
    return pose.billionths == result.world_truth.billionths;
  };
  if (std::ranges::all_of(result.world_path, same)) result.world_path.clear();
  if (std::ranges::all_of(result.present, std::identity())) result.present.clear();
  return result;
}

SimulatedFrame simulate_frame(const SimulationFrame& frame, const Scene& scene) {
  RandomStream random = simulation::named_stream(scene.seed, "frame:" + frame.name);
  SimulatedFrame result{frame.name, {}, {}, frame.error};
  for (const Real time_s : scene.times_s) {
    const Pose truth = scene.frames.at(frame.name)(time_s);
    result.truth.push_back(rounded(truth));
    const Vector6 error = simulation::draw_error(frame.error, random);
    result.given.push_back(rounded(Pose(SO3<Real>::exp(Vector3(error.head<3>())) * truth.rotation(),
                                        truth.translation() + Vector3(error.tail<3>()))));
  }
  return result;
}

/// All detections of a recording in which they do not name their objects, or may be false.
std::vector<std::vector<SimulatedSighting>> sightings_of(
    const std::vector<SimulatedObject>& objects, const Scene& scene) {
  std::vector<std::vector<SimulatedSighting>> sightings(scene.camera.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const SimulatedObject& object = objects[i];
    for (std::size_t k = 0; k < sightings.size(); ++k) {
      if (!object.detections[k]) continue;
      sightings[k].push_back(
          {object.class_id.empty() ? object.id : "", object.class_id, *object.detections[k], i});
    }
  }
  for (std::size_t i = 0; i < scene.config.clutter.size(); ++i) {
    const SimulationClutter& clutter = scene.config.clutter[i];
    simulation::ClutterSource source(clutter, scene.config.path.view, i, scene.period_s,
                                     scene.seed);
    for (std::size_t k = 0; k < sightings.size(); ++k) {
      for (const Pose& pose : source.next(scene.camera[k]))
        sightings[k].push_back({clutter.object, clutter.class_id, rounded(pose), {}});
    }
  }
  // Their order tells nothing of their sources.
  for (auto& frame : sightings)
    std::ranges::sort(frame, {}, [](const auto& sighting) { return sighting.pose.billionths; });
  return sightings;
}

bool has_sightings(const SimulationConfig& config) {
  return !config.clutter.empty() ||
         std::ranges::any_of(config.objects, [](const SimulationObject& object) {
           return !object.class_id.empty();
         });
}

std::vector<std::optional<SE3d>> poses_of(const std::vector<SimulatedPose>& track) {
  std::vector<std::optional<SE3d>> poses;
  poses.reserve(track.size());
  for (const SimulatedPose& entry : track) poses.emplace_back(entry.pose());
  return poses;
}

/// What the filter is told of the camera. Stream names of objects hold a '/'.
void simulate_camera_knowledge(const Scene& scene, SimulatedSequence& result) {
  const SimulationConfig& config = scene.config;
  if (config.path.set_up == SimulationSetUp::on_arm) {
    const std::vector<Pose> given =
        arm_poses(scene.camera, config.path.arm, simulation::named_stream(scene.seed, "arm"));
    for (const Pose& pose : given) result.odometry.push_back(rounded(pose));
    result.camera_start = result.odometry.front();
    return;
  }
  const bool still = config.path.set_up == SimulationSetUp::still;
  result.odometry = odometry(scene.camera, still ? SimulationSd{} : config.odometry, scene.period_s,
                             simulation::named_stream(scene.seed, "odometry"));
  RandomStream start = simulation::named_stream(scene.seed, "start");
  result.camera_start = rounded(Pose::exp(simulation::draw_error(config.start, start)).inverse() *
                                scene.camera.front());
}

/// The observations of a recording, and the first of each object in its recording.
void add_sightings(const SimulatedSequence& simulated, Sequence& result) {
  result.observations.resize(simulated.sightings.size());
  for (std::size_t k = 0; k < simulated.sightings.size(); ++k) {
    for (const SimulatedSighting& sighting : simulated.sightings[k]) {
      Observation observation = observation_of(sighting.pose.pose());
      observation.object = sighting.object;
      observation.class_id = sighting.class_id;
      observation.stamp_s = result.stamps[k];
      result.observations[k].push_back(std::move(observation));
      for (ObjectRecording& recording : result.objects) {
        auto& first = recording.detections[k];
        if (recording.id == sighting.object && !first) first = sighting.pose.pose();
      }
    }
  }
}

ObjectRecording recording_of(const SimulatedObject& object, bool has_sightings) {
  ObjectRecording recording{object.id, {}, {}, {}};
  const std::size_t count = object.detections.size();
  recording.detections.resize(count);
  const bool known = object.class_id.empty();
  for (std::size_t k = 0; k < count; ++k) {
    const bool present = object.is_present(k);
    if (!has_sightings && object.detections[k])
      recording.detections[k] = object.detections[k]->pose();
    if (!known) continue;
    recording.relative_truth.push_back(present ? std::optional(object.relative_truth[k].pose())
                                               : std::nullopt);
    recording.world_truth.push_back(present ? std::optional(object.world_at(k).pose())
                                            : std::nullopt);
  }
  return recording;
}

FrameRecording recording_of(const SimulatedFrame& frame) {
  const Matrix6d error = pose_covariance(frame.error.rotation_rad, frame.error.translation_m);
  FrameRecording recording{frame.name, {}};
  for (const SimulatedPose& given : frame.given) {
    const SE3d pose = given.pose();
    const SE3d about(SO3d(), pose.translation());
    recording.poses.emplace_back(KnownFrame{pose, about.adjoint_congruence(error)});
  }
  return recording;
}

}  // namespace

SE3d SimulatedPose::pose() const {
  std::array<double, 7> n;
  for (std::size_t i = 0; i < n.size(); ++i) n[i] = static_cast<double>(billionths[i]) / 1e9;
  return {SO3d::from_quaternion({n[6], n[3], n[4], n[5]}), {n[0], n[1], n[2]}};
}

Sequence SimulatedSequence::sequence() const {
  validate(*this);
  Sequence result;
  for (const std::int64_t stamp : stamps_ns) {
    result.stamps.push_back(static_cast<double>(stamp) / 1e9);
  }
  result.odometry = poses_of(odometry);
  result.camera_truth = poses_of(camera_truth);
  for (const SimulatedObject& object : objects)
    result.objects.push_back(recording_of(object, !sightings.empty()));
  add_sightings(*this, result);
  result.images.assign(stamps_ns.size(), {""});
  for (const SimulatedFrame& frame : frames) result.known_frames.push_back(recording_of(frame));
  return result;
}

SimulatedSequence simulate(const SimulationConfig& config, std::uint64_t seed) {
  validate(config);
  const SimulationPath& path = config.path;
  const std::int64_t period_ns = std::llround(path.period_s * kBillion);
  const double period_s = static_cast<double>(period_ns) / 1e9;
  Scene scene{camera_path(path), {}, period_s, seed, config, {}};
  for (const SimulationFrame& frame : config.frames)
    scene.frames.emplace(frame.name, simulation::frame_motion(frame));

  SimulatedSequence result;
  for (std::size_t k = 0; k < path.frames; ++k) {
    const std::int64_t stamp_ns = static_cast<std::int64_t>(k) * period_ns;
    result.stamps_ns.push_back(stamp_ns);
    scene.times_s.push_back(static_cast<Real>(stamp_ns) / kBillion);
    result.camera_truth.push_back(rounded(scene.camera[k]));
  }
  simulate_camera_knowledge(scene, result);
  for (const SimulationObject& object : config.objects)
    result.objects.push_back(simulate_object(object, scene));
  for (const SimulationFrame& frame : config.frames)
    result.frames.push_back(simulate_frame(frame, scene));
  if (has_sightings(config)) result.sightings = sightings_of(result.objects, scene);
  return result;
}

}  // namespace posemix
