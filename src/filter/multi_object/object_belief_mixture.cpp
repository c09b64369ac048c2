// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>

#include "object_merge.hpp"
#include "posemix/filter/update.hpp"
#include "posemix/mixture/log_weights.hpp"
#include "put_down.hpp"

namespace posemix::internal {

namespace {

/// A case of less probability costs nothing to merge.
constexpr double kLeastTie = 1e-7;

/// The bound for a `difference` of the means; not a number where a covariance is not positive
/// definite.
template <class Matrix, class Vector>
double loss_of_one(double weight, const Vector& difference, const Matrix& a, const Matrix& b) {
  const Matrix both = (1.0 - weight) * a + weight * b +
                      weight * (1.0 - weight) * difference * difference.transpose();
  const auto log_determinant = [](const Matrix& p) {
    const Eigen::LLT<Matrix> factor(p);
    return factor.info() == Eigen::Success ? log_det(factor)
                                           : std::numeric_limits<double>::quiet_NaN();
  };
  return 0.5 * (log_determinant(both) - (1.0 - weight) * log_determinant(a) -
                weight * log_determinant(b));
}

}  // namespace

double merge_loss(double weight, const CameraMoments& a, const CameraMoments& b) {
  if (weight < kLeastTie || weight > 1.0 - kLeastTie) return 0.0;
  const double loss =
      a.rig.empty()
          ? loss_of_one<Matrix6d, Vector6d>(weight, b.mean - a.mean, a.covariance, b.covariance)
          : loss_of_one<Eigen::MatrixXd, Eigen::VectorXd>(weight, b.rig.mean - a.rig.mean,
                                                          a.rig.covariance, b.rig.covariance);
  return std::isfinite(loss) ? std::max(loss, 0.0) : 0.0;
}

bool ObjectBelief::has_alternative_that_can_win(double score) const {
  return std::any_of(alternatives_.begin(), alternatives_.end(), [&](const Alternative& one) {
    return one.standing.score > score &&
           one.standing.log_weight > leader_->standing.log_weight - kDecided;
  });
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

void ObjectBelief::mix(JointGaussian& joint, const LogTotals& own, const OtherBelief& other,
                       const SymmetryGroup& symmetries, const MergeBounds& bounds,
                       std::uint64_t& next_id) {
  for (std::size_t h = 0; h < size(); ++h) {
    mutable_standing(h).log_weight += own.weight;
    mutable_standing(h).log_probability += own.probability;
  }
  const auto add_to = [](double& log_sum, double log_term) {
    const double terms[] = {log_sum, log_term};
    log_sum = log_sum_exp(terms);
  };
  log_absent_ += own.weight;
  log_absence_probability_ += own.probability;
  if (!lost_shown_.empty()) {
    const double weights[] = {log_absent_, other.log_absence.weight};
    const double total = log_sum_exp(weights);
    if (std::isfinite(total)) {
      mix_into(lost_shown_, std::exp(weights[0] - total), other.lost_shown,
               std::exp(weights[1] - total));
    }
  }
  add_to(log_absent_, other.log_absence.weight);
  add_to(log_absence_probability_, other.log_absence.probability);
  for (Alternative one : other.hypotheses) {
    const auto same = find(one.standing.id);
    if (same && leads(*same) && other.shares_leader) {
      leader_->standing = merged(leader_->standing, one.standing);
      continue;
    }
    // Merges with other hypotheses may have moved the two far apart.
    const bool is_same = same && agree(joint.covariance(kCamera, kCamera), symmetries, bounds,
                                       pose(joint, *same), one.pose);
    if (same && !is_same) one.standing.id = next_id++;
    add(joint, {one});
    if (is_same) merge_two(joint, *same, size() - 1, pose(joint, *same), pose(joint, size() - 1));
  }
}

}  // namespace posemix::internal
