// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "global_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "one_world.hpp"
#include "posemix/filter/update.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix::internal {
namespace {

/// States are mixed when that loses less than this part of the loss at which they are split, so
/// that they do not come and go with every detection.
constexpr double kMixedBelow = 0.1;

/// Whether the two objects have different hypotheses.
bool differ(const ObjectBelief& a, const ObjectBelief& b) {
  if (a.size() != b.size() || std::isfinite(a.log_absent()) != std::isfinite(b.log_absent()))
    return true;
  for (std::size_t h = 0; h < a.size(); ++h) {
    if (a.standing(h).id != b.standing(h).id) return true;
  }
  return false;
}

/// Whether an object is led by different hypotheses, both of which recent detections support.
bool can_both_win(const MultiObjectState& a, const MultiObjectState& b) {
  for (std::size_t j = 0; j < a.objects.size(); ++j) {
    const ObjectBelief& x = a.objects[j].belief;
    const ObjectBelief& y = b.objects[j].belief;
    if (!x.leading() || !y.leading()) continue;
    const Standing& s = x.standing(*x.leading());
    const Standing& t = y.standing(*y.leading());
    if (s.id != t.id && std::min(s.score, t.score) > a.supported_score()) return true;
  }
  return false;
}

}  // namespace

LogTotals normalise_pair(LogTotals& a, LogTotals& b) {
  const double weights[] = {a.weight, b.weight};
  const double probabilities[] = {a.probability, b.probability};
  const LogTotals total{log_sum_exp(weights), log_sum_exp(probabilities)};
  a = {a.weight - total.weight, a.probability - total.probability};
  b = {b.weight - total.weight, b.probability - total.probability};
  return total;
}

GlobalHypotheses::GlobalHypotheses(const MultiObjectState& initial, const Eigen::Vector3d& origin)
    : origin_(origin) {
  list_.push_back({initial});
}

/// The state that would lose most by one camera for all hypotheses of object `j` is split, until
/// none would lose much.
void GlobalHypotheses::split(std::size_t j, KeptVector<ObservedDetection>& observed,
                             const Starters& may_start) {
  KeptVector<double> losses;
  losses.reserve(list_.size());
  for (std::size_t i = 0; i < list_.size(); ++i)
    losses.push_back(list_[i].state.tie_loss(j, observed[i], may_start));
  while (list_.size() < settings().max_global_hypotheses) {
    const auto most = std::max_element(losses.begin(), losses.end());
    if (*most <= settings().split_loss) return;
    const auto i = static_cast<std::size_t>(most - losses.begin());
    const std::size_t leading = list_[i].state.objects[j].belief.leading().value();
    LogTotals own;
    LogTotals others;
    MultiObjectState rest = list_[i].state.split(j, own, others);
    ObservedDetection seen = observed[i];
    observed[i].updates = {seen.updates[leading]};
    seen.updates.erase(seen.updates.begin() + static_cast<std::ptrdiff_t>(leading));
    const LogTotals before = list_[i].log;
    list_[i].log = {before.weight + own.weight, before.probability + own.probability};
    list_.push_back({std::move(rest),
                     {before.weight + others.weight, before.probability + others.probability}});
    observed.push_back(std::move(seen));
    losses[i] = 0.0;
    losses.push_back(list_.back().state.tie_loss(j, observed.back(), may_start));
  }
}

void GlobalHypotheses::split_by_components(std::size_t j, KeptVector<ObservedDetection>& observed,
                                           KeptVector<Starters>& may_start) {
  for (std::size_t i = 0; i < list_.size(); ++i) {
    if (list_.size() >= settings().max_global_hypotheses) return;
    const auto k = list_[i].state.component_apart(j, observed[i]);
    if (!k) continue;
    const MultiObjectState& state = list_[i].state;
    const auto [own, others] = parted(observed[i].observation, *k);
    const std::size_t leading = state.objects[j].belief.leading().value();
    const Explanation& explanation = observed[i].updates[leading].explanation;
    // An update adds `share` times the log evidence of a part; the part itself counts in full.
    const double known = 1.0 - observed[i].share;
    const double part = explanation.probability_of(*k) / (1.0 - explanation.clutter_probability);
    observed.push_back(state.observe(j, others));
    observed[i] = state.observe(j, own);
    may_start.push_back(may_start[i]);
    may_start.back().erase(may_start.back().begin() + static_cast<std::ptrdiff_t>(*k));
    may_start[i] = {may_start[i][*k]};
    list_.push_back(list_[i]);
    list_[i].log.probability += known * std::log(part);
    list_.back().log.probability += known * std::log1p(-part);
  }
}

