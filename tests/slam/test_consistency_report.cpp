// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "error_series.hpp"
#include "posemix/testing/expect.hpp"

/// Series of poses whose errors are drawn from what is said of them, or from something else.
namespace posemix {
namespace {

using testing::series_of;
using testing::slow_errors;
using testing::standard_normal;
using testing::thrown_message;
using testing::white_series;

const AxisConsistency& axis_named(const ConsistencyReport& report, const std::string& name) {
  for (const AxisConsistency& axis : report.axes) {
    if (axis.axis == name) return axis;
  }
  throw InvalidInput("no axis " + name);
}

TEST(ConsistencyReport, AConsistentSeriesHasAneesOneAndNominalCoverage) {
  const auto series = white_series(2000, 1.0, 21);
  const ConsistencyReport report = consistency_of(series);
  EXPECT_EQ(report.verdict, ConsistencyVerdict::consistent);
  EXPECT_EQ(report.pose.dof, 6U);
  EXPECT_TRUE(report.pose.interval.contains(1.0));
  // Standard error of the mean of 2000 chi-square variables over 6 degrees of freedom: 0.013.
  EXPECT_NEAR(report.pose.anees, 1.0, 0.05);
  EXPECT_NEAR(report.rotation->anees, 1.0, 0.07);
  EXPECT_NEAR(report.position.anees, 1.0, 0.07);
  EXPECT_NEAR(report.pose.effective_frames, 2000.0, 100.0);
  EXPECT_NEAR(report.pose.within_frame_band, 0.95, 0.02);
  // Quantiles of chi-square with 6 degrees of freedom over 6 (tables): 1.237 and 14.449.
  EXPECT_NEAR(report.pose.frame_band.low, 1.237 / 6.0, 1e-4);
  EXPECT_NEAR(report.pose.frame_band.high, 14.449 / 6.0, 1e-4);
  const std::array<double, 3> nominal{0.01439, 0.32332, 0.82642};  // chi-square, 6, of 1, 4, 9
  const std::array<double, 3> normal{0.68269, 0.95450, 0.99730};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(report.pose.coverage.nominal[i], nominal[i], 1e-5);
    EXPECT_NEAR(report.pose.coverage.shares[i], nominal[i], 0.04);
  }
  ASSERT_EQ(report.axes.size(), 6U);
  for (const AxisConsistency& axis : report.axes) {
    EXPECT_NEAR(axis.normalized_rms, 1.0, 0.06) << axis.axis;
    EXPECT_NEAR(axis.normalized_mean, 0.0, 0.09) << axis.axis;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(axis.coverage.nominal[i], normal[i], 1e-5);
      EXPECT_NEAR(axis.coverage.shares[i], normal[i], 0.04) << axis.axis;
    }
  }
  EXPECT_LT(report.most_overconfident.ratio, report.most_overconfident.limit);
  EXPECT_GT(report.most_cautious.ratio, report.most_cautious.limit);
  EXPECT_EQ(report.findings.size(), 1U) << report.findings.back();
}

TEST(ConsistencyReport, NeesIsTheQuadraticFormOfTheErrorOnEitherSide) {
  const auto series = white_series(5, 1.7, 2);
  const ConsistencyReport report = consistency_of(series);
  for (std::size_t k = 0; k < series.size(); ++k) {
    const auto& [stamp, estimate, truth] = series[k];
    const Vector6d e = (truth * estimate.mean().inverse()).log();
    const double expected = e.dot(estimate.covariance().inverse() * e);
    EXPECT_NEAR(report.frames[k].nees, expected, 1e-9 * expected);
    // Rotation alone: the same in the frame of the world.
    const Eigen::Matrix3d rotation = estimate.covariance().topLeftCorner<3, 3>();
    const double turned = e.head<3>().dot(rotation.inverse() * e.head<3>());
    EXPECT_NEAR(report.frames[k].rotation_nees, turned, 1e-9 * turned);
    EXPECT_EQ(report.frames[k].stamp_s, stamp);
  }
}

