// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// NoiseUse::most_likely with one hypothesis: the max-mixture.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "scenario.hpp"

namespace posemix {
namespace {

using testing::camera_filter;
using testing::draw;
using testing::gaussian_noise;
using testing::isotropic;
using testing::kCameraPose;
using testing::kObject;
using testing::pose;

GaussianSumSettings max_mixture() {
  GaussianSumSettings settings;
  settings.noise_use = NoiseUse::most_likely;
  settings.update = UpdateRule::linearized;
  settings.reduction.max_components = 1;
  return settings;
}

GaussianSumFilter filter_with_object() {
  GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(0.5, 0.005), max_mixture());
  filter.add_independent_object(kCameraPose.inverse() * kObject, isotropic(2.0, 0.01));
  return filter;
}

TEST(MaxMixture, OneComponentIsTheInvariantEkf) {
  RandomStream stream(5);
  const DetectorNoise noise = gaussian_noise();
  GaussianSumFilter filter = filter_with_object();
  Hypothesis ekf = filter.posterior()[0].density;
  for (int frame = 0; frame < 30; ++frame) {
    const SE3d relative = ekf.mean()[0].inverse() * ekf.mean()[1];
    const Detection detection{1, relative * SE3d::exp(draw(isotropic(8.0, 0.03), stream)), &noise};
    const std::array component{&noise.components().front()};
    ekf = update(ekf, std::span(&detection, 1), component).posterior;
    filter.update(std::span(&detection, 1));
  }
  ASSERT_EQ(filter.posterior().size(), 1U);
  EXPECT_TRUE(filter.summarise().mean().is_approx(ekf.mean(), 1e-12));
  EXPECT_TRUE(filter.summarise().covariance().isApprox(ekf.covariance(), 1e-10));
}

TEST(MaxMixture, TheLargestWeightedLikelihoodIsUsedAlone) {
  // By hand: log w_i + log N(z; 0, S_i) against log w_clutter - log(8 pi^2 V).
  const DetectorNoise noise({{0.6, isotropic(3.0, 0.01)}, {0.3, isotropic(12.0, 0.05)}},
                            {.weight = 0.1, .volume_m3 = 2.0});
  std::array<int, 3> used{};
  for (const double error : {0.0, 0.01, 0.03, 0.05, 0.1, 0.2, 0.4, 0.6}) {
    GaussianSumFilter filter = filter_with_object();
    const Hypothesis prior = filter.posterior()[0].density;
    const Detection detection{1, kCameraPose.inverse() * kObject * SE3d(SO3d(), {error, 0.0, 0.0}),
                              &noise};
    std::array<double, 3> scores{};
    for (std::size_t i = 0; i < 2; ++i) {
      const Innovation one = innovation(prior.mean(), detection, noise.components()[i]);
      const Eigen::MatrixXd p = prior.covariance();
      const Matrix6d s = p.topLeftCorner(6, 6) + p.bottomRightCorner(6, 6) + one.noise;
      scores[i] = std::log(noise.components()[i].weight) -
                  0.5 * (one.residual.dot(s.inverse() * one.residual) + std::log(s.determinant()) +
                         6.0 * std::log(2.0 * std::numbers::pi));
    }
    scores[2] = std::log(0.1 / (8.0 * std::numbers::pi * std::numbers::pi * 2.0));
    const auto best =
        static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin());
    ++used[best];
    filter.update(std::span(&detection, 1));
    ASSERT_EQ(filter.posterior().size(), 1U);
    const Hypothesis& posterior = filter.posterior()[0].density;
    if (best == 2) {
      EXPECT_EQ(posterior.covariance(), prior.covariance()) << error;
      EXPECT_TRUE(posterior.mean().is_approx(prior.mean(), 0.0)) << error;
      continue;
    }
    const std::array component{&noise.components()[best]};
    const Hypothesis expected = update(prior, std::span(&detection, 1), component).posterior;
    EXPECT_TRUE(posterior.mean().is_approx(expected.mean(), 1e-12)) << error;
    EXPECT_TRUE(posterior.covariance().isApprox(expected.covariance(), 1e-12)) << error;
  }
  // The errors go through all three.
  for (const int count : used) EXPECT_GT(count, 0);
}

TEST(MaxMixture, ANewObjectEntersByTheHeaviestComponent) {
  const NoiseComponent flipped{0.3, isotropic(3.0, 0.01), NoiseFrame::object,
                               pose(0.0, 0.0, 3.0, 0.0, 0.0, 0.0)};
  const NoiseComponent heavy{0.7, isotropic(4.0, 0.02)};
  const DetectorNoise noise({flipped, heavy});
  GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(0.5, 0.005), max_mixture());
  const std::size_t object = filter.add_object(kCameraPose.inverse() * kObject, noise);
  ASSERT_EQ(filter.posterior().size(), 1U);
  EXPECT_TRUE(filter.summarise().mean()[object].is_approx(kObject, 1e-12));
}

TEST(MaxMixture, EachHypothesisKeepsOneChild) {
  GaussianSumSettings settings = max_mixture();
  settings.reduction.max_components = 8;
  settings.reduction.prune_below = 0.0;
  const Hypothesis one(PoseStackd({kCameraPose, kObject}),
                       1e-4 * Eigen::MatrixXd::Identity(12, 12));
  const Hypothesis other(PoseStackd({kCameraPose, kObject * pose(0.0, 1.0, 0.0, 0.0, 0.0, 0.0)}),
                         1e-4 * Eigen::MatrixXd::Identity(12, 12));
  GaussianSumFilter filter(Posterior({{std::log(0.5), one}, {std::log(0.5), other}}), settings);
  const DetectorNoise noise({{0.9, isotropic(4.0, 0.01)}}, {.weight = 0.1});
  const Detection detection{1, kCameraPose.inverse() * kObject, &noise};
  filter.update(std::span(&detection, 1));
  ASSERT_EQ(filter.posterior().size(), 2U);
  EXPECT_GT(filter.posterior().weight(0), 0.99);
  // The second explains the detection by clutter alone.
  EXPECT_EQ(filter.posterior()[1].density.covariance(), other.covariance());
}

}  // namespace
}  // namespace posemix
