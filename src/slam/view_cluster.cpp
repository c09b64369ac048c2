// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/view_cluster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "posemix/mixture/log_weights.hpp"

namespace posemix::internal {
namespace {

/// The weight of clutter of a noise without any, as in the filter of many objects.
constexpr double kDefaultClutter = 0.05;
/// Standard deviation of the position of a turned pose, in those of the white error.
constexpr double kTurnedScale = 3.0;
/// Hypotheses this far below the best are dropped [nats].
constexpr double kNegligible = 25.0;

double log_orientations() { return std::log(8.0 * std::numbers::pi * std::numbers::pi); }

/// Weights of the cases of one observation.
struct CaseWeights {
  double clutter;
  double turned;
  double pose_scale;  ///< factor on the weights of the noise's components

  CaseWeights(const Observation& observation, const DetectorNoise& noise, double turned_share) {
    const double missing = noise.clutter().weight;
    const double noise_clutter = missing > 0.0 ? missing : kDefaultClutter;
    const double left = noise_clutter * (1.0 - turned_share);
    clutter = std::clamp(observation.clutter.value_or(left), 1e-9, 1.0 - 1e-9);
    const double turned_part = noise_clutter * turned_share / (1.0 - left);
    turned = (1.0 - clutter) * turned_part;
    pose_scale = (1.0 - clutter) * (1.0 - turned_part) / (1.0 - missing);
  }
};

/// Makes the terms of observations in a frame at `origin` with the axes of the world.
class ViewTerms {
 public:
  ViewTerms(const ViewClass& known, const FuseViewsSettings& settings,
            const Eigen::Vector3d& origin)
      : noise_(known.noise), settings_(settings), to_local_(SO3d(), -origin) {
    const auto& components = noise_.components();
    const auto heaviest =
        std::max_element(components.begin(), components.end(),
                         [](const auto& a, const auto& b) { return a.weight < b.weight; });
    heaviest_ = static_cast<std::size_t>(heaviest - components.begin());
  }

  std::vector<ViewTerm> of(const ViewMember& member) const {
    const CaseWeights weights(*member.observation, noise_, settings_.turned_share);
    std::vector<ViewTerm> terms;
    for (const ObservationComponent& seen : member.observation->components) {
      if (seen.weight <= 0.0) continue;
      for (std::size_t c = 0; c < noise_.components().size(); ++c) {
        ViewTerm term = base(member, seen, c);
        term.log_prior = std::log(weights.pose_scale * noise_.components()[c].weight * seen.weight);
        terms.push_back(term);
      }
      if (weights.turned <= 0.0) continue;
      ViewTerm turned = base(member, seen, heaviest_);
      turned.is_turned = true;
      turned.white *= kTurnedScale * kTurnedScale;
      turned.log_prior = std::log(weights.turned * seen.weight) - log_orientations();
      terms.push_back(turned);
    }
    return terms;
  }

  double log_clutter(const Observation& observation) const {
    const CaseWeights weights(observation, noise_, settings_.turned_share);
    return std::log(weights.clutter) + log_uniform();
  }
  /// Log of the density of poses that are uniform over the volume.
  double log_uniform() const { return -log_orientations() - std::log(noise_.clutter().volume_m3); }
  ViewCorrelation correlation() const {
    const auto& slow = noise_.dependence().slow;
    if (!slow) return {1.0, 1.0};
    return {slow->correlation_angle_rad, slow->correlation_time_s};
  }

 private:
  ViewTerm base(const ViewMember& member, const ObservationComponent& seen,
                std::size_t index) const {
    const NoiseComponent& component = noise_.components()[index];
    const SE3d camera_object = seen.pose * component.offset.inverse();
    const NoiseAtPose at = noise_at(component, camera_object);
    const SE3d local_camera = to_local_ * member.world_camera;
    const Matrix6d to_local = (local_camera * at.axes).adjoint();
    ViewTerm term{.pose = local_camera * camera_object,
                  .white = to_local * at.covariance * to_local.transpose(),
                  .slow_factor = Matrix6d::Zero(),
                  .has_own_slow = component.run_length > 1.0,
                  .camera_position = local_camera.translation(),
                  .stamp_s = member.observation->stamp_s};
    if (seen.covariance && settings_.use_given_covariances && index == heaviest_) {
      Matrix6d given = *seen.covariance;
      symmetrize(given);
      term.white = (local_camera * seen.pose).adjoint_congruence(given);
    }
    if (const auto& slow = noise_.dependence().slow) {
      const Eigen::LLT<Matrix6d> factor(slow->covariance);
      term.slow_factor = to_local * at.units.asDiagonal() * Matrix6d(factor.matrixL());
    }
    return term;
  }