TEST(ConsistencyReport, FourTimesTheCovarianceIsTooCautiousByTwo) {
  const ConsistencyReport report = consistency_of(white_series(1000, 4.0, 3));
  EXPECT_EQ(report.verdict, ConsistencyVerdict::cautious);
  EXPECT_NEAR(report.pose.anees, 0.25, 0.02);
  EXPECT_TRUE(report.pose.interval.contains(0.25));
  EXPECT_NE(report.findings[0].find("too large by a factor of 2"), std::string::npos)
      << report.findings[0];
  const ConsistencyReport bold = consistency_of(white_series(1000, 0.25, 3));
  EXPECT_EQ(bold.verdict, ConsistencyVerdict::overconfident);
  EXPECT_NEAR(bold.pose.anees, 4.0, 0.3);
}

TEST(ConsistencyReport, TheDirectionAtFaultIsFound) {
  RandomStream stream(4);
  auto series = series_of(1000, 1.0, [&] { return standard_normal(stream); });
  // The estimate is told to be three times surer of the rotation about its own z axis.
  for (EstimateWithTruth& pair : series) {
    const SE3d& mean = pair.estimate.mean();
    Vector6d scale = Vector6d::Ones();
    scale[2] = 1.0 / 3.0;
    const Matrix6d body = scale.asDiagonal() * pair.estimate.body_covariance() * scale.asDiagonal();
    pair.estimate = PoseDensity(mean, mean.adjoint_congruence(body));
  }
  const ConsistencyReport report = consistency_of(series);
  EXPECT_EQ(report.verdict, ConsistencyVerdict::overconfident);
  const ErrorDirection& most = report.most_overconfident;
  // The marginal variance is nine times too small; a direction of the whole may be worse still.
  EXPECT_NEAR(axis_named(report, "rotation z").normalized_rms, 3.0, 0.2);
  EXPECT_GT(most.ratio, 8.0);
  EXPECT_GT(std::abs(most.correlation[2]), 0.9);
  EXPECT_NE(most.name.find("rotation z"), std::string::npos) << most.name;
  EXPECT_GT(most.ratio, most.limit);
  EXPECT_NEAR(axis_named(report, "position x").normalized_rms, 1.0, 0.1);
}

