// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "object_belief.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "object_merge.hpp"
#include "posemix/filter/update.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix::internal {
namespace {

/// Moments of the camera under several cases, summed up case by case.
class CameraMixture {
 public:
  explicit CameraMixture(const Matrix6d& before) : before_(before) {}

  /// A case in which the camera stays as it was.
  void add_unmoved(double weight) {
    weight_ += weight;
    second_ += weight * before_;
  }
  void add(double weight, const PairMoments& pair) {
    const Vector6d mean = pair.mean.head<6>();
    weight_ += weight;
    mean_ += weight * mean;
    second_ += weight * (pair.covariance.topLeftCorner<6, 6>() + mean * mean.transpose());
  }
  CameraAlternative moments() const {
    if (weight_ <= 0.0) return {0.0, Vector6d::Zero(), before_};
    const Vector6d mean = mean_ / weight_;
    return {weight_, mean, second_ / weight_ - mean * mean.transpose()};
  }

 private:
  Matrix6d before_;
  double weight_ = 0.0;
  Vector6d mean_ = Vector6d::Zero();
  Matrix6d second_ = Matrix6d::Zero();
};

}  // namespace

void follow_camera(ConditionalPose& pose, const CameraMoments& before, const CameraMoments& after) {
  // G = P_OC P_CC^-1, O <- Exp(G (m' - m)) O, P_OO += G (P_CC' - P_CC) G^T, P_OC <- G P_CC'.
  const Matrix6d g = regression_on_camera(pose.cross_covariance, before.covariance);
  const Vector6d shift = g * (after.mean - before.mean);
  pose.pose = SE3d::exp(shift) * pose.pose;
  pose.covariance += g * (after.covariance - before.covariance) * g.transpose();
  symmetrize(pose.covariance);
  pose.cross_covariance.noalias() = g * after.covariance;
}

std::optional<std::size_t> ObjectBelief::leading() const {
  return leader_ ? std::optional(leader_->position) : std::nullopt;
}

std::optional<std::size_t> ObjectBelief::pose_index() const {
  return leader_ ? std::optional(leader_->pose_index) : std::nullopt;
}

const Standing& ObjectBelief::standing(std::size_t h) const {
  return leads(h) ? leader_->standing : alternatives_.at(slot(h)).standing;
}

Standing& ObjectBelief::mutable_standing(std::size_t h) {
  return leads(h) ? leader_->standing : alternatives_.at(slot(h)).standing;
}

ConditionalPose ObjectBelief::pose(const JointGaussian& joint, std::size_t h) const {
  if (!leads(h)) return alternatives_.at(slot(h)).pose;
  const std::size_t index = leader_->pose_index;
  return {joint.pose(index), joint.covariance(index, index), joint.covariance(index, kCamera)};
}

Pair ObjectBelief::pair(const JointGaussian& joint, std::size_t h) const {
  if (leads(h)) return joint.pair(leader_->pose_index);
  const ConditionalPose& object = alternatives_.at(slot(h)).pose;
  Pair pair{joint.pose(kCamera), object.pose, {}};
  pair.covariance.topLeftCorner<6, 6>() = joint.covariance(kCamera, kCamera);
  pair.covariance.bottomLeftCorner<6, 6>() = object.cross_covariance;
  pair.covariance.topRightCorner<6, 6>() = object.cross_covariance.transpose();
  pair.covariance.bottomRightCorner<6, 6>() = object.covariance;
  return pair;
}

std::vector<double> ObjectBelief::probabilities(double length) const {
  std::vector<double> terms;
  for (std::size_t h = 0; h < size(); ++h) terms.push_back(standing(h).log_weight / length);
  terms.push_back(log_absent_ / length);
  const double total = log_sum_exp(terms);
  terms.pop_back();
  for (double& term : terms) term = std::exp(term - total);
  return terms;
}

void ObjectBelief::move_pose_index_up(std::size_t erased) {
  if (leader_ && leader_->pose_index > erased) --leader_->pose_index;
}

void ObjectBelief::add_noise(JointGaussian& joint, const Matrix6d& q) {
  for (Alternative& alternative : alternatives_) {
    ConditionalPose& object = alternative.pose;
    object.covariance += object.pose.adjoint_congruence(q);
  }
  if (leader_) {
    const std::size_t i = leader_->pose_index;
    block(joint.covariance(), i, i) += joint.pose(i).adjoint_congruence(q);
  }
}

void ObjectBelief::add_to_cross_covariances(const Matrix6d& factor) {
  for (Alternative& alternative : alternatives_) {
    const Matrix6d change = alternative.pose.cross_covariance * factor;
    alternative.pose.cross_covariance += change;
  }
}

std::vector<PairUpdate> ObjectBelief::observe(const JointGaussian& joint, const SE3d& detected,
                                              const ObjectSensor& sensor, double camera_gain_noise,
                                              GainCovariance gain_covariance) const {
  std::vector<PairUpdate> updates;
  updates.reserve(size());
  for (std::size_t h = 0; h < size(); ++h) {
    updates.push_back(
        internal::observe(pair(joint, h), detected, sensor, camera_gain_noise, gain_covariance));
  }
  return updates;
}

void ObjectBelief::multiply_weights(const std::vector<PairUpdate>& updates, double log_clutter) {
  for (std::size_t h = 0; h < size(); ++h)
    mutable_standing(h).log_weight += updates[h].log_evidence;
  log_absent_ += log_clutter;
}

void ObjectBelief::update_scores(const std::vector<PairUpdate>& updates, double log_clutter,
                                 double memory) {
  for (std::size_t h = 0; h < size(); ++h) {
    double& score = mutable_standing(h).score;
    score =
        memory * score + (std::isfinite(log_clutter) ? updates[h].log_evidence - log_clutter : 0.0);
  }
}

