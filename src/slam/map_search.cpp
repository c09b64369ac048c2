// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "map_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "posemix/base/statistics.hpp"

namespace posemix::internal {
namespace {

/// Angles about an axis of symmetry from which a pose is sought.
constexpr int kAxisStarts = 24;

constexpr double kNever = -std::numeric_limits<double>::infinity();

}  // namespace

bool may_be_one(const ObjectModel& a, const ObjectModel& b) {
  return a.id == b.id || (!a.class_id.empty() && a.class_id == b.class_id);
}

MapSearch::MapSearch(const MapSide& old_map, const MapSide& now, const RelocaliseSettings& settings)
    : old_(old_map),
      now_(now),
      gate_(chi_square_quantile(settings.agreement_probability, 6, "agreement_probability")),
      log_moved_(std::log(settings.moved_probability) -
                 std::log(8.0 * std::numbers::pi * std::numbers::pi * settings.volume_m3)),
      log_stayed_(std::log1p(-settings.moved_probability)) {
  for (std::size_t j = 0; j < now_.size(); ++j)
    if (!candidates_of(j).empty()) shared_.push_back(j);
}

std::vector<MapPair> MapSearch::candidates_of(std::size_t object) const {
  std::vector<MapPair> pairs;
  for (std::size_t j = 0; j < old_.size(); ++j) {
    if (!may_be_one(now_.model(object), old_.model(j))) continue;
    for (std::size_t a = 0; a < old_.hypotheses(j).size(); ++a)
      for (std::size_t b = 0; b < now_.hypotheses(object).size(); ++b)
        pairs.push_back({j, a, object, b});
  }
  return pairs;
}

std::vector<SE3d> MapSearch::starts_of(const MapPair& pair) const {
  const SymmetryGroup& symmetries = now_.model(pair.new_object).symmetries;
  const SE3d back = old_.hypotheses(pair.old_object)[pair.old_hypothesis].pose.inverse();
  const SE3d& seen = now_.hypotheses(pair.new_object)[pair.new_hypothesis].pose;
  std::vector<SE3d> starts;
  // All rotations about a point tell the position alone, from which no pose is begun.
  if (symmetries.axes().size() > 1) return starts;
  for (const SE3d& element : symmetries.elements()) {
    if (symmetries.axes().empty()) {
      starts.push_back(seen * element * back);
      continue;
    }
    const SymmetryAxis& axis = symmetries.axes().front();
    const SE3d to_axis(SO3d(), axis.point);
    for (int k = 0; k < kAxisStarts; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kAxisStarts;
      const SE3d turn(SO3d::exp(angle * axis.direction), Eigen::Vector3d::Zero());
      starts.push_back(seen * element * to_axis * turn * to_axis.inverse() * back);
    }
  }
  return starts;
}

double MapSearch::log_prior(const MapPair& pair) const {
  // What looks the same after n motions is at the nearest of n poses, as probable each.
  const auto images = now_.model(pair.new_object).symmetries.elements().size();
  return std::log(old_.hypotheses(pair.old_object)[pair.old_hypothesis].probability) +
         std::log(now_.hypotheses(pair.new_object)[pair.new_hypothesis].probability) + log_stayed_ -
         std::log(static_cast<double>(images));
}

MapPose MapSearch::grown(const MapPair& first, const SE3d& start) const {
  PairsFit fit(old_, now_, start, {first});
  std::vector<MapPair> rejected;
  while (fit.is_solved()) {
    const std::optional<MapPair> next = next_pair(fit, rejected);
    if (!next) break;
    std::vector<MapPair> pairs = fit.pairs();
    pairs.push_back(*next);
    const PairsFit larger(old_, now_, fit.new_old(), std::move(pairs));
    if (larger.is_solved() && std::ranges::max(larger.left_out()) <= gate_) {
      fit = larger;
    } else {
      rejected.push_back(*next);
    }
  }
  const double log_probability_of_fit = fit.is_solved() ? log_probability(fit) : kNever;
  return {std::move(fit), log_probability_of_fit};
}

std::optional<MapPair> MapSearch::next_pair(const PairsFit& fit,
                                            const std::vector<MapPair>& rejected) const {
  std::optional<MapPair> best;
  double best_score = log_moved_;
  for (const std::size_t object : shared_) {
    for (const MapPair& pair : candidates_of(object)) {
      const bool is_taken = std::ranges::any_of(fit.pairs(), [&](const MapPair& other) {
        return other.new_object == pair.new_object || other.old_object == pair.old_object;
      });
      if (is_taken || std::ranges::count(rejected, pair) > 0) continue;
      const PairPrediction expected = fit.predict(pair);
      const double score = log_prior(pair) + expected.log_density;
      if (expected.squared_distance > gate_ || score <= best_score) continue;
      best = pair;
      best_score = score;
    }
  }
  return best;
}

double MapSearch::log_probability(const PairsFit& fit) const {
  const auto moved = static_cast<double>(shared_.size() - fit.pairs().size());
  double sum = log_moved_ * moved + fit.log_evidence();  // eq. (7)
  for (const MapPair& pair : fit.pairs()) sum += log_prior(pair);
  return sum;
}

bool MapSearch::are_same(const PairsFit& a, const PairsFit& b) const {
  const Vector6d apart = (a.new_old() * b.new_old().inverse()).log();
  const Eigen::LLT<Matrix6d> factor(Matrix6d(a.covariance() + b.covariance()));
  return apart.dot(factor.solve(apart)) <= gate_;
}

bool MapSearch::leads_to_known(const MapPair& pair, const SE3d& start,
                               const std::vector<MapPose>& known) const {
  // About an axis, the start may be far from where it leads.
  if (!now_.model(pair.new_object).symmetries.axes().empty()) return false;
  const PairsFit begun(old_, now_, start, {pair});
  return std::ranges::any_of(known, [&](const MapPose& pose) {
    return std::ranges::count(pose.fit.pairs(), pair) > 0 && are_same(begun, pose.fit);
  });
}

std::vector<MapPose> MapSearch::poses() const {
  std::vector<MapPose> all;
  for (const std::size_t object : shared_) {
    for (const MapPair& pair : candidates_of(object)) {
      for (const SE3d& start : starts_of(pair))
        if (!leads_to_known(pair, start, all)) all.push_back(grown(pair, start));
    }
  }
  std::ranges::stable_sort(all, [](const MapPose& a, const MapPose& b) {
    return a.log_probability > b.log_probability;
  });
  std::vector<MapPose> different;
  for (MapPose& pose : all) {
    if (pose.log_probability == kNever) break;
    const bool is_known = std::ranges::any_of(
        different, [&](const MapPose& other) { return are_same(pose.fit, other.fit); });
    if (!is_known) different.push_back(std::move(pose));
  }
  return different;
}

}  // namespace posemix::internal
