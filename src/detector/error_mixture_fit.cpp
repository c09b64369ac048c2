// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "posemix/base/draw_index.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"
#include "posemix/detector/error_mixture.hpp"

namespace posemix {
namespace {

using Gaussian = ErrorMixture::Gaussian;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6>;

constexpr std::size_t kLeastErrors = 8;
constexpr double kFirstOutlierWeight = 0.05;
constexpr double kFarthest = 200.0;  ///< squared distance of a start in trimmed sds, at most
constexpr Eigen::Index kParametersPerComponent = 6 + 21 + 1;

void require_errors(std::size_t count) {
  if (count >= kLeastErrors) return;
  throw InvalidInput(
      fmt::format("{} errors of an estimator, expected at least {}", count, kLeastErrors));
}

Rows rows_of(std::span<const Vector6d> errors) {
  Rows rows(static_cast<Eigen::Index>(errors.size()), 6);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = errors[i].transpose();
  }
  return rows;
}

Matrix6d covariance_of(const Rows& rows) {
  const Rows centred = rows.rowwise() - rows.colwise().mean();
  return centred.transpose() * centred / static_cast<double>(rows.rows());
}

/// One run of EM with a given number of components.
class Run {
 public:
  Run(const Rows& rows, const Matrix6d& prior, const ErrorMixtureSettings& settings)
      : rows_(rows), prior_(prior), settings_(settings) {
    outlier_.head<3>().setConstant(std::pow(radians(settings.outlier_rotation_sd_deg), 2));
    outlier_.tail<3>().setConstant(std::pow(settings.outlier_translation_sd_m, 2));
  }

  /// k-means++ in trimmed standard deviations, the distances capped so that outliers are not
  /// sought.
  void start(std::size_t components, RandomStream& stream) {
    const Vector6d inverse_sd =
        (prior_.diagonal() / settings_.prior_scale).cwiseSqrt().cwiseInverse();
    const Rows scaled = rows_ * inverse_sd.asDiagonal();
    const auto rows = static_cast<std::size_t>(rows_.rows());
    Eigen::VectorXd nearest = Eigen::VectorXd::Constant(rows_.rows(), kFarthest);
    const double share = (1.0 - kFirstOutlierWeight) / static_cast<double>(components);
    for (std::size_t k = 0; k < components; ++k) {
      const auto chosen = static_cast<Eigen::Index>(
          draw_index(std::span(nearest.data(), rows), nearest.sum(), stream));
      nearest = nearest.cwiseMin((scaled.rowwise() - scaled.row(chosen)).rowwise().squaredNorm());
      means_.emplace_back(rows_.row(chosen).transpose());
      covariances_.emplace_back(prior_ / settings_.prior_scale);
      weights_.push_back(share);
    }
    weights_.push_back(kFirstOutlierWeight);
  }

  void iterate() {
    double before = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < settings_.max_iterations; ++i) {
      const double now = expect();
      history_.push_back(now);
      if (now - before < settings_.tolerance * static_cast<double>(rows_.rows())) break;
      before = now;
      maximise();
    }
  }

  double log_likelihood() const { return log_likelihood_; }
  const std::vector<double>& history() const { return history_; }

  double bic() const {
    const auto components = static_cast<double>(means_.size());
    return components * kParametersPerComponent * std::log(static_cast<double>(rows_.rows())) -
           2.0 * log_likelihood_;
  }

  ErrorMixture mixture() const {
    std::vector<Gaussian> densities;
    densities.reserve(means_.size());
    for (std::size_t k = 0; k < means_.size(); ++k) {
      densities.push_back(Gaussian::trusted(Rnd<6>(means_[k]), covariances_[k]));
    }
    densities.push_back(Gaussian::trusted(Rnd<6>(Vector6d::Zero()), outlier_.asDiagonal()));
    return ErrorMixture(Mixture<Gaussian>::from_weights(weights_, std::move(densities)));
  }

 private:
  /// Fills a component's column with its log weighted densities; returns log det P + tr(P^-1 P0)
  /// of its covariance P.
  double fill(std::size_t k, const Vector6d& mean, const Matrix6d& covariance) {
    const Eigen::LLT<Matrix6d> factor(covariance);
    const Matrix6d whitening = factor.matrixL().solve(Matrix6d::Identity());
    const Rows white = (rows_.rowwise() - mean.transpose()) * whitening.transpose();
    const double log_factor = std::log(weights_[k]) - 0.5 * log_det(factor) - 3.0 * kLogTwoPi;
    shares_.col(static_cast<Eigen::Index>(k)) =
        log_factor - 0.5 * white.rowwise().squaredNorm().array();
    return log_det(factor) + factor.solve(prior_).trace();
  }

