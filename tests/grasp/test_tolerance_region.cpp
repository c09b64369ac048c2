// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/grasp/tolerance_region.hpp"

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::thrown_message;

const Vector6d kScale =
    (Vector6d() << Eigen::Vector3d::Constant(radians(8.0)), Eigen::Vector3d::Constant(8e-3))
        .finished();

SE3d random_error(RandomStream& stream) {
  Eigen::VectorXd z(6);
  stream.fill_normal(z);
  const Vector6d x = kScale.cwiseProduct(Vector6d(z));
  return SE3d(SO3d::exp(x.head<3>()), x.tail<3>());
}

ToleranceRegion simulated_region() {
  return {
      .centre = (Vector6d() << radians(2.0), 0.0, 0.0, 3e-3, -2e-3, 0.0).finished(),
      .half_width =
          (Vector6d() << radians(6.0), radians(40.0), radians(40.0), 6e-3, 8e-3, 1.0).finished(),
      .softness = 0.1,
      .lever = Eigen::Vector3d(0.0, 0.05, 0.0),
      .success_inside = 0.97,
      .success_outside = 0.02};
}

std::vector<ErrorOutcome> simulate(const ToleranceRegion& region, std::size_t count,
                                   RandomStream& stream) {
  std::vector<ErrorOutcome> outcomes;
  for (std::size_t i = 0; i < count; ++i) {
    const SE3d error = random_error(stream);
    outcomes.push_back({error, stream.uniform() < region.success_probability(error)});
  }
  return outcomes;
}

/// The formula of the class, term by term.
TEST(ToleranceRegion, IsTheProductOfTwelveWalls) {
  const ToleranceRegion region = simulated_region();
  RandomStream stream(1);
  for (int i = 0; i < 20; ++i) {
    const SE3d error = random_error(stream);
    Vector6d x;
    x << error.rotation().log(), error.translation() + error.rotation().log().cross(region.lever);
    double box = 1.0;
    for (int k = 0; k < 6; ++k) {
      const double scale = region.softness * region.half_width[k];
      const double w = region.half_width[k];
      box *= 1.0 / (1.0 + std::exp(-(x[k] - region.centre[k] + w) / scale));
      box *= 1.0 / (1.0 + std::exp(-(region.centre[k] + w - x[k]) / scale));
    }
    EXPECT_NEAR(region.success_probability(error), 0.02 + 0.95 * box, 1e-14);
  }
}

TEST(ToleranceRegion, SoftWallsTendToThePapersBox) {
  ToleranceRegion soft = simulated_region();
  soft.softness = 1e-9;
  ToleranceRegion hard = soft;
  hard.softness = 0.0;
  RandomStream stream(2);
  int inside = 0;
  for (int i = 0; i < 500; ++i) {
    const SE3d error = random_error(stream);
    const double p = hard.success_probability(error);
    EXPECT_TRUE(p == hard.success_inside || p == hard.success_outside);
    EXPECT_NEAR(soft.success_probability(error), p, 1e-9);
    inside += p > 0.5 ? 1 : 0;
  }
  EXPECT_GT(inside, 50);
  EXPECT_LT(inside, 450);
  EXPECT_EQ(ToleranceRegion{}.success_probability(random_error(stream)), 1.0);
}

TEST(ToleranceRegion, ParametersGoThereAndBack) {
  const ToleranceRegion region = simulated_region();
  const ToleranceRegion back = region_of(parameters_of(region));
  EXPECT_LT((back.centre - region.centre).norm(), 1e-15);
  EXPECT_LT((back.half_width - region.half_width).norm(), 1e-14);
  EXPECT_LT((back.lever - region.lever).norm(), 1e-15);
  EXPECT_NEAR(back.softness, region.softness, 1e-15);
  EXPECT_NEAR(back.success_inside, region.success_inside, 1e-15);
  EXPECT_NEAR(back.success_outside, region.success_outside, 1e-15);
}

