// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <utility>

#include "moving_object_state.hpp"

/// Where the origin of the world of a moving object is. Far from it covariances of small errors are
/// differences of large numbers, of which every step would lose some.
namespace posemix::internal {
namespace {

void move_objects(std::vector<MovingHypothesis>& hypotheses, const WorldShift& shift) {
  for (MovingHypothesis& hypothesis : hypotheses) {
    for (PlacedObject& object : hypothesis.objects) {
      object.pose = shift(object.pose);
      shift.move_rows(object.covariance.topRows<6>());
      shift.move_columns(object.covariance.leftCols<6>());
      symmetrize(object.covariance);
    }
  }
}

}  // namespace

Matrix6d moved(const Matrix6d& covariance, const WorldShift& shift) {
  if (shift.is_none()) return covariance;
  Matrix6d result = shift(covariance);
  symmetrize(result);
  return result;
}

KnownFrame moved(const KnownFrame& frame, const WorldShift& shift) {
  return {.pose = shift(frame.pose), .covariance = moved(frame.covariance, shift)};
}

std::vector<KnownFrame> moved(std::vector<KnownFrame> frames, const WorldShift& shift) {
  for (KnownFrame& frame : frames) frame = moved(frame, shift);
  return frames;
}

void MovingObjectState::move_origin_to(const Eigen::Vector3d& origin) {
  if (origin == origin_) return;
  const WorldShift shift(origin_ - origin);
  move_objects(hypotheses_, shift);
  frames_ = moved(std::move(frames_), shift);
  constant_ = moved(constant_, shift);
  origin_ = origin;
}

MovingObjectReport MovingObjectState::update(const Observation& observation,
                                             const KnownCamera& camera) {
  move_origin_to(origin_near(camera.frame.pose.translation(), origin_));
  const WorldShift shift = to_scene();
  return update_here(observation,
                     {.frame = moved(camera.frame, shift),
                      .constant_covariance = moved(camera.constant_covariance, shift)});
}

void MovingObjectState::move_world(const SE3d& given, const Matrix6d& added,
                                   const Matrix6d& constant) {
  const WorldShift shift = to_scene();
  const SE3d by = shift.is_none() ? given : SE3d(given.rotation(), given * origin_ - origin_);
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = by.rotation().matrix();
  for (MovingHypothesis& hypothesis : hypotheses_) {
    for (std::size_t k = 0; k < model_count(); ++k) {
      PlacedObject& object = hypothesis.objects[k];
      object.pose = by * object.pose;
      Matrix18d f = Matrix18d::Identity();
      f.topLeftCorner<6, 6>() = by.adjoint();
      if (twist_frame(models_.models[k]) == MotionFrame::world) {
        f.block<6, 6>(kTwistRow, kTwistRow) = turn;
        object.twist = (turn * object.twist).eval();
      }
      object.transform(f);
      object.covariance.topLeftCorner<6, 6>() += moved(added, shift);
    }
  }
  constant_ = moved(constant, shift);
}

StepRecord MovingObjectState::record(const Matrix6d& change) const {
  return {.time_s = time_s_.value_or(0.0),
          .belief = {hypotheses_, lost_},
          .frames = frames_,
          .constant = constant_,
          .trace = trace_.value_or(StepTrace{}),
          .change = moved(change, to_scene()),
          .origin = origin_};
}

void MovingObjectState::restore(const StepRecord& record, const MovingBelief& belief) {
  hypotheses_ = belief.hypotheses;
  lost_ = belief.lost;
  frames_ = record.frames;
  constant_ = record.constant;
  origin_ = record.origin;
  time_s_ = record.time_s;
}

MovingBelief MovingObjectState::pulled_back(const StepRecord& next,
                                            const MovingBelief& after) const {
  if (next.origin == origin_) return pulled_back_here(next, after);
  const WorldShift shift(next.origin - origin_);
  StepRecord there = next;
  there.frames = moved(std::move(there.frames), shift);
  there.trace.camera = moved(there.trace.camera, shift);
  there.change = moved(there.change, shift);
  MovingBelief later = after;
  move_objects(later.hypotheses, shift);
  return pulled_back_here(there, later);
}

}  // namespace posemix::internal
