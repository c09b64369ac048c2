// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/smoothing_window.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <Eigen/Eigenvalues>

#include "filter/precision.hpp"
#include "filter/same_camera.hpp"
#include "posemix/filter/predict.hpp"
#include "posemix/lie/pose_blocks.hpp"

namespace posemix::internal {
namespace {

/// Covariance of an object of which nothing is known: far wider than one detection's.
Matrix6d vague_covariance() {
  return pose_covariance(Eigen::Vector3d::Constant(3.0), Eigen::Vector3d::Constant(10.0));
}

/// Those that see anything; none where a camera is moved on its body, and has another pose there
/// with every detection.
std::vector<SE3d> cameras_of(std::span<const SmootherFrame* const> frames) {
  constexpr std::size_t kMostCameras = 9;  // as many as the filter tells apart
  std::vector<SE3d> cameras;
  for (const SmootherFrame* frame : frames) {
    for (const ObservedObject& seen : frame->observed) {
      const bool is_new = std::none_of(cameras.begin(), cameras.end(), [&](const SE3d& camera) {
        return is_same_camera({.body_camera = camera}, {.body_camera = seen.source.body_camera});
      });
      if (is_new) cameras.push_back(seen.source.body_camera);
    }
  }
  if (cameras.size() > kMostCameras) cameras.clear();
  return cameras;
}

}  // namespace

Modes leading_modes(const MultiObjectFilter& filter) {
  Modes modes;
  for (std::size_t j = 0; j < filter.object_count(); ++j) modes.push_back(filter.leading(j));
  return modes;
}

SmoothingWindow::SmoothingWindow(const MultiObjectFilter& before, const MultiObjectFilter& now,
                                 const MotionSettings& motion, const SE3d& scene,
                                 const Modes& modes)
    : before_(before), now_(now), to_scene_(shift_near(scene)), indices_(modes.size()) {
  model_.motion = motion;
  model_.filter = &now;
  for (std::size_t j = 0; j < modes.size(); ++j) {
    if (!modes[j]) continue;
    indices_[j] = model_.first_object() + model_.objects.size();
    model_.objects.push_back(j);
    model_.sensors.push_back(&now.sensor(j));
    ObjectHypothesis one = now.hypotheses(j)[*modes[j]];
    one.pose = to_scene_(one.pose);
    one.covariance = to_scene_(one.covariance);
    symmetrize(one.covariance);
    hypotheses_.push_back(std::move(one));
  }
}

SmoothedModes SmoothingWindow::smooth(std::span<const SmootherFrame* const> frames,
                                      std::size_t passes) const {
  // A mode that the filter did not have before the window stands where it is now: in the first
  // pass, which has nothing else to tell right detections from wrong ones, with its covariance of
  // now, then as good as unknown.
  const Modes known = known_before();
  std::vector<SmootherFrame> near;  // where cameras that are given are far
  std::vector<const SmootherFrame*> taken(frames.begin(), frames.end());
  if (!to_scene_.is_none()) {
    for (const SmootherFrame* frame : frames) {
      near.push_back(*frame);
      auto& camera = near.back().input.camera;
      if (camera) camera = to_scene_(*camera);
    }
    for (std::size_t k = 0; k < near.size(); ++k) taken[k] = &near[k];
  }
  ModeModel model = model_;
  model.cameras = cameras_of(frames);
  ModeSmoother smoother(model, taken);
  smoother.pass(start(model, known, false));
  for (std::size_t pass = 1; pass < passes; ++pass) smoother.refine(start(model, known, true));
  SmoothedModes result{smoother.smoothed(), smoother.camera_lags()};
  if (to_scene_.is_none()) return result;
  const WorldShift back = to_scene_.inverse();
  for (JointState& state : result.states) state = moved(std::move(state), poses_in_world(), back);
  for (Matrix6d& lag : result.camera_lags) lag = back(lag);
  return result;
}

JointState SmoothingWindow::moved(JointState joint, const std::vector<std::size_t>& in_world,
                                  const WorldShift& shift) const {
  if (shift.is_none()) return joint;
  for (const std::size_t i : in_world) {
    joint.poses[i] = shift(joint.poses[i]);
    shift.move_rows(rows(joint.covariance, i));
    shift.move_columns(columns(joint.covariance, i));
  }
  symmetrize(joint.covariance);
  return joint;
}

std::vector<std::size_t> SmoothingWindow::poses_in_world() const {
  std::vector<std::size_t> list{kCamera};
  for (std::size_t i = model_.first_object(); i < model_.poses(); ++i) list.push_back(i);
  return list;
}

Hypothesis SmoothingWindow::reported(const JointState& joint) const {
  const Eigen::Index dof = joint.poses.dof();
  Eigen::MatrixXd covariance = joint.covariance.topLeftCorner(dof, dof);
  for (const std::size_t object : model_.objects) {
    const std::size_t pose = *indices_[object];
    block(covariance, pose, pose) += now_.unseen_covariance(object, joint.poses[pose]);
  }
  return Hypothesis::trusted(joint.poses, std::move(covariance));
}

std::optional<std::size_t> SmoothingWindow::too_far(std::span<const SmootherFrame* const> frames,
                                                    std::size_t passes) const {
  if (passes < 2) return std::nullopt;
  // The passes have inverses of covariances: a tenth of what a filter holds.
  constexpr double kLargestRatio = 0.1 * kLargestVarianceRatio;
  const Modes known = known_before();
  for (std::size_t i = 0; i < model_.objects.size(); ++i) {
    const std::size_t object = model_.objects[i];
    const WorldShift shift = shift_near(hypotheses_[i].pose);
    if (known[object] || shift.is_none()) continue;
    const Matrix6d there = shift(vague_covariance());
    if (there.diagonal().tail<3>().maxCoeff() > kLargestRatio * least_variance(object, frames))
      return object;
  }
  return std::nullopt;
}

/// Of a position along any direction, in any of the detections of an object [m^2].
double SmoothingWindow::least_variance(std::size_t object,
                                       std::span<const SmootherFrame* const> frames) const {
  const ObjectSensor& sensor = now_.sensor(object);
  const GivenCovariance use = sensor.noise.dependence().given_covariance;
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](const Matrix6d& covariance, double scale) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> position(
        covariance.bottomRightCorner<3, 3>(), Eigen::EigenvaluesOnly);
    least = std::min(least, scale * scale * position.eigenvalues()[0]);
  };
  const double scale = sensor.noise_scale.tail<3>().minCoeff();
  for (const SmootherFrame* frame : frames) {
    for (const ObservedObject& seen : frame->observed) {
      if (seen.object != object) continue;
      for (const ObservationComponent& component : seen.observation.components) {
        for (const NoiseComponent& noise : sensor.noise.components())
          take(noise_at(noise, component.pose).covariance, scale);
        for (const DetectorNoise& other : sensor.other_detectors) {
          for (const NoiseComponent& noise : other.components())
            take(noise_at(noise, component.pose).covariance, scale);
        }
        if (component.covariance && use != GivenCovariance::ignored)
          take(*component.covariance, use == GivenCovariance::as_given ? 1.0 : scale);
      }
    }
  }
  return least;
}

