// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "moving_object_state.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix::internal {
namespace {

constexpr double kImpossible = -std::numeric_limits<double>::infinity();

}  // namespace

/// The camera of an image; for an object that is held, with the error of the frame that holds it,
/// which a detection cannot tell from that of the camera.
KnownFrame MovingObjectState::camera_for(const KnownFrame& camera, std::size_t model) const {
  KnownFrame result = camera;
  if (const KnownFrame* frame = frame_of(model)) result.covariance += frame->covariance;
  return result;
}

MovingObjectState::Evidence MovingObjectState::evidence_of(
    const MovingObservation& observation) const {
  Evidence result;
  for (const MovingHypothesis& hypothesis : hypotheses_) {
    result.emplace_back();
    for (std::size_t k = 0; k < model_count(); ++k) {
      result.back().push_back(
          mode_evidence(hypothesis.objects[k].seen_from(camera_for(observation.camera, k)),
                        observation.weighed, sensor(), modes_, settings_.turned_clutter));
    }
  }
  return result;
}

/// Eq. (12): the density of an observation of whatever is at the place of a hypothesis.
std::vector<double> MovingObjectState::place_evidence(const Evidence& evidence) const {
  std::vector<double> result;
  for (std::size_t h = 0; h < hypotheses_.size(); ++h) {
    const Eigen::ArrayXd weights = hypotheses_[h].weights.by_model();
    std::vector<double> terms;
    terms.reserve(model_count());
    for (std::size_t k = 0; k < model_count(); ++k)
      terms.push_back(std::log(weights[static_cast<Eigen::Index>(k)] / weights.sum()) +
                      evidence[h][k].log_right.front());
    result.push_back(log_sum_exp(terms));
  }
  return result;
}

/// The weights of innovations, which are relative within the modes, become probabilities: those of
/// the modes are `of_mode` in `total`, which may be so small that its inverse is infinite.
void MovingObjectState::make_probabilities(const std::vector<double>& of_mode, double total,
                                           ModeEvidence& seen) const {
  const std::size_t n = sensor().noise.components().size();
  std::vector<double> within(modes_.count(), 0.0);
  auto& innovations = seen.explanation.innovations;
  for (std::size_t i = 0; i < innovations.size(); ++i)
    within[modes_.mode_of(i % n)] += innovations[i].weight;
  for (std::size_t i = 0; i < innovations.size(); ++i) {
    const std::size_t m = modes_.mode_of(i % n);
    innovations[i].weight =
        of_mode[m] > 0.0 ? innovations[i].weight / within[m] * (of_mode[m] / total) : 0.0;
  }
}

/// Eq. (11) for one hypothesis. The innovations get their probabilities.
MovingObjectState::WeighedHypothesis MovingObjectState::weigh_modes(
    MovingHypothesis& hypothesis, std::vector<ModeEvidence>& evidence,
    const std::vector<double>& places, const std::vector<double>& kept,
    const MovingObservation& observation, double peak) const {
  const WrongShares wrong = wrong_shares(observation.clutter, settings_.isolated_clutter);
  const double shown = 1.0 - wrong.alone;
  ModeWeights& weights = hypothesis.weights;
  const auto models = static_cast<Eigen::Index>(model_count());
  WeighedHypothesis result{.total = Eigen::ArrayXd::Zero(models),
                           .alone = Eigen::ArrayXXd::Zero(models, weights.right.cols()),
                           .begun = Eigen::ArrayXd::Zero(models)};
  for (std::size_t k = 0; k < model_count(); ++k) {
    ModeEvidence& seen = evidence[k];
    const auto row = static_cast<Eigen::Index>(k);
    const double wrong_density = std::exp(seen.log_wrong - peak);
    std::vector<double> of_mode(modes_.count(), 0.0);
    for (std::size_t m = 0; m < modes_.count(); ++m) {  // eq. (11), the detector is right
      const auto column = static_cast<Eigen::Index>(m);
      double& weight = weights.right(row, column);
      of_mode[m] = weight * shown * std::exp(seen.log_right[m] - peak);
      result.alone(row, column) = weight * wrong.alone * wrong_density;
      weight = of_mode[m] + result.alone(row, column);
    }
    const double in_runs =  // eq. (11), it is in a run
        weigh_runs(weights, row, seen, {places, kept, wrong, peak}, result.begun[row]);
    const double of_wrong = result.alone.row(row).sum() + in_runs;
    const double total = weights.right.row(row).sum() + in_runs;
    result.total[row] = total;
    make_probabilities(of_mode, total, seen);
    seen.position.weight = total > 0.0 ? seen.turned * (of_wrong / total) : 0.0;
  }
  ++hypothesis.detections;
  return result;
}

