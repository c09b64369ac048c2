// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/mode_smoother.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filter/same_camera.hpp"
#include "posemix/base/error.hpp"
#include "posemix/lie/pose_blocks.hpp"

namespace posemix::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Six rows of a covariance over all poses.
using PoseRows = Eigen::Matrix<double, kPoseDof, Eigen::Dynamic>;

/// P <- F P F^T where F adds `transfer` times the motion's rows to the camera's.
void move_camera_by(const MatrixXd& transfer, MatrixXd& covariance) {
  rows(covariance, kCamera) += transfer * rows(covariance, kMotion);
  columns(covariance, kCamera) += columns(covariance, kMotion) * transfer.transpose();
}

/// The observation with one component alone, by its index among those of a weight above zero. The
/// mean of components that are far apart would be a pose that nothing was seen at, from which no
/// later pass finds back.
Observation with_component(Observation observation, std::size_t k) {
  std::vector<ObservationComponent>& all = observation.components;
  std::erase_if(all, [](const ObservationComponent& one) { return !(one.weight > 0.0); });
  all = {all.at(k)};
  all.front().weight = 1.0;
  return observation;
}

}  // namespace

std::size_t ModeModel::slow_index(std::size_t j) const {
  std::size_t before = 0;
  for (std::size_t i = 0; i < j; ++i) before += has_slow(i) ? 1 : 0;
  return before * slow_per_object();
}

std::optional<std::size_t> ModeModel::slow_index(std::size_t j, const SE3d& body_camera) const {
  if (!has_slow(j)) return std::nullopt;
  if (cameras.empty()) return slow_index(j);
  for (std::size_t c = 0; c < cameras.size(); ++c)
    if (is_same_camera({.body_camera = cameras[c]}, {.body_camera = body_camera}))
      return slow_index(j) + c;
  throw InvalidInput("a detection is by a camera that is none of the model's");
}

double ModeModel::correlation(std::size_t j, const SE3d& body_object, std::size_t a,
                              std::size_t b) const {
  if (a == b) return 1.0;
  const double angle =
      view_angle(cameras[a].inverse() * body_object, cameras[b].inverse() * body_object);
  return sensors[j]->noise.dependence().slow->correlation(0.0, angle);
}

ModeSmoother::Step ModeSmoother::predict(const JointState& before, const FrameInput& input,
                                         JointState& moved) const {
  Step step;
  step.predicted = before.covariance;
  step.noise = MatrixXd::Zero(before.covariance.rows(), before.covariance.cols());
  step.slow_kept = VectorXd::Ones(before.slow.size());
  moved = {before.poses, before.slow, {}};
  // At the first frame there is no motion, but the camera may be given.
  if (!(input.dt > 0.0) && !input.camera) return step;
  move(camera_step(model_.motion, input), before.poses, step, moved.poses);
  if (input.dt > 0.0) decay_slow_errors(before.poses, input.dt, step, moved);
  step.predicted += step.noise;
  symmetrize(step.predicted);
  return step;
}

/// b <- a b + w with Cov w = (1 - a^2) B, see docs/many-objects.md, eq. (D2).
void ModeSmoother::decay_slow_errors(const PoseStackd& poses, double dt, Step& step,
                                     JointState& moved) const {
  for (std::size_t j = 0; j < model_.objects.size(); ++j) {
    if (!model_.has_slow(j)) continue;
    const ObjectSensor& sensor = *model_.sensors[j];
    const SE3d& object = poses[model_.first_object() + j];
    const SE3d seen = moved.poses[kCamera].inverse() * object;
    const double angle = view_angle(poses[kCamera].inverse() * object, seen);
    const double a = sensor.noise.dependence().slow->correlation(dt, angle);
    const Matrix6d fresh = (1.0 - a * a) * *sensor.slow_covariance();
    for (std::size_t c = 0; c < model_.slow_per_object(); ++c) {
      const std::size_t index = model_.slow_index(j) + c;
      const std::size_t at = model_.poses() + index;
      segment(step.slow_kept, index).setConstant(a);
      segment(moved.slow, index) *= a;
      rows(step.predicted, at) *= a;
      columns(step.predicted, at) *= a;
      for (std::size_t d = 0; d < model_.slow_per_object(); ++d)
        block(step.noise, at, at + d - c) = model_.correlation(j, seen, c, d) * fresh;
    }
  }
}

