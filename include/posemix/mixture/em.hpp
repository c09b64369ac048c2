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

/// Mixtures fitted to samples by expectation maximisation (MPG paper, section IV, whose M-step does
/// not maximise the likelihood).
namespace posemix {

/// How an EM run ended.
enum class EmStatus {
  converged,       ///< the log-likelihood rose by less than the tolerance
  max_iterations,  ///< the largest number of iterations was reached
  degenerate       ///< a component lost its samples or collapsed to its lower bound
};

/// Settings of fit_mixture.
struct EmSettings {
  std::size_t components = 1;
  int max_iterations = 1000;
  double tolerance = 1e-7;  ///< smallest gain of the log-likelihood per unit of weight [nats]
  /// Number of starts; the most likely fit is returned, a degenerate one only if all are.
  int restarts = 1;
  /// The means stay where they start: at the identity, or at the means of the start that is given.
  bool fixed_means = false;
  bool diagonal = false;  ///< diagonal covariances
  /// The units of the coordinates in which the two bounds below are stated; empty: 1 rad, 1 m.
  Eigen::VectorXd unit = {};
  /// Bounds on the square roots of a covariance's eigenvalues, in the units above.
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

/// The requirements of EM on a density D. A specialisation EmModel<D> has
///  - `Samples`, made from a span of elements, with size(): the samples in the layout that the
///    density reads;
///  - `Worker(const D&, const EmSettings&)`, one component in one iteration:
///    `log_density(samples, begin, count, out)` writes the log density of a block of samples into
///    an EmRow, `accumulate(shares)` then adds the sufficient statistics of that block with these
///    weights, `weight()` is the sum of all shares, and `update(step)` is the component that
///    maximises the expected log-likelihood; for 0 <= step < 1 the mean moves only by that fraction
///    of its step, and for step = 0 the expected log-likelihood must not fall;
///  - `start(elements, weights, settings, prior)`, a rough fit to start from, regularised by the
///    density `prior` unless that is null;
///  - `squared_distance(density, a, b)`, the squared distance of two elements in units of the
///    density's spread;
///  - `stretched(density, factors)`, the density with the spread of every coordinate multiplied;
///  - `parameters(dof, settings)`, the number of free parameters of one component;
///  - `on_lower_bound(density, settings)`, whether the component has collapsed;
///  - `prepared(density, settings)`, the density in the form that is fitted; only needed if D has
///    other forms too.
template <class D>
struct EmModel;

/// The mixture of `settings.components` components with the largest likelihood that EM finds.
///
/// Every iteration is a generalised EM step, in which all components are re-estimated. If the
/// log-likelihood would fall (the step of the means is a Gauss-Newton step), the means move by half
/// of their step, then by a quarter, then not at all. So `history` never falls by more than
/// rounding. The first start is by k-means++ in units of the samples' spread; further starts
/// alternate between k-means++ and concentric components. `weights` (empty: all one) count samples;
/// their sum is the number of samples in the BIC. With `start`, EM starts only there.
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
  std::size_t best;  ///< index of the smallest BIC among the fits that are not degenerate
};

/// Fits 1 to `settings.components` components, or as many as there are enough samples for.
/// @throws InvalidInput as fit_mixture
template <class D>
BicSelection<D> fit_mixture_by_bic(std::span<const typename D::Group> samples,
                                   std::span<const double> weights, const EmSettings& settings,
                                   RandomStream& stream);

/// The covariance of largest expected log-likelihood for a second moment under the bounds of the
/// settings: its eigenvalues are clipped in the units of the settings, or its diagonal entries.
Eigen::MatrixXd bounded_covariance(const Eigen::MatrixXd& second_moment,
                                   const EmSettings& settings);

}  // namespace posemix

#include "posemix/mixture/em_gaussian.hpp"   // IWYU pragma: export
#include "posemix/mixture/em_impl.hpp"       // IWYU pragma: export
#include "posemix/mixture/em_projected.hpp"  // IWYU pragma: export
