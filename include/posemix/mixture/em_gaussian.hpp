// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/lie/mean.hpp"
#include "posemix/mixture/density_kernel.hpp"
#include "posemix/mixture/em.hpp"
#include "posemix/mixture/em_samples.hpp"

namespace posemix {

namespace internal {

/// The weighted moments of all samples for one component; r is the weight of a sample.
template <LieGroup G>
struct EmGaussianMoments {
  double weight = 0.0;
  typename G::Tangent first;         ///< sum r xi
  typename G::TangentMatrix second;  ///< sum r xi xi^T
  /// Gradient of the expected log-likelihood with respect to the mean.
  typename G::Tangent gradient;

  explicit EmGaussianMoments(Eigen::Index dof)
      : first(G::Tangent::Zero(dof)),
        second(G::TangentMatrix::Zero(dof, dof)),
        gradient(G::Tangent::Zero(dof)) {}

  ConcentratedGaussian<G> update(const ConcentratedGaussian<G>& density, const EmSettings& settings,
                                 double step) const {
    using Tangent = typename G::Tangent;
    using Covariance = typename G::TangentMatrix;
    const Tangent move = settings.fixed_means
                             ? Tangent(Tangent::Zero(first.size()))
                             : Tangent(step * (density.covariance() * gradient) / weight);
    const Tangent mean_xi = first / weight;
    Covariance about = second / weight - mean_xi * move.transpose() - move * mean_xi.transpose() +
                       move * move.transpose();
    symmetrize(about);
    const G mean = settings.fixed_means ? density.mean() : G::exp(move) * density.mean();
    return ConcentratedGaussian<G>::trusted(mean, Covariance(bounded_covariance(about, settings)));
  }
};

/// One component in one iteration, on any group.
template <LieGroup G>
class EmAnyGroupWorker {
 public:
  using Density = ConcentratedGaussian<G>;
  using Tangent = typename G::Tangent;
  using Covariance = typename G::TangentMatrix;
  using Samples = EmSamples<G>;

  EmAnyGroupWorker(const Density& density, const EmSettings& settings)
      : density_(density),
        settings_(&settings),
        inverse_mean_(density.mean().inverse()),
        moments_(density.dof()) {
    const Eigen::LLT<Covariance> factor(density.covariance());
    const Eigen::Index n = density.dof();
    inverse_factor_ = factor.matrixL().solve(Covariance::Identity(n, n));
    log_constant_ = -0.5 * (log_det(factor) + static_cast<double>(n) * kLogTwoPi);
  }

  void log_density(const Samples& samples, std::size_t begin, std::size_t count, EmRow& out) {
    samples.log(begin, count, inverse_mean_, block_);
    const auto& xi = block_.xi();
    const Eigen::Index n = xi.rows();
    white_.resize(n, xi.cols());
    for (Eigen::Index i = 0; i < n; ++i) {
      white_.row(i) = inverse_factor_(i, 0) * xi.row(0);
      for (Eigen::Index j = 1; j <= i; ++j) white_.row(i) += inverse_factor_(i, j) * xi.row(j);
    }
    Eigen::Map<Eigen::ArrayXd> log(out.data(), xi.cols());
    log = log_constant_ - block_.log_volume;
    for (Eigen::Index i = 0; i < n; ++i) log -= 0.5 * white_.row(i).array().square().transpose();
  }

  void accumulate(const EmRow& row) {
    const auto& xi = block_.xi();
    const Eigen::Index n = xi.rows();
    const Eigen::Map<const Eigen::ArrayXd> shares(row.data(), xi.cols());
    moments_.weight += shares.sum();
    shared_.resize(xi.cols());
    for (Eigen::Index i = 0; i < n; ++i) {
      shared_ = xi.row(i).array() * shares.transpose();
      moments_.first[i] += shared_.sum();
      for (Eigen::Index j = 0; j <= i; ++j) {
        moments_.second(i, j) += shared_.matrix().dot(xi.row(j));
        moments_.second(j, i) = moments_.second(i, j);
      }
    }
    if (settings_->fixed_means) return;
    for (Eigen::Index i = 0; i < n; ++i) {  // P^-1 xi, in place: row i needs rows i, i + 1, ...
      white_.row(i) *= inverse_factor_(i, i);
      for (Eigen::Index j = i + 1; j < n; ++j)
        white_.row(i) += inverse_factor_(j, i) * white_.row(j);
    }
    Samples::add_gradient(block_, white_, row, moments_.gradient);
  }

  double weight() const { return moments_.weight; }
  Density update(double step) const { return moments_.update(density_, *settings_, step); }

  /// The moments accumulated so far.
  const EmGaussianMoments<G>& moments() const { return moments_; }

 private:
  Density density_;
  const EmSettings* settings_;
  G inverse_mean_;
  Covariance inverse_factor_;  ///< inverse of the Cholesky factor
  double log_constant_ = 0.0;
  typename Samples::Block block_;
  TangentRows<G> white_;
  Eigen::Array<double, 1, Eigen::Dynamic> shared_;
  EmGaussianMoments<G> moments_;
};

/// The worker that EM uses. Poses and vectors have specialisations with vector instructions.
template <LieGroup G>
class EmGaussianWorker : public EmAnyGroupWorker<G> {
 public:
  using EmAnyGroupWorker<G>::EmAnyGroupWorker;
};

/// One component in one iteration, for poses, with vector instructions.
template <>
class EmGaussianWorker<SE3d> {
 public:
  using Density = ConcentratedGaussian<SE3d>;
  using Samples = EmCoordinates;

