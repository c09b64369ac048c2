// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/projected_operations.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

/// log delta of the MPG paper, eq. 19: minus half of the squared Mahalanobis distance of the means
/// in the tangent space halfway.
template <RotationOrPose G>
double log_delta(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
  const SO3d halfway = gnomonic::halfway(p.tangent_point(), q.tangent_point());
  const ProjectedGaussian<G> p3 = change_chart(p, halfway), q3 = change_chart(q, halfway);
  const Eigen::LLT<typename G::TangentMatrix> sum(p3.covariance() + q3.covariance());
  const typename G::Tangent apart = q3.tangent_mean() - p3.tangent_mean();
  return -0.5 * sum.matrixL().solve(apart).squaredNorm();
}

/// The components that result from a pair of components.
template <RotationOrPose G>
class PairFusion {
 public:
  explicit PairFusion(const ProjectedMixtureFuseSettings& settings) : settings_(settings) {}

  void add(double log_weight, const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
    const bool close = tangent_angle(p, q) <= settings_.pair.max_angle;
    const bool needs_close =
        settings_.pair.rule == FusionRule::jacobian || settings_.weight == PairWeight::alpha_delta;
    if (needs_close && !close) return;
    ProjectedFusion<G> fused = fuse(p, q, settings_.pair);
    converged = converged && fused.converged;
    if (settings_.weight == PairWeight::alpha_delta) {
      components.push_back({log_weight + log_delta(p, q), std::move(fused.density)});
      return;
    }
    components.push_back({log_weight + fused.log_overlap, std::move(fused.density)});
    if (fused.second) {
      components.push_back(
          {log_weight + fused.second->log_overlap, std::move(fused.second->density)});
    }
  }

  std::vector<Component<ProjectedGaussian<G>>> components;
  bool converged = true;

 private:
  const ProjectedMixtureFuseSettings& settings_;
};

/// All components, those with a too wide rotation replaced by their parts. The spread of u is half
/// of the spread of the rotation.
template <RotationOrPose G>
std::vector<Component<ProjectedGaussian<G>>> split_wide(const Mixture<ProjectedGaussian<G>>& x,
                                                        double split_above) {
  require(split_above > 0.0, "compose: split_above must be positive");
  if (std::isinf(split_above)) return x.components();
  std::vector<Component<ProjectedGaussian<G>>> pieces;
  for (const auto& component : x.components()) {
    for (auto& piece : split(component.density, 0.5 * split_above)) {
      pieces.push_back({component.log_weight + std::log(piece.weight), std::move(piece.density)});
    }
  }
  return pieces;
}

/// Applies the operation to all pairs of components.
template <RotationOrPose G, class Operation>
Mixture<ProjectedGaussian<G>> on_pairs(const Mixture<ProjectedGaussian<G>>& x,
                                       const Mixture<ProjectedGaussian<G>>& y, double split_above,
                                       const Operation& operation) {
  const auto left = split_wide(x, split_above);
  std::vector<Component<ProjectedGaussian<G>>> pairs;
  pairs.reserve(left.size() * y.size());
  for (const auto& a : left) {
    for (const auto& b : y.components()) {
      pairs.push_back({a.log_weight + b.log_weight, operation(a.density, b.density)});
    }
  }
  return Mixture<ProjectedGaussian<G>>(std::move(pairs));
}

template <RotationOrPose G, class Operation>
Mixture<ProjectedGaussian<G>> on_each(const Mixture<ProjectedGaussian<G>>& x,
                                      const Operation& operation) {
  std::vector<Component<ProjectedGaussian<G>>> results;
  results.reserve(x.size());
  for (const auto& a : x.components()) results.push_back({a.log_weight, operation(a.density)});
  return Mixture<ProjectedGaussian<G>>(std::move(results));
}

}  // namespace

