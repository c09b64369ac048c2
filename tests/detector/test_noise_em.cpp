// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_em.hpp"

#include <gtest/gtest.h>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/testing/expect.hpp"
#include "simulated_detections.hpp"

namespace posemix {
namespace {

using testing::detect_along_ray;
using testing::detections_with_clutter;
using testing::normal_vector;
using testing::pose_before_camera;
using testing::ray_deviations;
using testing::relative_difference;

Matrix6d random_covariance(RandomStream& stream) {
  Matrix6d root;
  for (Eigen::Index column = 0; column < 6; ++column) root.col(column) = normal_vector(stream);
  Matrix6d covariance = 0.01 * (root * root.transpose() + Matrix6d::Identity());
  symmetrize(covariance);
  return covariance;
}

/// A covariance n n^T along the ray is that of the same residual along the camera's axes.
TEST(DetectionResidual, AlongTheRayIsTheInverseOfAlongCamera) {
  RandomStream stream(1);
  for (int i = 0; i < 20; ++i) {
    const SE3d truth = pose_before_camera(stream);
    const SE3d detected = truth * SE3d::exp(Vector6d(0.3 * normal_vector(stream)));
    const Vector6d ray = detection_residual(truth, detected, NoiseFrame::ray);
    const Vector6d camera = detection_residual(truth, detected, NoiseFrame::camera);
    const NoiseComponent turned =
        along_camera({.covariance = ray * ray.transpose(), .frame = NoiseFrame::ray}, truth);
    EXPECT_LT(relative_difference(turned.covariance, Matrix6d(camera * camera.transpose())), 1e-12);
  }
}

/// Away from the camera by a tenth of the range is a tenth along z; half as far away the same.
TEST(DetectionResidual, AlongTheRayIsAFractionOfTheRange) {
  const Eigen::Vector3d place(0.3, -0.2, 0.9);
  for (const double scale : {1.0, 0.5}) {
    const SE3d truth(SO3d::exp({0.3, 0.5, -0.2}), scale * place);
    const SE3d detected(truth.rotation(), 1.1 * scale * place);
    const Vector6d n = detection_residual(truth, detected, NoiseFrame::ray);
    EXPECT_LT((n - 0.1 * Vector6d::Unit(5)).norm(), 1e-14);
  }
}

/// Oracle: the concentrated Gaussian of T^-1 Y, whose covariance is turned by hand.
TEST(NoiseLogDensity, IsThatOfTheGaussianOnTheGroup) {
  RandomStream stream(2);
  for (int i = 0; i < 10; ++i) {
    const SE3d truth = pose_before_camera(stream);
    const SE3d offset = SE3d::exp(Vector6d(0.5 * normal_vector(stream)));
    const SE3d detected = truth * offset * SE3d::exp(Vector6d(0.3 * normal_vector(stream)));
    const SE3d error = (truth * offset).inverse() * detected;
    const SE3d turn((truth * offset).rotation().inverse(), Eigen::Vector3d::Zero());
    for (const NoiseFrame frame : {NoiseFrame::object, NoiseFrame::camera, NoiseFrame::ray}) {
      const NoiseComponent component{
          .weight = 0.7, .covariance = random_covariance(stream), .frame = frame, .offset = offset};
      Matrix6d covariance = along_camera(component, truth).covariance;
      if (frame != NoiseFrame::object) covariance = turn.adjoint_congruence(covariance);
      symmetrize(covariance);
      const double expected =
          0.7 * std::exp(ConcentratedGaussian<SE3d>(SE3d(), covariance).log_density(error)) +
          0.3 / (8.0 * std::numbers::pi * std::numbers::pi * 2.0);
      const DetectorNoise noise({component}, {.weight = 0.3, .volume_m3 = 2.0});
      const std::vector<NoiseObservation> one{{truth, detected}};
      EXPECT_NEAR(noise_log_density(noise, one)[0], std::log(expected), 1e-9);
    }
  }
}

NoiseEmSettings bounded(std::size_t components) {
  return {.components = components,
          .frame = NoiseFrame::ray,
          .clutter = true,
          .em = {.restarts = 2, .diagonal = true, .min_sd = 1e-4, .max_sd = 1.5}};
}

void expect_never_falls(const std::vector<double>& history) {
  for (std::size_t i = 1; i < history.size(); ++i)
    EXPECT_GE(history[i], history[i - 1] - 1e-10 * std::abs(history[i])) << "step " << i;
}

TEST(NoiseEm, RecoversTheWeightOfClutter) {
  const auto observations = detections_with_clutter(6000, 3);
  RandomStream stream(1);
  const NoiseEmFit fit = fit_noise_components(observations, bounded(1), stream);
  EXPECT_EQ(fit.status, EmStatus::converged);
  EXPECT_EQ(fit.parameters, 7U);
  // Three standard errors of a share of 0.3 among 6000.
  EXPECT_NEAR(fit.noise.clutter().weight, 0.3, 0.018);
  const Vector6d sd = fit.noise.components()[0].covariance.diagonal().cwiseSqrt();
  // Four standard errors of a deviation from 4200 values: 4 / sqrt(2 4200).
  for (Eigen::Index i = 0; i < 6; ++i) EXPECT_NEAR(sd[i] / ray_deviations()[i], 1.0, 0.044) << i;
  EXPECT_NEAR(fit.log_likelihood, noise_log_density(fit.noise, observations).sum(), 1e-6);
  expect_never_falls(fit.history);
  // The truth is not more likely than the maximum.
  const DetectorNoise truth({{.weight = 0.7,
                              .covariance = ray_deviations().cwiseAbs2().asDiagonal(),
                              .frame = NoiseFrame::ray}},
                            {.weight = 0.3});
  EXPECT_GT(fit.log_likelihood, noise_log_density(truth, observations).sum());
}

TEST(NoiseEm, ClutterThatIsNotThereVanishes) {
  std::vector<NoiseObservation> observations;
  RandomStream stream(4);
  for (int i = 0; i < 2000; ++i) {
    const SE3d truth = pose_before_camera(stream);
    observations.push_back({truth, detect_along_ray(truth, ray_deviations(), stream)});
  }
  EXPECT_LT(fit_noise_components(observations, bounded(1), stream).noise.clutter().weight, 2e-3);
  NoiseEmSettings settings = bounded(2);
  settings.least_clutter = 0.05;
  const NoiseEmFit held = fit_noise_components(observations, settings, stream);
  EXPECT_NEAR(held.noise.clutter().weight, 0.05, 1e-12);
  EXPECT_NEAR(held.log_likelihood, noise_log_density(held.noise, observations).sum(), 1e-6);
  expect_never_falls(held.history);
}

TEST(NoiseEm, NeverLowersTheLikelihoodWithOffsetsToo) {
  RandomStream stream(5);
  auto observations = detections_with_clutter(1500, 6);
  const SE3d mode(SO3d::exp({0.0, 1.5, 0.2}), {0.02, 0.0, -0.03});
  for (int i = 0; i < 400; ++i) {
    const SE3d truth = pose_before_camera(stream);
    observations.push_back({truth, detect_along_ray(truth * mode, ray_deviations(), stream)});
  }
  for (const bool diagonal : {true, false}) {
    NoiseEmSettings settings = bounded(2);
    settings.em.diagonal = diagonal;
    const NoiseEmFit fit = refine_noise(
        observations,
        DetectorNoise({{.weight = 1.0, .covariance = Matrix6d(0.04 * Matrix6d::Identity())},
                       {.weight = 1.0,
                        .covariance = Matrix6d(0.04 * Matrix6d::Identity()),
                        .frame = NoiseFrame::ray,
                        .offset = SE3d(SO3d::exp({0.2, 1.3, 0.0}), Eigen::Vector3d::Zero())}},
                      {.weight = 0.5}),
        settings);
    EXPECT_EQ(fit.status, EmStatus::converged);
    EXPECT_GT(fit.history.size(), 10U);
    expect_never_falls(fit.history);
    const NoiseComponent& found = fit.noise.components()[1];
    EXPECT_EQ(found.frame, NoiseFrame::ray);
    EXPECT_EQ(fit.noise.components()[0].frame, NoiseFrame::object);
    // Standard errors of the mean of 400: at most 4 deg / 20 and 8 cm / 20.
    EXPECT_LT((found.offset.rotation().inverse() * mode.rotation()).log().norm(), radians(0.8));
    EXPECT_LT((found.offset.translation() - mode.translation()).norm(), 0.012);
  }
}

TEST(NoiseEm, RefusesTooFew) {
  RandomStream stream(1);
  EXPECT_EQ(testing::thrown_message(
                [&] { fit_noise_components(detections_with_clutter(3, 1), bounded(2), stream); }),
            "noise model: 3 observations for 2 components, expected two per component");
}

}  // namespace
}  // namespace posemix
