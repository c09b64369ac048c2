// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <utility>

#include "moving_object_state.hpp"

/// What an observation makes of a hypothesis: one Gaussian by model, or several hypotheses.
namespace posemix::internal {

/// Model by model, the moments of cases at their midway point, eq. (8).
template <class Belongs>
void MovingObjectState::mix_cases(const std::vector<std::vector<ObservedCase>>& cases,
                                  const Belongs& belongs, MovingHypothesis& hypothesis) const {
  for (std::size_t k = 0; k < model_count(); ++k) {
    std::vector<WeightedObject> parts;
    for (const ObservedCase& one : cases[k])
      if (belongs(one)) parts.push_back({one.weight, &one.object});
    if (parts.empty()) continue;
    hypothesis.objects[k] = mixed(parts);
    fix_unobserved(hypothesis.objects[k], sensor().symmetries, models_.models[k]);
  }
}

/// A hypothesis with the weights of a group, which the whole loses.
MovingHypothesis MovingObjectState::part_of(MovingHypothesis& whole, const CaseGroup& group,
                                            const WeighedHypothesis& weighed,
                                            const std::vector<ModeEvidence>& evidence) const {
  MovingHypothesis part = whole;
  part.turned = {};
  part.weights = ModeWeights(whole.weights.right.rows(), whole.weights.right.cols());
  const std::size_t n = sensor().noise.components().size();
  for (std::size_t k = 0; k < model_count(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    for (const std::size_t i : group.innovations)
      part.weights.right(row, static_cast<Eigen::Index>(modes_.mode_of(i % n))) +=
          evidence[k].explanation.innovations[i].weight * weighed.total[row];
  }
  if (group.has_wrong) {
    part.weights.right += weighed.alone;
    std::swap(part.weights.runs, whole.weights.runs);
  }
  part.weights.right = part.weights.right.min(whole.weights.right);
  whole.weights.right -= part.weights.right;
  return part;
}

/// The Gaussians of a hypothesis move. Cases that fit no single one, as of an object that was not
/// seen for long and a detection that may be wrong, become hypotheses of their own.
void MovingObjectState::move(std::size_t index, const WeighedHypothesis& weighed,
                             const std::vector<ModeEvidence>& evidence,
                             const MovingObservation& observation, SplitHypotheses& split) {
  MovingHypothesis& hypothesis = hypotheses_[index];
  SplitHypotheses::Place& place = split.places.emplace_back();
  place.begun = weighed.begun;
  place.of_component.resize(observation.weighed.components.size());
  Eigen::Index best = 0;
  if (!(weighed.total.maxCoeff(&best) > 0.0)) return;
  const Vector18d gain = gain_factors();
  std::vector<std::vector<ObservedCase>> cases(model_count());
  for (std::size_t k = 0; k < model_count(); ++k) {
    if (!(weighed.total[static_cast<Eigen::Index>(k)] > 0.0)) continue;
    const KnownFrame camera = camera_for(observation.camera, k);
    cases[k] = observed_cases(hypothesis.objects[k], evidence[k],
                              {observation.weighed, camera, sensor(), gain});
  }
  const std::vector<CaseGroup> groups = groups_of(cases[static_cast<std::size_t>(best)]);
  if (groups.empty()) return;  // no probability is a number
  place.is_split = groups.size() > 1;
  const std::size_t n = sensor().noise.components().size();
  const std::size_t before = split.parts.size();
  for (std::size_t g = groups.size(); g-- > 0;) {
    const std::size_t at = g == 0 ? 0 : before + g;
    for (const std::size_t i : groups[g].innovations) place.of_component[i / n] = at;
    if (groups[g].has_wrong) place.of_wrong = at;
  }
  std::vector<std::uint64_t> ids{hypothesis.id};
  for (std::size_t g = 1; g < groups.size(); ++g) {
    MovingHypothesis& part =
        split.parts.emplace_back(part_of(hypothesis, groups[g], weighed, evidence));
    ids.push_back(part.id = next_id_++);
    mix_cases(
        cases, [&](const ObservedCase& one) { return groups[g].has(one); }, part);
    trace_split(hypothesis.id, part);
  }
  const auto of_first = [&](const ObservedCase& one) {
    return std::none_of(groups.begin() + 1, groups.end(),
                        [&](const CaseGroup& group) { return group.has(one); });
  };
  mix_cases(cases, of_first, hypothesis);
  if (place.is_split) place.shares = shares_of(groups, ids, weighed, evidence);
}

/// Of what the detector shows at the place of a hypothesis in its first mode, which is what runs
/// there show, the parts that are at the places of its groups.
std::vector<PlaceShare> MovingObjectState::shares_of(
    const std::vector<CaseGroup>& groups, const std::vector<std::uint64_t>& ids,
    const WeighedHypothesis& weighed, const std::vector<ModeEvidence>& evidence) const {
  const std::size_t n = sensor().noise.components().size();
  std::vector<PlaceShare> shares;
  shares.reserve(ids.size());
  for (const std::uint64_t id : ids) shares.push_back({id, 0.0});
  double total = 0.0;
  for (std::size_t k = 0; k < model_count(); ++k) {
    const auto& innovations = evidence[k].explanation.innovations;
    for (std::size_t i = 0; i < innovations.size(); ++i) {
      if (modes_.mode_of(i % n) != 0) continue;
      const double weight = weighed.total[static_cast<Eigen::Index>(k)] * innovations[i].weight;
      const auto group = std::find_if(groups.begin() + 1, groups.end(),
                                      [&](const CaseGroup& one) { return one.has(i); });
      const auto g = group == groups.end() ? 0 : static_cast<std::size_t>(group - groups.begin());
      shares[g].share += weight;
      total += weight;
    }
  }
  if (!(total > 0.0)) shares.front().share = total = 1.0;
  for (PlaceShare& one : shares) one.share /= total;
  return shares;
}

/// Runs at the place of a hypothesis that is split are at the places of its parts: what a run shows
/// is as probable as what is right there, and tells nothing of the run.
void MovingObjectState::divide_runs(SplitHypotheses& split) {
  for (std::size_t h = 0; h < hypotheses_.size(); ++h) {
    const std::vector<PlaceShare>& shares = split.places[h].shares;
    if (shares.empty()) continue;
    const std::uint64_t id = hypotheses_[h].id;
    lost_.divide(id, shares);
    for (auto* list : {&hypotheses_, &split.parts})
      for (MovingHypothesis& other : *list)
        if (other.id != id) other.weights.divide(id, shares);
  }
}

/// Notes that a hypothesis is a part of another.
void MovingObjectState::trace_split(std::uint64_t whole, const MovingHypothesis& part) {
  if (!trace_) return;
  trace_->arrivals.push_back({.id = part.id,
                              .weight = part.weights.by_model(),
                              .turned = {{whole, part.weights.by_model()}}});
}

}  // namespace posemix::internal
