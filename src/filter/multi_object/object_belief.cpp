// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "object_belief.hpp"

#include <algorithm>
#include <cmath>

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
  void add(double weight, const DetectionMoments& state) {
    const Vector6d mean = state.mean.head<6>();
    weight_ += weight;
    mean_ += weight * mean;
    second_ += weight * (state.covariance.topLeftCorner<6, 6>() + mean * mean.transpose());
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

/// Whether the pose has a positive definite covariance given the camera.
bool is_positive_definite_given(const ConditionalPose& object, const Matrix6d& camera) {
  const Matrix12x6d g = regression_on_camera(object.cross_covariance, camera);
  const Matrix12d given = object.covariance - g * object.cross_covariance.transpose();
  const Matrix6d pose = given.topLeftCorner<6, 6>();
  return Eigen::LLT<Matrix6d>(pose).info() == Eigen::Success &&
         (!object.slow || Eigen::LLT<Matrix12d>(given).info() == Eigen::Success);
}

}  // namespace

void follow_camera(ConditionalPose& pose, const CameraMoments& before, const CameraMoments& after) {
  follow_camera(pose, Eigen::LLT<Matrix6d>(before.covariance), before, after);
}

void follow_camera(ConditionalPose& pose, const Eigen::LLT<Matrix6d>& factor,
                   const CameraMoments& before, const CameraMoments& after) {
  // G = P_OC P_CC^-1, O <- Exp(G (m' - m)) O, P_OO += G (P_CC' - P_CC) G^T, P_OC <- G P_CC'.
  if (!pose.slow) {
    const Matrix6d cross = pose.cross_covariance.topRows<6>();
    const Matrix6d g = factor.solve(cross.transpose()).transpose();
    const Vector6d shift = g * (after.mean - before.mean);
    pose.pose = SE3d::exp(shift) * pose.pose;
    Matrix6d own = pose.covariance.topLeftCorner<6, 6>();
    own += g * (after.covariance - before.covariance) * g.transpose();
    symmetrize(own);
    pose.covariance.topLeftCorner<6, 6>() = own;
    pose.cross_covariance.topRows<6>() = g * after.covariance;
    return;
  }
  const Matrix12x6d g = regression_on_camera(pose.cross_covariance, factor);
  const Vector12d shift = g * (after.mean - before.mean);
  move(pose, shift);
  pose.covariance += g * (after.covariance - before.covariance) * g.transpose();
  symmetrize(pose.covariance);
  pose.cross_covariance.noalias() = g * after.covariance;
}

void shift_back(ConditionalPose& pose, const CameraChange& change, const Matrix6d& back,
                const Matrix12x6d& follows) {
  const Matrix6d with_error = change.error_covariance.topRows<6>() * back.transpose();
  const Matrix12x6d x = follows * with_error;
  const Matrix6d added = back * change.covariance * back.transpose();
  pose.pose = SE3d::exp(-back * change.mean) * pose.pose;
  pose.covariance.leftCols<6>() += x;
  pose.covariance.topRows<6>() += x.transpose();
  pose.covariance.topLeftCorner<6, 6>() += added;
  pose.cross_covariance += x;
  pose.cross_covariance.topRows<6>() += with_error.transpose() + added;
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
  return leads(h) ? joint.conditional(leader_->pose_index) : alternatives_.at(slot(h)).pose;
}

const SE3d& ObjectBelief::mean(const JointGaussian& joint, std::size_t h) const {
  return leads(h) ? joint.pose(leader_->pose_index) : alternatives_.at(slot(h)).pose.pose;
}

DetectionState ObjectBelief::state(const JointGaussian& joint, std::size_t h) const {
  const ConditionalPose object = pose(joint, h);
  DetectionState state{joint.pose(kCamera), object.pose, object.slow.value_or(Vector6d::Zero()),
                       Matrix18d::Zero()};
  state.covariance.topLeftCorner<6, 6>() = joint.covariance(kCamera, kCamera);
  state.covariance.bottomLeftCorner<12, 6>() = object.cross_covariance;
  state.covariance.topRightCorner<6, 12>() = object.cross_covariance.transpose();
  state.covariance.bottomRightCorner<12, 12>() = object.covariance;
  return state;
}

