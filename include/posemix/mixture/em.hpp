// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "posemix/base/random.hpp"
#include "posemix/base/words.hpp"
#include "posemix/mixture/em_rows.hpp"
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

/// The words of EmStatus in reports.
template <>
inline constexpr WordTable<EmStatus, 3> words<EmStatus>{{
    {"converged", EmStatus::converged},
    {"max_iterations", EmStatus::max_iterations},
    {"degenerate", EmStatus::degenerate},
}};

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

/// The requirements of EM on a density D, whose specialisation EmModel<D> meets EmDensity. If D has
/// other forms than the one that is fitted, it also has `prepared(density, settings)`, the density
/// in that form.
template <class D>
struct EmModel;

/// A kind of density that EM fits, by the members of EmModel<D>:
///  - `Samples`, made from a span of elements: the samples in the layout that the density reads;
///  - `Worker`, one component in one iteration: `log_density` writes the log density of a block of
///    samples into a row, `accumulate` then adds the sufficient statistics of that block with the
///    shares in a row, `weight` is the sum of all shares, and `update(step)` the component that
///    maximises the expected log-likelihood; for 0 <= step < 1 the mean goes only that part of the
///    way, and for step = 0 the expected log-likelihood must not fall;
///  - `start`, a crude fit for a start, drawn to the density `prior` where it points to one;
///  - `squared_distance` of two elements in units of the density's spread;
///  - `stretched`: the density with the spread of every coordinate multiplied by its factor;
///  - `parameters`, the free parameters of one component;
///  - `on_lower_bound`, whether the component has collapsed.
template <class D>
concept EmDensity =
    std::constructible_from<typename EmModel<D>::Samples, std::span<const typename D::Group>> &&
    std::constructible_from < typename EmModel<D>::Worker,
const D&,
    const EmSettings& >
        &&requires(const D& density, const D* prior, const EmSettings& settings,
                   std::span<const typename D::Group> elements, std::span<const double> weights,
                   const typename EmModel<D>::Samples& samples, typename EmModel<D>::Worker& worker,
                   std::size_t index, EmRow& row, double step, const Eigen::VectorXd& factors) {
  { samples.size() } -> std::same_as<std::size_t>;
  worker.log_density(samples, index, index, row);
  worker.accumulate(std::as_const(row));
  { std::as_const(worker).weight() } -> std::same_as<double>;
  { std::as_const(worker).update(step) } -> std::same_as<D>;
  { EmModel<D>::start(elements, weights, settings, prior) } -> std::same_as<D>;
  { EmModel<D>::squared_distance(density, elements[0], elements[1]) } -> std::same_as<double>;
  { EmModel<D>::stretched(density, factors) } -> std::same_as<D>;
  { EmModel<D>::parameters(density.dof(), settings) } -> std::same_as<std::size_t>;
  { EmModel<D>::on_lower_bound(density, settings) } -> std::same_as<bool>;
};

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
template <EmDensity D>
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
template <EmDensity D>
BicSelection<D> fit_mixture_by_bic(std::span<const typename D::Group> samples,
                                   std::span<const double> weights, const EmSettings& settings,
                                   RandomStream& stream);

/// The covariance of largest expected log-likelihood for a second moment under the bounds of the
/// settings: its eigenvalues are clipped in the units of the settings, or its diagonal entries.
/// @throws InvalidInput when a setting is out of range, or the matrix is not square
Eigen::MatrixXd bounded_covariance(const Eigen::MatrixXd& second_moment,
                                   const EmSettings& settings);

}  // namespace posemix

#include "posemix/mixture/em_gaussian.hpp"   // IWYU pragma: export
#include "posemix/mixture/em_impl.hpp"       // IWYU pragma: export
#include "posemix/mixture/em_projected.hpp"  // IWYU pragma: export
