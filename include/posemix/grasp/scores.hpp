// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

/// How good predicted probabilities of success are.
namespace posemix {

/// A predicted probability and what came of it.
struct ScoredPrediction {
  double probability;
  bool success;
  std::size_t group = 0;  ///< only predictions of one group are compared by the AUC
};

// All functions throw InvalidInput for a probability that is not in [0, 1].

/// Mean squared difference of probability and outcome.
double brier_score(std::span<const ScoredPrediction> predictions);

/// Mean of -log of the probability that the outcome was given, at least 1e-9 [nats].
double log_loss(std::span<const ScoredPrediction> predictions);

/// Share of predictions on the right side of one half (one half predicts success).
double accuracy(std::span<const ScoredPrediction> predictions);

/// Probability that, of a success and a failure of the same group, the success got the larger
/// probability (ties count half): all such pairs together. NaN where there are none.
double auc_within_groups(std::span<const ScoredPrediction> predictions);

/// Predictions in one bin of a reliability diagram.
struct ReliabilityBin {
  std::size_t count = 0;
  double mean_probability = 0.0;
  double success_rate = 0.0;
};

/// Bins of equal width over [0, 1]; means are NaN in empty ones. @throws InvalidInput without bins
std::vector<ReliabilityBin> reliability(std::span<const ScoredPrediction> predictions,
                                        std::size_t bins = 10);

/// Expected calibration error: mean over the predictions of their bin's distance of success rate
/// and mean probability.
double calibration_error(std::span<const ScoredPrediction> predictions, std::size_t bins = 10);

}  // namespace posemix
