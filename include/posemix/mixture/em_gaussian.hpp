// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/lie/mean.hpp"
#include "posemix/mixture/em.hpp"
#include "posemix/mixture/em_samples.hpp"

namespace posemix {

/// Concentrated Gaussians under EM. With xi = Log(X X0^-1), weights r and their sum W, the expected
/// log-likelihood of a component is
///   sum r (-log |det J_l(xi)| - (xi^T P^-1 xi + log det P) / 2) + const.
/// Given X0 its maximum is P = sum r xi xi^T / W. Moving the mean to Exp(d) X0 changes it by d^T g,
///   g = sum r J_r(xi)^-T (P^-1 xi + grad log |det J_l(xi)|),
/// and by -W d^T P^-1 d / 2 in second order (Gauss-Newton, J_r = I), so d = P g / W; the second
/// moment about the new mean is taken as that of xi - d. All are exact on R^n.
template <LieGroup G>
struct EmModel<ConcentratedGaussian<G>> {
  using Density = ConcentratedGaussian<G>;
  using Tangent = typename G::Tangent;
  using Covariance = typename G::TangentMatrix;
  using Samples = EmSamples<G>;
  using Rows = TangentRows<G>;

  class Worker {
   public:
    Worker(const Density& density, const EmSettings& settings)
        : density_(density),
          settings_(&settings),
          inverse_mean_(density.mean().inverse()),
          first_(Tangent::Zero(density.dof())),
          second_(Covariance::Zero(density.dof(), density.dof())),
          gradient_(Tangent::Zero(density.dof())) {
      const Eigen::LLT<Covariance> factor(density.covariance());
      const Eigen::Index n = density.dof();
      inverse_factor_ = factor.matrixL().solve(Covariance::Identity(n, n));
      log_constant_ = -0.5 * (log_det(factor) + static_cast<double>(n) * kLogTwoPi);
    }

    void log_density(const Samples& samples, std::size_t begin, std::size_t count,
                     Eigen::Ref<Eigen::ArrayXd> out) {
      samples.log(begin, count, inverse_mean_, block_);
      const auto& xi = block_.xi();
      const Eigen::Index n = xi.rows();
      white_.resize(n, xi.cols());
      for (Eigen::Index i = 0; i < n; ++i) {
        white_.row(i) = inverse_factor_(i, 0) * xi.row(0);
        for (Eigen::Index j = 1; j <= i; ++j) white_.row(i) += inverse_factor_(i, j) * xi.row(j);
      }
      out = log_constant_ - block_.log_volume;
      for (Eigen::Index i = 0; i < n; ++i) out -= 0.5 * white_.row(i).array().square().transpose();
    }

    void accumulate(const Eigen::ArrayXd& shares) {
      const auto& xi = block_.xi();
      const Eigen::Index n = xi.rows();
      weight_ += shares.sum();
      shared_.resize(xi.cols());
      for (Eigen::Index i = 0; i < n; ++i) {
        shared_ = xi.row(i).array() * shares.transpose();
        first_[i] += shared_.sum();
        for (Eigen::Index j = 0; j <= i; ++j) {
          second_(i, j) += shared_.matrix().dot(xi.row(j));
        }
      }
      if (settings_->fixed_means) return;
      for (Eigen::Index i = 0; i < n; ++i) {  // P^-1 xi, in place: row i needs rows i, i + 1, ...
        white_.row(i) *= inverse_factor_(i, i);
        for (Eigen::Index j = i + 1; j < n; ++j)
          white_.row(i) += inverse_factor_(j, i) * white_.row(j);
      }
      Samples::add_gradient(block_, white_, shares, gradient_);
    }

    double weight() const { return weight_; }

    Density update(double step) const {
      const Covariance moment = second_.template selfadjointView<Eigen::Lower>();
      const Tangent first = first_ / weight_;
      const Tangent move = settings_->fixed_means
                               ? Tangent(Tangent::Zero(first.size()))
                               : Tangent(step * (density_.covariance() * gradient_) / weight_);
      Covariance about = moment / weight_ - first * move.transpose() - move * first.transpose() +
                         move * move.transpose();
      symmetrize(about);
      const G mean = settings_->fixed_means ? density_.mean() : G::exp(move) * density_.mean();
      return Density::trusted(mean, Covariance(bounded_covariance(about, *settings_)));
    }

   private:
    Density density_;
    const EmSettings* settings_;
    G inverse_mean_;
    Covariance inverse_factor_;  ///< inverse of the Cholesky factor
    double log_constant_ = 0.0;
    typename Samples::Block block_;
    Rows white_;
    Eigen::Array<double, 1, Eigen::Dynamic> shared_;
    double weight_ = 0.0;
    Tangent first_;
    Covariance second_;  ///< lower triangle
    Tangent gradient_;
  };

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
    if (prior != nullptr) {  // counts as many samples as it takes to span the tangent space
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

  static bool on_lower_bound(const Density& density, const EmSettings& settings) {
    const Eigen::Index n = density.dof();
    const Eigen::VectorXd unit =
        settings.unit.size() == 0 ? Eigen::VectorXd::Ones(n) : settings.unit;
    const Eigen::VectorXd variance =
        density.covariance().diagonal().array() / unit.array().square();
    return variance.maxCoeff() <= 1.001 * settings.min_sd * settings.min_sd;
  }
};

}  // namespace posemix
