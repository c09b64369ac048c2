// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "scene.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "posemix/base/units.hpp"
#include "posemix/slam/object_model.hpp"

namespace posemix {
namespace {

constexpr double kTurnRate = 0.2;     // radians per second
constexpr double kFlipRunS = 2.0;     // mean length of a run of flips
constexpr double kWrongBest = 0.25;   // mean of min(u, 1 - u)
constexpr double kClutterBoxM = 0.5;  // half the edges, so that its volume is one cubic metre

SE3d half_turn() { return {SO3d::exp({0.0, 0.0, std::numbers::pi}), Eigen::Vector3d::Zero()}; }

SO3d random_rotation(RandomStream& random) {
  Eigen::VectorXd q(4);
  random.fill_normal(q);
  q.normalize();
  return SO3d::from_quaternion(Eigen::Quaterniond(q[0], q[1], q[2], q[3]));
}

Eigen::Vector3d view_of(const SE3d& camera, const SE3d& object) {
  return (object.inverse() * camera.translation()).normalized();
}

Matrix6d noise_covariance(double across_deg, double about_deg, double across, double along) {
  return pose_covariance(kRadPerDeg * Eigen::Vector3d(across_deg, across_deg, about_deg),
                         Eigen::Vector3d(across, across, along));
}

}  // namespace

DetectorNoise detector_of(const ConsistencyCell& cell) {
  if (cell.default_detector) return default_detector_noise();
  const Matrix6d white = noise_covariance(2.0, 1.5, 0.004, 0.015);
  const Matrix6d slow = noise_covariance(3.0, 2.0, 0.006, 0.025);
  const double flips = cell.modes == ModeInput::best ? kWrongBest : cell.flips;
  const double right = 1.0 - flips - cell.clutter;
  NoiseComponent inlier{.weight = right, .covariance = white, .frame = NoiseFrame::ray};
  NoiseDependence dependence;
  if (cell.slow) {
    dependence.slow = SlowError{slow, cell.correlation_s, radians(cell.correlation_angle_deg)};
  } else {
    inlier.covariance += slow;
  }
  std::vector<NoiseComponent> components{inlier};
  if (flips > 0.0) {
    components.push_back(inlier);
    components.back().weight = flips;
    components.back().offset = half_turn();
  }
  if (cell.flips > 0.0 || cell.modes_in_runs) dependence.mode_time_s = kFlipRunS;
  return DetectorNoise(std::move(components), {.weight = cell.clutter}, dependence);
}

SymmetryGroup symmetries_of(ObjectShape shape) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  switch (shape) {
    case ObjectShape::axis:
      return SymmetryGroup::turns(z, 0);
    case ObjectShape::ball:
      return SymmetryGroup({}, {{z}, {Eigen::Vector3d::UnitX()}});
    case ObjectShape::half_turn:
      return SymmetryGroup::turns(z, 2);
    case ObjectShape::plain:
      break;
  }
  return {};
}

MotionSettings motion_of(const ConsistencyCell& cell) {
  MotionSettings motion;
  if (cell.odometry == OdometryQuality::good) motion.noise.covariance /= 16.0;
  if (cell.odometry == OdometryQuality::none) motion.model = MotionModel::random_walk;
  return motion;
}

Vector6d draw_error(const Matrix6d& covariance, RandomStream& random) {
  Eigen::VectorXd white(6);
  random.fill_normal(white);
  return Matrix6d(covariance.llt().matrixL()) * white;
}

ConsistencyScene::ConsistencyScene(const ConsistencyCell& cell, RandomStream random)
    : cell_(cell), noise_(detector_of(cell)), motion_(motion_of(cell)), random_(random) {
  const Eigen::Vector3d centre(0.0, 0.0, 1.0);
  for (std::size_t j = 0; j < cell.objects; ++j) {
    const double place = static_cast<double>(j) - 0.5 * static_cast<double>(cell.objects - 1);
    objects_.emplace_back(random_rotation(random_),
                          centre + Eigen::Vector3d(0.15 * place, 0.05 * place * place, 0.0));
    Detector detector{.slow = Vector6d::Zero(), .view = view_of(camera_, objects_.back())};
    if (const auto& slow = noise_.dependence().slow)
      detector.slow = draw_error(slow->covariance, random_);
    if (const auto& common = noise_.dependence().common)
      detector.common = SE3d::exp(draw_error(*common, random_));
    detectors_.push_back(detector);
  }
}

void ConsistencyScene::move(double dt, FrameInput& input) {
  if (motion_.model == MotionModel::random_walk) {
    camera_ = camera_ * SE3d::exp(draw_error(motion_.walk.over(dt), random_));
    return;
  }
  const SE3d centre(SO3d(), {0.0, 0.0, 1.0});
  const SE3d turn(SO3d::exp({0.0, kTurnRate * dt, 0.0}), Eigen::Vector3d::Zero());
  const SE3d next = centre * turn * centre.inverse() * camera_;
  // The true motion is what odometry measures, moved by its noise on the right.
  const SE3d error = SE3d::exp(draw_error(motion_.noise.over(dt), random_));
  input.motion = camera_.inverse() * next * error.inverse();
  camera_ = next;
}