/// The camera's motion: mean, transition of the covariance, and noise of camera, motion and map.
void ModeSmoother::move(const CameraStep& camera, const PoseStackd& poses, Step& step,
                        PoseStackd& moved) const {
  const auto add_noise = [&](std::size_t pose, const Matrix6d& q) {
    block(step.noise, pose, pose) = moved[pose].adjoint_congruence(q);
  };
  if (camera.given) {
    step.is_given = true;
    rows(step.predicted, kCamera).setZero();
    columns(step.predicted, kCamera).setZero();
    moved[kCamera] = camera.given->mean();
    block(step.noise, kCamera, kCamera) = camera.given->covariance();
  } else if (camera.velocity) {
    const double periods = camera.velocity->periods;
    step.transfer = constant_velocity_transfer(poses[kCamera], poses[kMotion], periods);
    move_camera_by(step.transfer, step.predicted);
    moved[kCamera] = poses[kCamera] * SE3d::exp(periods * poses[kMotion].log());
    add_noise(kCamera, camera.q);
    add_noise(kMotion, camera.velocity->q);
  } else if (camera.odometry) {
    moved[kCamera] = poses[kCamera] * *camera.odometry;
    add_noise(kCamera, camera.q);
  } else {
    add_noise(kCamera, camera.q);
  }
}

/// Camera, object `j` and its slow error, with the covariance of [xi_O - xi_C; beta].
ModeState ModeSmoother::state_of(const PoseStackd& poses, const VectorXd& slow,
                                 const MatrixXd& covariance, std::size_t j,
                                 const std::optional<std::size_t>& index) const {
  const std::size_t object = model_.first_object() + j;
  ModeState state{.camera = poses[kCamera], .object = poses[object]};
  const MatrixXd h_p = rows(covariance, object) - rows(covariance, kCamera);
  state.covariance.topLeftCorner<6, 6>() = columns(h_p, object) - columns(h_p, kCamera);
  if (index) {
    const std::size_t at = model_.poses() + *index;
    state.slow = segment(slow, *index);
    state.covariance.topRightCorner<6, 6>() = columns(h_p, at);
    state.covariance.bottomLeftCorner<6, 6>() = columns(h_p, at).transpose();
    state.covariance.bottomRightCorner<6, 6>() = block(covariance, at, at);
  }
  return state;
}

/// In information form, for a detection's information may be singular: with H = [-I I A], D = H P
/// H^T, M = (I + Lambda D)^-1: m += P H^T M (eta - Lambda H m), P -= P H^T M Lambda H P.
void ModeSmoother::update(Step& step, const SmootherFrame& frame, const MatrixXd& weighing,
                          bool is_first) const {
  step.mean = step.predicted_mean;
  step.covariance = step.predicted;
  for (std::size_t j = 0; j < model_.objects.size(); ++j) {
    for (const ObservedObject& one : frame.observed) {
      if (one.object != model_.objects[j]) continue;
      const auto index = model_.slow_index(j, one.source.body_camera);
      ModeState state = state_of(step.poses, step.slow, weighing, j, index);
      state.camera = state.camera * one.source.body_camera;
      const ObjectSensor& sensor = model_.filter->sensor(one.object, one.source.detector);
      ModeMeasurement seen = measure_mode(state, one.observation, sensor);
      if (is_first && one.observation.components.size() > 1)
        seen = measure_mode(state, with_component(one.observation, seen.best_component), sensor);
      update(step, j, index, seen);
    }
  }
}

