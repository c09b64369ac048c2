// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "object_belief.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "posemix/filter/update.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix::internal {
namespace {

/// Moments of the camera under several cases, summed up case by case.
class CameraMixture {
 public:
  explicit CameraMixture(const CameraMoments& before)
      : before_(before.covariance),
        rig_before_(before.rig.covariance),
        rig_{Eigen::VectorXd::Zero(before.rig.mean.size()),
             Eigen::MatrixXd::Zero(rig_before_.rows(), rig_before_.cols())} {}

  /// A case in which the camera stays as it was.
  void add_unmoved(double weight) {
    weight_ += weight;
    second_ += weight * before_;
    rig_.covariance += weight * rig_before_;
  }
  void add(double weight, const DetectionUpdate& update) {
    const DetectionMoments& state = update.posterior;
    const Vector6d mean = state.mean.head<6>();
    weight_ += weight;
    mean_ += weight * mean;
    second_ += weight * (state.covariance.topLeftCorner<6, 6>() + mean * mean.transpose());
    if (rig_.empty()) return;
    const RigMoments rig = update.camera().rig;
    rig_.mean += weight * rig.mean;
    rig_.covariance += weight * (rig.covariance + rig.mean * rig.mean.transpose());
  }
  CameraAlternative moments() const {
    if (weight_ <= 0.0) return {0.0, Vector6d::Zero(), before_, {0.0 * rig_.mean, rig_before_}};
    const Vector6d mean = mean_ / weight_;
    CameraAlternative result{weight_, mean, second_ / weight_ - mean * mean.transpose()};
    if (rig_.empty()) return result;
    result.rig.mean = rig_.mean / weight_;
    result.rig.covariance =
        rig_.covariance / weight_ - result.rig.mean * result.rig.mean.transpose();
    return result;
  }

 private:
  Matrix6d before_;
  Eigen::MatrixXd rig_before_;
  RigMoments rig_;  ///< sums of the first and second moments; empty without extrinsics
  double weight_ = 0.0;
  Vector6d mean_ = Vector6d::Zero();
  Matrix6d second_ = Matrix6d::Zero();
};

}  // namespace

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
  return leads(h) ? joint.conditional(leader_->pose_index) : alternatives_.at(slot(h)).pose;
}

const SE3d& ObjectBelief::mean(const JointGaussian& joint, std::size_t h) const {
  return leads(h) ? joint.pose(leader_->pose_index) : alternatives_.at(slot(h)).pose.pose;
}

DetectionState ObjectBelief::state(const JointGaussian& joint, std::size_t h) const {
  const ConditionalPose object = pose(joint, h);
  DetectionState state{joint.pose(kCamera), object.pose, object.slow.value_or(Vector6d::Zero()),
                       Matrix18d::Zero(), object.slow.has_value()};
  state.covariance.topLeftCorner<6, 6>() = joint.covariance(kCamera, kCamera);
  state.covariance.bottomLeftCorner<12, 6>() = object.cross_covariance;
  state.covariance.topRightCorner<6, 12>() = object.cross_covariance.transpose();
  state.covariance.bottomRightCorner<12, 12>() = object.covariance;
  return state;
}

std::vector<double> ObjectBelief::probabilities() const {
  std::vector<double> terms;
  terms.reserve(size() + 1);
  for (std::size_t h = 0; h < size(); ++h) terms.push_back(standing(h).log_probability);
  terms.push_back(log_absence_probability_);
  const double total = log_sum_exp(terms);
  terms.pop_back();
  for (double& term : terms) term = std::exp(term - total);
  return terms;
}

void ObjectBelief::move_pose_index_up(std::size_t erased, std::size_t blocks) {
  if (leader_ && leader_->pose_index > erased) leader_->pose_index -= blocks;
}

