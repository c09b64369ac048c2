// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "exhaustive_filter.hpp"
#include "multi_object_scene.hpp"
#include "posemix/divergence/monte_carlo.hpp"

namespace posemix {
namespace {

using testing::ExhaustiveFilter;
using testing::isotropic;
using testing::OrbitScene;

using PoseMixture = Mixture<ConcentratedGaussian<SE3d>>;

struct Losses {
  double camera = 0.0;
  double object = 0.0;
  std::size_t tuples = 0;
};

double mixture_divergence(const PoseMixture& p, const PoseMixture& q) {
  RandomStream stream(3, 1);
  return kl_monte_carlo(p, q, stream, {.samples = 20000}).value;
}

/// KL from the exhaustive posterior to that of the filter after `frames` frames.
Losses losses(std::uint64_t seed, double odometry_deg, double odometry_m, double flips) {
  constexpr std::size_t objects = 2;
  constexpr int frames = 25;
  OrbitScene scene(seed, objects, odometry_deg, odometry_m);
  const Matrix6d start = isotropic(0.1, 0.002);
  MultiObjectSettings settings = testing::plain_settings();
  settings.max_hypotheses = 1000;
  settings.merge_rotation_rad = 0.0;
  const double explained = 25.2627;  // quantile 0.9997 of chi-square with six degrees of freedom
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(scene.camera, start),
                           std::vector<ObjectSensor>(objects, {testing::ray_noise()}), settings);
  ExhaustiveFilter exact(scene.camera, start, objects, testing::ray_noise(), explained);
  for (int frame = 0; frame < frames; ++frame) {
    if (frame > 0) {
      const SE3d motion = scene.advance();
      filter.predict_with_odometry(motion, scene.q, 0.1);
      exact.predict(motion, scene.q);
    }
    for (std::size_t j = 0; j < objects; ++j) {
      const SE3d detected = scene.detect(j, flips, 0.03);
      filter.update(j, detected);
      exact.update(j, detected);
    }
  }
  Losses result;
  result.tuples = exact.size();
  result.camera = mixture_divergence(exact.marginal(0), filter.camera_mixture());
  for (std::size_t j = 0; j < objects; ++j) {
    result.object += mixture_divergence(exact.marginal(j + 1), filter.object_mixture(j)) /
                     static_cast<double>(objects);
  }
  return result;
}

Losses mean_losses(double odometry_deg, double odometry_m, double flips) {
  constexpr int kSeeds = 12;
  Losses mean;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Losses one = losses(static_cast<std::uint64_t>(seed), odometry_deg, odometry_m, flips);
    mean.camera += one.camera / kSeeds;
    mean.object += one.object / kSeeds;
    mean.tuples = std::max(mean.tuples, one.tuples);
  }
  ::testing::Test::RecordProperty("camera_kl", fmt::format("{:.5f}", mean.camera));
  ::testing::Test::RecordProperty("object_kl", fmt::format("{:.5f}", mean.object));
  return mean;
}

// Two objects, 25 frames, 3 % wild detections.
TEST(MultiObjectExhaustive, LosesLittleAtGoodOdometryThoughModesTie) {
  const Losses mean = mean_losses(0.01, 0.15e-3, 0.4);
  EXPECT_GT(mean.tuples, 8U);
  EXPECT_LT(mean.camera, 0.02);
  EXPECT_LT(mean.object, 0.02);
}

TEST(MultiObjectExhaustive, LosesLittleAtMediumOdometryWhereOneModeLeads) {
  const Losses mean = mean_losses(0.05, 1e-3, 0.2);
  EXPECT_GT(mean.tuples, 8U);
  EXPECT_LT(mean.camera, 0.02);
  EXPECT_LT(mean.object, 0.02);
}

// If two modes tie again and again, the camera has alternatives of its own: global hypotheses.
TEST(MultiObjectExhaustive, LosesLittleAtMediumOdometryThoughModesTie) {
  const Losses mean = mean_losses(0.05, 1e-3, 0.4);
  EXPECT_GT(mean.tuples, 8U);
  EXPECT_LT(mean.camera, 0.02);
  EXPECT_LT(mean.object, 0.02);
}

// With one object and one component of noise the filter approximates nothing.
TEST(MultiObjectExhaustive, IsExactForOneMode) {
  OrbitScene scene(5, 1, 0.3, 0.005);
  const Matrix6d start = isotropic(0.1, 0.002);
  const DetectorNoise noise({{.weight = 1.0,
                              .covariance = testing::ray_noise().components().front().covariance,
                              .frame = NoiseFrame::ray}});
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(scene.camera, start), {{noise}},
                           testing::plain_settings());
  ExhaustiveFilter exact(scene.camera, start, 1, noise, 25.0);
  for (int frame = 0; frame < 40; ++frame) {
    if (frame > 0) {
      const SE3d motion = scene.advance();
      filter.predict_with_odometry(motion, scene.q, 0.1);
      exact.predict(motion, scene.q);
    }
    const SE3d detected = scene.detect(0, 0.0, 0.0);
    filter.update(0, detected);
    exact.update(0, detected);
  }
  const auto camera = exact.marginal(0)[0].density;
  const auto object = exact.marginal(1)[0].density;
  EXPECT_LT((filter.camera().mean() * camera.mean().inverse()).log().norm(), 1e-9);
  EXPECT_TRUE(filter.camera().covariance().isApprox(camera.covariance(), 1e-6));
  EXPECT_LT((filter.hypotheses(0)[0].pose * object.mean().inverse()).log().norm(), 1e-9);
  EXPECT_TRUE(filter.hypotheses(0)[0].covariance.isApprox(object.covariance(), 1e-6));
}

}  // namespace
}  // namespace posemix
