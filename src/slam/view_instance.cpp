// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "posemix/base/statistics.hpp"
#include "posemix/mixture/log_weights.hpp"
#include "posemix/reduction/reduce.hpp"
#include "slam/view_cluster.hpp"

namespace posemix::internal {
namespace {

using Density = ConcentratedGaussian<SE3d>;

/// Hypotheses are of one mode within this angle and this part of the distribution of the lighter
/// one's distance.
constexpr double kModeAngle = radians(30.0);
constexpr double kModeProbability = 0.99;

/// Hypotheses with the same pose.
struct ViewMode {
  std::vector<Component<Density>> parts;
  std::vector<double> view_weights;  ///< of the parts in which a member's pose is the mode's
  double log_weight = 0.0;
  bool has_orientation = true;
};

double squared_distance(const Density& a, const Density& b) {
  const Vector6d difference = (a.mean() * b.mean().inverse()).log();
  const Eigen::LLT<Matrix6d> factor(Matrix6d(a.covariance() + b.covariance()));
  return factor.matrixL().solve(difference).squaredNorm();
}

bool is_of_mode(const ViewMode& mode, const Density& density, bool has_orientation) {
  if (mode.has_orientation != has_orientation) return false;
  const Density& first = mode.parts.front().density;
  const SE3d between = first.mean().inverse() * density.mean();
  if (has_orientation && between.rotation().angle() > kModeAngle) return false;
  return squared_distance(first, density) < chi_square_quantile(kModeProbability, 6);
}

/// The mean number of views that one view stands for, inverted: views from the same side err alike.
double mode_exponent(std::span<const ViewMember> members, const Eigen::Vector3d& object,
                     double angle_rad) {
  if (angle_rad <= 0.0) return 1.0;
  double sum = 0.0;
  for (const ViewMember& a : members) {
    double alike = 0.0;
    for (const ViewMember& b : members) {
      const Eigen::Vector3d to_a = a.world_camera.translation() - object;
      const Eigen::Vector3d to_b = b.world_camera.translation() - object;
      alike += std::exp(-std::atan2(to_a.cross(to_b).norm(), to_a.dot(to_b)) / angle_rad);
    }
    sum += 1.0 / alike;
  }
  return sum / static_cast<double>(members.size());
}

/// The density of a hypothesis with what no view tells: angles about axes of symmetry, and the
/// error in common.
Density reported(const Density& solved, const ViewClass& known) {
  const SE3d& pose = solved.mean();
  Matrix6d body = solved.body_covariance();
  const Matrix6d observed = known.symmetries.observed_projection();
  body = observed * body * observed.transpose();
  if (const auto& common = known.noise.dependence().common) body += *common;
  if (!known.symmetries.axes().empty())
    body = observed * body * observed.transpose() + known.symmetries.unobserved_covariance();
  Matrix6d covariance = pose.adjoint_congruence(body);
  symmetrize(covariance);
  return Density::trusted(pose, covariance);
}

class ViewModes {
 public:
  ViewModes(const SymmetryGroup& symmetries, std::size_t members)
      : symmetries_(symmetries), members_(members) {}

  /// Hypotheses come in the order of falling weight.
  void add(const CaseHypothesis& hypothesis, Density density, double log_weight) {
    const bool has_orientation = hypothesis.stack.has_orientation();
    if (!modes_.empty() && has_orientation && !symmetries_.is_trivial())
      density = Density::trusted(nearest(density.mean()), density.covariance());
    const auto same = std::find_if(modes_.begin(), modes_.end(), [&](const ViewMode& mode) {
      return is_of_mode(mode, density, has_orientation);
    });
    ViewMode& mode = same != modes_.end() ? *same : modes_.emplace_back();
    if (mode.parts.empty()) {
      mode.has_orientation = has_orientation;
      mode.view_weights.assign(members_, 0.0);
    }
    mode.parts.push_back({log_weight, std::move(density)});
    for (std::size_t i = 0; i < members_; ++i) {
      if (hypothesis.cases[i] == ViewCase::pose) mode.view_weights[i] += std::exp(log_weight);
    }
  }

  std::vector<ViewMode> release() && { return std::move(modes_); }

 private:
  /// The equivalent pose nearest to the first mode.
  SE3d nearest(const SE3d& pose) const {
    const Density& first = modes_.front().parts.front().density;
    const Matrix6d information =
        Eigen::LLT<Matrix6d>(first.body_covariance()).solve(Matrix6d::Identity());
    return symmetries_.closest_observed(pose, first.mean(), information);
  }

  const SymmetryGroup& symmetries_;
  std::size_t members_;
  std::vector<ViewMode> modes_;
};

/// The mode as one component, in the world.
Component<Density> merged(const ViewMode& mode, const SE3d& world_local) {
  Component<Density> component = merge(std::span<const Component<Density>>(mode.parts)).component;
  const Density& density = component.density;
  component.density = Density::trusted(world_local * density.mean(),
                                       world_local.adjoint_congruence(density.covariance()));
  return component;
}

}  // namespace

FusedInstance fused_instance(std::span<const ViewMember> members, const ViewClass& known,
                             const FuseViewsSettings& settings, std::size_t views) {
  const ClusterBelief belief =
      cluster_belief(members, known, settings, views, settings.max_hypotheses);
  const Eigen::Vector3d origin = members.front().position();
  const double exponent = mode_exponent(members, origin, settings.mode_angle_rad);
  ViewModes modes(known.symmetries, members.size());
  const double top = belief.hypotheses.front().log_weight;
  for (const CaseHypothesis& hypothesis : belief.hypotheses) {
    modes.add(hypothesis, reported(hypothesis.stack.solve(), known),
              exponent * (hypothesis.log_weight - top));
  }
  std::vector<Component<Density>> components;
  std::vector<ViewMode> all = std::move(modes).release();
  components.reserve(all.size());
  for (const ViewMode& mode : all) components.push_back(merged(mode, SE3d(SO3d(), origin)));
  const std::vector<std::size_t> order =
      heaviest_first(components.size(), [&](std::size_t i) { return components[i].log_weight; });
  std::vector<Component<Density>> sorted;
  sorted.reserve(order.size());
  for (const std::size_t i : order) sorted.push_back(components[i]);
  ReductionSettings reduction;
  reduction.prune_below = settings.prune_below;
  reduction.keep_heaviest = settings.max_components;
  reduction.max_components = settings.max_components;
  FusedInstance instance{.density = reduce(Mixture<Density>(std::move(sorted)), reduction).mixture};
  instance.probability = 1.0 / (1.0 + std::exp(belief.log_clutter - belief.log_object));
  const ViewMode& leading = all[order.front()];
  const double total = std::exp(components[order.front()].log_weight);
  for (std::size_t i = 0; i < members.size(); ++i) {
    const double probability = std::min(1.0, leading.view_weights[i] / total);
    instance.support.push_back({members[i].view, members[i].index, probability});
    instance.supporting_views += probability;
  }
  return instance;
}

}  // namespace posemix::internal