TEST(ToleranceRegion, RefusesWhatIsNone) {
  ToleranceRegion region = simulated_region();
  region.half_width[2] = 0.0;
  EXPECT_EQ(thrown_message([&] { validate(region); }), "half width 0, expected a positive one");
  region = simulated_region();
  region.success_outside = 0.98;
  EXPECT_NE(thrown_message([&] { validate(region); }).find("0.98 outside and 0.97 inside"),
            std::string::npos);
  region = simulated_region();
  region.softness = -1.0;
  EXPECT_EQ(thrown_message([&] { validate(region); }), "softness -1, expected one >= 0");
  EXPECT_NE(thrown_message([] { parameters_of({}); }).find("no finite parameters"),
            std::string::npos);
  RandomStream stream(1);
  EXPECT_EQ(thrown_message([&] { fit_tolerance_region({}, {.starts = 0}, stream); }),
            "fit of a tolerance region without a start");
  EXPECT_EQ(thrown_message([&] {
              bootstrap_regions(simulate(simulated_region(), 3, stream), {}, 1, {}, stream);
            }),
            "bootstrap of outcomes without a group for each");
}

TEST(RegionFit, GradientAgainstDifferences) {
  RandomStream stream(3);
  const std::vector<ErrorOutcome> outcomes = simulate(simulated_region(), 60, stream);
  for (int trial = 0; trial < 5; ++trial) {
    RegionParameters theta = parameters_of(simulated_region());
    for (double& value : theta) value += 0.3 * stream.normal();
    RegionParameters gradient;
    region_log_posterior(theta, outcomes, {}, &gradient);
    for (int k = 0; k < kRegionParameters; ++k) {
      const double h = 1e-5;
      RegionParameters above = theta;
      RegionParameters below = theta;
      above[k] += h;
      below[k] -= h;
      const double slope =
          (region_log_posterior(above, outcomes, {}) - region_log_posterior(below, outcomes, {})) /
          (2.0 * h);
      EXPECT_NEAR(gradient[k], slope, 1e-5 * (1.0 + std::abs(slope))) << "parameter " << k;
    }
  }
}

TEST(RegionFit, RecoversASimulatedRegion) {
  RandomStream stream(4);
  const ToleranceRegion truth = simulated_region();
  const RegionFit fit = fit_tolerance_region(simulate(truth, 4000, stream), {}, stream);
  EXPECT_TRUE(fit.converged);
  EXPECT_EQ(fit.successes + fit.failures, 4000U);
  for (const int k : {0, 3, 4}) {
    const double unit = k < 3 ? radians(1.0) : 1e-3;
    EXPECT_NEAR(fit.region.centre[k], truth.centre[k], 0.4 * unit) << k;
    EXPECT_NEAR(fit.region.half_width[k], truth.half_width[k], 0.5 * unit) << k;
    EXPECT_TRUE(fit.identified[static_cast<std::size_t>(k)]);
  }
  EXPECT_NEAR(fit.region.lever.y(), truth.lever.y(), 5e-3);
  EXPECT_NEAR(fit.region.softness, truth.softness, 0.03);
  EXPECT_NEAR(fit.region.success_inside, truth.success_inside, 0.03);
  EXPECT_NEAR(fit.region.success_outside, truth.success_outside, 0.01);
}

TEST(RegionFit, IsThePriorsWithoutOutcomes) {
  RandomStream stream(5);
  const RegionFit fit = fit_tolerance_region({}, {}, stream);
  EXPECT_NEAR(fit.region.half_width[0], radians(12.0), 1e-6);
  EXPECT_NEAR(fit.region.half_width[5], 12e-3, 1e-8);
  EXPECT_NEAR(fit.region.softness, 0.2, 1e-6);
  EXPECT_NEAR(fit.log_posterior, 0.0, 1e-12);
  for (const bool identified : fit.identified) EXPECT_FALSE(identified);
}

TEST(RegionFit, BootstrapIsUnsureWhereNothingWasSeen) {
  RandomStream stream(6);
  const ToleranceRegion truth = simulated_region();
  const std::vector<ErrorOutcome> outcomes = simulate(truth, 60, stream);
  std::vector<std::size_t> groups;
  for (std::size_t i = 0; i < outcomes.size(); ++i) groups.push_back(i / 3);
  RandomStream first(7);
  RandomStream second(7);
  const auto regions = bootstrap_regions(outcomes, groups, 12, {.starts = 1}, first);
  const auto again = bootstrap_regions(outcomes, groups, 12, {.starts = 1}, second);
  ASSERT_EQ(regions.size(), 12U);
  double least = 1.0;
  double most = 0.0;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    EXPECT_EQ(regions[i].half_width, again[i].half_width);
    least = std::min(least, regions[i].half_width[3]);
    most = std::max(most, regions[i].half_width[3]);
  }
  EXPECT_GT(most - least, 5e-4);
}

}  // namespace
}  // namespace posemix
