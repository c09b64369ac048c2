// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/method.hpp"
#include "posemix/slam/run.hpp"

#include <gtest/gtest.h>

#include <array>

#include "filter/scenario.hpp"
#include "posemix/slam/evaluation.hpp"

namespace posemix {
namespace {

using testing::draw;
using testing::gaussian_noise;
using testing::isotropic;
using testing::pose;

const SE3d kParticleStart = pose(0.1, 0.2, -0.1, 0.3, -0.2, 0.1);
const PoseDensity kPrior(kParticleStart, isotropic(0.5, 0.005));
const SE3d kParticleMug = pose(0.4, -0.3, 0.2, 0.1, 0.2, 1.1);
const SE3d kBox = pose(-0.2, 0.5, 0.7, -0.3, 0.1, 0.9);

/// Frames of one object with detector errors that follow the model.
Sequence sequence_of(std::size_t frames, const SE3d& object = kParticleMug, std::uint64_t seed = 1,
                     const Matrix6d& errors = isotropic(4.0, 0.01)) {
  RandomStream stream(seed);
  Sequence sequence;
  ObjectRecording recording{"mug", {}, {}, {}};
  SE3d camera = kParticleStart;
  for (std::size_t k = 0; k < frames; ++k) {
    sequence.stamps.push_back(0.1 * static_cast<double>(k));
    sequence.camera_truth.emplace_back(camera);
    sequence.odometry.emplace_back(kParticleStart.inverse() * camera);
    recording.detections.emplace_back(camera.inverse() * object * SE3d::exp(draw(errors, stream)));
    recording.world_truth.emplace_back(object);
    camera = camera * pose(0.02, 0.01, 0.0, 0.01, 0.0, 0.02);
  }
  sequence.objects.push_back(recording);
  return sequence;
}

ObjectModel model(DetectorNoise noise, const std::string& id = "mug") {
  return {id, std::move(noise), std::nullopt};
}

SlamRun run_particles(const Sequence& sequence, const DetectorNoise& noise,
                      const ParticleFilterSettings& settings = {},
                      const MotionSettings& motion = {}) {
  return run(sequence, kPrior, {model(noise)}, {.motion = motion, .tracker = settings});
}

double rotation_error(const SlamRun& run, std::size_t frame, const SE3d& truth) {
  return degrees(
      (run.frames[frame].objects[0]->mean().rotation() * truth.rotation().inverse()).log().norm());
}

void expect_close(const PoseDensity& estimate, const PoseDensity& expected, double mean_error) {
  const Vector6d sd = expected.covariance().diagonal().cwiseSqrt();
  const Vector6d e = (estimate.mean() * expected.mean().inverse()).log();
  EXPECT_LT(e.cwiseAbs().cwiseQuotient(sd).maxCoeff(), mean_error);
  const Vector6d ratio =
      estimate.covariance().diagonal().cwiseQuotient(expected.covariance().diagonal());
  EXPECT_GT(ratio.minCoeff(), 0.85);
  EXPECT_LT(ratio.maxCoeff(), 1.15);
}

TEST(ParticleFilter, OneGaussianIsTheInvariantEkf) {
  // Small errors, so that the problem is linear. After three detections of weight one the effective
  // sample size is (5 / 9)^3 of the particles, about 1300: standard errors of 0.03 standard
  // deviations for means and 0.04 for variances, of which four are allowed.
  const DetectorNoise noise = gaussian_noise(1.0, 0.01);
  const Sequence sequence = sequence_of(3, kParticleMug, 1, isotropic(1.0, 0.01));
  ParticleFilterSettings settings;
  settings.particles = 8000;
  settings.resample_below = 0.0;
  settings.object_walk.covariance.setZero();
  MotionSettings motion;
  motion.noise = {isotropic(0.1, 0.002), NoisePer::frame};
  const SlamRun particles = run_particles(sequence, noise, settings, motion);
  const SlamMethod& riekf = find_slam_method("riekf");
  const SlamRun ekf = run(sequence, kPrior, riekf.models({model(noise)}), riekf.settings(motion));
  for (std::size_t k = 0; k < 3; ++k) {
    expect_close(particles.frames[k].camera, ekf.frames[k].camera, 0.12);
    expect_close(*particles.frames[k].objects[0], *ekf.frames[k].objects[0], 0.12);
    expect_close(*particles.frames[k].relative[0], *ekf.frames[k].relative[0], 0.12);
  }
}

TEST(ParticleFilter, TheSameSeedGivesTheSameRun) {
  const Sequence sequence = sequence_of(12);
  const DetectorNoise noise({{0.8, isotropic(4.0, 0.01)}}, {.weight = 0.2});
  ParticleFilterSettings settings;
  settings.particles = 100;
  const SlamRun first = run_particles(sequence, noise, settings);
  const SlamRun second = run_particles(sequence, noise, settings);
  settings.seed = 2;
  const SlamRun other = run_particles(sequence, noise, settings);
  for (std::size_t k = 0; k < sequence.stamps.size(); ++k) {
    const auto matrix = [k](const SlamRun& run) { return run.frames[k].camera.mean().matrix(); };
    EXPECT_EQ(matrix(first), matrix(second));
    EXPECT_NE(matrix(first), matrix(other));
    EXPECT_EQ(first.frames[k].relative[0]->covariance(),
              second.frames[k].relative[0]->covariance());
  }
  ASSERT_EQ(first.posterior.size(), second.posterior.size());
  for (std::size_t i = 0; i < first.posterior.size(); ++i) {
    EXPECT_EQ(first.posterior[i].log_weight, second.posterior[i].log_weight);
    EXPECT_EQ(first.posterior[i].density.mean()[1].matrix(),
              second.posterior[i].density.mean()[1].matrix());
  }
}

TEST(ParticleFilter, TracksThroughGrossErrorsByClutter) {
  Sequence sequence = sequence_of(60);
  for (std::size_t k = 20; k < 30; ++k)
    sequence.objects[0].detections[k] =
        *sequence.objects[0].detections[k] * pose(2.0, 0.0, 0.0, 0.3, 0.0, 0.0);
  const DetectorNoise robust({{0.8, isotropic(4.0, 0.01)}}, {.weight = 0.2});
  const SlamRun with_clutter = run_particles(sequence, robust);
  EXPECT_LT(rotation_error(with_clutter, 29, kParticleMug), 6.0);
  EXPECT_LT(rotation_error(with_clutter, 59, kParticleMug), 6.0);
  EXPECT_EQ(with_clutter.frames[25].report.statuses[0], DetectionStatus::used);
  const Metrics metrics = evaluate(sequence, with_clutter);
  EXPECT_LT(*metrics.camera.position_rmse_m, 0.05);
}

TEST(ParticleFilter, AWrongFirstDetectionIsLeftByTheParticlesThatWaited) {
  Sequence sequence = sequence_of(40);
  sequence.objects[0].detections[0] =
      *sequence.objects[0].detections[0] * pose(0.0, 2.5, 0.0, 0.0, 0.0, 0.0);
  const DetectorNoise robust({{0.8, isotropic(4.0, 0.01)}}, {.weight = 0.2});
  const SlamRun waited = run_particles(sequence, robust);
  EXPECT_EQ(waited.frames[0].report.statuses[0], DetectionStatus::started);
  EXPECT_GT(rotation_error(waited, 0, kParticleMug), 90.0);
  EXPECT_LT(rotation_error(waited, 39, kParticleMug), 6.0);
}

TEST(ParticleFilter, SeveralObjectsEnterAsTheyAreSeen) {
  Sequence sequence = sequence_of(20);
  Sequence second = sequence_of(20, kBox, 2);
  second.objects[0].id = "box";
  for (std::size_t k = 0; k < 8; ++k) second.objects[0].detections[k].reset();
  sequence.objects.push_back(second.objects[0]);
  const DetectorNoise noise = gaussian_noise();
  const RunOptions options{.record_hypotheses = true, .progress = {}};
  ParticleFilterSettings settings;
  settings.hypotheses = 5;
  const SlamRun result =
      run(sequence, kPrior, {model(noise), model(noise, "box")}, {.tracker = settings}, options);
  EXPECT_FALSE(result.frames[7].objects[1].has_value());
  EXPECT_EQ(result.frames[8].report.statuses[1], DetectionStatus::started);
  ASSERT_TRUE(result.frames[19].objects[1].has_value());
  EXPECT_EQ(result.pose_indices, (std::vector<std::optional<std::size_t>>{1, 2}));
  EXPECT_EQ(result.posterior.size(), 5U);
  EXPECT_EQ(result.posterior[0].density.mean().size(), 3U);
  EXPECT_EQ(result.frames[19].hypotheses.size(), 5U);
  EXPECT_LT(*evaluate(sequence, result).objects[1].world.rotation_rmse_deg, 8.0);
}

TEST(ParticleFilter, RunsWithoutDetectionsOdometryAndWithConstantVelocity) {
  const DetectorNoise noise = gaussian_noise();
  Sequence empty = sequence_of(4);
  for (auto& detection : empty.objects[0].detections) detection.reset();
  const SlamRun nothing = run_particles(empty, noise);
  EXPECT_FALSE(nothing.pose_indices[0].has_value());
  EXPECT_TRUE(nothing.frames[3].camera.mean().is_approx(*empty.camera_truth[3], 1e-9));
  Sequence blind = sequence_of(30);
  blind.odometry.clear();
  for (const MotionModel model : {MotionModel::random_walk, MotionModel::constant_velocity}) {
    MotionSettings motion;
    motion.model = model;
    motion.noise.covariance = isotropic(10.0, 0.1);
    const SlamRun result = run_particles(blind, noise, {}, motion);
    const std::size_t first = model == MotionModel::constant_velocity ? 2 : 1;
    EXPECT_EQ(result.pose_indices[0], first);
    EXPECT_EQ(result.posterior[0].density.mean().size(), first + 1);
    EXPECT_LT(*evaluate(blind, result).objects[0].relative.rotation_rmse_deg, 8.0);
  }
}

TEST(ParticleFilter, AnIndependentStartIsDrawnFromItsOwnCovariance) {
  // Off by half a metre in the world, which the detector's noise alone would not explain.
  ObjectModel start = model(gaussian_noise());
  start.independent_start = isotropic(0.5, 0.2);
  const SlamRun result =
      run(sequence_of(1), kPrior, {start}, {.tracker = ParticleFilterSettings{}});
  const Vector6d sd = result.frames[0].objects[0]->covariance().diagonal().cwiseSqrt();
  // 300 draws: standard error of a standard deviation 4 %.
  for (int i = 3; i < 6; ++i) EXPECT_NEAR(sd[i], 0.2, 0.04);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(degrees(sd[i]), 0.5, 0.1);
}

TEST(ParticleFilter, ProgressStopsAndSettingsAreChecked) {
  const Sequence sequence = sequence_of(6);
  RunOptions options;
  options.progress = [](std::size_t done, std::size_t) { return done < 3; };
  const std::vector<ObjectModel> models{model(gaussian_noise())};
  const ObjectSlamSettings particles{.tracker = ParticleFilterSettings{}};
  EXPECT_EQ(run(sequence, kPrior, models, particles, options).frames.size(), 3U);
  const auto refused = [&](const ParticleFilterSettings& settings) {
    EXPECT_THROW(run(sequence, kPrior, models, {.tracker = settings}), InvalidInput);
  };
  refused({.particles = 0});
  refused({.resample_below = 1.5});
  refused({.kernel = Matrix6d::Zero()});
  refused({.hypotheses = 0});
  EXPECT_THROW(run(sequence, kPrior, {}, particles), InvalidInput);
  ParticleSlam slam(kPrior, models);
  EXPECT_THROW(slam.step({.detections = {{}}, .candidates = {{"mug", SE3d(), 1.0}}}), InvalidInput);
}

}  // namespace
}  // namespace posemix
