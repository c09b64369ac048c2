// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/grasp/scores.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "posemix/base/error.hpp"
#include "posemix/base/random.hpp"
#include "posemix/grasp/calibration.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::thrown_message;

TEST(Scores, OfFewPredictionsByHand) {
  const std::vector<ScoredPrediction> p{
      {0.9, true}, {0.8, false}, {0.3, false}, {0.35, true}, {1.0, true}};
  EXPECT_NEAR(brier_score(p), (0.01 + 0.64 + 0.09 + 0.4225 + 0.0) / 5.0, 1e-15);
  EXPECT_NEAR(log_loss(p), -(std::log(0.9) + std::log(0.2) + std::log(0.7) + std::log(0.35)) / 5.0,
              1e-15);
  EXPECT_NEAR(accuracy(p), 3.0 / 5.0, 1e-15);
  // Bins of a quarter: {0.3, 0.35} with rate 0.5, {0.9, 0.8, 1.0} with rate 2/3.
  EXPECT_NEAR(calibration_error(p, 4), (2.0 * (0.5 - 0.325) + 3.0 * (0.9 - 2.0 / 3.0)) / 5.0,
              1e-15);
  const std::vector<ScoredPrediction> sure{{0.0, true}};
  EXPECT_NEAR(log_loss(sure), -std::log(1e-9), 1e-12);
  EXPECT_EQ(thrown_message([&] { reliability(p, 0); }),
            "a reliability diagram needs at least one bin");
}

TEST(Scores, AucAgainstAllPairs) {
  RandomStream stream(1);
  std::vector<ScoredPrediction> p;
  for (int i = 0; i < 300; ++i) {
    const double probability = std::round(20.0 * stream.uniform()) / 20.0;  // with ties
    p.push_back({probability, stream.uniform() < 0.3 + 0.5 * probability,
                 static_cast<std::size_t>(3.0 * stream.uniform())});
  }
  double right = 0.0;
  double pairs = 0.0;
  for (const ScoredPrediction& a : p) {
    for (const ScoredPrediction& b : p) {
      if (!a.success || b.success || a.group != b.group) continue;
      pairs += 1.0;
      right += a.probability > b.probability ? 1.0 : a.probability == b.probability ? 0.5 : 0.0;
    }
  }
  EXPECT_GT(pairs, 1000.0);
  EXPECT_NEAR(auc_within_groups(p), right / pairs, 1e-12);
  const std::vector<ScoredPrediction> apart{{0.9, true, 0}, {0.1, false, 1}};
  EXPECT_TRUE(std::isnan(auc_within_groups(apart)));
}

TEST(Logistic, GradientVanishesAtTheFit) {
  RandomStream stream(2);
  Eigen::MatrixXd x(200, 2);
  std::vector<bool> y;
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    x.row(i) << stream.normal(), 3.0 * stream.normal();
    y.push_back(stream.uniform() < 1.0 / (1.0 + std::exp(-(0.5 + x(i, 0) - 0.4 * x(i, 1)))));
  }
  const LogisticModel model = fit_logistic(x, y, {.weights_sd = 2.0, .bias_sd = 5.0});
  Eigen::Vector3d gradient(model.weights[0] / 4.0, model.weights[1] / 4.0, model.bias / 25.0);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const double miss =
        model.probability(x.row(i).transpose()) - (y[static_cast<std::size_t>(i)] ? 1.0 : 0.0);
    gradient += miss * Eigen::Vector3d(x(i, 0), x(i, 1), 1.0);
  }
  EXPECT_LT(gradient.norm(), 1e-8);
  EXPECT_NEAR(model.weights[0], 1.0, 0.5);
  EXPECT_EQ(thrown_message([&] { fit_logistic(x, {true}); }),
            "200 rows of features for 1 outcomes");
}

TEST(Logistic, FiniteWhereOutcomesAreSeparable) {
  const Eigen::MatrixXd x = Eigen::Vector4d(-2.0, -1.0, 1.0, 2.0);
  const LogisticModel model = fit_logistic(x, {false, false, true, true});
  EXPECT_TRUE(std::isfinite(model.weights[0]));
  EXPECT_GT(model.weights[0], 0.5);
}

TEST(Platt, RecoversADistortion) {
  RandomStream stream(3);
  std::vector<ScoredPrediction> p;
  for (int i = 0; i < 20000; ++i) {
    const double score = 2.0 * stream.normal();
    const double truth = 1.0 / (1.0 + std::exp(-(0.6 * score - 0.5)));
    p.push_back({1.0 / (1.0 + std::exp(-score)), stream.uniform() < truth});
  }
  const PlattCalibration platt = fit_platt(p);
  EXPECT_NEAR(platt.slope, 0.6, 0.03);
  EXPECT_NEAR(platt.bias, -0.5, 0.05);
  for (ScoredPrediction& q : p) q.probability = platt(q.probability);
  EXPECT_LT(calibration_error(p), 0.015);
  EXPECT_NEAR(fit_platt({}).slope, 1.0, 1e-12);
  EXPECT_NEAR(fit_platt({}).bias, 0.0, 1e-12);
}

TEST(Scores, RefuseWhatIsNoProbability) {
  for (const double wrong : {-1e-3, 1.001, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    const std::vector<ScoredPrediction> predictions{{0.5, true, 0}, {wrong, false, 0}};
    EXPECT_THROW(brier_score(predictions), InvalidInput);
    EXPECT_THROW(log_loss(predictions), InvalidInput);
    EXPECT_THROW(accuracy(predictions), InvalidInput);
    EXPECT_THROW(auc_within_groups(predictions), InvalidInput);
    EXPECT_THROW(reliability(predictions), InvalidInput);
    EXPECT_THROW(calibration_error(predictions), InvalidInput);
  }
}

}  // namespace
}  // namespace posemix