void ModeSmoother::update(Step& step, std::size_t j, const std::optional<std::size_t>& index,
                          const ModeMeasurement& seen) const {
  const std::size_t object = model_.first_object() + j;
  PoseRows h_p = rows(step.covariance, object) - rows(step.covariance, kCamera);
  Vector6d h_m = segment(step.mean, object) - segment(step.mean, kCamera);
  if (index) {
    const std::size_t at = model_.poses() + *index;
    h_p += seen.slow_map * rows(step.covariance, at);
    h_m += seen.slow_map * segment(step.mean, at);
  }
  Matrix6d d = columns(h_p, object) - columns(h_p, kCamera);
  if (index) d += columns(h_p, model_.poses() + *index) * seen.slow_map.transpose();
  const Eigen::PartialPivLU<Matrix6d> m(Matrix6d::Identity() + seen.information * d);
  step.mean += h_p.transpose() * m.solve(seen.pull - seen.information * h_m);
  step.covariance -= h_p.transpose() * m.solve(seen.information * h_p);
  symmetrize(step.covariance);
}

JointState ModeSmoother::at(const Step& step, const VectorXd& mean, MatrixXd covariance) {
  const Eigen::Index dof = step.poses.dof();
  return {PoseStackd::exp(mean.head(dof)) * step.poses, step.slow + mean.tail(step.slow.size()),
          std::move(covariance)};
}

void ModeSmoother::run(const JointState& start, const std::vector<JointState>& reference) {
  steps_.clear();
  steps_.reserve(frames_.size());
  JointState now = start;
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    JointState moved;
    Step step = predict(now, frames_[k]->input, moved);
    step.poses = reference.empty() ? moved.poses : reference[k].poses;
    step.slow = reference.empty() ? moved.slow : reference[k].slow;
    step.predicted_mean.resize(step.predicted.rows());
    step.predicted_mean << (moved.poses * step.poses.inverse()).log(), moved.slow - step.slow;
    update(step, *frames_[k], reference.empty() ? step.predicted : reference[k].covariance,
           reference.empty());
    now = at(step, step.mean, step.covariance);
    steps_.push_back(std::move(step));
  }
  backward();
}

/// Rauch, Tung and Striebel (1965): A = P_k F^T P_(k+1|k)^-1, m_k^s = m_k + A (m_(k+1)^s -
/// m_(k+1|k)); the covariance in the form that cannot lose its sign,
/// P_k^s = (I - A F) P_k (I - A F)^T + A (P_(k+1)^s + Q) A^T. F adds the motion to the camera, or
/// forgets a camera that is given, and multiplies the slow errors.
void ModeSmoother::backward() {
  std::vector<JointState> reversed;
  reversed.reserve(steps_.size());
  VectorXd mean = steps_.back().mean;
  MatrixXd covariance = steps_.back().covariance;
  reversed.push_back(at(steps_.back(), mean, covariance));
  camera_lags_.assign(steps_.size(), Matrix6d::Zero());
  for (std::size_t k = steps_.size() - 1; k-- > 0;) {
    const Step& now = steps_[k];
    const Step& next = steps_[k + 1];
    const Eigen::Index slow = next.slow_kept.size();
    MatrixXd f_p = now.covariance;
    if (next.transfer.size() > 0)
      rows(f_p, kCamera) += next.transfer * rows(now.covariance, kMotion);
    if (next.is_given) rows(f_p, kCamera).setZero();
    f_p.bottomRows(slow) = next.slow_kept.asDiagonal() * now.covariance.bottomRows(slow);
    const MatrixXd a = next.predicted.llt().solve(f_p).transpose();
    camera_lags_[k + 1] = rows(a, kCamera) * columns(covariance, kCamera);
    mean = now.mean + a * (mean - next.predicted_mean);
    MatrixXd a_f = a;
    if (next.transfer.size() > 0) columns(a_f, kMotion) += columns(a, kCamera) * next.transfer;
    if (next.is_given) columns(a_f, kCamera).setZero();
    a_f.rightCols(slow) = a.rightCols(slow) * next.slow_kept.asDiagonal();
    const MatrixXd keep = MatrixXd::Identity(a.rows(), a.cols()) - a_f;
    covariance =
        keep * now.covariance * keep.transpose() + a * (covariance + next.noise) * a.transpose();
    symmetrize(covariance);
    reversed.push_back(at(now, mean, covariance));
  }
  smoothed_.assign(std::make_move_iterator(reversed.rbegin()),
                   std::make_move_iterator(reversed.rend()));
}

}  // namespace posemix::internal