/// The scale of the noise is learned from the innovation of the leading hypothesis, and slow errors
/// keep what a detection sees of them.
void MovingObjectState::learn(const MovingHypothesis& leader, const ModeEvidence& evidence,
                              const Observation& observation, const KnownFrame& camera) {
  if (leader.detections < 2) return;
  const bool given =
      std::any_of(observation.components.begin(), observation.components.end(),
                  [](const auto& component) { return component.covariance.has_value(); });
  const MultiObjectSettings settings{.noise_scale_detections = settings_.noise_scale_detections,
                                     .least_noise_scale = settings_.least_noise_scale};
  const DetectionUpdate update{evidence.explanation, {}};
  const Vector6d factor = detector_.learn(update, given, settings, 0.0);
  if (!sensor().noise.dependence().slow || factor.isOnes(1e-12)) return;
  if (trace_) trace_->slow_factor = factor;
  for (MovingHypothesis& hypothesis : hypotheses_)
    for (PlacedObject& object : hypothesis.objects) rescale_slow(object, sensor(), camera, factor);
}

/// What the stages of an update need, with the part of its weights that no earlier one told.
MovingObservation MovingObjectState::weighed(const Observation& given,
                                             const KnownFrame& camera) const {
  const double dt = seen_s_ ? *time_s_ - *seen_s_ : 0.0;
  MovingObservation result{
      .weighed = weigh(given, sensor(), detector_.weight_share(given, *time_s_), {}),
      .camera = camera,
      .clutter = given.clutter.value_or(sensor().noise.clutter().weight),
      .stay = seen_s_ ? modes_.persistence(dt) : 0.0,
      .turned = turned_in(dt)};
  result.weighed.clarity = clarity(given.components);
  result.weighed.log_clutter = kImpossible;
  return result;
}

/// The largest of all log densities, to which they are relative, so that none overflows.
double MovingObjectState::largest(const Evidence& evidence) const {
  double peak = log_anywhere();
  for (const auto& by_model : evidence) {
    for (const ModeEvidence& seen : by_model) {
      peak = std::max(peak, seen.log_wrong);
      for (const double log_density : seen.log_right) peak = std::max(peak, log_density);
    }
  }
  return peak;
}

double MovingObjectState::log_anywhere() const {
  return -std::log(8.0 * std::numbers::pi * std::numbers::pi * sensor().noise.clutter().volume_m3);
}

/// Eq. (10) to (15). Returns the log of the summed weights.
double MovingObjectState::take_in(const MovingObservation& observation, Evidence& evidence,
                                  SplitHypotheses& split, std::vector<MovingHypothesis>& births) {
  const MovingBelief before{hypotheses_, lost_};
  const std::vector<double> places = place_evidence(evidence);
  const double peak = largest(evidence);
  const WrongShares wrong = wrong_shares(observation.clutter, settings_.isolated_clutter);
  std::vector<std::vector<double>> kept;
  for (MovingHypothesis& hypothesis : hypotheses_) {
    draw_modes(hypothesis, observation);
    kept.push_back(keep_offsets(hypothesis));
  }
  for (std::size_t h = 0; h < hypotheses_.size(); ++h) {
    const WeighedHypothesis weighed =
        weigh_modes(hypotheses_[h], evidence[h], places, kept[h], observation, peak);
    move(h, weighed, evidence[h], observation, split);
  }
  lost_.draw_modes(observation.stay, modes_, wrong.in_run, settings_.recurring_clutter,
                   places_but(kAnyPlace));
  weigh_lost(observation, places, peak);
  divide_runs(split);
  const std::vector<std::uint64_t> at = begin(observation, evidence, peak, split, births);
  // What was right is taken by births, except for a detection that stands alone.
  lost_.right *= wrong.alone * std::exp(log_anywhere() - peak);
  place_runs(observation, at, split);
  double total = lost_.total();
  for (const auto* list : {&hypotheses_, &births, &split.parts})
    for (const MovingHypothesis& hypothesis : *list) total += hypothesis.weights.total();
  if (!(total > 0.0)) {
    // An observation that is impossible by all that is stated tells nothing.
    hypotheses_ = before.hypotheses;
    lost_ = before.lost;
    return peak + std::log(std::numeric_limits<double>::min());
  }
  births.insert(births.end(), std::make_move_iterator(split.parts.begin()),
                std::make_move_iterator(split.parts.end()));
  return std::log(total) + peak;
}

