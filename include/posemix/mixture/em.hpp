// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "posemix/base/random.hpp"
#include "posemix/mixture/mixture.hpp"

/// Mixtures fitted to samples by expectation maximisation (MPG paper, section IV, there with an
/// M-step that does not maximise the likelihood).
namespace posemix {

/// How an EM run ended.
enum class EmStatus {
  converged,       ///< an iteration gained less than the tolerance
  max_iterations,  ///< stopped before that
  degenerate       ///< a component lost its samples or collapsed to its lower bound
};

/// Settings of fit_mixture.
struct EmSettings {
  std::size_t components = 1;
  int max_iterations = 1000;
  double tolerance = 1e-7;  ///< of the log-likelihood's gain per unit of weight [nats]
  int restarts = 1;         ///< number of starts, of which the most likely end is kept
  /// The means stay where they start: at the identity, or at those of the start that is given.
  bool fixed_means = false;
  bool diagonal = false;  ///< diagonal covariances
  /// One unit per coordinate in which the two bounds below are stated; empty: 1 rad, 1 m.
  Eigen::VectorXd unit = {};
  /// Bounds of the square roots of a covariance's eigenvalues, in the units above.
  double min_sd = 1e-6;
  double max_sd = std::numeric_limits<double>::infinity();
};

/// A fitted mixture.
template <class D>
struct EmResult {
  Mixture<D> mixture;
  double log_likelihood;        ///< sum of weight times log density over the samples [nats]
  std::vector<double> history;  ///< log-likelihood of the start and after every iteration
  EmStatus status;
  std::size_t parameters;  ///< free parameters
  double bic;              ///< parameters log(total weight) - 2 log_likelihood; smaller is better
  int starts;              ///< starts that were tried
};

/// The interface of a density to EM. A specialisation EmModel<D> has
///  - `Samples`, made from a span of elements, with size(): the samples as the density wants them;
///  - `Worker(const D&, const EmSettings&)`, one component in one iteration:
///    `log_density(samples, begin, count, out)` writes the log density of a block of samples into
///    an EmRow, `accumulate(shares)` then adds the sufficient statistics of that block with these
///    weights, `weight()` is the sum of all shares, and `update(step)` the component that maximises
///    the expected log-likelihood; for 0 <= step < 1 the mean goes only that part of the way, and
///    for step = 0 the expected log-likelihood must not fall;
///  - `start(elements, weights, settings, prior)`, a crude fit for a start, drawn to the density
///    `prior` where it points to one;
///  - `squared_distance(density, a, b)` of two elements in units of the density's spread;
///  - `stretched(density, factors)` with the spread of every coordinate multiplied;
///  - `parameters(dof, settings)`, the free parameters of one component;
///  - `on_lower_bound(density, settings)`, whether the component has collapsed;
///  - where not every density is of the form that is fitted, `prepared(density, settings)`, one
///  that
///    is.
template <class D>
struct EmModel;

/// The maximum-likelihood mixture of `settings.components` components, as far as EM finds it.
///
/// Every iteration is a generalised EM step: all components are re-estimated, and where the
/// log-likelihood would fall (the mean's step is of Gauss-Newton type), the means go half the way,
/// then a quarter, then stay. So `history` never falls by more than rounding. The first start is by
/// k-means++ in units of the samples' spread; further starts alternate between that and concentric
/// components. `weights` (empty: all one) count samples; their sum is the number in the BIC. With
/// `start`, EM starts there and nowhere else.
/// @throws InvalidInput for settings out of range, a sample that is not finite or a weight that is
/// negative or not finite (naming its index), and too few samples of positive weight: dof + 1 for
/// every component, 2 with diagonal covariances
template <class D>
EmResult<D> fit_mixture(std::span<const typename D::Group> samples, std::span<const double> weights,
                        const EmSettings& settings, RandomStream& stream,
                        const std::optional<Mixture<D>>& start = std::nullopt);

/// Fits of 1, 2, ... components.
template <class D>
struct BicSelection {
  std::vector<EmResult<D>> fits;  ///< entry k has k + 1 components
  std::size_t best;               ///< of the smallest BIC among those that are not degenerate
};

/// Fits 1 to `settings.components` components (as many as there are samples for).
/// @throws InvalidInput as fit_mixture
template <class D>
BicSelection<D> fit_mixture_by_bic(std::span<const typename D::Group> samples,
                                   std::span<const double> weights, const EmSettings& settings,
                                   RandomStream& stream);

/// The covariance of largest expected log-likelihood for a second moment under the settings'
/// bounds: its eigenvalues clipped in the settings' units, or its diagonal.
Eigen::MatrixXd bounded_covariance(const Eigen::MatrixXd& second_moment,
                                   const EmSettings& settings);

}  // namespace posemix

#include "posemix/mixture/em_gaussian.hpp"   // IWYU pragma: export
#include "posemix/mixture/em_impl.hpp"       // IWYU pragma: export
#include "posemix/mixture/em_projected.hpp"  // IWYU pragma: export
