// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/motion.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/linear.hpp"
#include "posemix/base/range.hpp"
#include "posemix/lie/pose_checks.hpp"

namespace posemix::internal {

const MotionSettings& checked(const MotionSettings& motion) {
  kPositive.check(motion.period_s, "motion: period_s");
  check_noise(motion.noise.covariance, "motion: noise");
  check_noise(motion.walk.covariance, "motion: walk");
  check_noise(motion.motion_noise.covariance, "motion: motion_noise");
  check_noise(motion.unknown_motion.covariance, "motion: unknown_motion");
  if (motion.model == MotionModel::given)
    checked_covariance(motion.noise.covariance, 6, "motion: the noise of a given pose");
  return motion;
}

void require_not_given(const MotionSettings& motion, const char* where) {
  if (motion.model != MotionModel::given) return;
  throw InvalidInput(fmt::format(
      "{}: the motion model is \"given\", which is for the multi-object filter", where));
}

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
    case MotionModel::given:
      if (input.camera) {
        step.given =
            PoseDensity(*input.camera, input.camera->adjoint_congruence(motion.noise.covariance));
      } else {
        step.q = motion.unknown_motion.over(input.dt);
      }
      break;
    case MotionModel::still:
      step.odometry = SE3d();
      step.q.setZero();
      break;
  }
  const bool finite =
      step.q.allFinite() &&
      (!step.velocity || (step.velocity->q.allFinite() && std::isfinite(step.velocity->periods)));
  if (!finite)
    throw InvalidInput(
        fmt::format("frame: the noise of the motion over {} s is not finite", input.dt));
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
  if (step.given) {
    filter.set_camera(*step.given, step.dt);
  } else if (step.velocity) {
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
