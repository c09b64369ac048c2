// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <utility>

#include "backward_step.hpp"
#include "moving_object_state.hpp"
#include "posemix/mixture/log_weights.hpp"

/// The backward pass over hypotheses and models: docs/moving-objects.md, "Looking ahead".
namespace posemix::internal {
namespace {

/// Cases below this probability are left out.
constexpr double kLeastWeight = 1e-12;

const MovingHypothesis* find(const std::vector<MovingHypothesis>& hypotheses, std::uint64_t id) {
  const auto at = std::find_if(hypotheses.begin(), hypotheses.end(),
                               [&](const MovingHypothesis& other) { return other.id == id; });
  return at == hypotheses.end() ? nullptr : &*at;
}

std::uint64_t place_after_merges(const StepTrace& trace, std::uint64_t id) {
  for (const auto& [gone, kept] : trace.merged)
    if (gone == id) id = kept;
  return id;
}

/// a / b, and zero where there is nothing.
Eigen::ArrayXd share(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) {
  return (b > 0.0).select(a / b, 0.0);
}

ModeWeights of_models(const Eigen::ArrayXd& weights) {
  ModeWeights result(weights.size(), 1);
  result.right.col(0) = weights;
  return result;
}

/// Smoothed weights of what a step has before its observation, by model.
struct BackwardFlow {
  /// By hypothesis before the step: that goes on, in parts where it was split, and that ends by a
  /// turn.
  std::vector<std::vector<MovingObjectState::LaterPart>> goes_on = {};
  std::vector<Eigen::ArrayXd> ends = {};
  Eigen::ArrayXd lost = {};
};

/// The hypothesis of which one is a part; itself where it is none.
std::uint64_t whole_of(const StepTrace& trace, std::uint64_t id) {
  for (const Arrival& arrival : trace.arrivals)
    if (arrival.id == id && arrival.from_lost.size() == 0) return arrival.turned.front().first;
  return id;
}

/// Eq. (17): from after the observation to before it.
BackwardFlow flow_of(const std::vector<MovingHypothesis>& before, const StepTrace& trace,
                     const MovingBelief& after) {
  BackwardFlow flow{.lost = after.lost.by_model()};
  const Eigen::ArrayXd none = Eigen::ArrayXd::Zero(flow.lost.size());
  flow.goes_on.resize(before.size());
  flow.ends.assign(before.size(), none);
  const auto index = [&](std::uint64_t id) {
    const MovingHypothesis* at = find(before, id);
    return at ? static_cast<std::size_t>(at - before.data()) : before.size();
  };
  for (const auto& [id, weight] : trace.weights) {
    const std::uint64_t place = place_after_merges(trace, id);
    const MovingHypothesis* later = find(after.hypotheses, place);
    if (!later) continue;
    Eigen::ArrayXd merged = none;
    for (const auto& [other, of_other] : trace.weights)
      if (place_after_merges(trace, other) == place) merged += of_other;
    const Eigen::ArrayXd smoothed = later->weights.by_model() * share(weight, merged);
    Eigen::ArrayXd own = weight;
    for (const Arrival& arrival : trace.arrivals) {
      if (arrival.id != id || arrival.from_lost.size() == 0) continue;
      own -= arrival.weight.col(0);
      flow.lost += smoothed * share(arrival.from_lost.col(0), weight);
      for (const auto& [from, turned] : arrival.turned) {
        const std::size_t h = index(from);
        if (h < before.size()) flow.ends[h] += smoothed * share(turned.col(0), weight);
      }
    }
    const std::size_t h = index(whole_of(trace, id));
    if (h == before.size()) continue;
    flow.goes_on[h].push_back({smoothed * share(own.max(0.0), weight), later});
  }
  return flow;
}

}  // namespace

void MovingObjectState::trace_weights(const std::vector<MovingHypothesis>& births) {
  if (!trace_) return;
  for (const auto* list : {&std::as_const(hypotheses_), &births})
    for (const MovingHypothesis& hypothesis : *list)
      trace_->weights.emplace_back(hypothesis.id, hypothesis.weights.by_model());
}

void MovingObjectState::trace_prediction() {
  trace();
  trace_weights({});
}

Vector18d MovingObjectState::gain_factors() const {
  Vector18d gain = Vector18d::Ones();
  if (sensor().noise.dependence().is_typical) gain.tail<6>().setConstant(settings_.slow_error_gain);
  return gain;
}

/// Eq. (19): the Gaussian of a model after the models were mixed, given all that comes later.
PlacedObject MovingObjectState::smoothed_mixture(const PlacedObject& mixed, std::size_t model,
                                                 const MovingHypothesis& hypothesis,
                                                 const StepRecord& next,
                                                 PlacedObject smoothed) const {
  const double dt = next.time_s - *time_s_;
  Matrix18d f = Matrix18d::Identity();
  PlacedObject predicted = mixed;
  if (dt > 0.0) {
    const MotionPrediction motion = this->predicted(mixed, model, dt, frame_motions(next.frames));
    predicted.set_motion(motion.state, motion.jacobian);
    f.topLeftCorner<12, 12>() = motion.jacobian;
  }
  predicted.covariance.topLeftCorner<6, 6>() += next.change;
  const auto slow = sensor().slow_covariance();
  for (const auto& [id, correlation] : next.trace.correlation) {
    if (id != hypothesis.id || !slow) continue;
    decay_slow(predicted, correlation, *slow);
    f.bottomRows<6>() *= correlation;
  }
  if (slow && !next.trace.slow_factor.isOnes(1e-12))
    f = (rescale_slow(predicted, sensor(), next.trace.camera, next.trace.slow_factor) * f).eval();
  const SymmetryGroup& symmetries = sensor().symmetries;
  if (!symmetries.is_trivial())
    smoothed.pose = symmetries.closest(smoothed.pose, predicted.pose, Matrix6d::Identity());
  return smoothed_before(mixed, f, predicted, smoothed, gain_factors());
}

/// Eq. (20) to (22): of the weight that goes on by the model k, and the Gaussian of it, the parts
/// by the model before.
void MovingObjectState::split_models(const MovingHypothesis& hypothesis,
                                     const Eigen::ArrayXd& sources, const PlacedObject& mixed,
                                     const PlacedObject& smoothed, std::size_t k, double weight,
                                     std::vector<SmoothedPart>& parts) const {
  const LaterEvidence evidence(mixed, smoothed);
  std::vector<SmoothedPart> found;
  std::vector<double> logs;
  for (std::size_t l = 0; l < model_count(); ++l) {
    const double source = sources[static_cast<Eigen::Index>(l)];
    if (!(source > kLeastWeight * sources.sum())) continue;
    PlacedObject converted = hypothesis.objects[l];
    Matrix18d f = Matrix18d::Identity();
    if (l != k) {
      Matrix12d jacobian;
      converted = as_of_model(converted, l, k, jacobian);
      f.topLeftCorner<12, 12>() = jacobian;
    }
    LaterEvidence::Result result =
        evidence.applied_to(hypothesis.objects[l], converted, f, gain_factors());
    found.push_back({l, 0.0, std::move(result.object)});
    logs.push_back(std::log(source) + result.log_likelihood);
  }
  const double total = log_sum_exp(logs);
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i].weight = weight * std::exp(logs[i] - total);
    parts.push_back(std::move(found[i]));
  }
}