/// What the leading hypothesis says of the observation, under the right mode that is most probable.
void MovingObjectState::describe(const ModeEvidence& seen, MovingObjectReport& report) const {
  const auto& innovations = seen.explanation.innovations;
  const std::size_t n = sensor().noise.components().size();
  report.inlier_probability = seen.explanation.inlier_probability();
  const Innovation* best = &seen.explanation.inlier();
  for (std::size_t i = 0; i < innovations.size(); ++i) {
    report.right_probability += innovations[i].weight;
    if (modes_.first(modes_.mode_of(i % n)) == i % n && innovations[i].weight > best->weight)
      best = &innovations[i];
  }
  const Eigen::LLT<Matrix6d> s(best->covariance);
  report.nis = s.matrixL().solve(best->residual).squaredNorm();
  const SE3d to_axes = best->axes.inverse();
  report.residual =
      Vector6d(to_axes.adjoint_blocks().times(best->residual))
          .cwiseQuotient(to_axes.adjoint_congruence(best->covariance).diagonal().cwiseSqrt());
}

MovingObjectReport MovingObjectState::update_here(const Observation& given,
                                                  const KnownCamera& camera) {
  const MovingObservation observation = weighed(given, camera.frame);
  if (trace_) trace_ = StepTrace{.camera = camera.frame};
  decay_slow_errors(camera.frame, seen_s_ ? *time_s_ - *seen_s_ : 0.0);
  constant_ = camera.constant_covariance;
  seen_s_ = time_s_;
  ++observations_;
  const MovingHypothesis* led = leader();
  const std::uint64_t led_id = led ? led->id : kAnyPlace;
  Evidence evidence = evidence_of(observation);
  std::vector<MovingHypothesis> births;
  MovingObjectReport report;
  SplitHypotheses split;
  report.log_evidence = take_in(observation, evidence, split, births);
  report.started = std::any_of(births.begin(), births.end(),
                               [](const auto& born) { return born.detections == 1; });
  trace_weights(births);
  detector_.count_detection(observation.weighed, *time_s_);
  Expected expected = this->expected(evidence, split);
  if (const MovingHypothesis* leading = leader())
    learn(*leading, *expected.at(leading->id), given, camera.frame);
  for (MovingHypothesis& born : births) hypotheses_.push_back(std::move(born));
  const Merges merges = merge();
  report.merges = merges.size();
  for (const auto& [gone, kept] : merges)
    if (expected.contains(gone)) expected.emplace(kept, expected.at(gone));
  normalise();
  keep_heaviest();
  const MovingHypothesis* leads = leader();
  report.changed_leader = leads && leads->id != led_id;
  if (leads && expected.contains(leads->id)) describe(*expected.at(leads->id), report);
  return report;
}

MovingObjectState::Expected MovingObjectState::expected(const Evidence& evidence,
                                                        const SplitHypotheses& split) const {
  Expected result;
  for (std::size_t h = 0; h < evidence.size(); ++h) {
    const ModeEvidence* own = &evidence[h][hypotheses_[h].best_model()];
    result[hypotheses_[h].id] = own;
    for (const PlaceShare& part : split.places[h].shares) result[part.place] = own;
  }
  return result;
}

}  // namespace posemix::internal