void ObjectBelief::count_detection() {
  for (std::size_t h = 0; h < size(); ++h) ++mutable_standing(h).detections;
}

double ObjectBelief::log_total(const std::vector<Alternative>& births) const {
  std::vector<double> terms;
  for (std::size_t h = 0; h < size(); ++h) terms.push_back(standing(h).log_weight);
  for (const Alternative& birth : births) terms.push_back(birth.standing.log_weight);
  terms.push_back(log_absent_);
  return log_sum_exp(terms);
}

CameraAlternative ObjectBelief::camera_alternative(const std::vector<PairUpdate>& updates,
                                                   const std::vector<Alternative>& births,
                                                   double log_evidence,
                                                   const Matrix6d& before) const {
  const auto weight = [&](double log_weight) { return std::exp(log_weight - log_evidence); };
  CameraMixture cases(before);
  cases.add_unmoved(weight(log_absent_));
  for (const Alternative& birth : births) cases.add_unmoved(weight(birth.standing.log_weight));
  for (std::size_t i = 0; i < alternatives_.size(); ++i)
    cases.add(weight(alternatives_[i].standing.log_weight), updates[index_of(i)].posterior);
  return cases.moments();
}

void ObjectBelief::follow_camera(const std::vector<PairUpdate>& updates,
                                 const CameraMoments& after) {
  for (std::size_t i = 0; i < alternatives_.size(); ++i) {
    const PairMoments& pair = updates[index_of(i)].posterior;
    ConditionalPose& object = alternatives_[i].pose;
    object.pose = SE3d::exp(pair.mean.tail<6>()) * object.pose;
    object.covariance = pair.covariance.bottomRightCorner<6, 6>();
    object.cross_covariance = pair.covariance.bottomLeftCorner<6, 6>();
    internal::follow_camera(object, {pair.mean.head<6>(), pair.covariance.topLeftCorner<6, 6>()},
                            after);
  }
}

void ObjectBelief::follow_camera(const CameraMoments& before, const CameraMoments& after) {
  for (Alternative& alternative : alternatives_)
    internal::follow_camera(alternative.pose, before, after);
}

void ObjectBelief::add(JointGaussian& joint, const std::vector<Alternative>& births) {
  auto next = births.begin();
  if (!leader_ && next != births.end()) {
    const ConditionalPose& first = next->pose;
    leader_ = {next->standing, 0,
               joint.append(first.pose, first.covariance, first.cross_covariance)};
    ++next;
  }
  alternatives_.insert(alternatives_.end(), next, births.end());
}

std::size_t ObjectBelief::merge(JointGaussian& joint, const SymmetryGroup& symmetries,
                                const MergeBounds& bounds) {
  std::size_t merges = 0;
  for (std::size_t a = 0; a < size(); ++a) {
    for (std::size_t b = a + 1; b < size();) {
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
  const Midway midway(at_a, standing(a).log_weight, at_b, standing(b).log_weight);
  const Standing common = merged(standing(a), standing(b));
  if (!leads(a) && !leads(b)) {
    alternatives_[slot(a)] = {common, midway.merged(at_a, at_b)};
    erase_alternative(b);
    return;
  }
  // The rows of the joint Gaussian: those of the leading one, and the regression of the other.
  const std::size_t index = leader_->pose_index;
  const auto rows_at = [&](std::size_t h, const ConditionalPose& at) {
    return leads(h) ? joint.rows_of(index) : joint.regressed_rows(at.cross_covariance);
  };
  Eigen::MatrixXd merged_rows = midway.cross_covariance(rows_at(a, at_a), rows_at(b, at_b));
  block(merged_rows, 0, index) = midway.covariance(at_a.covariance, at_b.covariance);
  joint.set_rows(index, midway.pose(), merged_rows);
  erase_alternative(leads(a) ? b : a);
  leader_->standing = common;
  leader_->position = a;
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
  for (const std::size_t h : dropped) erase_alternative(h);
}

void ObjectBelief::normalise() {
  std::vector<double> weights{log_absent_};
  for (std::size_t h = 0; h < size(); ++h) weights.push_back(standing(h).log_weight);
  const double total = log_sum_exp(weights);
  log_absent_ -= total;
  for (std::size_t h = 0; h < size(); ++h) mutable_standing(h).log_weight -= total;
}

void ObjectBelief::choose_leader(JointGaussian& joint, double margin) {
  if (!leader_) return;
  std::size_t heaviest = 0;
  for (std::size_t h = 1; h < size(); ++h) {
    if (standing(h).log_weight > standing(heaviest).log_weight) heaviest = h;
  }
  if (leads(heaviest) || standing(heaviest).log_weight <= leader_->standing.log_weight + margin)
    return;
  const std::size_t position = leader_->position;
  const Alternative former{leader_->standing, pose(joint, position)};
  const Alternative next = alternatives_[slot(heaviest)];
  joint.replace(leader_->pose_index, next.pose.pose, next.pose.covariance,
                next.pose.cross_covariance);
  erase_alternative(heaviest);
  leader_ = {next.standing, heaviest, leader_->pose_index};
  alternatives_.insert(alternatives_.begin() + static_cast<std::ptrdiff_t>(slot(position)), former);
}

void ObjectBelief::erase_alternative(std::size_t h) {
  alternatives_.erase(alternatives_.begin() + static_cast<std::ptrdiff_t>(slot(h)));
  if (leader_ && leader_->position > h) --leader_->position;
}

}  // namespace posemix::internal