namespace {

/// The components that start hypotheses, for every state: those that none of any state explains. An
/// object that is put down elsewhere has its places in every state.
KeptVector<Starters> starters_of(const KeptVector<ObservedDetection>& observed,
                                 const Starters& may_start, std::size_t states) {
  KeptVector<Starters> starters(states, may_start);
  for (std::size_t i = 0; i < states; ++i) {
    if (!observed[i].put_down) continue;
    starters[i] = observed[i].explained;
    starters[i].flip();
  }
  return starters;
}

/// A component starts hypotheses where none of any state explains it.
Starters unexplained(const KeptVector<ObservedDetection>& observed) {
  Starters may_start(observed.front().explained.size(), true);
  for (const ObservedDetection& seen : observed) {
    for (std::size_t k = 0; k < may_start.size(); ++k)
      if (seen.explained[k]) may_start[k] = false;
  }
  return may_start;
}

}  // namespace

ObjectUpdateReport GlobalHypotheses::update(std::size_t j, const Observation& observation,
                                            const ObservationSource& source) {
  stay_near_the_origin();
  const auto led = leading_id(j);
  activate(j);
  for (Weighted& one : list_) one.state.see_from(j, source);
  KeptVector<ObservedDetection> observed;
  observed.reserve(list_.size());
  for (const Weighted& one : list_) observed.push_back(one.state.observe(j, observation, source));
  const Starters may_start = unexplained(observed);
  split(j, observed, may_start);
  KeptVector<Starters> starters = starters_of(observed, may_start, list_.size());
  split_by_components(j, observed, starters);

  ObjectUpdateReport report;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    LogTotals evidence;
    const ObjectUpdateReport one = list_[i].state.update(j, observed[i], starters[i], evidence);
    list_[i].log.weight += evidence.weight;
    list_[i].log.probability += evidence.probability;
    const std::size_t merges = report.merges + one.merges;
    const bool started = report.started || one.started;
    if (i == 0) report = one;
    report.merges = merges;
    report.started = started;
  }
  share_next_id();
  report.log_evidence =
      log_sum_exp(list_.size(), [&](std::size_t i) { return list_[i].log.weight; });
  normalise();
  choose_first();
  reduce();
  take_out_world_error();
  share_next_id();
  const auto leads = leading_id(j);
  report.changed_leader = leads && leads != led;
  return report;
}

ObjectUpdateReport GlobalHypotheses::update(std::size_t j, const SE3d& camera_object) {
  of_a_pose_.components.front().pose = camera_object;
  return update(j, of_a_pose_, {});
}

void GlobalHypotheses::forget(std::size_t j) {
  for (Weighted& one : list_) one.state.forget(j);
  reduce();
  share_next_id();
  reset_reports();
}

void GlobalHypotheses::reset_reports() {
  summary_.reset();
  joint_.reset();
}

void GlobalHypotheses::share_next_id() {
  std::uint64_t next_id = 0;
  for (const Weighted& one : list_) next_id = std::max(next_id, one.state.next_id);
  for (Weighted& one : list_) one.state.next_id = next_id;
}

void GlobalHypotheses::normalise() {
  const LogTotals total{
      log_sum_exp(list_.size(), [&](std::size_t i) { return list_[i].log.weight; }),
      log_sum_exp(list_.size(), [&](std::size_t i) { return list_[i].log.probability; })};
  for (Weighted& one : list_) {
    one.log.weight -= total.weight;
    one.log.probability -= total.probability;
  }
}

void GlobalHypotheses::choose_first() {
  const auto most = std::max_element(
      list_.begin(), list_.end(),
      [](const Weighted& a, const Weighted& b) { return a.log.probability < b.log.probability; });
  if (most->log.probability > list_.front().log.probability + settings().leader_margin)
    std::rotate(list_.begin(), most, most + 1);
  // As ObjectBelief::catch_up.
  for (const Weighted& one : list_)
    list_.front().log.weight = std::max(list_.front().log.weight, one.log.weight);
  normalise();
}

