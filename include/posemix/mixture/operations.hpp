// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/density/operations.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/mixture/mixture.hpp"

/// Operations on mixtures, written once for every kind of density: each applies the operation on
/// densities to all pairs of components, and throws as it does.
namespace posemix {

/// The mixture of X Y for independent X and Y, one component per pair.
template <class D>
Mixture<D> compose(const Mixture<D>& x, const Mixture<D>& y) {
  std::vector<Component<D>> pairs;
  pairs.reserve(x.size() * y.size());
  for (const auto& a : x.components()) {
    for (const auto& b : y.components()) {
      pairs.push_back({a.log_weight + b.log_weight, compose(a.density, b.density)});
    }
  }
  return Mixture<D>(std::move(pairs));
}

/// The mixture of X^-1.
template <class D>
Mixture<D> inverse(const Mixture<D>& x) {
  std::vector<Component<D>> inverses;
  inverses.reserve(x.size());
  for (const auto& a : x.components()) inverses.push_back({a.log_weight, inverse(a.density)});
  return Mixture<D>(std::move(inverses));
}

/// The mixture of X^-1 Y for independent X and Y.
template <class D>
Mixture<D> between(const Mixture<D>& x, const Mixture<D>& y) {
  return compose(inverse(x), y);
}

/// Result of fusing two mixtures.
template <class D>
struct MixtureFusion {
  Mixture<D> density;  ///< the normalised product
  double log_overlap;  ///< log of the integral of the product [nats]
  bool converged;      ///< whether the fusion of every pair has converged
};

/// The normalised product of two mixtures: all pairs, each weighted by the product of the two
/// weights and the overlap of the two densities.
/// @throws InvalidInput when the overlap of every pair underflows to zero even as a logarithm
template <class D>
MixtureFusion<D> fuse(const Mixture<D>& p, const Mixture<D>& q, const FuseSettings& settings = {}) {
  std::vector<Component<D>> pairs;
  std::vector<double> log_weights;
  bool converged = true;
  for (const auto& a : p.components()) {
    for (const auto& b : q.components()) {
      auto fused = fuse(a.density, b.density, settings);
      converged = converged && fused.converged;
      log_weights.push_back(a.log_weight + b.log_weight + fused.log_overlap);
      pairs.push_back({log_weights.back(), std::move(fused.density)});
    }
  }
  return {Mixture<D>(std::move(pairs)), log_sum_exp(log_weights), converged};
}

/// The marginal mixture of one pose of a joint density.
/// @throws InvalidInput when the index is out of range
Mixture<ConcentratedGaussian<SE3d>> marginal(const Mixture<ConcentratedGaussian<PoseStackd>>& joint,
                                             std::size_t index);

/// The mixture of T_from^-1 T_to, including the cross-covariance of every component.
/// @throws InvalidInput when an index is out of range or the two are the same
Mixture<ConcentratedGaussian<SE3d>> relative_pose(
    const Mixture<ConcentratedGaussian<PoseStackd>>& joint, std::size_t from, std::size_t to);

extern template class Mixture<ConcentratedGaussian<SO3d>>;
extern template class Mixture<ConcentratedGaussian<SE3d>>;
extern template class Mixture<ConcentratedGaussian<PoseStackd>>;

}  // namespace posemix