  EmGaussianWorker(const Density& density, const EmSettings& settings);

  void log_density(const Samples& samples, std::size_t begin, std::size_t count, EmRow& out);
  void accumulate(const EmRow& shares);
  double weight() const { return sums_.total(0); }
  Density update(double step) const;

  /// The moments accumulated so far.
  EmGaussianMoments<SE3d> moments() const;
  /// The tangent vectors of the block, in rows.
  const std::vector<EmRow>& rows() const { return rows_; }

 private:
  Vector6d gradient(const EmGaussianMoments<SE3d>& moments) const;

  Density density_;
  const EmSettings* settings_;
  PoseKernel kernel_;
  std::vector<EmRow> rows_;
  std::size_t count_ = 0;
  EmSums<28> sums_;
  EmSums<kPoseGradientSums> gradient_;
};

}  // namespace internal

/// Concentrated Gaussians under EM. With xi = Log(X X0^-1), weights r and their sum W, the expected
/// log-likelihood of a component is
///   sum r (-log |det J_l(xi)| - (xi^T P^-1 xi + log det P) / 2) + const.
/// For a given X0 its maximum is at P = sum r xi xi^T / W. Moving the mean to Exp(d) X0 changes it
/// by d^T g,
///   g = sum r J_r(xi)^-T (P^-1 xi + grad log |det J_l(xi)|),
/// and by -W d^T P^-1 d / 2 in second order (Gauss-Newton, J_r = I), so d = P g / W. The second
/// moment about the new mean is approximated by that of xi - d. All of this is exact on R^n.
template <LieGroup G>
struct EmModel<ConcentratedGaussian<G>> {
  using Density = ConcentratedGaussian<G>;
  using Tangent = typename G::Tangent;
  using Covariance = typename G::TangentMatrix;
  using Worker = internal::EmGaussianWorker<G>;
  using Samples = typename Worker::Samples;

  static Density start(std::span<const G> elements, std::span<const double> weights,
                       const EmSettings& settings, const Density* prior) {
    const Eigen::Index n = elements.front().dof();
    const G mean = settings.fixed_means
                       ? elements.front().identity()
                       : weighted_mean<G>(elements, weights, {.max_iterations = 20}).mean;
    const G inverse = mean.inverse();
    Covariance moment = Covariance::Zero(n, n);
    double total = 0.0;
    double largest = 0.0;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const Tangent xi = (elements[i] * inverse).log();
      moment += weights[i] * xi * xi.transpose();
      total += weights[i];
      largest = std::max(largest, weights[i]);
    }
    // The prior counts as enough samples to span the tangent space.
    if (prior != nullptr) {
      const double count = static_cast<double>(n) * largest;
      moment += count * prior->covariance();
      total += count;
    }
    moment /= total;
    symmetrize(moment);
    return Density::trusted(mean, Covariance(bounded_covariance(moment, settings)));
  }

  static double squared_distance(const Density& density, const G& a, const G& b) {
    const Tangent xi = (a * b.inverse()).log();
    return (xi.array().square() / density.covariance().diagonal().array()).sum();
  }

  static Density stretched(const Density& density, const Eigen::VectorXd& factors) {
    return Density::trusted(density.mean(), Covariance(factors.asDiagonal() * density.covariance() *
                                                       factors.asDiagonal()));
  }

  static std::size_t parameters(Eigen::Index dof, const EmSettings& settings) {
    const auto n = static_cast<std::size_t>(dof);
    return (settings.fixed_means ? 0 : n) + (settings.diagonal ? n : n * (n + 1) / 2);
  }

  /// A component of the given start, within the bounds of the settings.
  static Density prepared(const Density& density, const EmSettings& settings) {
    return Density::trusted(density.mean(),
                            Covariance(bounded_covariance(density.covariance(), settings)));
  }

  static bool on_lower_bound(const Density& density, const EmSettings& settings) {
    const Eigen::Index n = density.dof();
    const Eigen::VectorXd unit =
        settings.unit.size() == 0 ? Eigen::VectorXd::Ones(n) : settings.unit;
    const Eigen::VectorXd variance =
        density.covariance().diagonal().array() / unit.array().square();
    return variance.maxCoeff() <= 1.001 * settings.min_sd * settings.min_sd;
  }
};

extern template EmResult<ConcentratedGaussian<SO3d>> fit_mixture(
    std::span<const SO3d>, std::span<const double>, const EmSettings&, RandomStream&,
    const std::optional<Mixture<ConcentratedGaussian<SO3d>>>&);
extern template EmResult<ConcentratedGaussian<SE3d>> fit_mixture(
    std::span<const SE3d>, std::span<const double>, const EmSettings&, RandomStream&,
    const std::optional<Mixture<ConcentratedGaussian<SE3d>>>&);

}  // namespace posemix

#include "posemix/mixture/em_rn.hpp"  // IWYU pragma: export
