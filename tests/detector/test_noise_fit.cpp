// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_fit.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "posemix/testing/expect.hpp"
#include "simulated_slow_errors.hpp"

namespace posemix {
namespace {

using testing::detections_with_clutter;
using testing::normal_vector;
using testing::pose_before_camera;
using testing::ray_deviations;
using testing::recordings_with_modes;
using testing::thrown_message;

std::vector<NoiseTrack> recordings_with_clutter() {
  std::vector<NoiseTrack> tracks;
  for (std::size_t recording = 0; recording < 3; ++recording) {
    NoiseTrack& track = tracks.emplace_back();
    for (NoiseObservation each : detections_with_clutter(500, 20 + recording)) {
      each.recording = recording;
      track.emplace_back(each);
    }
  }
  return tracks;
}

TEST(NoiseTrack, LeavesOutFramesWithoutATruth) {
  const SE3d pose(SO3d(), {0.0, 0.0, 1.0});
  const std::vector<std::optional<SE3d>> truth{pose, std::nullopt, pose};
  const std::vector<std::optional<SE3d>> detected{std::nullopt, pose, pose};
  const NoiseTrack track = noise_track(truth, detected, 5);
  ASSERT_EQ(track.size(), 2U);
  EXPECT_FALSE(track[0].has_value());
  EXPECT_EQ(track[1]->recording, 5U);
  EXPECT_EQ(observations_of(std::vector<NoiseTrack>{track, track}).size(), 2U);
  EXPECT_EQ(thrown_message([&] { noise_track(truth, std::span(detected).first(2)); }),
            "noise model: 3 true poses and 2 detections, expected as many");
}

TEST(NoiseTrack, HasStampsAndThePathOfTheView) {
  const auto turned = [](double degree) {
    return SE3d(SO3d::exp({0.0, radians(degree), 0.0}), {0.0, 0.0, 1.0});
  };
  const std::vector<std::optional<SE3d>> truth{turned(0.0), turned(20.0), std::nullopt,
                                               turned(-10.0)};
  const std::vector<std::optional<SE3d>> detected{truth[0], std::nullopt, std::nullopt, truth[3]};
  const std::vector<double> stamps{1.0, 1.5, 2.0, 4.0};
  const NoiseTrack track = noise_track(truth, detected, 0, stamps);
  ASSERT_EQ(track.size(), 3U);
  EXPECT_EQ(track[2]->stamp_s, 4.0);
  EXPECT_EQ(track[0]->view_path_rad, 0.0);
  EXPECT_NEAR(track[2]->view_path_rad, radians(50.0), 1e-12);
  EXPECT_NEAR(seconds_per_frame(std::vector<NoiseTrack>{track}), 1.5, 1e-12);
  EXPECT_EQ(thrown_message([&] { noise_track(truth, detected, 0, std::span(stamps).first(2)); }),
            "noise model: 2 stamps of 4 frames, expected as many");
  const std::vector<double> back{1.0, 2.0, 1.5, 4.0};
  EXPECT_EQ(
      thrown_message([&] { noise_track(truth, detected, 0, back); }),
      "noise model: the stamp 1.5 s of frame 2 follows 2 s, expected an order in which stamps "
      "do not decrease");
}

TEST(NoiseFit, FindsFrameComponentsClutterAndModes) {
  RandomStream stream(1);
  const NoiseFit fit =
      fit_noise(recordings_with_modes(), {.max_components = 1, .restarts = 2}, stream);
  EXPECT_EQ(fit.frame, NoiseFrame::ray);
  const auto& components = fit.noise.components();
  ASSERT_EQ(components.size(), 2U);
  EXPECT_NEAR(components[0].weight, 0.7 * 2200.0 / 2400.0, 0.03);
  for (Eigen::Index i = 0; i < 6; ++i) {
    // Four standard errors of a deviation from 1540 values.
    EXPECT_NEAR(std::sqrt(components[0].covariance(i, i)) / ray_deviations()[i], 1.0, 0.072) << i;
  }
  EXPECT_NEAR(components[1].weight, 0.15 * 2200.0 / 2400.0, 0.025);
  EXPECT_NEAR(degrees(components[1].offset.rotation().log().norm()), 90.0, 1.0);
  ASSERT_EQ(fit.modes.size(), 2U);
  for (const NoiseMode& mode : fit.modes)
    EXPECT_EQ(mode.accepted, std::abs(degrees(mode.offset.rotation().angle()) - 90.0) < 2.0);
  EXPECT_EQ(fit.chosen, fit.fits.size() - 1);
  EXPECT_EQ(fit.bic, fit.fits[fit.chosen].bic);
  EXPECT_NEAR(fit.log_likelihood,
              noise_log_density(fit.noise, observations_of(recordings_with_modes())).sum(), 1e-6);
}

/// Errors n + x + c with a first-order process x, x' = 0.8 x + ..., once a second, white n of half
/// its standard deviation, and c constant per recording with as much.
TEST(NoiseFit, FillsTheDependence) {
  constexpr double kA = 0.8;
  RandomStream stream(3);
  std::vector<NoiseTrack> tracks;
  for (std::size_t recording = 0; recording < 30; ++recording) {
    const Vector6d common = 0.5 * normal_vector(stream);
    Vector6d x = normal_vector(stream);
    NoiseTrack& track = tracks.emplace_back();
    for (int i = 0; i < 300; ++i) {
      x = kA * x + std::sqrt(1.0 - kA * kA) * normal_vector(stream);
      const SE3d truth = pose_before_camera(stream);
      const Vector6d error = common + x + 0.5 * normal_vector(stream);
      track.push_back(NoiseObservation{.truth = truth,
                                       .detected = truth * SE3d::exp(Vector6d(0.02 * error)),
                                       .recording = recording,
                                       .stamp_s = static_cast<double>(i)});
    }
  }
  const NoiseFitSettings settings{.max_components = 1,
                                  .restarts = 1,
                                  .frame = NoiseFrame::object,
                                  .clutter = false,
                                  .modes = false};
  const NoiseFit fit = fit_noise(tracks, settings, stream);
  const NoiseDependence& dependence = fit.noise.dependence();
  ASSERT_TRUE(dependence.slow.has_value());
  ASSERT_TRUE(dependence.common.has_value());
  EXPECT_EQ(fit.slow_error.models[fit.slow_error.chosen].decay, SlowErrorDecay::time);
  EXPECT_NEAR(dependence.slow->correlation_time_s, -1.0 / std::log(kA), 0.4);
  for (Eigen::Index i = 0; i < 6; ++i) {
    EXPECT_NEAR(std::sqrt(fit.noise.components()[0].covariance(i, i)) / 0.01, 1.0, 0.1) << i;
    EXPECT_NEAR(std::sqrt(dependence.slow->covariance(i, i)) / 0.02, 1.0, 0.1) << i;
    // Standard error of a deviation from 30 values: 1 / sqrt(60).
    EXPECT_NEAR(std::sqrt((*dependence.common)(i, i)) / 0.01, 1.0, 0.4) << i;
  }
  EXPECT_TRUE(dependence.common->isDiagonal(0.0));
  EXPECT_NEAR(fit.noise.clutter().weight, settings.least_clutter, 1e-12);
}

/// Recordings with runs of clutter: a filter uses the model as it is.
TEST(NoiseFit, MeasuresRunsOfGrossErrors) {
  testing::SlowSimulation simulation{.white_sd = Vector6d::Constant(0.02),
                                     .slow_sd = Vector6d::Constant(0.04),
                                     .angle_rad = 1.0,
                                     .gross = 0.02,
                                     .gross_frames = 10.0};
  simulation.frames = 300;
  RandomStream stream(1);
  const NoiseFit fit =
      fit_noise(testing::slow_recordings(simulation, 8),
                {.max_components = 2, .restarts = 2, .frame = NoiseFrame::object}, stream);
  ASSERT_TRUE(fit.noise.dependence().slow.has_value());
  // An indicator that leaves one state after 50 frames and the other after 10 has a correlation of
  // exp(-k (1 / 50 + 1 / 10)) over k frames, so that about 2 / 0.12 frames of 0.5 s count as one.
  EXPECT_NEAR(fit.noise.dependence().mode_time_s, 8.3, 4.0);
  EXPECT_NEAR(fit.noise.clutter().weight, 10.0 / 60.0, 0.06);
  EXPECT_EQ(fit.noise.components()[0].run_length, 1.0);
  for (std::size_t i = 1; i < fit.noise.components().size(); ++i)
    EXPECT_EQ(fit.noise.components()[i].run_length, fit.correlation.outlier.within);
}

TEST(NoiseFit, ChoosesByCrossValidation) {
  RandomStream stream(1);
  const std::vector<NoiseTrack> tracks = recordings_with_clutter();
  const NoiseFit fit = fit_noise(tracks,
                                 {.max_components = 2,
                                  .restarts = 1,
                                  .modes = false,
                                  .criterion = NoiseCriterion::cross_validation,
                                  .folds = 3},
                                 stream);
  EXPECT_EQ(fit.frame, NoiseFrame::ray);
  ASSERT_EQ(fit.validation.size(), 12U);
  double best = -1e300;
  for (const NoiseValidation& row : fit.validation) {
    const bool right = row.frame == NoiseFrame::ray && row.clutter;
    EXPECT_EQ(row.below_best < 0.05, right);
    if (right && row.components == fit.chosen + 1) best = row.log_density;
  }
  for (const NoiseValidation& row : fit.validation) {
    if (row.clutter) {
      EXPECT_GE(best, row.log_density);
    }
  }
}

TEST(NoiseFit, IsTheSameForTheSameStream) {
  const std::vector<NoiseTrack> tracks = recordings_with_clutter();
  RandomStream first(3);
  RandomStream second(3);
  const NoiseFitSettings settings{.max_components = 2, .restarts = 3, .frame = NoiseFrame::ray};
  EXPECT_EQ(fit_noise(tracks, settings, first).log_likelihood,
            fit_noise(tracks, settings, second).log_likelihood);
}

TEST(NoiseFit, RefusesSettingsThatContradictEachOther) {
  RandomStream stream(1);
  const std::vector<NoiseTrack> tracks = recordings_with_clutter();
  const auto message = [&](const NoiseFitSettings& settings) {
    return thrown_message([&] { fit_noise(tracks, settings, stream); });
  };
  EXPECT_EQ(message({.max_components = 0}), "noise model: 0 components, expected one or more");
  EXPECT_NE(message({.free_means = true}).find("that fits best"), std::string::npos);
  EXPECT_NE(message({.frame = NoiseFrame::object, .free_means = true}).find("beside clutter"),
            std::string::npos);
  EXPECT_NE(message({.clutter = false}).find("modes without clutter"), std::string::npos);
  EXPECT_EQ(message({.criterion = NoiseCriterion::cross_validation}),
            "noise model: cross validation with 0 folds, expected two or more");
  EXPECT_EQ(thrown_message([&] { fit_noise({}, {}, stream); }),
            "noise model: 0 observations for 1 component, expected two per component");
}

}  // namespace
}  // namespace posemix
