// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <utility>

#include "moving_object_state.hpp"

namespace posemix::internal {
namespace {

/// Parts of a mixture of models below this are left out.
constexpr double kLeastPart = 1e-9;

/// exp(generator t) of a Markov chain, by halving the time and the power series.
Eigen::MatrixXd transition_of(const Eigen::MatrixXd& generator, double t) {
  const Eigen::Index n = generator.rows();
  int halvings = 0;
  const double largest = generator.cwiseAbs().maxCoeff() * t;
  for (; std::ldexp(largest, -halvings) > 0.25; ++halvings) {
  }
  const Eigen::MatrixXd g = std::ldexp(t, -halvings) * generator;
  Eigen::MatrixXd power = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd sum = power;
  for (int k = 1; k < 14; ++k) {
    power = (power * g / k).eval();
    sum += power;
  }
  for (int k = 0; k < halvings; ++k) sum = (sum * sum).eval();
  sum = sum.cwiseMax(0.0).eval();
  for (Eigen::Index i = 0; i < n; ++i) sum.row(i) /= sum.row(i).sum();
  return sum;
}

/// Rate of jumps to anywhere by a model, besides one half of its breaks.
struct JumpRate {
  double operator()(const PutDownMotion& motion) const { return motion.jump_rate; }
  template <class Motion>
  double operator()(const Motion&) const {
    return 0.0;
  }
};

struct BreakRate {
  double operator()(const RandomWalkMotion& motion) const { return motion.break_rate; }
  double operator()(const ConstantVelocityMotion& motion) const { return motion.break_rate; }
  template <class Motion>
  double operator()(const Motion&) const {
    return 0.0;
  }
};

}  // namespace

Eigen::ArrayXd MovingObjectState::turned_in(double dt) const {
  Eigen::ArrayXd result(static_cast<Eigen::Index>(model_count()));
  for (std::size_t k = 0; k < model_count(); ++k)
    result[static_cast<Eigen::Index>(k)] =
        -std::expm1(-0.5 * std::visit(BreakRate{}, models_.models[k]) * dt);
  return result;
}

const KnownFrame* MovingObjectState::frame_of(std::size_t model) const {
  const auto* attached = std::get_if<AttachedMotion>(&models_.models[model]);
  return attached && attached->frame < frames_.size() ? &frames_[attached->frame] : nullptr;
}

std::size_t MovingObjectState::frames_needed() const {
  std::size_t needed = 0;
  for (const ObjectMotion& motion : models_.models) {
    if (const auto* attached = std::get_if<AttachedMotion>(&motion))
      needed = std::max(needed, attached->frame + 1);
  }
  return needed;
}

/// Eq. (8): the Gaussian of every model becomes the mixture of those that it may come from. One
/// that is taken up or put down by a frame gets the error of the frame's pose.
void MovingObjectState::mix(MovingHypothesis& hypothesis, const Eigen::MatrixXd& transition) const {
  const Eigen::ArrayXd before = hypothesis.weights.by_model();
  const double total = before.sum();
  std::vector<PlacedObject> after;
  for (std::size_t k = 0; k < model_count(); ++k) {
    std::vector<PlacedObject> sources;
    std::vector<double> weights;
    for (std::size_t l = 0; l < model_count(); ++l) {
      const auto row = static_cast<Eigen::Index>(l);
      const double weight = before[row] * transition(row, static_cast<Eigen::Index>(k));
      if (!(weight > kLeastPart * total) && l != k) continue;
      sources.push_back(hypothesis.objects[l]);
      weights.push_back(weight);
      if (l == k) continue;
      Matrix12d jacobian;
      const MotionState state = as_state_of(sources.back().motion_state(), models_.models[l],
                                            models_.models[k], &jacobian);
      sources.back().set_motion(state, jacobian);
      for (const KnownFrame* frame : {frame_of(l), frame_of(k)}) {
        if (frame) sources.back().covariance.topLeftCorner<6, 6>() += frame->covariance;
      }
    }
    std::vector<WeightedObject> parts;
    for (std::size_t i = 0; i < sources.size(); ++i)
      parts.push_back({std::max(weights[i], 1e-300), &sources[i]});
    after.push_back(mixed(parts));
  }
  hypothesis.objects = std::move(after);
  hypothesis.weights.change_models(transition);
}

/// Eq. (9): jumps, and what no model describes.
void MovingObjectState::leak(double dt) {
  Eigen::ArrayXd gone(static_cast<Eigen::Index>(model_count()));
  for (std::size_t k = 0; k < model_count(); ++k)
    gone[static_cast<Eigen::Index>(k)] =
        -std::expm1(-(std::visit(JumpRate{}, models_.models[k]) +
                      0.5 * std::visit(BreakRate{}, models_.models[k]) + settings_.lost_rate) *
                    dt);
  for (MovingHypothesis& hypothesis : hypotheses_) {
    ModeWeights part = hypothesis.weights;
    part.scale(gone);
    // A run at the place that the object has left goes on there, and any other where it is.
    hypothesis.weights.scale(1.0 - gone);
    lost_.add(part);
  }
}

void MovingObjectState::advance(double time_s, const std::vector<KnownFrame>& frames) {
  const double dt = time_s_ ? time_s - *time_s_ : 0.0;
  std::vector<SE3d> moved(std::max(frames.size(), frames_.size()));
  for (std::size_t i = 0; i < std::min(frames.size(), frames_.size()); ++i)
    moved[i] = frames[i].pose * frames_[i].pose.inverse();
  if (dt > 0.0) {
    const Eigen::MatrixXd transition = transition_of(generator_, dt);
    for (MovingHypothesis& hypothesis : hypotheses_) {
      if (model_count() > 1) mix(hypothesis, transition);
      for (std::size_t k = 0; k < model_count(); ++k) {
        const auto* attached = std::get_if<AttachedMotion>(&models_.models[k]);
        internal::predict(hypothesis.objects[k], models_.models[k], dt,
                          attached && frame_of(k) ? moved[attached->frame] : SE3d());
      }
    }
    if (model_count() > 1) lost_.change_models(transition);
    leak(dt);
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i < frames_.size()) {
      frames_[i] = frames[i];
    } else {
      frames_.push_back(frames[i]);
    }
  }
  time_s_ = time_s;
}

void MovingObjectState::move_world(const SE3d& by, const Matrix6d& added,
                                   const Matrix6d& constant) {
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
      object.covariance.topLeftCorner<6, 6>() += added;
    }
  }
  constant_ = constant;
}

void MovingObjectState::decay_slow_errors(const KnownFrame& camera, double dt) {
  const auto& slow = sensor().noise.dependence().slow;
  for (MovingHypothesis& hypothesis : hypotheses_) {
    const SE3d now = camera.pose.inverse() * hypothesis.objects[hypothesis.best_model()].pose;
    if (slow) {
      const double turned = hypothesis.seen_from ? view_angle(*hypothesis.seen_from, now) : 0.0;
      for (PlacedObject& object : hypothesis.objects)
        decay_slow(object, slow->correlation(dt, turned), *sensor().slow_covariance());
    }
    hypothesis.seen_from = now;
  }
}

}  // namespace posemix::internal
