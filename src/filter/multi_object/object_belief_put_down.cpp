// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "object_belief.hpp"
#include "posemix/filter/moving_object_filter.hpp"
#include "posemix/mixture/log_weights.hpp"
#include "put_down.hpp"

/// The weights of an object that is put down elsewhere now and then (docs/many-objects.md).
namespace posemix::internal {
namespace {

constexpr double kNoWeight = -std::numeric_limits<double>::infinity();

/// Children of a hypothesis below this probability do not move it.
constexpr double kLeastMove = 1e-5;

/// How detectors are wrong: as for one object that moves.
constexpr MovingObjectSettings kDetectors{};

/// The densities of an observation over exp(peak), which no density exceeds.
struct Densities {
  double peak = kNoWeight;
  double anywhere = 0.0;
  std::vector<std::pair<std::uint64_t, double>> at;  ///< by place, of what is there

  double at_place(std::uint64_t place, double elsewhere) const {
    const auto found =
        std::find_if(at.begin(), at.end(), [&](const auto& one) { return one.first == place; });
    return found == at.end() ? elsewhere : found->second;
  }
};

Densities densities_of(const std::vector<ModeEvidence>& seen,
                       const std::vector<std::uint64_t>& places, double volume_m3) {
  Densities result;
  const double anywhere = -std::log(8.0 * std::numbers::pi * std::numbers::pi * volume_m3);
  result.peak = anywhere;
  for (const ModeEvidence& one : seen) {
    result.peak = std::max(result.peak, one.log_wrong);
    for (const double log_density : one.log_right) result.peak = std::max(result.peak, log_density);
  }
  result.anywhere = std::exp(anywhere - result.peak);
  for (std::size_t h = 0; h < seen.size(); ++h)
    result.at.emplace_back(places[h], std::exp(seen[h].log_right.front() - result.peak));
  return result;
}

/// The weights of runs, times the density of the observation: `wrong` where it is of a run that
/// begins, or stands alone. Returns the part of runs that begin.
double weigh_runs(ModeWeights& shown, const Densities& densities, double wrong, double alone) {
  double begun = 0.0;
  for (WrongRun& run : shown.runs) {
    const bool begins = run.place == kAnyPlace;
    const double density = begins ? wrong : densities.at_place(run.place, wrong);
    const double in_run = run.weight[0] * (1.0 - alone) * density;
    if (begins) begun = in_run;
    run.weight[0] = run.weight[0] * alone * wrong + (begins ? 0.0 : in_run);
  }
  return begun;
}

/// Eq. (22) for one hypothesis: its modes times the densities, divided by their sum. The
/// explanation gets the probabilities of all cases. Returns the part of runs that begin.
double weigh(ModeWeights& shown, ModeEvidence& seen, const Densities& densities, double alone,
             const DetectorModes& modes) {
  Explanation& explanation = seen.explanation;
  const double wrong = std::exp(seen.log_wrong - densities.peak);
  std::vector<double> of_mode;
  double right = 0.0;
  for (std::size_t m = 0; m < modes.count(); ++m) {
    double& weight = shown.right(0, static_cast<Eigen::Index>(m));
    of_mode.push_back(weight * (1.0 - alone) * std::exp(seen.log_right[m] - densities.peak));
    right += of_mode.back();
    weight = of_mode.back() + weight * alone * wrong;
  }
  double begun = weigh_runs(shown, densities, wrong, alone);
  double total = shown.total() + begun;
  // Its inverse would be infinite.
  if (total < std::numeric_limits<double>::min()) total = 0.0;
  explanation.log_evidence = std::log(total) + densities.peak;
  const double scale = total > 0.0 ? 1.0 / total : 0.0;
  shown *= scale;
  begun *= scale;
  explanation.clutter_probability = total > 0.0 ? 1.0 - right * scale : 1.0;
  explanation.log_weights = 0.0;
  explanation.squared_distances.assign(seen.squared_distances.begin(),
                                       seen.squared_distances.end());
  const std::size_t n = explanation.noise_components;
  std::vector<double> within(modes.count(), 0.0);
  for (std::size_t i = 0; i < explanation.innovations.size(); ++i)
    within[modes.mode_of(i % n)] += explanation.innovations[i].weight;
  for (std::size_t i = 0; i < explanation.innovations.size(); ++i) {
    const std::size_t m = modes.mode_of(i % n);
    double& weight = explanation.innovations[i].weight;
    weight = of_mode[m] > 0.0 ? weight / within[m] * of_mode[m] * scale : 0.0;
    if (weight < kLeastMove) weight = 0.0;
  }
  return begun;
}

/// Log evidence if detections were independent, for scores.
double independent(const ModeEvidence& seen, const WeighedObservation& observation,
                   const DetectorModes& modes) {
  std::vector<double> terms{observation.log_clutter};
  for (std::size_t m = 0; m < modes.count(); ++m)
    terms.push_back(std::log(modes.weight(m) * observation.object_weight) + seen.log_right[m]);
  return log_sum_exp(terms);
}

/// By component, the hypothesis that explains it best, within the squared distance.
std::vector<std::optional<std::size_t>> explaining(const std::vector<ModeEvidence>& seen,
                                                   std::size_t components, double explained) {
  std::vector<std::optional<std::size_t>> result(components);
  for (std::size_t i = 0; i < components; ++i) {
    double least = explained;
    for (std::size_t h = 0; h < seen.size(); ++h) {
      if (!(seen[h].squared_distances[i] < least)) continue;
      least = seen[h].squared_distances[i];
      result[i] = h;
    }
  }
  return result;
}

}  // namespace

std::vector<ModeWeights> PutDown::unseen() const {
  std::vector<ModeWeights> result;
  for (const DetectorModes& modes : detectors) {
    result.emplace_back(1, static_cast<Eigen::Index>(modes.count()));
    result.back().right(0, 0) = 1.0;
  }
  return result;
}

void mix_into(std::vector<ModeWeights>& shown, double factor, const std::vector<ModeWeights>& other,
              double other_factor) {
  for (std::size_t d = 0; d < shown.size(); ++d) {
    shown[d] *= factor;
    ModeWeights added = other[d];
    added *= other_factor;
    shown[d].add(added);
  }
}

std::vector<ModeWeights> ObjectBelief::shown_at_birth(std::size_t detector,
                                                      std::size_t mode) const {
  std::vector<ModeWeights> result = lost_shown_;
  ModeWeights& shown = result[detector];
  shown = ModeWeights(1, shown.right.cols());
  shown.right(0, static_cast<Eigen::Index>(mode)) = 1.0;
  return result;
}

void ObjectBelief::leak(double jumps) {
  if (!(jumps > 0.0) || size() == 0) return;
  const double log_gone = std::log(-std::expm1(-jumps));
  std::vector<double> terms{log_absent_};
  for (std::size_t h = 0; h < size(); ++h) terms.push_back(standing(h).log_weight + log_gone);
  const double after = log_sum_exp(terms);
  double factor = std::exp(log_absent_ - after);
  for (std::size_t h = 0; h < size(); ++h) {
    Standing& standing = mutable_standing(h);
    mix_into(lost_shown_, factor, standing.shown, std::exp(terms[h + 1] - after));
    factor = 1.0;
    standing.log_weight -= jumps;
    standing.log_probability = standing.log_weight;
  }
  log_absent_ = log_absence_probability_ = after;
}

std::vector<std::uint64_t> ObjectBelief::places() const {
  std::vector<std::uint64_t> result;
  result.reserve(size());
  for (std::size_t h = 0; h < size(); ++h) result.push_back(place_of(standing(h).id));
  return result;
}

PutDownEvidence ObjectBelief::observe_put_down(const JointGaussian& joint,
                                               const WeighedObservation& observation,
                                               const ObjectSensor& sensor,
                                               const GainFactors& factors, const ShownModes& shown,
                                               double explained, DetectionUpdates& updates) const {
  const std::vector<std::uint64_t> all = places();
  const WrongShares wrong = wrong_shares(shown.clutter, kDetectors.isolated_clutter);
  WeighedObservation right = observation;
  right.log_clutter = kNoWeight;
  std::vector<ModeEvidence> seen;
  seen.reserve(size());
  for (std::size_t h = 0; h < size(); ++h)
    seen.push_back(mode_evidence(state_from(joint, h, observation.source), right, sensor,
                                 shown.modes, kDetectors.turned_clutter));
  const Densities densities = densities_of(seen, all, sensor.noise.clutter().volume_m3);
  PutDownEvidence result{.detector = shown.detector, .alone = wrong.alone};
  result.explaining = explaining(seen, observation.components.size(), explained);
  const auto drawn = [&](ModeWeights modes, std::uint64_t own) {
    std::vector<std::uint64_t> others;
    std::copy_if(all.begin(), all.end(), std::back_inserter(others),
                 [&](std::uint64_t place) { return place != own; });
    modes.draw_modes(shown.stay, shown.modes, wrong.in_run, kDetectors.recurring_clutter, others);
    return modes;
  };
  for (std::size_t h = 0; h < size(); ++h) {
    result.score.push_back(independent(seen[h], observation, shown.modes));
    result.shown.push_back(drawn(standing(h).shown[shown.detector], all[h]));
    result.begun.push_back(
        weigh(result.shown.back(), seen[h], densities, wrong.alone, shown.modes));
    const SeenHypothesis own{state_from(joint, h, observation.source), observation, sensor};
    updates.push_back(moved_by(joint, h, own, std::move(seen[h].explanation), factors));
  }
  result.lost = drawn(lost_shown_[shown.detector], kAnyPlace);
  result.lost_right = result.lost.right.row(0);
  // What is right is taken by births, except for a detection that stands alone.
  result.lost.right *= wrong.alone * densities.anywhere;
  result.lost_begun = weigh_runs(result.lost, densities, densities.anywhere, wrong.alone);
  const double total = result.lost.total() + result.lost_begun;
  result.log_lost = std::log(total) + densities.peak;
  if (total > 0.0) {
    result.lost *= 1.0 / total;
    result.lost_begun /= total;
  }
  return result;
}

void ObjectBelief::take_in(const PutDownEvidence& seen, const DetectionUpdates& updates,
                           const std::vector<std::uint64_t>& places,
                           std::span<const ObservationComponent> components, double log_clutter,
                           double memory) {
  // Runs that began are at the places of the observation's components, at its own of which the
  // detector is right.
  const auto place_runs = [&](ModeWeights& shown, double begun, std::uint64_t own) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      double& weight =
          places[i] == own && own != kAnyPlace ? shown.right(0, 0) : shown.run_at(places[i])[0];
      weight += components[i].weight * begun;
    }
  };
  for (std::size_t h = 0; h < size(); ++h) {
    Standing& standing = mutable_standing(h);
    standing.log_weight += updates[h].log_evidence();
    standing.log_probability = standing.log_weight;
    standing.score =
        memory * standing.score + (std::isfinite(log_clutter) ? seen.score[h] - log_clutter : 0.0);
    ++standing.detections;
    standing.shown[seen.detector] = seen.shown[h];
    place_runs(standing.shown[seen.detector], seen.begun[h], place_of(standing.id));
  }
  log_absent_ += seen.log_lost;
  log_absence_probability_ = log_absent_;
  lost_shown_[seen.detector] = seen.lost;
  place_runs(lost_shown_[seen.detector], seen.lost_begun, kAnyPlace);
}

