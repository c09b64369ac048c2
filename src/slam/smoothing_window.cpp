// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/smoothing_window.hpp"

#include <algorithm>
#include <utility>

#include "posemix/filter/predict.hpp"
#include "posemix/lie/pose_blocks.hpp"

namespace posemix::internal {
namespace {

/// Covariance of an object of which nothing is known: far wider than one detection's.
Matrix6d vague_covariance() {
  return pose_covariance(Eigen::Vector3d::Constant(3.0), Eigen::Vector3d::Constant(10.0));
}

}  // namespace

Modes leading_modes(const MultiObjectFilter& filter) {
  Modes modes;
  for (std::size_t j = 0; j < filter.object_count(); ++j) modes.push_back(filter.leading(j));
  return modes;
}

SmoothingWindow::SmoothingWindow(const MultiObjectFilter& before, const MultiObjectFilter& now,
                                 const MotionSettings& motion, const Modes& modes)
    : before_(before), now_(now), indices_(modes.size()) {
  model_.motion = motion;
  model_.odometry_camera_fraction = now.settings().odometry_camera_fraction;
  model_.correlation_length = now.correlation_length();
  model_.gain_covariance =
      now.settings().has_odometry ? GainCovariance::update : GainCovariance::likelihood;
  for (std::size_t j = 0; j < modes.size(); ++j) {
    if (!modes[j]) continue;
    indices_[j] = model_.first_object() + model_.objects.size();
    model_.objects.push_back(j);
    model_.sensors.push_back(&now.sensor(j));
    hypotheses_.push_back(now.hypotheses(j)[*modes[j]]);
  }
}

std::vector<Hypothesis> SmoothingWindow::smooth(std::span<const FrameInput* const> frames,
                                                std::size_t passes) const {
  // A mode that the filter did not have before the window stands where it is now: in the first
  // pass, which has nothing else to tell right detections from wrong ones, with its covariance of
  // now, then as good as unknown.
  const Modes known = known_before();
  ModeSmoother smoother(model_, frames);
  smoother.pass(start(known, false));
  for (std::size_t pass = 1; pass < passes; ++pass) smoother.refine(start(known, true));
  return smoother.smoothed();
}

Hypothesis SmoothingWindow::inflated(const Hypothesis& joint) const {
  Eigen::MatrixXd covariance = now_.covariance_factor() * joint.covariance();
  for (const std::size_t object : model_.objects) {
    const std::size_t pose = *indices_[object];
    block(covariance, pose, pose) +=
        now_.bias_covariance(object, joint.mean()[kCamera], joint.mean()[pose]);
  }
  return Hypothesis::trusted(joint.mean(), std::move(covariance));
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

Hypothesis SmoothingWindow::start(const Modes& known, bool vague) const {
  PoseStackd poses(model_.first_object() + model_.objects.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(poses.dof(), poses.dof());

  // Poses that are new, and where those that the filter had belong.
  const Hypothesis given = before_.joint_of(known);
  const auto objects = static_cast<std::size_t>(
      std::count_if(known.begin(), known.end(), [](const auto& mode) { return mode.has_value(); }));
  std::vector<std::size_t> to{kCamera};
  if (given.mean().size() - objects > 1) to.push_back(kMotion);
  if (model_.has_motion())
    block(covariance, kMotion, kMotion) = model_.motion.motion_noise.over(model_.motion.period_s);
  for (std::size_t i = 0; i < model_.objects.size(); ++i) {
    const std::size_t pose = *indices_[model_.objects[i]];
    if (known[model_.objects[i]]) {
      to.push_back(pose);
    } else {
      poses[pose] = hypotheses_[i].pose;
      block(covariance, pose, pose) = vague ? vague_covariance() : hypotheses_[i].covariance;
    }
  }
  // The filter's covariances count dependent detections as it knew them; their true error stays.
  const double factor = before_.covariance_factor() / now_.covariance_factor();
  for (std::size_t i = 0; i < to.size(); ++i) {
    poses[to[i]] = given.mean()[i];
    for (std::size_t k = 0; k < to.size(); ++k)
      block(covariance, to[i], to[k]) = factor * block(given.covariance(), i, k);
  }
  return Hypothesis::trusted(std::move(poses), std::move(covariance));
}

}  // namespace posemix::internal
