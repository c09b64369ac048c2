// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "simulation_detector.hpp"

#include <algorithm>

#include "simulation_paths.hpp"
#include "simulation_sight.hpp"

namespace posemix::internal::simulation {
namespace {

Vector6 vector_of(const SimulationSd& sd) {
  Vector6 values;
  values << sd.rotation_rad.cast<Real>(), sd.translation_m.cast<Real>();
  return values;
}

std::vector<double> weights_of(const SimulationObject& object) {
  std::vector<double> weights;
  weights.reserve(object.noise.size());
  for (const SimulationNoise& component : object.noise) weights.push_back(component.weight);
  return weights;
}

Real correlation(double time_s, double period_s) {
  return time_s > 0.0 ? std::exp(-static_cast<Real>(period_s) / time_s) : Real(0);
}

/// The error along the camera's axes from one along the viewing ray to a mode T_camera_mode, whose
/// translation is in units of the range (as `viewing_ray`).
Vector6 along_camera(const Vector6& error, const Pose& camera_mode) {
  constexpr Real kLeastRangeM = 1e-3L;
  const Vector3& ray = camera_mode.translation();
  const auto turn = Eigen::Quaternion<Real>::FromTwoVectors(Vector3::UnitZ(), ray);
  const SO3<Real> axes = SO3<Real>::from_quaternion(turn);
  Vector6 turned;
  turned << axes * Vector3(error.head<3>()),
      axes * Vector3(std::max(ray.norm(), kLeastRangeM) * error.tail<3>());
  return turned;
}

}  // namespace

Detector::Detector(const SimulationObject& object, double period_s, std::uint64_t seed)
    : flip_(pose_of(object.flips.rotation_rad, object.flips.translation_m)),
      box_(object.outliers.box_m.cast<Real>()),
      hidden_frames_(object.hidden_frames),
      slow_(object.slow),
      period_s_(period_s),
      slow_random_(named_stream(seed, object.id + "/slow")),
      component_(weights_of(object), correlation(object.correlation_s, period_s),
                 named_stream(seed, object.id + "/component")),
      normal_(correlation(object.correlation_s, period_s),
              named_stream(seed, object.id + "/normal")),
      flips_(run_chain(object.flips.runs, period_s, named_stream(seed, object.id + "/flips"))),
      outliers_(
          run_chain(object.outliers.runs, period_s, named_stream(seed, object.id + "/outliers"))),
      misses_(run_chain(object.misses, period_s, named_stream(seed, object.id + "/misses"))),
      wrong_poses_(named_stream(seed, object.id + "/wrong-poses")) {
  for (const SimulationNoise& noise : object.noise) {
    modes_.push_back({noise.frame, vector_of(noise.sd),
                      pose_of(noise.offset_rotation_rad, noise.offset_translation_m)});
  }
}

/// docs/many-objects.md, eq. (D2).
Vector6 Detector::slow_error(const Pose& truth) {
  const Vector3 view = (truth.rotation().inverse() * Vector3(-truth.translation())).normalized();
  Real kept = 0;
  if (view_) {
    const Real angle = std::atan2(view_->cross(view).norm(), view_->dot(view));
    kept = std::exp(-angle / slow_->correlation_angle_rad - period_s_ / slow_->correlation_s);
  }
  view_ = view;
  slow_state_ = kept * slow_state_ + std::sqrt(1 - kept * kept) * vector_of(slow_->sd).cwiseProduct(
                                                                      draw_normal(slow_random_));
  return slow_state_;
}

std::optional<Pose> Detector::next(const Pose& truth) {
  // Every process moves on in every frame, whatever the others say.
  const Mode& mode = modes_[component_.next()];
  Vector6 error = mode.sd.cwiseProduct(normal_.next());
  if (slow_) error += slow_error(truth);
  const bool flipped = flips_.next() == 1;
  const bool outlier = outliers_.next() == 1;
  const bool missed = misses_.next() == 1;
  const SO3<Real> wrong_rotation = draw_rotation(wrong_poses_);
  Vector3 wrong_translation;
  for (Eigen::Index i = 0; i < 3; ++i) {
    wrong_translation[i] = (2 * static_cast<Real>(wrong_poses_.uniform()) - 1) * box_[i];
  }
  if (!outlier) wrong_.reset();
  if (outlier && !wrong_) wrong_ = Pose(wrong_rotation, wrong_translation);
  if (frame_++ < hidden_frames_ || missed) return std::nullopt;

  const Pose mode_pose = truth * (wrong_ ? *wrong_ : flipped ? flip_ : Pose()) * mode.offset;
  if (mode.frame == NoiseFrame::object) return mode_pose * Pose::exp(error);
  const SO3<Real> to_mode = mode_pose.rotation().inverse();
  const Vector6 in_camera = mode.frame == NoiseFrame::ray ? along_camera(error, mode_pose) : error;
  Vector6 turned;
  turned << to_mode * Vector3(in_camera.head<3>()), to_mode * Vector3(in_camera.tail<3>());
  return mode_pose * Pose::exp(turned);
}

}  // namespace posemix::internal::simulation
