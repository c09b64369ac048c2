// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/odometry_noise.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/testing/expect.hpp"
#include "simulated_detections.hpp"

namespace posemix {
namespace {

using testing::normal_vector;

Vector6d walk_deviations() {
  Vector6d sd;
  sd << radians(0.2), radians(0.1), radians(0.3), 1e-3, 2e-3, 1.5e-3;
  return sd;
}

Vector6d jitter_deviations() {
  Vector6d sd;
  sd << radians(0.05), radians(0.1), radians(0.02), 1e-3, 5e-4, 2e-3;
  return sd;
}

/// A camera on a circle of 1 m that looks inwards, once around in a minute. The odometry adds
/// Exp(n) on the right of every step, the annotation Exp(w) on the right of every pose.
/// The noise of the odometry acts at a point that moves with the camera, `distance` m ahead; the
/// jitter of the annotation at one `jitter_distance` m ahead.
OdometryRecording simulated_odometry(std::size_t frames, double spikes, RandomStream& stream,
                                     double distance, double jitter_distance) {
  const auto at = [](double ahead, const Vector6d& noise) {
    const SE3d point(SO3d(), Eigen::Vector3d(0.0, 0.0, ahead));
    return point * SE3d::exp(noise) * point.inverse();
  };
  OdometryRecording recording{.name = "r", .stamps = {}, .odometry = {}, .camera_truth = {}};
  constexpr double kPeriod = 0.1;
  SE3d odometry;
  SE3d before;
  for (std::size_t i = 0; i < frames; ++i) {
    const double time = kPeriod * static_cast<double>(i);
    const double angle = radians(6.0) * time;
    const SE3d camera(SO3d::exp({0.0, angle, 0.0}), {-std::sin(angle), 0.0, -std::cos(angle)});
    if (i > 0) {
      const Vector6d n = std::sqrt(kPeriod) * normal_vector(stream).cwiseProduct(walk_deviations());
      odometry = odometry * (before.inverse() * camera) * at(distance, n);
    }
    before = camera;
    Vector6d w = normal_vector(stream).cwiseProduct(jitter_deviations());
    if (stream.uniform() < spikes) w *= 50.0;
    recording.stamps.push_back(time);
    recording.odometry.emplace_back(odometry);
    recording.camera_truth.emplace_back(camera * at(jitter_distance, w));
  }
  return recording;
}

std::vector<OdometryRecording> recordings(std::size_t count, double spikes, double distance = 0.0,
                                          double jitter_distance = 0.0) {
  RandomStream stream(5);
  std::vector<OdometryRecording> all;
  for (std::size_t r = 0; r < count; ++r)
    all.push_back(simulated_odometry(900, spikes, stream, distance, jitter_distance));
  return all;
}

TEST(OdometryNoise, RecoversWalkAndJitter) {
  const OdometryNoise noise = fit_odometry_noise(recordings(20, 0.0), {.bootstrap = 30});
  EXPECT_EQ(noise.recordings, 20U);
  ASSERT_EQ(noise.windows.size(), 10U);
  EXPECT_NEAR(noise.windows[9].seconds, 30.0, 0.01);
  for (Eigen::Index i = 0; i < 6; ++i) {
    // 20 recordings of 90 s; the windows with most information about q are the 3600 or so of half a
    // second.
    EXPECT_NEAR(noise.sd_per_sqrt_s[i] / walk_deviations()[i], 1.0, 0.12) << i;
    EXPECT_LT(noise.sd_per_sqrt_s_error[i], 0.1 * walk_deviations()[i]) << i;
    EXPECT_NEAR(noise.sd_per_sqrt_s[i], walk_deviations()[i], 4.5 * noise.sd_per_sqrt_s_error[i]);
    // If the walk of a single step, 0.1 s, is far above the jitter, the jitter is hard to estimate.
    const double step = std::sqrt(0.1) * walk_deviations()[i];
    EXPECT_NEAR(noise.jitter_sd[i], jitter_deviations()[i],
                0.1 * jitter_deviations()[i] + 0.1 * step)
        << i;
    for (const OdometryWindow& window : noise.windows)
      EXPECT_NEAR(std::sqrt(window.fitted[i] / window.variance[i]), 1.0, 0.3);
  }
}

TEST(OdometryNoise, RecoversTheDistanceOfTheScene) {
  for (const double distance : {0.0, 0.7, 2.0}) {
    // The jitter of the annotation acts at the camera.
    const OdometryNoise jittered =
        fit_odometry_noise(recordings(20, 0.0, distance), {.bootstrap = 30});
    EXPECT_NEAR(jittered.scene_distance_m, distance, 0.1) << distance;
    EXPECT_NEAR(jittered.scene_distance_m, distance,
                4.5 * jittered.scene_distance_error_m + 0.02 + 0.05 * distance);
    const OdometryNoise noise =
        fit_odometry_noise(recordings(20, 0.0, distance, distance), {.bootstrap = 0});
    for (Eigen::Index i = 0; i < 6; ++i)
      EXPECT_NEAR(noise.sd_per_sqrt_s[i] / walk_deviations()[i], 1.0, 0.15) << i;
    // At a distance that is not the scene's the translation has a part of the rotation.
    const OdometryNoise given = fit_odometry_noise(
        recordings(20, 0.0, distance), {.scene_distance_m = distance + 1.0, .bootstrap = 0});
    EXPECT_GT(given.sd_per_sqrt_s[4], 1.3 * walk_deviations()[4]);
    EXPECT_EQ(given.scene_distance_m, distance + 1.0);
  }
}

TEST(OdometryNoise, SpikesOfTheAnnotationDoNotCount) {
  const OdometryNoise noise = fit_odometry_noise(recordings(20, 0.02), {.bootstrap = 0});
  for (Eigen::Index i = 0; i < 6; ++i)
    EXPECT_NEAR(noise.sd_per_sqrt_s[i] / walk_deviations()[i], 1.0, 0.2) << i;
  EXPECT_TRUE(std::isnan(noise.jitter_sd_error[0]));
}

TEST(OdometryNoise, FramesWithoutAPoseAreSkipped) {
  auto all = recordings(20, 0.0);
  for (OdometryRecording& recording : all) {
    for (std::size_t i = 0; i < 900; i += 7) recording.odometry[i] = std::nullopt;
    for (std::size_t i = 3; i < 900; i += 11) recording.camera_truth[i] = std::nullopt;
  }
  const OdometryNoise noise = fit_odometry_noise(all, {.bootstrap = 0});
  for (Eigen::Index i = 0; i < 6; ++i)
    EXPECT_NEAR(noise.sd_per_sqrt_s[i] / walk_deviations()[i], 1.0, 0.15) << i;
  for (OdometryRecording& recording : all) {
    for (auto& pose : recording.camera_truth) pose = std::nullopt;
  }
  EXPECT_EQ(testing::thrown_message([&] { fit_odometry_noise(all, {}); }),
            "odometry noise: no recording has odometry with the camera's truth");
}

}  // namespace
}  // namespace posemix
