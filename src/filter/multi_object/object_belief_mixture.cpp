// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>

#include "object_merge.hpp"
#include "posemix/filter/update.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix::internal {

namespace {

/// A case of less probability costs nothing to merge.
constexpr double kLeastTie = 1e-7;

}  // namespace

double merge_loss(double weight, const CameraMoments& a, const CameraMoments& b) {
  if (weight < kLeastTie || weight > 1.0 - kLeastTie) return 0.0;
  const Vector6d difference = b.mean - a.mean;
  const Matrix6d both = (1.0 - weight) * a.covariance + weight * b.covariance +
                        weight * (1.0 - weight) * difference * difference.transpose();
  const auto log_determinant = [](const Matrix6d& p) {
    const Eigen::LLT<Matrix6d> factor(p);
    return factor.info() == Eigen::Success ? log_det(factor)
                                           : std::numeric_limits<double>::quiet_NaN();
  };
  const double loss =
      0.5 * (log_determinant(both) - (1.0 - weight) * log_determinant(a.covariance) -
             weight * log_determinant(b.covariance));
  return std::isfinite(loss) ? std::max(loss, 0.0) : 0.0;
}

bool ObjectBelief::has_supported_alternative(double score) const {
  return std::any_of(alternatives_.begin(), alternatives_.end(),
                     [&](const Alternative& one) { return one.standing.score > score; });
}

void ObjectBelief::keep_leader() {
  alternatives_.clear();
  leader_->position = 0;
  log_absent_ = log_absence_probability_ = -std::numeric_limits<double>::infinity();
}

std::optional<std::size_t> ObjectBelief::drop_leader(JointGaussian& joint) {
  const std::size_t index = leader_->pose_index;
  if (alternatives_.empty()) {
    leader_.reset();
    return index;
  }
  const auto next = std::max_element(alternatives_.begin(), alternatives_.end(),
                                     [](const Alternative& a, const Alternative& b) {
                                       return a.standing.log_weight < b.standing.log_weight;
                                     });
  joint.replace(index, next->pose);
  leader_ = {next->standing, static_cast<std::size_t>(next - alternatives_.begin()), index};
  alternatives_.erase(next);
  return std::nullopt;
}

std::optional<std::size_t> ObjectBelief::find(std::uint64_t id) const {
  for (std::size_t h = 0; h < size(); ++h) {
    if (standing(h).id == id) return h;
  }
  return std::nullopt;
}

std::size_t ObjectBelief::insert(const Alternative& alternative) {
  std::size_t h = 0;
  while (h < size() && standing(h).id < alternative.standing.id) ++h;
  const auto before = static_cast<std::ptrdiff_t>(h - (leader_ && leader_->position < h ? 1 : 0));
  if (leader_ && leader_->position >= h) ++leader_->position;
  alternatives_.insert(alternatives_.begin() + before, alternative);
  return h;
}

void ObjectBelief::mix(JointGaussian& joint, const LogTotals& own,
                       const std::vector<Alternative>& other, const LogTotals& other_absence,
                       bool shares_leader) {
  for (std::size_t h = 0; h < size(); ++h) {
    mutable_standing(h).log_weight += own.weight;
    mutable_standing(h).log_probability += own.probability;
  }
  const auto add = [](double& log_sum, double log_term) {
    const double terms[] = {log_sum, log_term};
    log_sum = log_sum_exp(terms);
  };
  log_absent_ += own.weight;
  log_absence_probability_ += own.probability;
  add(log_absent_, other_absence.weight);
  add(log_absence_probability_, other_absence.probability);
  for (const Alternative& one : other) {
    const auto same = find(one.standing.id);
    if (!leader_) {
      this->add(joint, {one});
    } else if (!same) {
      insert(one);
    } else if (shares_leader && leads(*same)) {
      leader_->standing = merged(leader_->standing, one.standing);
    } else {
      const std::size_t h = insert(one);
      merge_two(joint, h, h + 1, pose(joint, h), pose(joint, h + 1));
    }
  }
}

}  // namespace posemix::internal
