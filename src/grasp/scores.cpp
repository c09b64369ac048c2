// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/grasp/scores.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"

namespace posemix {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kLeastProbability = 1e-9;

void check(std::span<const ScoredPrediction> predictions) {
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    const double probability = predictions[i].probability;
    if (!kUnitInterval.contains(probability))
      kUnitInterval.check(probability, fmt::format("probability {}", i));
  }
}

template <class Loss>
double mean_of(std::span<const ScoredPrediction> predictions, Loss loss) {
  check(predictions);
  double sum = 0.0;
  for (const ScoredPrediction& p : predictions) sum += loss(p);
  return sum / static_cast<double>(predictions.size());
}

}  // namespace

double brier_score(std::span<const ScoredPrediction> predictions) {
  return mean_of(predictions, [](const ScoredPrediction& p) {
    const double miss = p.probability - (p.success ? 1.0 : 0.0);
    return miss * miss;
  });
}

double log_loss(std::span<const ScoredPrediction> predictions) {
  return mean_of(predictions, [](const ScoredPrediction& p) {
    return -std::log(std::max(kLeastProbability, p.success ? p.probability : 1.0 - p.probability));
  });
}

double accuracy(std::span<const ScoredPrediction> predictions) {
  return mean_of(predictions, [](const ScoredPrediction& p) {
    return (p.probability >= 0.5) == p.success ? 1.0 : 0.0;
  });
}

double auc_within_groups(std::span<const ScoredPrediction> predictions) {
  check(predictions);
  std::vector<ScoredPrediction> sorted(predictions.begin(), predictions.end());
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return std::tie(a.group, a.probability) < std::tie(b.group, b.probability);
  });
  double right = 0.0;
  double pairs = 0.0;
  double failures = 0.0;  // of the group so far
  for (std::size_t i = 0; i < sorted.size();) {
    if (i == 0 || sorted[i].group != sorted[i - 1].group) failures = 0.0;
    double tied[2] = {0.0, 0.0};  // failures and successes of one group and probability
    const ScoredPrediction& first = sorted[i];
    for (; i < sorted.size() && sorted[i].group == first.group &&
           sorted[i].probability == first.probability;
         ++i) {
      tied[sorted[i].success ? 1 : 0] += 1.0;
    }
    right += tied[1] * (failures + 0.5 * tied[0]);
    failures += tied[0];
  }
  for (std::size_t i = 0; i < sorted.size();) {
    double count[2] = {0.0, 0.0};
    const std::size_t group = sorted[i].group;
    for (; i < sorted.size() && sorted[i].group == group; ++i) {
      count[sorted[i].success ? 1 : 0] += 1.0;
    }
    pairs += count[0] * count[1];
  }
  return pairs > 0.0 ? right / pairs : kNaN;
}

std::vector<ReliabilityBin> reliability(std::span<const ScoredPrediction> predictions,
                                        std::size_t bins) {
  require(bins > 0, "a reliability diagram needs at least one bin");
  internal::check_count(bins, "bins");
  check(predictions);
  std::vector<ReliabilityBin> result(bins);
  for (const ScoredPrediction& p : predictions) {
    const auto place = static_cast<std::size_t>(p.probability * static_cast<double>(bins));
    ReliabilityBin& bin = result[std::min(place, bins - 1)];
    ++bin.count;
    bin.mean_probability += p.probability;
    bin.success_rate += p.success ? 1.0 : 0.0;
  }
  for (ReliabilityBin& bin : result) {
    bin.mean_probability /= static_cast<double>(bin.count);
    bin.success_rate /= static_cast<double>(bin.count);
  }
  return result;
}

double calibration_error(std::span<const ScoredPrediction> predictions, std::size_t bins) {
  double sum = 0.0;
  for (const ReliabilityBin& bin : reliability(predictions, bins)) {
    if (bin.count == 0) continue;
    sum += static_cast<double>(bin.count) * std::abs(bin.success_rate - bin.mean_probability);
  }
  return sum / static_cast<double>(predictions.size());
}

}  // namespace posemix
