// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "multi_object_scene.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"

/// The squared Mahalanobis distance of innovations that filters report.
namespace posemix {
namespace {

using testing::isotropic;
using testing::OrbitScene;
using testing::plain_settings;
using testing::ray_noise;

TEST(Innovations, OfTheMultiObjectFilterAreThoseOfThePredictedDetection) {
  const NoiseComponent sharp = ray_noise().components().front();
  OrbitScene scene(5, 1, 0.02, 3e-4);
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                           {{DetectorNoise({sharp})}}, plain_settings());
  constexpr int kFrames = 400;
  double sum = 0.0;
  for (int frame = 0; frame <= kFrames; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    const SE3d seen = scene.detect(0, 0.0, 0.0);
    std::optional<ConcentratedGaussian<SE3d>> predicted;
    if (filter.leading(0)) predicted = filter.predicted_detection(0, *filter.leading(0));
    const std::optional<double> nis = filter.update(0, seen).nis;
    ASSERT_EQ(nis.has_value(), frame > 0) << "the first detection has no innovation";
    if (!nis) continue;
    const NoiseAtPose noise = noise_at(sharp, predicted->mean());
    const Matrix6d s = predicted->covariance() + noise.axes.adjoint_congruence(noise.covariance);
    const Vector6d z = (seen * predicted->mean().inverse()).log();
    EXPECT_NEAR(*nis, z.dot(s.llt().solve(z)), 1e-3 * (1.0 + *nis)) << frame;
    sum += *nis;
  }
  // Chi-square with six degrees of freedom: four standard errors of the mean of frames that are
  // independent are 0.69.
  EXPECT_NEAR(sum / kFrames, 6.0, 0.69);
}

TEST(Innovations, OfTheGaussianSumFilterAreThoseOfTheHeaviestHypothesis) {
  const DetectorNoise noise({{.weight = 0.9, .covariance = isotropic(3.0, 0.01)},
                             {.weight = 0.1, .covariance = isotropic(30.0, 0.1)}});
  const SE3d camera;
  const SE3d object(SO3d::exp({0.1, 0.2, 0.3}), {0.0, 0.1, 1.0});
  for (const double gate : {1.0, 0.99}) {
    GaussianSumSettings settings;
    settings.gate_probability = gate;
    GaussianSumFilter filter(
        Posterior({{0.0, Hypothesis(PoseStackd({camera}), isotropic(0.5, 0.005))}}), settings);
    const std::size_t index = filter.add_independent_object(object, isotropic(2.0, 0.01));
    for (const double shift : {0.01, 0.2, 2.0}) {
      const Detection detection{index, object * SE3d(SO3d(), {0.0, shift, 0.0}), &noise};
      const Hypothesis prior = filter.posterior()[0].density;
      // Near, the narrow component is the more likely one; far away, the wide one.
      const NoiseComponent& best = noise.components()[shift < 0.1 ? 0 : 1];
      const UpdateReport report = filter.update(std::span(&detection, 1));
      ASSERT_EQ(report.nis.size(), 1U);
      EXPECT_NEAR(*report.nis[0], squared_mahalanobis(prior, detection, best), 1e-9) << shift;
      if (gate < 1.0) {
        EXPECT_EQ(report.gated[0], *report.nis[0] > 16.81) << shift;
      }
    }
  }
}

}  // namespace
}  // namespace posemix
