// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/motion.hpp"

#include <utility>

namespace posemix::internal {

CameraStep camera_step(const MotionSettings& motion, const FrameInput& input) {
  CameraStep step{.dt = input.dt, .odometry = {}, .q = motion.noise.over(input.dt), .velocity = {}};
  switch (motion.model) {
    case MotionModel::odometry:
      step.odometry = input.motion;
      if (!input.motion) step.q = motion.unknown_motion.over(input.dt);
      break;
    case MotionModel::random_walk:
      step.q = motion.walk.over(input.dt);
      break;
    case MotionModel::constant_velocity:
      step.velocity = {input.dt / motion.period_s, motion.motion_noise.over(input.dt),
                       motion.motion_noise.over(motion.period_s)};
      break;
  }
  return step;
}

Hypothesis predict(Hypothesis hypothesis, const CameraStep& step) {
  if (step.velocity) {
    return predict_constant_velocity(std::move(hypothesis), step.velocity->periods, step.q,
                                     step.velocity->q);
  }
  return predict_with_odometry(std::move(hypothesis), step.odometry.value_or(SE3d()), step.q);
}

void predict(MultiObjectFilter& filter, const CameraStep& step) {
  if (step.velocity) {
    filter.predict_constant_velocity(step.velocity->periods, step.q, step.velocity->q,
                                     step.velocity->at_rest, step.dt);
  } else if (step.odometry) {
    filter.predict_with_odometry(*step.odometry, step.q, step.dt);
  } else {
    filter.predict_random_walk(step.q, step.dt);
  }
}

Hypothesis camera_hypothesis(const PoseDensity& camera, const MotionSettings& motion) {
  Hypothesis hypothesis(PoseStackd(std::vector<SE3d>{camera.mean()}), camera.covariance());
  if (motion.model != MotionModel::constant_velocity) return hypothesis;
  return with_independent_pose(hypothesis, SE3d(), motion.motion_noise.over(motion.period_s));
}

}  // namespace posemix::internal
