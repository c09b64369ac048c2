// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/truth_match.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include "error_series.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::thrown_message;
using testing::white_series;

std::vector<StampedEstimate> estimates_of(const std::vector<EstimateWithTruth>& series) {
  std::vector<StampedEstimate> estimates;
  for (const auto& pair : series) estimates.push_back({pair.stamp_s, pair.estimate});
  return estimates;
}

std::vector<StampedTruth> truth_of(const std::vector<EstimateWithTruth>& series, double late = 0) {
  std::vector<StampedTruth> truth;
  for (const auto& pair : series) truth.push_back({pair.stamp_s + late, pair.truth});
  return truth;
}

TEST(TruthMatch, PairsAreThoseNearestToOneAnother) {
  const auto series = white_series(20, 1.0, 14);
  auto truth = truth_of(series, 0.004);
  truth.erase(truth.begin() + 7);
  const auto pairs = match_to_truth(estimates_of(series), truth);
  ASSERT_EQ(pairs.size(), 19U);
  EXPECT_EQ(pairs[7].stamp_s, series[8].stamp_s);
  EXPECT_EQ(pairs[7].truth.translation(), series[8].truth.translation());
  // A wider window does not give two estimates the same truth.
  EXPECT_EQ(match_to_truth(estimates_of(series), truth, {.max_difference_s = 0.2}).size(), 19U);
}

/// Estimates and true poses at these times; a true pose's x is its index.
std::vector<int> matched(const std::vector<double>& estimate_stamps,
                         const std::vector<double>& truth_stamps, double max_difference_s) {
  std::vector<StampedEstimate> estimates;
  std::vector<StampedTruth> truth;
  for (const double stamp : estimate_stamps)
    estimates.push_back({stamp, PoseDensity(SE3d(), Matrix6d::Identity())});
  for (const double stamp : truth_stamps) {
    const auto index = static_cast<double>(truth.size());
    truth.push_back({stamp, SE3d(SO3d(), Eigen::Vector3d(index, 0, 0))});
  }
  std::vector<int> indices;
  for (const auto& pair : match_to_truth(estimates, truth, {.max_difference_s = max_difference_s}))
    indices.push_back(static_cast<int>(std::lround(pair.truth.translation().x())));
  return indices;
}

TEST(TruthMatch, EqualDistancesLoseNoPair) {
  using Indices = std::vector<int>;
  // Every estimate is in the middle of two true poses, every true pose in that of two estimates.
  EXPECT_EQ(matched({0, 2, 4}, {1, 3, 5}, 1.0), (Indices{0, 1, 2}));
  EXPECT_EQ(matched({1, 3, 5}, {0, 2, 4}, 1.0), (Indices{0, 1, 2}));
  EXPECT_EQ(matched({1, 3, 5}, {0, 2, 4, 6}, 1.0), (Indices{0, 1, 2}));
  // Two estimates at the same distance of one true pose: one of them is left alone.
  EXPECT_EQ(matched({0, 2, 7, 10}, {1, 7, 10}, 1.0), (Indices{0, 1, 2}));
  // Stamps of today in steps that are no binary fractions.
  std::vector<double> estimates;
  std::vector<double> truth;
  for (int k = 0; k < 50; ++k) {
    estimates.push_back(1.7e9 + 0.1 * k);
    truth.push_back(1.7e9 + 0.05 + 0.1 * k);
  }
  Indices all(50);
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(matched(estimates, truth, 0.06), all);
  // What is nearer goes before what would make more pairs.
  EXPECT_EQ(matched({0.0, 1.0, 5.0}, {0.9, 2.0, 5.0}, 1.1), (Indices{0, 2}));
}

TEST(TruthMatch, NoDifferenceIsTheSameStamp) {
  EXPECT_EQ(matched({0, 1, 2, 3}, {0, 1.5, 2, 3}, 0.0), (std::vector<int>{0, 2, 3}));
  for (const double wrong : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(thrown_message([&] {
                matched({0, 1}, {0, 1}, wrong);
              }).find("expected a number that is not negative"),
              std::string::npos);
  }
}

TEST(TruthMatch, WithoutCommonTimesTheRangesAreNamed) {
  const auto series = white_series(5, 1.0, 15);
  const std::string message =
      thrown_message([&] { return match_to_truth(estimates_of(series), truth_of(series, 100.0)); });
  EXPECT_NE(message.find("0 pairs"), std::string::npos) << message;
  EXPECT_NE(message.find("from 100 to 100.4 s"), std::string::npos) << message;
}

TEST(TruthMatch, AlignmentUndoesAMotionOfTheWorld) {
  const auto series = white_series(200, 1.0, 16);
  const SE3d motion(SO3d::exp(Eigen::Vector3d(0.3, -0.2, 1.0)), Eigen::Vector3d(5, -3, 2));
  auto moved = estimates_of(series);
  for (StampedEstimate& frame : moved) {
    frame.estimate = PoseDensity(motion * frame.estimate.mean(),
                                 motion.adjoint_congruence(frame.estimate.covariance()));
  }
  const auto truth = truth_of(series);
  const auto aligned = match_to_truth(moved, truth, {.alignment = Alignment::se3});
  const double anees = consistency_of(aligned).pose.anees;
  EXPECT_NEAR(anees, consistency_of(series).pose.anees, 0.1);
  EXPECT_GT(consistency_of(match_to_truth(moved, truth)).pose.anees, 100.0);
  const auto first = match_to_truth(moved, truth, {.alignment = Alignment::first});
  EXPECT_EQ(first.size(), series.size() - 1);
  const SE3d onto = series[0].truth * moved[0].estimate.mean().inverse();
  EXPECT_TRUE(first[0].estimate.mean().is_approx(onto * moved[1].estimate.mean(), 1e-12));
}

TEST(TruthMatch, PositionsOnALineCannotBeAligned) {
  std::vector<StampedEstimate> estimates;
  std::vector<StampedTruth> truth;
  for (int k = 0; k < 5; ++k) {
    const SE3d pose(SO3d(), Eigen::Vector3d(k, 0, 0));
    estimates.push_back({1.0 * k, PoseDensity(pose, Matrix6d::Identity())});
    truth.push_back({1.0 * k, pose});
  }
  const std::string message = thrown_message(
      [&] { return match_to_truth(estimates, truth, {.alignment = Alignment::se3}); });
  EXPECT_NE(message.find("on a line"), std::string::npos) << message;
}

}  // namespace
}  // namespace posemix
