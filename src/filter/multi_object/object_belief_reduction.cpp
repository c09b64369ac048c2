// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <functional>
#include <numeric>

#include "object_merge.hpp"
#include "posemix/filter/update.hpp"
#include "posemix/mixture/log_weights.hpp"
#include "put_down.hpp"

namespace posemix::internal {

std::size_t ObjectBelief::merge(JointGaussian& joint, const SymmetryGroup& symmetries,
                                const MergeBounds& bounds) {
  std::size_t merges = 0;
  for (std::size_t a = 0; a < size(); ++a) {
    for (std::size_t b = a + 1; b < size();) {
      if (!are_near(symmetries, bounds, mean(joint, a), mean(joint, b))) {
        ++b;
        continue;
      }
      const ConditionalPose at_a = pose(joint, a);
      ConditionalPose at_b = pose(joint, b);
      if (agree(joint.covariance(kCamera, kCamera), symmetries, bounds, at_a, at_b)) {
        merge_two(joint, a, b, at_a, at_b);
        ++merges;
      } else {
        ++b;
      }
    }
  }
  return merges;
}

/// Hypothesis `b`, which comes after `a`, becomes a part of `a`.
void ObjectBelief::merge_two(JointGaussian& joint, std::size_t a, std::size_t b,
                             const ConditionalPose& at_a, const ConditionalPose& at_b) {
  const RowsMidway midway(at_a, standing(a).log_weight, at_b, standing(b).log_weight);
  const Standing common = merged(standing(a), standing(b));
  const std::uint64_t gone = standing(standing(a).id == common.id ? b : a).id;
  if (!leads(a) && !leads(b)) {
    alternatives_[slot(a)] = {common, midway.merged(at_a, at_b)};
    erase_alternative(b);
    if (!common.shown.empty()) redirect_runs(place_of(gone), place_of(common.id));
    return;
  }
  // The rows of the joint Gaussian: those of the leading one, and the regression of the other.
  const std::size_t index = leader_->pose_index;
  const auto rows_at = [&](std::size_t h, const ConditionalPose& at) {
    return leads(h) ? joint.rows_of(index) : Eigen::MatrixXd(joint.regressed_rows(at).get());
  };
  const ConditionalPose both = midway.merged(at_a, at_b);
  joint.activate(index);
  joint.set_rows(index, both.pose, both.slow,
                 midway.cross_covariance(rows_at(a, at_a), rows_at(b, at_b)), both.covariance);
  erase_alternative(leads(a) ? b : a);
  leader_->standing = common;
  leader_->position = a;
  if (!common.shown.empty()) redirect_runs(place_of(gone), place_of(common.id));
}

void ObjectBelief::keep_best(std::size_t most, std::size_t best_scores) {
  if (size() <= most) return;
  std::vector<std::size_t> order(size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return standing(a).log_weight > standing(b).log_weight;
  });
  const auto others =
      order.begin() + static_cast<std::ptrdiff_t>(most - std::min(best_scores, most - 1));
  std::stable_sort(others, order.end(), [&](std::size_t i, std::size_t k) {
    const Standing& a = standing(i);
    const Standing& b = standing(k);
    return a.score != b.score ? a.score > b.score : a.id > b.id;
  });
  // The leading hypothesis is not dropped, because its pose is in the joint Gaussian.
  const auto leader = std::find(order.begin(), order.end(), leader_->position);
  const auto last = order.begin() + static_cast<std::ptrdiff_t>(most) - 1;
  if (leader > last) std::iter_swap(leader, last);
  std::vector<std::size_t> dropped(last + 1, order.end());
  std::sort(dropped.begin(), dropped.end(), std::greater<>());
  for (const std::size_t h : dropped) {
    redirect_runs(place_of(standing(h).id), kAnyPlace);
    erase_alternative(h);
  }
}

LogTotals ObjectBelief::normalise() {
  const LogTotals total{
      log_sum_exp(size() + 1,
                  [&](std::size_t i) { return i == 0 ? log_absent_ : standing(i - 1).log_weight; }),
      log_sum_exp(size() + 1, [&](std::size_t i) {
        return i == 0 ? log_absence_probability_ : standing(i - 1).log_probability;
      })};
  log_absent_ -= total.weight;
  log_absence_probability_ -= total.probability;
  for (std::size_t h = 0; h < size(); ++h) {
    mutable_standing(h).log_weight -= total.weight;
    mutable_standing(h).log_probability -= total.probability;
  }
  return total;
}

void ObjectBelief::choose_leader(JointGaussian& joint, double margin) {
  if (!leader_) return;
  std::size_t most = 0;
  for (std::size_t h = 1; h < size(); ++h) {
    if (standing(h).log_probability > standing(most).log_probability) most = h;
  }
  if (standing(most).log_probability > leader_->standing.log_probability + margin)
    make_leader(joint, most);
  // Weight and probability of an object that is put down elsewhere are the same.
  if (leader_->standing.shown.empty()) catch_up();
}

void ObjectBelief::catch_up() {
  double most = leader_->standing.log_weight;
  for (const Alternative& one : alternatives_) most = std::max(most, one.standing.log_weight);
  if (most == leader_->standing.log_weight) return;
  leader_->standing.log_weight = most;
  normalise();
}

void ObjectBelief::make_leader(JointGaussian& joint, std::size_t h) {
  if (leads(h)) return;
  const std::size_t position = leader_->position;
  const Alternative former{leader_->standing, pose(joint, position)};
  const Alternative next = alternatives_[slot(h)];
  joint.replace(leader_->pose_index, next.pose);
  erase_alternative(h);
  leader_ = {next.standing, h, leader_->pose_index};
  alternatives_.insert(alternatives_.begin() + static_cast<std::ptrdiff_t>(slot(position)), former);
}

void ObjectBelief::erase_alternative(std::size_t h) {
  alternatives_.erase(alternatives_.begin() + static_cast<std::ptrdiff_t>(slot(h)));
  if (leader_ && leader_->position > h) --leader_->position;
}

}  // namespace posemix::internal