  const DetectorNoise& noise_;
  const FuseViewsSettings& settings_;
  SE3d to_local_;
  std::size_t heaviest_ = 0;
};

/// Keeps the heaviest hypotheses, the heaviest first.
void keep_heaviest(std::vector<CaseHypothesis>& hypotheses, std::size_t count) {
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const auto& a, const auto& b) { return a.log_weight > b.log_weight; });
  if (hypotheses.size() > count)
    hypotheses.erase(hypotheses.begin() + std::ptrdiff_t(count), hypotheses.end());
  const double least = hypotheses.front().log_weight - kNegligible;
  std::erase_if(hypotheses, [&](const auto& h) { return h.log_weight < least; });
}

CaseHypothesis extended(const CaseHypothesis& hypothesis, const ViewTerm& term,
                        const SymmetryGroup& symmetries) {
  CaseHypothesis child = hypothesis;
  child.stack.add(term, symmetries);
  child.cases.push_back(term.is_turned ? ViewCase::turned : ViewCase::pose);
  child.log_prior += term.log_prior;
  child.log_weight = child.log_prior + child.stack.log_evidence();
  return child;
}

}  // namespace

Eigen::Vector3d ViewMember::position() const {
  return world_camera * observation->components[best_component(*observation)].pose.translation();
}

double ClusterBelief::log_evidence() const {
  return log_sum_exp(std::array{log_object, log_clutter});
}

Eigen::Matrix3d position_covariance(const ViewMember& member, const ViewClass& known) {
  const SE3d& camera_object =
      member.observation->components[best_component(*member.observation)].pose;
  const DetectorNoise white = known.noise.as_white();
  Eigen::Matrix3d widest = Eigen::Matrix3d::Zero();
  for (const NoiseComponent& component : white.components()) {
    const NoiseAtPose at = noise_at(component, camera_object);
    const Eigen::Matrix3d axes = (member.world_camera * at.axes).rotation().matrix();
    const Eigen::Matrix3d covariance =
        axes * at.covariance.bottomRightCorner<3, 3>() * axes.transpose();
    if (covariance.trace() > widest.trace()) widest = covariance;
  }
  return widest;
}

namespace {

/// The hypotheses with one more member: it shows the object, under each of its terms, or is
/// clutter.
std::vector<CaseHypothesis> with_member(std::vector<CaseHypothesis>& hypotheses,
                                        CaseHypothesis& root, std::span<const ViewTerm> terms,
                                        const SymmetryGroup& symmetries, double log_not_shown) {
  std::vector<CaseHypothesis> next;
  next.reserve((terms.size() + 1) * (hypotheses.size() + 1));
  for (const ViewTerm& term : terms) {
    next.push_back(extended(root, term, symmetries));
    for (const CaseHypothesis& hypothesis : hypotheses)
      next.push_back(extended(hypothesis, term, symmetries));
  }
  const auto miss = [&](CaseHypothesis& hypothesis) {
    hypothesis.cases.push_back(ViewCase::clutter);
    hypothesis.log_prior += log_not_shown;
    hypothesis.log_weight += log_not_shown;
  };
  for (CaseHypothesis& hypothesis : hypotheses) {
    miss(hypothesis);
    next.push_back(std::move(hypothesis));
  }
  miss(root);
  return next;
}

}  // namespace

ClusterBelief cluster_belief(std::span<const ViewMember> members, const ViewClass& known,
                             const FuseViewsSettings& settings, std::size_t views,
                             std::size_t max_hypotheses) {
  const ViewTerms terms(known, settings, members.front().position());
  const double log_seen = std::log(settings.detection_probability);
  const double log_missed = std::log1p(-settings.detection_probability);
  const double log_birth = terms.log_uniform();
  CaseHypothesis root{ViewStack(terms.correlation())};
  root.log_prior = root.log_weight =
      static_cast<double>(views - members.size()) * log_missed + log_birth;
  ClusterBelief belief;
  // The object that none of the members shows waits for the next one.
  std::vector<CaseHypothesis> hypotheses;
  for (const ViewMember& member : members) {
    const double log_clutter = terms.log_clutter(*member.observation);
    std::vector<ViewTerm> all = terms.of(member);
    for (ViewTerm& term : all) term.log_prior += log_seen;
    belief.log_clutter += log_clutter;
    hypotheses = with_member(hypotheses, root, all, known.symmetries, log_clutter + log_missed);
    keep_heaviest(hypotheses, max_hypotheses);
  }
  std::vector<double> weights;
  weights.reserve(hypotheses.size());
  for (const CaseHypothesis& hypothesis : hypotheses) weights.push_back(hypothesis.log_weight);
  belief.log_object = log_sum_exp(weights);
  belief.hypotheses = std::move(hypotheses);
  return belief;
}

}  // namespace posemix::internal
