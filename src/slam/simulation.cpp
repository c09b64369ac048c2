// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/simulation.hpp"

#include <cmath>
#include <numbers>

#include "simulation_detector.hpp"

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
    poses.push_back(camera_at(path, static_cast<Real>(k) / static_cast<Real>(path.frames)));
  }
  return poses;
}

Vector6 draw(const SimulationSd& sd, RandomStream& random) {
  Vector6 error = simulation::draw_normal(random);
  error.head<3>().array() *= sd.rotation_rad.cast<Real>().array();
  error.tail<3>().array() *= sd.translation_m.cast<Real>().array();
  return error;
}

std::vector<SimulatedPose> odometry(const std::vector<Pose>& camera, const SimulationSd& sd,
                                    double period_s, RandomStream random) {
  std::vector<SimulatedPose> result;
  Pose integrated;
  for (std::size_t k = 0; k < camera.size(); ++k) {
    if (k > 0) {
      const Vector6 error = std::sqrt(static_cast<Real>(period_s)) * draw(sd, random);
      integrated = integrated * (camera[k - 1].inverse() * camera[k]) * Pose::exp(error);
    }
    result.push_back(rounded(integrated));
  }
  return result;
}

SimulatedObject simulate_object(const SimulationObject& object, const std::vector<Pose>& camera,
                                double period_s, std::uint64_t seed) {
  const Pose world(SO3<Real>::exp(object.rotation_rad.cast<Real>()),
                   object.position_m.cast<Real>());
  simulation::Detector detector(object, period_s, seed);
  SimulatedObject result{object.id, rounded(world), {}, {}};
  for (const Pose& pose : camera) {
    const Pose relative = pose.inverse() * world;
    result.relative_truth.push_back(rounded(relative));
    const std::optional<Pose> detection = detector.next(relative);
    result.detections.push_back(detection ? std::optional(rounded(*detection)) : std::nullopt);
  }
  return result;
}

std::vector<std::optional<SE3d>> poses_of(const std::vector<SimulatedPose>& track) {
  std::vector<std::optional<SE3d>> poses;
  poses.reserve(track.size());
  for (const SimulatedPose& entry : track) poses.emplace_back(entry.pose());
  return poses;
}

}  // namespace

SE3d SimulatedPose::pose() const {
  std::array<double, 7> n;
  for (std::size_t i = 0; i < n.size(); ++i) n[i] = static_cast<double>(billionths[i]) / 1e9;
  return {SO3d::from_quaternion({n[6], n[3], n[4], n[5]}), {n[0], n[1], n[2]}};
}

Sequence SimulatedSequence::sequence() const {
  Sequence result;
  for (const std::int64_t stamp : stamps_ns) {
    result.stamps.push_back(static_cast<double>(stamp) / 1e9);
  }
  result.odometry = poses_of(odometry);
  result.camera_truth = poses_of(camera_truth);
  for (const SimulatedObject& object : objects) {
    ObjectRecording recording{object.id, {}, poses_of(object.relative_truth), {}};
    for (const auto& detection : object.detections) {
      recording.detections.push_back(detection ? std::optional(detection->pose()) : std::nullopt);
    }
    recording.world_truth.assign(stamps_ns.size(), object.world_truth.pose());
    result.objects.push_back(std::move(recording));
  }
  return result;
}

SimulatedSequence simulate(const SimulationConfig& config, std::uint64_t seed) {
  validate(config);
  const SimulationPath& path = config.path;
  const std::int64_t period_ns = std::llround(path.period_s * kBillion);
  const double period_s = static_cast<double>(period_ns) / 1e9;
  const std::vector<Pose> camera = camera_path(path);

  SimulatedSequence result;
  for (std::size_t k = 0; k < path.frames; ++k) {
    result.stamps_ns.push_back(static_cast<std::int64_t>(k) * period_ns);
    result.camera_truth.push_back(rounded(camera[k]));
  }
  // Stream names of objects hold a '/'.
  result.odometry =
      odometry(camera, config.odometry, period_s, simulation::named_stream(seed, "odometry"));
  RandomStream start = simulation::named_stream(seed, "start");
  result.camera_start = rounded(Pose::exp(draw(config.start, start)).inverse() * camera.front());
  for (const SimulationObject& object : config.objects) {
    result.objects.push_back(simulate_object(object, camera, period_s, seed));
  }
  return result;
}

}  // namespace posemix
