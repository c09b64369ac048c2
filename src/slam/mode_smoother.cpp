// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/mode_smoother.hpp"

#include <utility>

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

/// H P: the rows of the object minus those of the camera.
PoseRows difference_rows(const MatrixXd& covariance, std::size_t object) {
  return rows(covariance, object) - rows(covariance, kCamera);
}

Matrix6d difference_covariance(const MatrixXd& covariance, std::size_t object) {
  const PoseRows h_p = difference_rows(covariance, object);
  return columns(h_p, object) - columns(h_p, kCamera);
}

}  // namespace

ModeSmoother::Step ModeSmoother::predict(const PoseStackd& poses, const MatrixXd& covariance,
                                         const FrameInput& input, PoseStackd& moved) const {
  Step step;
  step.predicted = covariance;
  step.noise = MatrixXd::Zero(covariance.rows(), covariance.cols());
  moved = poses;
  if (!(input.dt > 0.0)) return step;
  move(camera_step(model_.motion, input), poses, step, moved);
  // As in the filter, what no detection can tell does not last from one to the next.
  for (std::size_t j = 0; j < model_.objects.size(); ++j) {
    const SymmetryGroup& symmetries = model_.sensors[j]->symmetries;
    if (symmetries.is_trivial() || !input.detections[model_.objects[j]]) continue;
    const std::size_t object = model_.first_object() + j;
    block(step.noise, object, object) +=
        moved[object].adjoint_congruence(symmetries.unobserved_covariance());
  }
  step.predicted += step.noise;
  symmetrize(step.predicted);
  return step;
}

/// The camera's motion: mean, transition of the covariance, and noise of camera, motion and map.
void ModeSmoother::move(const CameraStep& camera, const PoseStackd& poses, Step& step,
                        PoseStackd& moved) const {
  const auto add_noise = [&](std::size_t pose, const Matrix6d& q) {
    block(step.noise, pose, pose) = moved[pose].adjoint_congruence(q);
  };
  if (camera.velocity) {
    const double periods = camera.velocity->periods;
    step.transfer = constant_velocity_transfer(poses[kCamera], poses[kMotion], periods);
    move_camera_by(step.transfer, step.predicted);
    moved[kCamera] = poses[kCamera] * SE3d::exp(periods * poses[kMotion].log());
    add_noise(kCamera, camera.q);
    add_noise(kMotion, camera.velocity->q);
  } else if (camera.odometry) {
    const Matrix6d q = camera.q / model_.correlation_length;
    moved[kCamera] = poses[kCamera] * *camera.odometry;
    add_noise(kCamera, model_.odometry_camera_fraction * q);
    for (std::size_t i = model_.first_object(); i < poses.size(); ++i)
      add_noise(i, (1.0 - model_.odometry_camera_fraction) * q);
  } else {
    add_noise(kCamera, camera.q);
  }
}

/// In information form, for a detection's information may be singular: with D = H P H^T,
/// M = (I + Lambda D)^-1: m += P H^T M (eta - Lambda H m), P -= P H^T M Lambda H P.
void ModeSmoother::update(Step& step, const FrameInput& input, const MatrixXd& weighing) const {
  step.mean = step.predicted_mean;
  step.covariance = step.predicted;
  for (std::size_t j = 0; j < model_.objects.size(); ++j) {
    const auto& detected = input.detections[model_.objects[j]];
    if (!detected) continue;
    const std::size_t object = model_.first_object() + j;
    const ModeMeasurement seen = measure_mode(step.reference[kCamera], step.reference[object],
                                              difference_covariance(weighing, object), *detected,
                                              *model_.sensors[j], model_.gain_covariance);
    const PoseRows h_p = difference_rows(step.covariance, object);
    const Matrix6d d = columns(h_p, object) - columns(h_p, kCamera);
    const Vector6d h_m = segment(step.mean, object) - segment(step.mean, kCamera);
    const Eigen::PartialPivLU<Matrix6d> m(Matrix6d::Identity() + seen.information * d);
    step.mean += h_p.transpose() * m.solve(seen.pull - seen.information * h_m);
    step.covariance -= h_p.transpose() * m.solve(seen.information * h_p);
    symmetrize(step.covariance);
  }
}

void ModeSmoother::run(const Hypothesis& start, const std::vector<Hypothesis>& reference) {
  steps_.clear();
  steps_.reserve(frames_.size());
  PoseStackd poses = start.mean();
  MatrixXd covariance = start.covariance();
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    PoseStackd moved;
    Step step = predict(poses, covariance, *frames_[k], moved);
    step.reference = reference.empty() ? moved : reference[k].mean();
    step.predicted_mean = (moved * step.reference.inverse()).log();
    update(step, *frames_[k], reference.empty() ? step.predicted : reference[k].covariance());
    poses = PoseStackd::exp(step.mean) * step.reference;
    covariance = step.covariance;
    steps_.push_back(std::move(step));
  }
  backward();
}

/// Rauch, Tung and Striebel (1965): A = P_k F^T P_(k+1|k)^-1, m_k^s = m_k + A (m_(k+1)^s -
/// m_(k+1|k)); the covariance in the form that cannot lose its sign,
/// P_k^s = (I - A F) P_k (I - A F)^T + A (P_(k+1)^s + Q) A^T.
void ModeSmoother::backward() {
  const auto to_density = [](const Step& step, const VectorXd& mean, MatrixXd covariance) {
    return Hypothesis::trusted(PoseStackd::exp(mean) * step.reference, std::move(covariance));
  };
  std::vector<Hypothesis> reversed;
  reversed.reserve(steps_.size());
  VectorXd mean = steps_.back().mean;
  MatrixXd covariance = steps_.back().covariance;
  reversed.push_back(to_density(steps_.back(), mean, covariance));
  for (std::size_t k = steps_.size() - 1; k-- > 0;) {
    const Step& now = steps_[k];
    const Step& next = steps_[k + 1];
    MatrixXd f_p = now.covariance;
    if (next.transfer.size() > 0)
      rows(f_p, kCamera) += next.transfer * rows(now.covariance, kMotion);
    const MatrixXd a = next.predicted.llt().solve(f_p).transpose();
    mean = now.mean + a * (mean - next.predicted_mean);
    MatrixXd keep = MatrixXd::Identity(a.rows(), a.cols()) - a;
    if (next.transfer.size() > 0) columns(keep, kMotion) -= columns(a, kCamera) * next.transfer;
    covariance =
        keep * now.covariance * keep.transpose() + a * (covariance + next.noise) * a.transpose();
    symmetrize(covariance);
    reversed.push_back(to_density(now, mean, covariance));
  }
  smoothed_.assign(std::make_move_iterator(reversed.rbegin()),
                   std::make_move_iterator(reversed.rend()));
}

}  // namespace posemix::internal