void ObjectBelief::add_jump(std::size_t h, double log_weight, std::size_t detector,
                            std::size_t mode) {
  Standing& standing = mutable_standing(h);
  const double terms[] = {standing.log_weight, log_weight};
  const double sum = log_sum_exp(terms);
  ModeWeights& shown = standing.shown[detector];
  shown *= std::exp(standing.log_weight - sum);
  shown.right(0, static_cast<Eigen::Index>(mode)) += std::exp(log_weight - sum);
  standing.log_weight = standing.log_probability = sum;
}

void ObjectBelief::redirect_runs(std::uint64_t gone, std::uint64_t place) {
  for (std::size_t h = 0; h < size(); ++h) {
    Standing& standing = mutable_standing(h);
    for (ModeWeights& shown : standing.shown)
      shown.redirect(gone, place, place == place_of(standing.id));
  }
  for (ModeWeights& shown : lost_shown_) shown.redirect(gone, place, false);
}

void ObjectBelief::forget_places() {
  constexpr double kLogNegligible = -32.2;  // 1e-14
  for (std::size_t h = size(); h-- > 0;) {
    if (leads(h) || standing(h).log_weight > kLogNegligible) continue;
    redirect_runs(place_of(standing(h).id), kAnyPlace);
    erase_alternative(h);
  }
}

}  // namespace posemix::internal