double GlobalHypotheses::loss_of_mixing(const Weighted& a, const Weighted& b) const {
  const bool are_one = are_one_but_for_the_world(a.state, b.state);
  if (are_one && are_at_one_place(a.state, b.state)) return 0.0;
  LogTotals log_a = a.log;
  LogTotals log_b = b.log;
  normalise_pair(log_a, log_b);
  double weight = std::exp(log_b.weight);
  // Of which only one can win if detections decide.
  if (!are_one && std::abs(a.log.weight - b.log.weight) < kDecided &&
      can_both_win(a.state, b.state))
    weight = 0.5;
  double loss = merge_loss(weight, a.state.joint.camera_moments(),
                           b.state.joint.camera_moments(a.state.joint));
  // What the hypotheses of one object tell of those of another beyond the camera is lost, which is
  // at most the entropy of the two cases for each object after the first.
  std::size_t different = 0;
  for (std::size_t j = 0; j < a.state.objects.size(); ++j)
    different += differ(a.state.objects[j].belief, b.state.objects[j].belief) ? 1 : 0;
  if (different > 1 && weight > 0.0 && weight < 1.0) {
    loss -= static_cast<double>(different - 1) *
            (weight * log_b.weight + (1.0 - weight) * log_a.weight);
  }
  return loss;
}

void GlobalHypotheses::reduce() {
  while (list_.size() > 1) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t first = 0;
    std::size_t second = 0;
    for (std::size_t a = 0; a < list_.size(); ++a) {
      for (std::size_t b = a + 1; b < list_.size(); ++b) {
        const double loss = loss_of_mixing(list_[a], list_[b]);
        if (loss < least) std::tie(least, first, second) = std::tuple(loss, a, b);
      }
    }
    if (list_.size() <= settings().max_global_hypotheses &&
        least > kMixedBelow * settings().split_loss)
      return;
    // The more probable one keeps its leading hypotheses; the first one stays the first.
    Weighted& a = list_[first];
    Weighted& b = list_[second];
    if (first > 0 && b.log.probability > a.log.probability) std::swap(a, b);
    const LogTotals total = normalise_pair(a.log, b.log);
    a.state.mix(b.state, a.log, b.log);
    a.log = total;
    list_.erase(list_.begin() + static_cast<std::ptrdiff_t>(second));
  }
}

double GlobalHypotheses::probability_of(std::size_t j, std::uint64_t id) const {
  double sum = 0.0;
  for (const Weighted& one : list_) {
    const ObjectBelief& belief = one.state.objects[j].belief;
    if (const auto h = belief.find(id))
      sum += std::exp(one.log.probability + belief.standing(*h).log_probability);
  }
  return sum;
}

std::optional<std::uint64_t> GlobalHypotheses::leading_id(std::size_t j) const {
  std::optional<std::uint64_t> most;
  double probability = 0.0;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const ObjectBelief& belief = list_[i].state.objects[j].belief;
    for (std::size_t h = 0; h < belief.size(); ++h) {
      const std::uint64_t id = belief.standing(h).id;
      const auto has_it = [&](const Weighted& one) { return one.state.objects[j].belief.find(id); };
      if (std::any_of(list_.begin(), list_.begin() + static_cast<std::ptrdiff_t>(i), has_it))
        continue;
      const double of_id = probability_of(j, id);
      if (most && (of_id < probability || (of_id == probability && id >= *most))) continue;
      most = id;
      probability = of_id;
    }
  }
  const ObjectBelief& first = list_.front().state.objects[j].belief;
  if (!most || !first.leading()) return most;
  const std::uint64_t led = first.standing(*first.leading()).id;
  return probability > probability_of(j, led) * std::exp(settings().leader_margin) ? *most : led;
}

const MultiObjectState& GlobalHypotheses::summary() const {
  if (list_.size() == 1) return list_.front().state;
  const std::lock_guard lock(mutex_);
  if (!summary_) summary_ = mixed();
  return *summary_;
}

const ConcentratedGaussian<PoseStackd>& GlobalHypotheses::joint() const {
  const MultiObjectState& all = summary();
  const std::lock_guard lock(mutex_);
  if (!joint_) joint_ = all.reported_joint(to_world());
  return *joint_;
}

}  // namespace posemix::internal