template <RotationOrPose G>
MixtureFusion<ProjectedGaussian<G>> fuse(const Mixture<ProjectedGaussian<G>>& p,
                                         const Mixture<ProjectedGaussian<G>>& q,
                                         const ProjectedMixtureFuseSettings& settings) {
  PairFusion<G> fusion(settings);
  for (const auto& a : p.components()) {
    for (const auto& b : q.components()) {
      fusion.add(a.log_weight + b.log_weight, a.density, b.density);
    }
  }
  require(!fusion.components.empty(),
          "fuse: the tangent points of every pair are further apart than the Jacobian rule allows");
  const double log_overlap =
      checked_log_total(std::span<const Component<ProjectedGaussian<G>>>(fusion.components));
  return {Mixture<ProjectedGaussian<G>>(std::move(fusion.components)), log_overlap,
          fusion.converged};
}

template <RotationOrPose G>
Mixture<ProjectedGaussian<G>> compose(const Mixture<ProjectedGaussian<G>>& x,
                                      const Mixture<ProjectedGaussian<G>>& y,
                                      const ProjectedMixtureComposeSettings& settings) {
  return on_pairs(x, y, settings.split_above,
                  [&](const auto& a, const auto& b) { return compose(a, b, settings.rule); });
}

template <RotationOrPose G>
Mixture<ProjectedGaussian<G>> inverse(const Mixture<ProjectedGaussian<G>>& x,
                                      const ProjectedMixtureComposeSettings& settings) {
  return on_each(x, [&](const auto& a) { return inverse(a, settings.rule); });
}

template <RotationOrPose G>
Mixture<ProjectedGaussian<G>> between(const Mixture<ProjectedGaussian<G>>& x,
                                      const Mixture<ProjectedGaussian<G>>& y,
                                      const ProjectedMixtureComposeSettings& settings) {
  return on_pairs(x, y, settings.split_above,
                  [&](const auto& a, const auto& b) { return between(a, b, settings.rule); });
}

template <RotationOrPose G>
Mixture<ProjectedGaussian<G>> transform(const G& a, const Mixture<ProjectedGaussian<G>>& x) {
  return on_each(x, [&](const auto& density) { return transform(a, density); });
}

template <RotationOrPose G>
Mixture<ProjectedGaussian<G>> transform(const Mixture<ProjectedGaussian<G>>& x, const G& b,
                                        const ProjectedMixtureComposeSettings& settings) {
  return on_each(x, [&](const auto& density) { return transform(density, b, settings.rule); });
}

// NOLINTBEGIN(bugprone-macro-parentheses): types
#define POSEMIX_INSTANTIATE(G)                                                                     \
  template class Mixture<ProjectedGaussian<G>>;                                                    \
  template MixtureFusion<ProjectedGaussian<G>> fuse(const Mixture<ProjectedGaussian<G>>&,          \
                                                    const Mixture<ProjectedGaussian<G>>&,          \
                                                    const ProjectedMixtureFuseSettings&);          \
  template Mixture<ProjectedGaussian<G>> compose(const Mixture<ProjectedGaussian<G>>&,             \
                                                 const Mixture<ProjectedGaussian<G>>&,             \
                                                 const ProjectedMixtureComposeSettings&);          \
  template Mixture<ProjectedGaussian<G>> inverse(const Mixture<ProjectedGaussian<G>>&,             \
                                                 const ProjectedMixtureComposeSettings&);          \
  template Mixture<ProjectedGaussian<G>> between(const Mixture<ProjectedGaussian<G>>&,             \
                                                 const Mixture<ProjectedGaussian<G>>&,             \
                                                 const ProjectedMixtureComposeSettings&);          \
  template Mixture<ProjectedGaussian<G>> transform(const G&,                                       \
                                                   const Mixture<ProjectedGaussian<G>>&);          \
  template Mixture<ProjectedGaussian<G>> transform(const Mixture<ProjectedGaussian<G>>&, const G&, \
                                                   const ProjectedMixtureComposeSettings&);

POSEMIX_INSTANTIATE(SO3d)
POSEMIX_INSTANTIATE(SE3d)
#undef POSEMIX_INSTANTIATE
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace posemix