/// The same hypotheses as they were before the window, where they were.
Modes SmoothingWindow::known_before() const {
  Modes known(now_.object_count());
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    const auto list = before_.hypotheses(model_.objects[i]);
    const auto found = std::find_if(list.begin(), list.end(), [&](const ObjectHypothesis& other) {
      return other.id == hypotheses_[i].id;
    });
    if (found != list.end())
      known[model_.objects[i]] = static_cast<std::size_t>(found - list.begin());
  }
  return known;
}

SmoothingWindow::Given SmoothingWindow::given_before(const ModeModel& model,
                                                     const Modes& known) const {
  std::vector<ObservationSource> cameras;
  cameras.reserve(model.cameras.size());
  for (const SE3d& camera : model.cameras) cameras.push_back({.body_camera = camera});
  JointState joint = before_.joint_state(known, cameras);
  const auto objects = static_cast<std::size_t>(
      std::count_if(known.begin(), known.end(), [](const auto& mode) { return mode.has_value(); }));
  const bool has_motion = joint.poses.size() - objects > 1;
  std::vector<std::size_t> in_world{kCamera};
  for (std::size_t i = has_motion ? 2 : 1; i < joint.poses.size(); ++i) in_world.push_back(i);
  return {moved(std::move(joint), in_world, to_scene_), has_motion};
}

