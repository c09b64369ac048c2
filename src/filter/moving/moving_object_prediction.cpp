// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "detector/view_turn.hpp"
#include "filter/precision.hpp"
#include "moving_object_state.hpp"
#include "prediction_reach.hpp"

namespace posemix::internal {
namespace {

/// Parts of a mixture of models below this are left out.
constexpr double kLeastModelPart = 1e-9;

/// Squarings of a transition after which rounding may have grown, as every one doubles its relative
/// error.
constexpr int kExactSquarings = 20;

void normalise_rows(Eigen::MatrixXd& transition) {
  transition = transition.cwiseMax(0.0).eval();
  for (Eigen::Index i = 0; i < transition.rows(); ++i) transition.row(i) /= transition.row(i).sum();
}

/// exp(generator t) of a Markov chain, by halving the time and the power series.
Eigen::MatrixXd transition_of(const Eigen::MatrixXd& generator, double t) {
  const Eigen::Index n = generator.rows();
  const double largest = generator.cwiseAbs().maxCoeff();
  int halvings = 0;
  double step = std::min(t, std::numeric_limits<double>::max());
  // The product with the whole time may be infinite, that with the step is not in the end.
  for (; largest * step > 0.25; ++halvings) step *= 0.5;
  const Eigen::MatrixXd g = step * generator;
  Eigen::MatrixXd power = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd sum = power;
  for (int k = 1; k < 14; ++k) {
    power = (power * g / k).eval();
    sum += power;
  }
  for (int k = 0; k < halvings; ++k) {
    sum = (sum * sum).eval();
    if (k >= kExactSquarings) normalise_rows(sum);
  }
  normalise_rows(sum);
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

/// The Gaussian of a model as one of another. An object that is taken up or put down by a frame
/// gets the error of the frame's pose.
PlacedObject MovingObjectState::as_of_model(const PlacedObject& object, std::size_t from,
                                            std::size_t to, Matrix12d& jacobian) const {
  PlacedObject result = object;
  result.set_motion(
      as_state_of(object.motion_state(), models_.models[from], models_.models[to], &jacobian),
      jacobian);
  for (const KnownFrame* frame : {frame_of(from), frame_of(to)}) {
    if (frame) result.covariance.topLeftCorner<6, 6>() += frame->covariance;
  }
  return result;
}

/// Eq. (8): the Gaussian of every model becomes the mixture of those that it may come from.
std::vector<PlacedObject> MovingObjectState::mixed_models(const MovingHypothesis& hypothesis,
                                                          const Eigen::MatrixXd& transition) const {
  const Eigen::ArrayXd before = hypothesis.weights.by_model();
  const double total = before.sum();
  std::vector<PlacedObject> after;
  after.reserve(model_count());
  std::vector<PlacedObject> others;
  std::vector<WeightedObject> parts;
  others.reserve(model_count());
  for (std::size_t k = 0; k < model_count(); ++k) {
    others.clear();
    parts.clear();
    for (std::size_t l = 0; l < model_count(); ++l) {
      const auto row = static_cast<Eigen::Index>(l);
      const double weight = before[row] * transition(row, static_cast<Eigen::Index>(k));
      if (!(weight > kLeastModelPart * total) && l != k) continue;
      const PlacedObject* source = &hypothesis.objects[l];
      if (l != k) {
        Matrix12d jacobian;
        others.push_back(as_of_model(*source, l, k, jacobian));
        source = &others.back();
      }
      parts.push_back({std::max(weight, 1e-300), source});
    }
    after.push_back(mixed(parts));
  }
  return after;
}

Eigen::ArrayXd MovingObjectState::gone_in(double dt) const {
  constexpr double kMostGone = 1.0 - 1e-12;
  Eigen::ArrayXd gone(static_cast<Eigen::Index>(model_count()));
  for (std::size_t k = 0; k < model_count(); ++k)
    gone[static_cast<Eigen::Index>(k)] =
        -std::expm1(-(std::visit(JumpRate{}, models_.models[k]) +
                      0.5 * std::visit(BreakRate{}, models_.models[k]) + settings_.lost_rate) *
                    dt);
  return gone.min(kMostGone);
}

/// Eq. (9): jumps, and what no model describes.
void MovingObjectState::leak(double dt) {
  constexpr double kLeastWeight = 1e-200;
  const Eigen::ArrayXd gone = gone_in(dt);
  for (MovingHypothesis& hypothesis : hypotheses_) {
    if (hypothesis.weights.total() < kLeastWeight) continue;
    ModeWeights part = hypothesis.weights;
    part.scale(gone);
    // A run at the place that the object has left goes on there, and any other where it is.
    hypothesis.weights.scale(1.0 - gone);
    lost_.add(part);
  }
}

Eigen::MatrixXd MovingObjectState::transition_over(double dt) const {
  return transition_of(generator_, dt);
}

std::vector<SE3d> MovingObjectState::frame_motions(const std::vector<KnownFrame>& later) const {
  std::vector<SE3d> moved(std::max(later.size(), frames_.size()));
  for (std::size_t i = 0; i < std::min(later.size(), frames_.size()); ++i)
    moved[i] = later[i].pose * frames_[i].pose.inverse();
  return moved;
}

MotionPrediction MovingObjectState::predicted(const PlacedObject& object, std::size_t model,
                                              double dt, const std::vector<SE3d>& moved) const {
  const auto* attached = std::get_if<AttachedMotion>(&models_.models[model]);
  return predicted_within(position_reach(sensor().noise), object.motion_state(),
                          models_.models[model], dt,
                          attached && frame_of(model) ? moved[attached->frame] : SE3d());
}

void MovingObjectState::advance(double time_s, const std::vector<KnownFrame>& given) {
  const std::vector<KnownFrame> frames = internal::moved(given, to_scene());
  const double dt = time_s_ ? time_s - *time_s_ : 0.0;
  if (dt > 0.0) {
    const std::vector<SE3d> moved = frame_motions(frames);
    const bool changes = model_count() > 1;
    const Eigen::MatrixXd transition = changes ? transition_over(dt) : Eigen::MatrixXd();
    for (MovingHypothesis& hypothesis : hypotheses_) {
      if (changes) {
        hypothesis.objects = mixed_models(hypothesis, transition);
        hypothesis.weights.change_models(transition);
      }
      for (std::size_t k = 0; k < model_count(); ++k) {
        const MotionPrediction next = predicted(hypothesis.objects[k], k, dt, moved);
        hypothesis.objects[k].set_motion(next.state, next.jacobian);
      }
    }
    if (changes) lost_.change_models(transition);
    leak(dt);
  }
  frames_.resize(std::max(frames_.size(), frames.size()));
  std::copy(frames.begin(), frames.end(), frames_.begin());
  time_s_ = time_s;
}

void MovingObjectState::decay_slow_errors(const KnownFrame& camera, double dt) {
  const auto& slow = sensor().noise.dependence().slow;
  const MovingHypothesis* const led = leader();
  for (MovingHypothesis& hypothesis : hypotheses_) {
    const SE3d now = camera.pose.inverse() * hypothesis.objects[hypothesis.best_model()].pose;
    if (slow) {
      const Eigen::Vector3d turned = view_turn(hypothesis.seen_from.value_or(now), now);
      const double correlation = slow->correlation(dt, turned.norm());
      if (trace_) trace_->correlation.emplace_back(hypothesis.id, correlation);
      if (&hypothesis == led) detector_.look(turned, dt);
      for (PlacedObject& object : hypothesis.objects)
        decay_slow(object, correlation, *sensor().slow_covariance());
    }
    hypothesis.seen_from = now;
  }
}

}  // namespace posemix::internal