namespace {

/// All probabilities sum to one, and hypotheses with hardly any are dropped.
void sum_to_one(MovingBelief& belief) {
  double total = belief.lost.total();
  for (const MovingHypothesis& hypothesis : belief.hypotheses) total += hypothesis.weights.total();
  belief.lost *= 1.0 / total;
  for (MovingHypothesis& hypothesis : belief.hypotheses) hypothesis.weights *= 1.0 / total;
  std::erase_if(belief.hypotheses, [](const MovingHypothesis& hypothesis) {
    return !(hypothesis.weights.total() > kLeastWeight);
  });
}

}  // namespace

/// Eq. (19) to (22) for what a hypothesis goes on as, by all models.
void MovingObjectState::go_back(const MovingHypothesis& hypothesis,
                                const Eigen::MatrixXd& transition, const LaterPart& later,
                                const StepRecord& next, std::vector<SmoothedPart>& parts) const {
  if (!(later.weight.sum() > kLeastWeight)) return;
  const Eigen::ArrayXd before = hypothesis.weights.by_model();
  const std::vector<PlacedObject> mixed = mixed_models(hypothesis, transition);
  for (std::size_t k = 0; k < model_count(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    if (!(later.weight[column] > kLeastWeight)) continue;
    const PlacedObject smoothed =
        smoothed_mixture(mixed[k], k, hypothesis, next, later.hypothesis->objects[k]);
    split_models(hypothesis, before * transition.col(column).array(), mixed[k], smoothed, k,
                 later.weight[column], parts);
  }
}

MovingBelief MovingObjectState::pulled_back_here(const StepRecord& next,
                                                 const MovingBelief& after) const {
  const auto models = static_cast<Eigen::Index>(model_count());
  const double dt = next.time_s - *time_s_;
  const Eigen::MatrixXd transition =
      model_count() > 1 ? transition_over(dt) : Eigen::MatrixXd::Identity(models, models);
  const Eigen::ArrayXd gone = gone_in(dt);
  const BackwardFlow flow = flow_of(hypotheses_, next.trace, after);
  // Eq. (18): what was lost before the step, and what the step lost, by model.
  const Eigen::ArrayXd lost = lost_.by_model();
  Eigen::ArrayXd all_lost = (transition.transpose() * lost.matrix()).array();
  for (const MovingHypothesis& hypothesis : hypotheses_)
    all_lost += gone * (transition.transpose() * hypothesis.weights.by_model().matrix()).array();
  const Eigen::ArrayXd of_lost = share(flow.lost, all_lost);
  MovingBelief result{hypotheses_, of_models(lost * (transition * of_lost.matrix()).array())};
  for (std::size_t h = 0; h < hypotheses_.size(); ++h) {
    const MovingHypothesis& hypothesis = hypotheses_[h];
    const Eigen::ArrayXd before = hypothesis.weights.by_model();
    const Eigen::ArrayXd changed = (transition.transpose() * before.matrix()).array();
    std::vector<SmoothedPart> parts;
    for (const LaterPart& later : flow.goes_on[h])
      go_back(hypothesis, transition, later, next, parts);
    // What ends here knows nothing of what comes later.
    const Eigen::ArrayXd ends = share(flow.ends[h], changed) + gone * of_lost;
    const Eigen::ArrayXd ended = before * (transition * ends.matrix()).array();
    for (std::size_t l = 0; l < model_count(); ++l)
      parts.push_back({l, ended[static_cast<Eigen::Index>(l)], hypothesis.objects[l]});
    merge_parts(parts, result.hypotheses[h]);
  }
  sum_to_one(result);
  return result;
}

/// Eq. (23): model by model, the parts become one Gaussian.
void MovingObjectState::merge_parts(const std::vector<SmoothedPart>& parts,
                                    MovingHypothesis& hypothesis) const {
  Eigen::ArrayXd weights = Eigen::ArrayXd::Zero(static_cast<Eigen::Index>(model_count()));
  for (std::size_t l = 0; l < model_count(); ++l) {
    std::vector<WeightedObject> of_model;
    for (const SmoothedPart& part : parts) {
      if (part.model != l || !(part.weight > 0.0)) continue;
      of_model.push_back({part.weight, &part.object});
      weights[static_cast<Eigen::Index>(l)] += part.weight;
    }
    if (!of_model.empty()) hypothesis.objects[l] = mixed(of_model);
  }
  hypothesis.weights = of_models(weights);
}

}  // namespace posemix::internal
