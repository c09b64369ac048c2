// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>

#include "moving_object_state.hpp"

/// The modes of the detector and its runs of wrong detections, by hypothesis.
namespace posemix::internal {

/// Eq. (10), and the part that was turned since the last observation.
void MovingObjectState::draw_modes(MovingHypothesis& hypothesis,
                                   const MovingObservation& observation) const {
  const WrongShares wrong = wrong_shares(observation.clutter, settings_.isolated_clutter);
  ModeWeights& weights = hypothesis.weights;
  weights.draw_modes(observation.stay, modes_, wrong.in_run, settings_.recurring_clutter,
                     places_but(hypothesis.id));
  hypothesis.turned = weights.right.colwise() * observation.turned;
  weights.right -= hypothesis.turned;
}

std::vector<double> MovingObjectState::keep_offsets(MovingHypothesis& hypothesis) const {
  std::vector<double> ratios;
  const PlacedObject& own = hypothesis.objects[hypothesis.best_model()];
  for (WrongRun& run : hypothesis.weights.runs) {
    ratios.push_back(1.0);
    const auto place =
        std::find_if(hypotheses_.begin(), hypotheses_.end(),
                     [&](const MovingHypothesis& other) { return other.id == run.place; });
    if (place == hypotheses_.end() || !sensor().symmetries.axes().empty()) continue;
    const PlacedObject& other = place->objects[place->best_model()];
    const Eigen::Matrix3d covariance =
        own.covariance.topLeftCorner<3, 3>() + other.covariance.topLeftCorner<3, 3>();
    if (!run.offset) {
      run.offset = own.pose.rotation().inverse() * other.pose.rotation();
      run.offset_covariance = covariance;
      continue;
    }
    const Eigen::Vector3d turned =
        (other.pose.rotation() * (own.pose.rotation() * *run.offset).inverse()).log();
    const Eigen::Matrix3d both = covariance + run.offset_covariance;
    const double log_kept = -0.5 * turned.dot(Eigen::LLT<Eigen::Matrix3d>(both).solve(turned));
    // Never above one: most of the weight may have come to the run since, and did not pay for it.
    ratios.back() = std::exp(std::min(log_kept - run.log_kept, 0.0));
    run.log_kept = std::min(run.log_kept, log_kept);
  }
  return ratios;
}

std::vector<std::uint64_t> MovingObjectState::places_but(std::uint64_t own) const {
  std::vector<std::uint64_t> places;
  for (const MovingHypothesis& hypothesis : hypotheses_)
    if (hypothesis.id != own) places.push_back(hypothesis.id);
  return places;
}

/// The same for the case that the place is not known; what is right is taken by births.
void MovingObjectState::weigh_lost(const MovingObservation& observation,
                                   const std::vector<double>& places, double peak) {
  const WrongShares wrong = wrong_shares(observation.clutter, settings_.isolated_clutter);
  const double anywhere = std::exp(log_anywhere() - peak);
  for (WrongRun& run : lost_.runs) {
    double density = anywhere;
    for (std::size_t h = 0; h < places.size(); ++h)
      if (hypotheses_[h].id == run.place) density = std::exp(places[h] - peak);
    run.weight *= (1.0 - wrong.alone) * density + wrong.alone * anywhere;
  }
}

/// Density of the observation, over that of `peak`, at the place of the hypothesis with the id;
/// `elsewhere` where there is none.
double MovingObjectState::density_at(std::uint64_t place, const std::vector<double>& places,
                                     double peak, double elsewhere) const {
  for (std::size_t h = 0; h < places.size(); ++h)
    if (hypotheses_[h].id == place) return std::exp(places[h] - peak);
  return elsewhere;
}

/// Eq. (11) for one model of a hypothesis while the detector is in a run: the sum of the weights,
/// and that of the run that began.
double MovingObjectState::weigh_runs(ModeWeights& weights, Eigen::Index row,
                                     const ModeEvidence& seen, const RunEvidence& given,
                                     double& begun) const {
  const double wrong_density = std::exp(seen.log_wrong - given.peak);
  double total = 0.0;
  for (std::size_t r = 0; r < weights.runs.size(); ++r) {
    WrongRun& run = weights.runs[r];
    double& weight = run.weight[row];
    double density = wrong_density;
    if (run.place != kAnyPlace) {
      density = density_at(run.place, given.places, given.peak, wrong_density) *
                (seen.turned * given.kept[r] + 1.0 - seen.turned);
    }
    const double in_run = weight * (1.0 - given.wrong.alone) * density;
    const double alone = weight * given.wrong.alone * wrong_density;
    total += in_run + alone;
    if (run.place == kAnyPlace) {
      begun = in_run;
      weight = alone;
    } else {
      weight = in_run + alone;
    }
  }
  return total;
}

}  // namespace posemix::internal