  /// Responsibilities; returns the log posterior (up to a constant).
  double expect() {
    const std::size_t components = means_.size();
    shares_.resize(rows_.rows(), static_cast<Eigen::Index>(components + 1));
    double penalty = 0.0;
    for (std::size_t k = 0; k < components; ++k) {
      penalty += fill(k, means_[k], covariances_[k]);
    }
    fill(components, Vector6d::Zero(), outlier_.asDiagonal());
    const Eigen::ArrayXd largest = shares_.rowwise().maxCoeff();
    shares_ = (shares_.colwise() - largest).exp();
    const Eigen::ArrayXd total = shares_.rowwise().sum();
    shares_.colwise() /= total;
    log_likelihood_ = (largest + total.log()).sum();
    return log_likelihood_ - 0.5 * settings_.prior_count * penalty;
  }

  void maximise() {
    const auto count = static_cast<double>(rows_.rows());
    for (std::size_t k = 0; k < means_.size(); ++k) {
      const Eigen::VectorXd share = shares_.col(static_cast<Eigen::Index>(k)).matrix();
      const double weight = share.sum();
      weights_[k] = std::max(weight / count, 1e-12);
      if (weight < 1e-9) continue;
      means_[k] = rows_.transpose() * share / weight;
      const Rows centred = rows_.rowwise() - means_[k].transpose();
      const Matrix6d moment = centred.transpose() * share.asDiagonal() * centred;
      covariances_[k] =
          (moment + settings_.prior_count * prior_) / (weight + settings_.prior_count);
      symmetrize(covariances_[k]);
    }
    weights_.back() = std::max(shares_.rightCols<1>().sum() / count, 1e-12);
  }

  const Rows& rows_;
  Matrix6d prior_;
  const ErrorMixtureSettings& settings_;
  Vector6d outlier_;
  std::vector<Vector6d> means_;
  std::vector<Matrix6d> covariances_;
  std::vector<double> weights_;  ///< the outliers' last
  Eigen::ArrayXXd shares_;
  double log_likelihood_ = 0.0;
  std::vector<double> history_;
};

}  // namespace

std::vector<Vector6d> trimmed_errors(std::span<const Vector6d> errors, double trim) {
  kPositive.check(trim, "trim");
  if (errors.size() < kLeastErrors) return {errors.begin(), errors.end()};
  Vector6d centre;
  Vector6d reach;
  for (Eigen::Index k = 0; k < 6; ++k) {
    std::vector<double> values;
    for (const Vector6d& error : errors) values.push_back(error[k]);
    centre[k] = upper_median(values);
    for (double& value : values) value = std::abs(value - centre[k]);
    reach[k] = trim * 1.4826 * upper_median(std::move(values));
  }
  std::vector<Vector6d> kept;
  std::copy_if(errors.begin(), errors.end(), std::back_inserter(kept), [&](const Vector6d& error) {
    return ((error - centre).array().abs() <= reach.array()).all();
  });
  if (kept.size() < kLeastErrors) kept.assign(errors.begin(), errors.end());
  return kept;
}

ErrorMixture fit_error_gaussian(std::span<const Vector6d> errors) {
  require_errors(errors.size());
  const Rows rows = rows_of(errors);
  const Matrix6d covariance = covariance_of(rows) + 1e-12 * Matrix6d::Identity();
  std::vector<Component<Gaussian>> components;
  components.push_back(
      {0.0, Gaussian::trusted(Rnd<6>(Vector6d(rows.colwise().mean().transpose())), covariance)});
  return ErrorMixture(Mixture<Gaussian>(std::move(components)));
}

ErrorMixtureFit fit_error_mixture(std::span<const Vector6d> errors,
                                  const ErrorMixtureSettings& settings, RandomStream& stream) {
  require_errors(errors.size());
  require(settings.max_components > 0, "an error mixture needs at least one full component");
  require(settings.restarts > 0, "a fit of an error mixture needs at least one start");
  kNotNegative.check(settings.tolerance, "tolerance");
  const Rows rows = rows_of(errors);
  const Vector6d spread =
      covariance_of(rows_of(trimmed_errors(errors, settings.trim))).diagonal().array() + 1e-12;
  const Matrix6d prior = (settings.prior_scale * spread).asDiagonal();
  std::optional<Run> best;
  std::size_t chosen = 0;
  for (std::size_t k = 1; k <= settings.max_components && k <= chosen + 2; ++k) {
    for (int restart = 0; restart < settings.restarts; ++restart) {
      Run run(rows, prior, settings);
      run.start(k, stream);
      run.iterate();
      if (best && !(run.bic() < best->bic())) continue;
      best.emplace(std::move(run));
      chosen = k;
    }
  }
  return {best->mixture(), chosen, best->log_likelihood(), best->bic(), best->history()};
}

}  // namespace posemix