DetectionUpdates ObjectBelief::observe(const JointGaussian& joint,
                                       const WeighedObservation& observation,
                                       const ObjectSensor& sensor,
                                       const GainFactors& factors) const {
  DetectionUpdates updates;
  updates.reserve(size());
  for (std::size_t h = 0; h < size(); ++h) {
    const DetectionState seen_from = state_from(joint, h, observation.source);
    updates.push_back(moved_by(joint, h, {seen_from, observation, sensor},
                               explain(seen_from, observation, sensor), factors));
  }
  return updates;
}

DetectionUpdate ObjectBelief::moved_by(const JointGaussian& joint, std::size_t h,
                                       const SeenHypothesis& seen, Explanation explanation,
                                       const GainFactors& factors) const {
  if (factors.are_whole) linearise_there(seen.state, seen.observation, seen.sensor, explanation);
  if (joint.extrinsics() == 0)
    return internal::moved_by(std::move(explanation), seen.state, factors);
  const ConditionalPose object = pose(joint, h);
  const Eigen::Index rig = joint.rig().rows();
  Eigen::MatrixXd covariance(rig + 12, rig + 12);
  covariance.topLeftCorner(rig, rig) = joint.rig();
  covariance.bottomLeftCorner(12, rig) << object.cross_covariance, object.extrinsics;
  covariance.topRightCorner(rig, 12) = covariance.bottomLeftCorner(12, rig).transpose();
  covariance.bottomRightCorner<12, 12>() = object.covariance;
  return internal::moved_by(std::move(explanation), joint.seen_by(seen.observation.source),
                            covariance, factors);
}

void ObjectBelief::multiply_weights(const DetectionUpdates& updates, double log_clutter,
                                    double share) {
  for (std::size_t h = 0; h < size(); ++h) {
    Standing& standing = mutable_standing(h);
    const double told = updates[h].explanation.log_weights;
    standing.log_weight += updates[h].log_evidence();
    // The weights are already those that no earlier observation told.
    standing.log_probability += share * (updates[h].log_evidence() - told) + told;
  }
  log_absent_ += log_clutter;
  // Without clutter absence is impossible, however little a detection tells.
  log_absence_probability_ += std::isfinite(log_clutter) ? share * log_clutter : log_clutter;
}

void ObjectBelief::update_scores(const DetectionUpdates& updates, double log_clutter,
                                 double memory) {
  for (std::size_t h = 0; h < size(); ++h) {
    double& score = mutable_standing(h).score;
    score = memory * score +
            (std::isfinite(log_clutter) ? updates[h].log_evidence() - log_clutter : 0.0);
  }
}

void ObjectBelief::count_detection() {
  for (std::size_t h = 0; h < size(); ++h) ++mutable_standing(h).detections;
}

double ObjectBelief::log_total(const Alternatives& births) const {
  return log_sum_exp(size() + births.size() + 1, [&](std::size_t i) {
    if (i < size()) return standing(i).log_weight;
    i -= size();
    return i < births.size() ? births[i].standing.log_weight : log_absent_;
  });
}

CameraAlternative ObjectBelief::camera_alternative(const DetectionUpdates& updates,
                                                   const Alternatives& births, double log_evidence,
                                                   const CameraMoments& before) const {
  const auto weight = [&](double log_weight) { return std::exp(log_weight - log_evidence); };
  CameraMixture cases(before);
  cases.add_unmoved(weight(log_absent_));
  for (const Alternative& birth : births) cases.add_unmoved(weight(birth.standing.log_weight));
  for (std::size_t i = 0; i < alternatives_.size(); ++i)
    cases.add(weight(alternatives_[i].standing.log_weight), updates[index_of(i)]);
  return cases.moments();
}

void ObjectBelief::add(JointGaussian& joint, const Alternatives& births) {
  auto next = births.begin();
  if (!leader_ && next != births.end()) {
    leader_ = {next->standing, 0, joint.append(next->pose)};
    ++next;
  }
  alternatives_.insert(alternatives_.end(), next, births.end());
}

}  // namespace posemix::internal