void ConsistencyScene::move_slow_error(std::size_t object, double dt) {
  const auto& slow = noise_.dependence().slow;
  Detector& detector = detectors_[object];
  const Eigen::Vector3d view = view_of(camera_, objects_[object]);
  const double angle = std::atan2(detector.view.cross(view).norm(), detector.view.dot(view));
  detector.view = view;
  if (!slow) return;
  const double a = std::exp(-angle / slow->correlation_angle_rad - dt / slow->correlation_time_s);
  detector.slow =
      a * detector.slow + std::sqrt(1.0 - a * a) * draw_error(slow->covariance, random_);
}

SE3d ConsistencyScene::clutter(const SE3d& near) {
  Eigen::Vector3d place;
  for (double& value : place) value = kClutterBoxM * (2.0 * random_.uniform() - 1.0);
  return {random_rotation(random_), near.translation() + place};
}

Vector6d ConsistencyScene::white_error(Detector& detector) {
  const auto& components = noise_.components();
  const Vector6d slow = noise_.dependence().slow ? detector.slow : Vector6d::Zero();
  if (!cell_.default_detector) return slow + draw_error(components.front().covariance, random_);
  // A run of gross errors has one error, with a slow error of its own.
  const NoiseComponent& gross = components.back();
  const double fraction = gross.weight / (gross.weight + components.front().weight);
  if (detector.gross_left == 0) {
    const double start = fraction / ((1.0 - fraction) * gross.run_length);
    if (random_.uniform() < start) {
      detector.gross_left = static_cast<std::size_t>(gross.run_length);
      detector.gross = draw_error(gross.covariance, random_) +
                       draw_error(noise_.dependence().slow->covariance, random_);
    }
  }
  if (detector.gross_left == 0) return slow + draw_error(components.front().covariance, random_);
  --detector.gross_left;
  return detector.gross;
}

std::optional<SE3d> ConsistencyScene::detect(std::size_t object) {
  Detector& detector = detectors_[object];
  const SE3d expected = camera_.inverse() * objects_[object];
  // Runs of flips are a Markov chain that is flipped for the fraction of the time.
  const double kept = std::exp(-0.1 / kFlipRunS);
  if (random_.uniform() >= kept) detector.flipped = random_.uniform() < cell_.flips;
  const bool wrong_start = detector.detections++ < cell_.wrong_starts;
  const Vector6d error = white_error(detector);
  if (random_.uniform() < noise_.clutter().weight) return clutter(expected);
  const SE3d mode = wrong_start || detector.flipped ? expected * half_turn() : expected;
  const NoiseAtPose at = noise_at(noise_.components().front(), mode);
  const SE3d turned = at.axes * SE3d::exp(at.units.cwiseProduct(error)) * at.axes.inverse();
  SE3d seen = turned * mode * detector.common;
  if (cell_.shape == ObjectShape::axis)
    seen = seen * SE3d(SO3d::exp({0.0, 0.0, 6.0 * random_.uniform()}), Eigen::Vector3d::Zero());
  if (cell_.shape == ObjectShape::ball)
    seen = seen * SE3d(random_rotation(random_), Eigen::Vector3d::Zero());
  if (cell_.shape == ObjectShape::half_turn && random_.uniform() < 0.5) seen = seen * half_turn();
  return seen;
}

void ConsistencyScene::add_modes(std::size_t object, const SE3d& seen, FrameInput& input) {
  Detector& detector = detectors_[object];
  const double kept = cell_.modes_in_runs ? std::exp(-0.1 / kFlipRunS) : 0.0;
  const bool is_kept = random_.uniform() < kept;
  const double first_weight = random_.uniform();
  const bool is_first_right = random_.uniform() < first_weight;
  if (!is_kept || detector.detections == 1)
    detector.right_weight = is_first_right ? first_weight : 1.0 - first_weight;
  const double weight = detector.right_weight;
  const SE3d other = seen * half_turn();
  if (cell_.modes == ModeInput::best) {
    input.detections[object] = weight >= 0.5 ? seen : other;
    return;
  }
  input.detections[object].reset();
  input.observations.push_back(
      {.object = std::to_string(object),
       .components = {{.weight = weight, .pose = seen}, {.weight = 1.0 - weight, .pose = other}}});
}

FrameInput ConsistencyScene::next(double dt, bool seen) {
  FrameInput input{.dt = dt};
  if (!is_first_) {
    move(dt, input);
    time_s_ += dt;
    for (std::size_t j = 0; j < objects_.size(); ++j) move_slow_error(j, dt);
  }
  is_first_ = false;
  for (std::size_t j = 0; j < objects_.size(); ++j) {
    const bool is_late = j + 1 == objects_.size() && time_s_ < cell_.late_s;
    const std::optional<SE3d> detected = seen && !is_late ? detect(j) : std::nullopt;
    input.detections.push_back(detected);
    if (cell_.modes != ModeInput::none && detected) add_modes(j, *detected, input);
  }
  return input;
}

}  // namespace posemix