std::vector<double> ObjectBelief::probabilities() const {
  std::vector<double> terms;
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

std::vector<DetectionUpdate> ObjectBelief::observe(const JointGaussian& joint,
                                                   const WeighedObservation& observation,
                                                   const ObjectSensor& sensor,
                                                   const GainFactors& factors) const {
  std::vector<DetectionUpdate> updates;
  updates.reserve(size());
  for (std::size_t h = 0; h < size(); ++h) {
    DetectionState seen_from = state(joint, h);
    seen_from.camera = seen_from.camera * observation.source.body_camera;
    updates.push_back(internal::observe(seen_from, observation, sensor, factors));
  }
  return updates;
}

void ObjectBelief::multiply_weights(const std::vector<DetectionUpdate>& updates, double log_clutter,
                                    double share) {
  for (std::size_t h = 0; h < size(); ++h) {
    Standing& standing = mutable_standing(h);
    standing.log_weight += updates[h].log_evidence();
    standing.log_probability += share * updates[h].log_evidence();
  }
  log_absent_ += log_clutter;
  // Without clutter absence is impossible, however little a detection tells.
  log_absence_probability_ += std::isfinite(log_clutter) ? share * log_clutter : log_clutter;
}

void ObjectBelief::update_scores(const std::vector<DetectionUpdate>& updates, double log_clutter,
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

double ObjectBelief::log_total(const std::vector<Alternative>& births) const {
  std::vector<double> terms;
  for (std::size_t h = 0; h < size(); ++h) terms.push_back(standing(h).log_weight);
  for (const Alternative& birth : births) terms.push_back(birth.standing.log_weight);
  terms.push_back(log_absent_);
  return log_sum_exp(terms);
}

CameraAlternative ObjectBelief::camera_alternative(const std::vector<DetectionUpdate>& updates,
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

void ObjectBelief::follow_camera(const std::vector<DetectionUpdate>& updates,
                                 const CameraMoments& after) {
  for (std::size_t i = 0; i < alternatives_.size(); ++i) {
    const DetectionMoments& own = updates[index_of(i)].posterior;
    ConditionalPose& object = alternatives_[i].pose;
    move(object, own.mean.tail<12>());
    object.covariance = own.covariance.bottomRightCorner<12, 12>();
    object.cross_covariance = own.covariance.bottomLeftCorner<12, 6>();
    internal::follow_camera(object, {own.mean.head<6>(), own.covariance.topLeftCorner<6, 6>()},
                            after);
  }
}

void ObjectBelief::follow_camera(const CameraMoments& before, const CameraMoments& after) {
  if (alternatives_.empty()) return;
  const Eigen::LLT<Matrix6d> factor(before.covariance);
  for (Alternative& alternative : alternatives_)
    internal::follow_camera(alternative.pose, factor, before, after);
}

void ObjectBelief::shift_back(const CameraChange& change, const Matrix6d& back,
                              const Matrix6d& camera, bool detected) {
  if (alternatives_.empty()) return;
  const Eigen::LLT<Matrix6d> factor(camera);
  const Matrix6d with_error = change.error_covariance.topRows<6>() * back.transpose();
  const Matrix6d shifted =
      with_error + with_error.transpose() + back * change.covariance * back.transpose();
  for (Alternative& alternative : alternatives_) {
    ConditionalPose& pose = alternative.pose;
    if (detected) {
      // The correction is that of the leading hypothesis, and the covariance of this one need not
      // be positive definite with it.
      ConditionalPose own = pose;
      internal::shift_back(own, change, back, Matrix12x6d::Zero());
      if (is_positive_definite_given(own, camera + shifted)) {
        pose = own;
        continue;
      }
    }
    internal::shift_back(pose, change, back, regression_on_camera(pose.cross_covariance, factor));
  }
}

void ObjectBelief::add(JointGaussian& joint, const std::vector<Alternative>& births) {
  auto next = births.begin();
  if (!leader_ && next != births.end()) {
    leader_ = {next->standing, 0, joint.append(next->pose)};
    ++next;
  }
  alternatives_.insert(alternatives_.end(), next, births.end());
}

}  // namespace posemix::internal
