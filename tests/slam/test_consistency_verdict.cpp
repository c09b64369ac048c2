// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "error_series.hpp"

/// The verdict on a series of errors, and what it stands on.
namespace posemix {
namespace {

using testing::series_of;
using testing::slow_errors;
using testing::standard_normal;
using testing::white_series;

TEST(ConsistencyVerdict, FewFramesAreWorthNoMoreThanIsKnown) {
  for (const std::size_t frames : {2U, 3U, 5U, 9U}) {
    RandomStream stream(frames);
    const Vector6d z = standard_normal(stream);
    const ConsistencyReport report = consistency_of(series_of(frames, 1.0, [&] { return z; }));
    // The draws are the same, and the charts differ by what errors of some degrees do.
    EXPECT_LT(report.pose.effective_frames, 1.35) << frames;
    EXPECT_NE(report.findings.back().find("too few to tell how alike"), std::string::npos)
        << report.findings.back();
  }
  // White errors of two frames tell no more.
  EXPECT_EQ(consistency_of(white_series(2, 1.0, 31)).pose.effective_frames, 1.0);
  EXPECT_EQ(consistency_of(white_series(2, 1.0, 31)).position.effective_frames, 1.0);
}

/// The series with the covariance along the estimate's axes times these factors on both sides.
std::vector<EstimateWithTruth> scaled(std::vector<EstimateWithTruth> series, const Vector6d& by) {
  for (EstimateWithTruth& pair : series) {
    const SE3d& mean = pair.estimate.mean();
    const Matrix6d body = by.asDiagonal() * pair.estimate.body_covariance() * by.asDiagonal();
    pair.estimate = PoseDensity(mean, mean.adjoint_congruence(body));
  }
  return series;
}

TEST(ConsistencyVerdict, TheVerdictIsTheWorstOfAllParts) {
  Vector6d by;
  by << Eigen::Vector3d::Constant(0.8), Eigen::Vector3d::Constant(1.7);
  const ConsistencyReport report = consistency_of(scaled(white_series(400, 1.0, 32), by));
  EXPECT_EQ(report.verdict, ConsistencyVerdict::overconfident);
  EXPECT_EQ(report.rotation->verdict, ConsistencyVerdict::overconfident);
  EXPECT_EQ(report.position.verdict, ConsistencyVerdict::cautious);
  EXPECT_TRUE(report.findings[0].starts_with("overconfident in part, ")) << report.findings[0];
  EXPECT_TRUE(report.findings[1].starts_with("the rotation is overconfident by a factor of 1.2"))
      << report.findings[1];
  EXPECT_TRUE(report.findings[2].starts_with("the position is too cautious by a factor of 1."))
      << report.findings[2];
}

TEST(ConsistencyVerdict, OneDirectionAtFaultIsEnough) {
  Vector6d by = Vector6d::Ones();
  by[1] = 0.7;
  const ConsistencyReport report = consistency_of(scaled(white_series(120, 1.0, 33), by));
  EXPECT_GT(report.most_overconfident.ratio, report.most_overconfident.limit);
  EXPECT_EQ(report.verdict, ConsistencyVerdict::overconfident);
  EXPECT_FALSE(report.findings[0].starts_with("consistent")) << report.findings[0];
}

TEST(ConsistencyVerdict, ConsistentSeriesAreSeldomFoundOtherwise) {
  RandomStream stream(34);
  int white = 0;
  int slow = 0;
  constexpr int kSeries = 300;
  for (int i = 0; i < kSeries; ++i) {
    const auto seed = static_cast<std::uint64_t>(5000 + i);
    white += consistency_of(white_series(60, 1.0, seed)).verdict != ConsistencyVerdict::consistent;
    slow += consistency_of(series_of(200, 1.0, slow_errors(stream, 0.9))).verdict !=
            ConsistencyVerdict::consistent;
  }
  // 8 %, and 3 standard errors of 1.6 %.
  EXPECT_LE(white, 0.127 * kSeries);
  EXPECT_LE(slow, 0.127 * kSeries);
}

/// Errors as stated whose covariances differ: of a filter that converges, slowly or fast, and of
/// one that loses its object now and then.
TEST(ConsistencyVerdict, CovariancesMayDifferFromFrameToFrame) {
  const std::vector<std::function<double(double)>> sds{
      [](double k) { return 1.0 / std::sqrt(k + 1.0); },
      [](double k) { return std::max(0.1, std::exp(-k / 13.0)); },
      [](double k) { return std::fmod(k, 20.0) == 0.0 ? 5.0 : 1.0; }};
  constexpr int kSeries = 300;
  for (std::size_t kind = 0; kind < sds.size(); ++kind) {
    int otherwise = 0;
    int beyond = 0;
    for (std::uint64_t seed = 0; seed < kSeries; ++seed) {
      RandomStream stream(7000 + seed);
      std::vector<EstimateWithTruth> series;
      for (int k = 0; k < 600; ++k) {
        const double sd = sds[kind](k);
        const Matrix6d p = sd * sd * testing::body_covariance();
        const Vector6d error = p.llt().matrixL() * standard_normal(stream);
        series.push_back({0.1 * k, PoseDensity(SE3d::exp(error), p), SE3d()});
      }
      const ConsistencyReport report = consistency_of(series);
      otherwise += report.verdict != ConsistencyVerdict::consistent;
      beyond += report.most_overconfident.ratio > report.most_overconfident.limit ||
                report.most_cautious.ratio < report.most_cautious.limit;
    }
    // 8 % and 1 %, and 3 standard errors of each.
    EXPECT_LE(otherwise, 0.127 * kSeries) << kind;
    EXPECT_LE(beyond, 0.027 * kSeries) << kind;
  }
}

TEST(ConsistencyVerdict, ADirectionThatIsNoAxisHasAName) {
  // Rotation x and position y are taken for one, so that their difference has hardly any variance.
  auto series = white_series(50, 1.0, 35);
  for (EstimateWithTruth& pair : series) {
    Matrix6d body = pose_covariance({0.02, 0.03, 0.01}, {0.005, 0.01, 0.02});
    body(0, 4) = body(4, 0) = (1.0 - 1e-5) * 0.02 * 0.01;
    pair.estimate =
        PoseDensity(pair.estimate.mean(), pair.estimate.mean().adjoint_congruence(body));
  }
  const ConsistencyReport report = consistency_of(series);
  const ErrorDirection& most = report.most_overconfident;
  EXPECT_LT(most.correlation.cwiseAbs().maxCoeff(), 0.3);
  EXPECT_NE(most.name.find("rotation x"), std::string::npos) << most.name;
  EXPECT_NE(most.name.find("position y"), std::string::npos) << most.name;
  // Of unit length, so that no part is too small for a name.
  EXPECT_TRUE(most.name.starts_with("0.6")) << most.name;
}

}  // namespace
}  // namespace posemix
