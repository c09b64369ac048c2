// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "posemix/grasp/scores.hpp"

/// Logistic regression, and with it the calibration of probabilities.
namespace posemix {

/// P(success) = s(bias + weights^T x), s the logistic function.
struct LogisticModel {
  Eigen::VectorXd weights;
  double bias = 0.0;

  double probability(const Eigen::VectorXd& features) const;
};

/// Settings of fit_logistic: a normal prior on weights and bias about `mean`.
struct LogisticSettings {
  Eigen::VectorXd weights_mean = {};  ///< zero where empty
  double bias_mean = 0.0;
  double weights_sd = 1.0;
  double bias_sd = 3.0;
  int max_iterations = 50;
};

/// Most probable logistic model of outcomes, by Newton's method with halved steps; row i of
/// `features` belongs to outcome i. The problem is convex.
/// @throws InvalidInput when sizes differ
LogisticModel fit_logistic(const Eigen::MatrixXd& features, const std::vector<bool>& outcomes,
                           const LogisticSettings& settings = {});

/// Platt's calibration: logit of the calibrated probability = slope * logit of the raw one + bias.
/// Raw probabilities are taken to lie within [0.001, 0.999].
struct PlattCalibration {
  double slope = 1.0;
  double bias = 0.0;

  double operator()(double probability) const;
};

/// Most probable calibration, with normal priors of standard deviation 1 about slope 1 and bias 0:
/// the identity without predictions.
PlattCalibration fit_platt(std::span<const ScoredPrediction> predictions);

}  // namespace posemix