TEST(ConsistencyReport, AnIndependentEigenproblemHasTheSameRatios) {
  const auto series = white_series(40, 1.0, 5);
  const ConsistencyReport report = consistency_of(series);
  Matrix6d squares = Matrix6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
  for (const auto& [stamp, estimate, truth] : series) {
    const Vector6d e = (estimate.mean().inverse() * truth).log();
    squares += e * e.transpose();
    covariance += estimate.body_covariance();
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> solver(squares, covariance);
  EXPECT_NEAR(report.most_cautious.ratio, solver.eigenvalues()[0], 1e-9);
  EXPECT_NEAR(report.most_overconfident.ratio, solver.eigenvalues()[5], 1e-9);
}

TEST(ConsistencyReport, TheIntervalOfIndependentErrorsHolds) {
  int held = 0;
  constexpr int kSeries = 200;
  for (int i = 0; i < kSeries; ++i) {
    const auto seed = static_cast<std::uint64_t>(100 + i);
    held += consistency_of(white_series(60, 1.0, seed)).pose.interval.contains(1.0) ? 1 : 0;
  }
  // 190 +- 3 standard errors of 3.1.
  EXPECT_GE(held, 181);
}

TEST(ConsistencyReport, SlowErrorsAreWorthFewFramesAndTheIntervalHolds) {
  int held = 0;
  int chi_square_held = 0;
  double frames = 0.0;
  constexpr int kSeries = 120;
  RandomStream stream(6);
  for (int i = 0; i < kSeries; ++i) {
    // The correlation of the NEES falls by keep^2: 300 (1 - keep^2) / (1 + keep^2) = 30.
    const ConsistencyReport report =
        consistency_of(series_of(300, 1.0, slow_errors(stream, 0.9045)));
    held += report.pose.interval.contains(1.0) ? 1 : 0;
    chi_square_held += report.pose.independent_band.contains(report.pose.anees) ? 1 : 0;
    frames += report.pose.effective_frames / kSeries;
  }
  // 0.95 +- 3 standard errors of 0.02.
  EXPECT_GE(held, static_cast<int>(0.89 * kSeries));
  EXPECT_LT(chi_square_held, kSeries * 7 / 10);
  EXPECT_GT(frames, 20.0);
  EXPECT_LT(frames, 40.0);
}

TEST(ConsistencyReport, AnErrorThatNeverChangesIsOneLook) {
  RandomStream stream(7);
  const Vector6d z = standard_normal(stream);
  const ConsistencyReport report = consistency_of(series_of(500, 1.0, [&] { return z; }));
  EXPECT_LT(report.pose.effective_frames, 1.5);
  EXPECT_NEAR(report.constant_share, 1.0, 1e-2);
  EXPECT_NE(report.findings.back().find("too few"), std::string::npos);
}

TEST(ConsistencyReport, ABiasIsNamed) {
  RandomStream stream(8);
  auto series = series_of(500, 1.0, [&] { return standard_normal(stream); });
  for (EstimateWithTruth& pair : series) {
    // 3 cm along the estimate's own x axis, whose standard deviation is 5 mm.
    const SE3d moved = pair.estimate.mean() * SE3d(SO3d(), Eigen::Vector3d(-0.03, 0.0, 0.0));
    pair.estimate = PoseDensity(moved, moved.adjoint_congruence(pair.estimate.body_covariance()));
  }
  const ConsistencyReport report = consistency_of(series);
  EXPECT_EQ(report.verdict, ConsistencyVerdict::overconfident);
  EXPECT_NEAR(axis_named(report, "position x").mean_error, 0.03, 5e-4);
  const auto named =
      std::count_if(report.findings.begin(), report.findings.end(), [](const std::string& finding) {
        return finding.starts_with("mean error along position x: ");
      });
  EXPECT_EQ(named, 1);
}

/// An object that looks the same after any turn about its z axis, which may be off its origin.
class AxisSymmetry : public ::testing::TestWithParam<double> {};

TEST_P(AxisSymmetry, FiveDegreesOfFreedomCountAndTheTurnDoesNot) {
  const Eigen::Vector3d point(GetParam(), 0.0, 0.0);
  const SymmetryGroup group({}, {{Eigen::Vector3d::UnitZ(), point}});
  const SE3d to_point(SO3d(), point);
  RandomStream stream(9);
  auto series = series_of(1500, 1.0, [&] { return standard_normal(stream); });
  const ConsistencyReport plain = consistency_of(series);
  for (EstimateWithTruth& pair : series) {
    const SE3d turn(SO3d::exp(Eigen::Vector3d(0, 0, 6.0 * stream.uniform() - 3.0)),
                    Eigen::Vector3d::Zero());
    pair.truth = pair.truth * (to_point * turn * to_point.inverse());
  }
  const ConsistencyReport report = consistency_of(series, {.symmetries = group});
  EXPECT_EQ(report.pose.dof, 5U);
  EXPECT_EQ(report.rotation->dof, 2U);
  EXPECT_EQ(report.position.dof, 3U);
  EXPECT_EQ(report.verdict, ConsistencyVerdict::consistent) << report.findings[0];
  EXPECT_NEAR(report.pose.anees, 1.0, 0.06);
  EXPECT_NEAR(report.rotation->anees, 1.0, 0.1);
  EXPECT_NEAR(report.position.anees, 1.0, 0.1);
  EXPECT_EQ(report.axes.size(), 5U);
  // Without declaring it the same series is hopeless.
  EXPECT_GT(consistency_of(series).pose.anees, 100.0);
  // What is known of the turn has no part in it, however much or little that is.
  auto blurred = series;
  for (EstimateWithTruth& pair : blurred) {
    const SE3d& mean = pair.estimate.mean();
    Vector6d turn;
    turn << Eigen::Vector3d::UnitZ(), point.cross(Eigen::Vector3d::UnitZ());
    const Matrix6d body = pair.estimate.body_covariance() + 9.0 * turn * turn.transpose();
    pair.estimate = PoseDensity(mean, mean.adjoint_congruence(body));
  }
  const ConsistencyReport same = consistency_of(blurred, {.symmetries = group});
  EXPECT_NEAR(same.pose.anees, report.pose.anees, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Offsets, AxisSymmetry, ::testing::Values(0.0, 0.2));

TEST(ConsistencyReport, UnderAllTurnsThePositionIsLeft) {
  const Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  const SymmetryGroup ball(
      {}, {{Eigen::Vector3d::UnitX(), centre}, {Eigen::Vector3d::UnitY(), centre}});
  RandomStream stream(10);
  auto series = series_of(1000, 1.0, [&] { return standard_normal(stream); });
  for (EstimateWithTruth& pair : series) {
    const Eigen::Vector3d turn = 0.5 * standard_normal(stream).head<3>();
    pair.truth = pair.truth * SE3d(SO3d::exp(turn), Eigen::Vector3d::Zero());
  }
  const ConsistencyReport report = consistency_of(series, {.symmetries = ball});
  EXPECT_EQ(report.pose.dof, 3U);
  EXPECT_FALSE(report.rotation.has_value());
  EXPECT_NEAR(report.pose.anees, 1.0, 0.08);
  EXPECT_EQ(report.axes.size(), 3U);
}

TEST(ConsistencyReport, TheNearestOfDiscreteImagesCounts) {
  const SymmetryGroup group = SymmetryGroup::turns(Eigen::Vector3d::UnitZ(), 2);
  auto series = white_series(300, 1.0, 11);
  const ConsistencyReport plain = consistency_of(series);
  for (std::size_t k = 0; k < series.size(); k += 2)
    series[k].truth = series[k].truth * SE3d(SO3d::exp({0, 0, std::numbers::pi}), {0, 0, 0});
  const ConsistencyReport report = consistency_of(series, {.symmetries = group});
  EXPECT_EQ(report.pose.dof, 6U);
  EXPECT_NEAR(report.pose.anees, plain.pose.anees, 1e-9);
}

TEST(ConsistencyReport, AxesOfTheReferenceTurnErrorsOnly) {
  const auto series = white_series(50, 1.0, 12);
  const ConsistencyReport body = consistency_of(series);
  const ConsistencyReport world = consistency_of(series, {.axes = ErrorAxes::reference});
  EXPECT_EQ(body.pose.anees, world.pose.anees);
  double mean = 0.0;
  for (const auto& [stamp, estimate, truth] : series) {
    const Eigen::Vector3d turn = (truth.rotation() * estimate.mean().rotation().inverse()).log();
    mean += turn.x() / 50.0;
  }
  EXPECT_NEAR(world.axes[0].mean_error, mean, 1e-12);
}

TEST(ConsistencyReport, RefusesWhatIsNoSeries) {
  auto series = white_series(3, 1.0, 13);
  EXPECT_NE(thrown_message([&] {
              return consistency_of({series.data(), 1});
            }).find("at least 2"),
            std::string::npos);
  std::swap(series[0], series[1]);
  EXPECT_NE(thrown_message([&] { return consistency_of(series); }).find("increase"),
            std::string::npos);
  std::swap(series[0], series[1]);
  series[2].estimate = PoseDensity::trusted(SE3d(), -Matrix6d::Identity());
  EXPECT_NE(thrown_message([&] { return consistency_of(series); }).find("stamp 0.2"),
            std::string::npos);
}

}  // namespace
}  // namespace posemix
