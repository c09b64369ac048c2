// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/grasp/calibration.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "grasp/region_parameters.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr double kLeastRaw = 1e-3;

double clipped_logit(double p) { return logit(std::clamp(p, kLeastRaw, 1.0 - kLeastRaw)); }

/// Negative log posterior of (weights, bias), its gradient and Hessian.
struct Posterior {
  const Eigen::MatrixXd& design;  ///< features and a column of ones
  const std::vector<bool>& outcomes;
  Eigen::VectorXd mean;
  Eigen::VectorXd precision;

  double value(const Eigen::VectorXd& theta) const {
    const Eigen::VectorXd z = design * theta;
    double sum = 0.5 * ((theta - mean).array().square() * precision.array()).sum();
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      const double score = z[static_cast<Eigen::Index>(i)];
      sum -= log_logistic(outcomes[i] ? score : -score);
    }
    return sum;
  }

  Eigen::VectorXd newton_step(const Eigen::VectorXd& theta) const {
    const Eigen::VectorXd z = design * theta;
    Eigen::VectorXd residual(z.size());
    Eigen::VectorXd curvature(z.size());
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      const double p = logistic(z[i]);
      residual[i] = p - (outcomes[static_cast<std::size_t>(i)] ? 1.0 : 0.0);
      curvature[i] = p * (1.0 - p);
    }
    const Eigen::VectorXd gradient =
        design.transpose() * residual + precision.cwiseProduct(theta - mean);
    Eigen::MatrixXd hessian = design.transpose() * curvature.asDiagonal() * design;
    hessian.diagonal() += precision;
    return -hessian.llt().solve(gradient);
  }
};

}  // namespace

double LogisticModel::probability(const Eigen::VectorXd& features) const {
  if (features.size() != weights.size())
    throw InvalidInput(
        fmt::format("{} features for a model of {}", features.size(), weights.size()));
  return logistic(bias + weights.dot(features));
}

LogisticModel fit_logistic(const Eigen::MatrixXd& features, const std::vector<bool>& outcomes,
                           const LogisticSettings& settings) {
  const Eigen::Index n = features.cols();
  if (features.rows() != static_cast<Eigen::Index>(outcomes.size())) {
    throw InvalidInput(
        fmt::format("{} rows of features for {} outcomes", features.rows(), outcomes.size()));
  }
  kPositive.check(settings.weights_sd, "weights_sd");
  kPositive.check(settings.bias_sd, "bias_sd");
  kAnyNumber.check(settings.bias_mean, "bias_mean");
  if (!features.allFinite()) throw InvalidInput("a feature is not finite");
  const Eigen::VectorXd& weights_mean = settings.weights_mean;
  if ((weights_mean.size() != 0 && weights_mean.size() != n) || !weights_mean.allFinite())
    throw InvalidInput(
        fmt::format("weights_mean has {} entries, expected {} finite ones, or none for zeros",
                    weights_mean.size(), n));
  Eigen::MatrixXd design(features.rows(), n + 1);
  design << features, Eigen::VectorXd::Ones(features.rows());
  Posterior posterior{design, outcomes, Eigen::VectorXd::Zero(n + 1),
                      Eigen::VectorXd::Constant(n + 1, std::pow(settings.weights_sd, -2.0))};
  if (settings.weights_mean.size() > 0) posterior.mean.head(n) = settings.weights_mean;
  posterior.mean[n] = settings.bias_mean;
  posterior.precision[n] = std::pow(settings.bias_sd, -2.0);
  Eigen::VectorXd theta = posterior.mean;
  double value = posterior.value(theta);
  for (int iteration = 0; iteration < settings.max_iterations; ++iteration) {
    const Eigen::VectorXd step = posterior.newton_step(theta);
    double share = 1.0;
    double next = posterior.value(theta + step);
    while (next > value && share > 1e-10) {
      share *= 0.5;
      next = posterior.value(theta + share * step);
    }
    if (!(next < value)) break;
    theta += share * step;
    value = next;
    if (step.norm() < 1e-10 * (1.0 + theta.norm())) break;
  }
  return {theta.head(n), theta[n]};
}

double PlattCalibration::operator()(double probability) const {
  return logistic(slope * clipped_logit(probability) + bias);
}

PlattCalibration fit_platt(std::span<const ScoredPrediction> predictions) {
  Eigen::MatrixXd raw(static_cast<Eigen::Index>(predictions.size()), 1);
  std::vector<bool> outcomes;
  for (const ScoredPrediction& p : predictions) {
    raw(static_cast<Eigen::Index>(outcomes.size()), 0) = clipped_logit(p.probability);
    outcomes.push_back(p.success);
  }
  const LogisticModel model =
      fit_logistic(raw, outcomes, {.weights_mean = Eigen::VectorXd::Ones(1), .bias_sd = 1.0});
  return {model.weights[0], model.bias};
}

}  // namespace posemix