JointState SmoothingWindow::start(const ModeModel& model, const Modes& known, bool vague) const {
  JointState start{PoseStackd(model.poses()), {}, {}};
  const std::size_t slow_errors = model.slow_index(model.objects.size());
  start.slow = Eigen::VectorXd::Zero(offset(slow_errors));
  const Eigen::Index dof = offset(model.poses() + slow_errors);
  start.covariance = Eigen::MatrixXd::Zero(dof, dof);

  // Blocks that are new, and where those that the filter had belong.
  const auto [given, has_motion] = given_before(model, known);
  std::vector<std::size_t> poses{kCamera};
  std::vector<std::size_t> slow;
  std::vector<std::size_t> new_objects;
  if (has_motion) poses.push_back(kMotion);
  if (model.has_motion()) {
    block(start.covariance, kMotion, kMotion) =
        model.motion.motion_noise.over(model.motion.period_s);
  }
  for (std::size_t i = 0; i < model.objects.size(); ++i) {
    if (!known[model.objects[i]]) {
      new_objects.push_back(i);
      continue;
    }
    poses.push_back(*indices_[model.objects[i]]);
    for (std::size_t c = 0; model.has_slow(i) && c < model.slow_per_object(); ++c)
      slow.push_back(model.poses() + model.slow_index(i) + c);
  }
  for (std::size_t i = 0; i < poses.size(); ++i) start.poses[poses[i]] = given.poses[i];
  for (const std::size_t i : new_objects) add_new(model, i, vague, start);
  for (std::size_t i = 0; i < slow.size(); ++i)
    segment(start.slow, slow[i] - model.poses()) = segment(given.slow, i);
  std::vector<std::size_t> to = poses;
  to.insert(to.end(), slow.begin(), slow.end());
  for (std::size_t i = 0; i < to.size(); ++i) {
    for (std::size_t k = 0; k < to.size(); ++k)
      block(start.covariance, to[i], to[k]) = block(given.covariance, i, k);
  }
  return start;
}

/// An object that the filter did not have, independent of the rest.
void SmoothingWindow::add_new(const ModeModel& model, std::size_t i, bool vague,
                              JointState& start) const {
  const std::size_t pose = *indices_[model.objects[i]];
  start.poses[pose] = hypotheses_[i].pose;
  block(start.covariance, pose, pose) = new_covariance(i, vague);
  if (!model.has_slow(i)) return;
  const SE3d seen = start.poses[kCamera].inverse() * hypotheses_[i].pose;
  const std::size_t at = model.poses() + model.slow_index(i);
  for (std::size_t c = 0; c < model.slow_per_object(); ++c) {
    for (std::size_t d = 0; d < model.slow_per_object(); ++d)
      block(start.covariance, at + c, at + d) =
          model.correlation(i, seen, c, d) * *model.sensors[i]->slow_covariance();
  }
}

/// Covariance of an object that the filter did not have; the angles about axes of symmetry are
/// those that stand for all.
Matrix6d SmoothingWindow::new_covariance(std::size_t i, bool vague) const {
  Matrix6d covariance = vague ? vague_covariance() : hypotheses_[i].covariance;
  const SymmetryGroup& symmetries = model_.sensors[i]->symmetries;
  if (symmetries.axes().empty()) return covariance;
  const SE3d& object = hypotheses_[i].pose;
  const Matrix6d observed =
      object.adjoint() * symmetries.observed_projection() * object.inverse().adjoint();
  return observed * covariance * observed.transpose() +
         kFixedAngle * object.adjoint_congruence(symmetries.unobserved_covariance());
}

}  // namespace posemix::internal
