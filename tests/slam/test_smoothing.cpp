// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/smoothing.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>

#include "posemix/slam/evaluation.hpp"
#include "simulation_samples.hpp"
#include "smoothing_scene.hpp"

namespace posemix {
namespace {

using testing::distance;
using testing::draw;
using testing::drawn_sequence;
using testing::isotropic;
using testing::kFrames;
using testing::kObjects;
using testing::kR;
using testing::kStart;
using testing::kStartCovariance;
using testing::models_with;
using testing::plain_slam_settings;
using testing::pose;

/// A small version of the prototype's simulation: correlated errors, gross errors in runs, flips.
SimulationConfig hard_config() {
  SimulationObject object = testing::object_with(
      {{.sd = testing::sd_of(Eigen::Vector3d::Constant(5.0), Eigen::Vector3d::Constant(0.01))}});
  object.correlation_s = 0.1;
  object.outliers.runs = {0.2, 0.8};
  object.flips = {
      {0.15, 0.5}, Eigen::Vector3d(0.0, 0.0, std::numbers::pi), Eigen::Vector3d::Zero()};
  SimulationConfig config = testing::config_with({object}, 200);
  return config;
}

TEST(Smoothing, IsBetterThanTheFilterOnDisturbedDetections) {
  double causal = 0.0;
  double smooth = 0.0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const SimulatedSequence simulated = simulate(hard_config(), seed);
    const Sequence sequence = simulated.sequence();
    ObjectSlamSettings settings;
    settings.motion = motion_settings(hard_config());
    const PoseDensity prior = camera_prior(hard_config(), simulated);
    const std::vector<ObjectModel> models{{"mug"}};
    const auto error = [&](const SlamRun& result) {
      const PoseErrors errors = evaluate(sequence, result).objects[0].relative;
      return std::log(*errors.rotation_rmse_deg) + std::log(*errors.position_rmse_m);
    };
    causal += error(run(sequence, prior, models, settings));
    smooth += error(run_smoothed(sequence, prior, models, settings, {}));
  }
  EXPECT_LT(smooth, causal - 12 * std::log(1.2));
}

/// Twenty equal wrong detections, then sixty right ones.
Sequence wrong_at_first() {
  RandomStream stream(9, 1);
  Sequence sequence;
  sequence.objects.push_back({"0", {}, {}, {}});
  SE3d camera = kStart;
  const SE3d turned = pose(0.0, 2.0, 0.0, 0.0, 0.0, 0.0);
  for (int k = 0; k < 80; ++k) {
    sequence.stamps.push_back(0.1 * k);
    sequence.odometry.emplace_back(kStart.inverse() * camera);
    sequence.camera_truth.emplace_back(camera);
    ObjectRecording& object = sequence.objects[0];
    object.world_truth.emplace_back(kObjects[0]);
    object.detections.emplace_back(camera.inverse() * kObjects[0] * (k < 20 ? turned : SE3d()) *
                                   SE3d::exp(draw(isotropic(2.0, 0.005), stream)));
    camera = camera * pose(0.004, 0.002, 0.0, 0.002, 0.0, 0.004);
  }
  return sequence;
}

constexpr double kRight = 0.1;  ///< 6 deg or 10 cm
constexpr double kWrong = 1.0;

TEST(Smoothing, TheModeOfTheEndHoldsFromTheBeginning) {
  const Sequence sequence = wrong_at_first();
  const PoseDensity prior(kStart, kStartCovariance);
  const std::vector<ObjectModel> models{{"0"}};
  const SlamRun causal = run(sequence, prior, models, {});
  const SlamRun smoothed =
      run_smoothed(sequence, prior, models, {}, {}, {.record_hypotheses = true, .progress = {}});
  EXPECT_GT(distance(causal.frames[5].objects[0]->mean(), kObjects[0]), kWrong);
  for (const FrameEstimate& frame : smoothed.frames) {
    EXPECT_LT(distance(frame.objects[0]->mean(), kObjects[0]), kRight);
    EXPECT_EQ(frame.mode_probabilities, causal.frames.back().mode_probabilities);
  }
  // The wrong one is among the alternatives, with its last weight.
  ASSERT_EQ(smoothed.hypotheses[0].size(), causal.hypotheses[0].size());
  const auto& first = smoothed.frames.front().alternatives[0];
  ASSERT_FALSE(first.empty());
  for (const ObjectAlternative& each : first) {
    EXPECT_LE(each.probability, 1.0);
    EXPECT_GE(each.probability, SmoothingSettings().least_probability);
  }
  EXPECT_TRUE(run_smoothed(sequence, prior, models, {}, {}).frames[0].alternatives.empty());
}

TEST(Smoothing, AlternativesAreSmoothedInPlaceOfTheLeadingMode) {
  // Right and wrong in turn: both hypotheses live.
  Sequence sequence = wrong_at_first();
  const SE3d turned = pose(0.0, 2.0, 0.0, 0.0, 0.0, 0.0);
  for (std::size_t k = 0; k < sequence.stamps.size(); ++k) {
    sequence.objects[0].detections[k] =
        sequence.camera_truth[k]->inverse() * kObjects[0] * (k % 2 == 0 ? turned : SE3d());
  }
  SmoothingSettings settings;
  settings.least_probability = 0.0;
  const SlamRun smoothed = run_smoothed(sequence, PoseDensity(kStart, kStartCovariance), {{"0"}},
                                        {}, settings, {.record_hypotheses = true, .progress = {}});
  for (const FrameEstimate& frame : smoothed.frames) {
    double right = kWrong;
    double wrong = kWrong;
    for (const ObjectAlternative& each : frame.alternatives[0]) {
      right = std::min(right, distance(each.pose, kObjects[0]));
      wrong = std::min(wrong, distance(each.pose, kObjects[0] * turned));
    }
    EXPECT_LT(right, kRight);
    EXPECT_LT(wrong, kRight);
  }
}

TEST(Smoothing, TakesObjectsOfKnownPose) {
  // Poses of objects drawn from their priors, and a camera of which little is known at first.
  const Matrix6d known = isotropic(0.2, 0.002);
  const Matrix6d start = isotropic(5.0, 0.1);
  double filtered = 0.0;
  double smoothed = 0.0;
  double nees = 0.0;
  constexpr int kRuns = 40;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    RandomStream stream(17, seed);
    const Sequence sequence = drawn_sequence(seed, 2);
    std::vector<ObjectModel> models = models_with(DetectorNoise({{1.0, kR}}), 2);
    for (std::size_t j = 0; j < 2; ++j) {
      const SE3d stated = SE3d::exp(draw(known, stream)) * kObjects[j];
      models[j].prior = {.world = PoseDensity(stated, known), .probability = 1.0};
    }
    const PoseDensity prior(SE3d::exp(draw(start, stream)) * *sequence.camera_truth[0], start);
    const SlamRun causal = run(sequence, prior, models, plain_slam_settings());
    const SlamRun smooth = run_smoothed(sequence, prior, models, plain_slam_settings(), {});
    // At the end both have the same data.
    EXPECT_LT(distance(causal.frames.back().camera.mean(), smooth.frames.back().camera.mean()),
              1e-3);
    EXPECT_NEAR(smooth.frames.back().camera.covariance().trace() /
                    causal.frames.back().camera.covariance().trace(),
                1.0, 0.02);
    const SE3d& truth = *sequence.camera_truth[0];
    filtered += distance(causal.frames[0].camera.mean(), truth);
    const PoseDensity& first = smooth.frames[0].camera;
    smoothed += distance(first.mean(), truth);
    const Vector6d error = (truth * first.mean().inverse()).log();
    nees += error.dot(first.covariance().llt().solve(error)) / 6.0 / kRuns;
  }
  EXPECT_LT(smoothed, 0.8 * filtered);
  // The mean of 240 squared normal deviates is within this band in 99.9 % of all cases.
  EXPECT_GT(nees, 0.72);
  EXPECT_LT(nees, 1.32);
}

TEST(Smoothing, APauseOfTwoPeakedObservationsIsOnOneOfThem) {
  // A known object turned by half a turn in every other answer; after 100 s nothing is known of the
  // camera, and between the peaks is a camera that saw nothing.
  const SE3d object = pose(0.0, 0.0, 0.0, 0.0, 0.0, 1.0);
  const SE3d flip = pose(0.0, 0.0, std::numbers::pi, 0.0, 0.0, 0.0);
  ObjectModel tag{
      .id = "tag",
      .noise = DetectorNoise({{1.0, isotropic(1.0, 0.01)}}, {.weight = 0.01, .volume_m3 = 1.0},
                             {.slow = std::nullopt})};
  tag.prior = {.world = PoseDensity(object, isotropic(1.0, 0.01)), .probability = 0.95};
  ObjectSlamSettings settings;
  settings.motion.model = MotionModel::constant_velocity;
  FixedLagSmoother smoother(PoseDensity(SE3d(), isotropic(0.1, 0.001)), {tag}, settings, {});
  RandomStream stream(3, 8);
  for (int k = 0; k < 18; ++k) {
    FrameInput input{.dt = k == 9 ? 100.0 : 0.1};
    for (int sighting = 0; sighting < 2; ++sighting) {
      Observation seen{.object = "tag"};
      for (const SE3d& mode : {object, object * flip}) {
        const SE3d shifted = pose(0.0, 0.0, 0.0, 0.01 * stream.normal(), 0.0, 0.0) * mode;
        seen.components.push_back({.weight = 0.5, .pose = shifted});
      }
      input.observations.push_back(seen);
    }
    smoother.step(input);
  }
  for (const FrameEstimate& frame : smoother.finish()) {
    const SE3d& camera = frame.camera.mean();
    EXPECT_LT(camera.translation().norm(), 0.05);
    const double turn = camera.rotation().log().norm();
    EXPECT_LT(std::min(turn, std::numbers::pi - turn), 0.1);
  }
}

TEST(Smoothing, RefusesACameraThatIsLost) {
  const PoseDensity lost(
      SE3d(), pose_covariance(Eigen::Vector3d::Constant(std::sqrt(kUniformRotationVariance)),
                              Eigen::Vector3d::Constant(10.0)));
  EXPECT_THROW(FixedLagSmoother(lost, models_with(default_detector_noise(), 1), {}, {}),
               InvalidInput);
}

TEST(FixedLag, AsLongAsTheRecordingIsFullSmoothing) {
  const Sequence sequence = drawn_sequence(3, 2);
  const PoseDensity prior(kStart, kStartCovariance);
  const auto models = models_with(default_detector_noise(), 2);
  const SlamRun full = run_smoothed(sequence, prior, models, {}, {});
  const SlamRun lag = run_smoothed(sequence, prior, models, {}, {.lag_frames = kFrames});
  for (std::size_t k = 0; k < kFrames; ++k) {
    EXPECT_EQ(full.frames[k].camera.mean().matrix(), lag.frames[k].camera.mean().matrix());
    EXPECT_EQ(full.frames[k].camera.covariance(), lag.frames[k].camera.covariance());
    EXPECT_EQ(full.frames[k].relative[0]->covariance(), lag.frames[k].relative[0]->covariance());
  }
}

TEST(FixedLag, ReportsEveryFrameOnceAndInTime) {
  const Sequence sequence = drawn_sequence(3, 2);
  const auto models = models_with(DetectorNoise({{1.0, kR}}), 2);
  FixedLagSmoother smoother(PoseDensity(kStart, kStartCovariance), models, plain_slam_settings(),
                            {.lag_frames = 5});
  std::vector<FrameEstimate> frames;
  for (std::size_t k = 0; k < kFrames; ++k) {
    const std::vector<std::optional<SE3d>> seen{sequence.objects[0].detections[k],
                                                sequence.objects[1].detections[k]};
    // The time and the motion before the first frame do not matter.
    auto frame = smoother.step({0.1, pose(0.02, 0.01, 0.0, 0.01, 0.0, 0.02), seen});
    ASSERT_EQ(frame.has_value(), k >= 5);
    if (frame) frames.push_back(*frame);
  }
  EXPECT_EQ(frames.size(), kFrames - 5);
  for (FrameEstimate& frame : smoother.finish()) frames.push_back(std::move(frame));
  EXPECT_TRUE(smoother.finish().empty());
  ASSERT_EQ(frames.size(), kFrames);
  for (std::size_t k = 0; k < kFrames; ++k) {
    EXPECT_LT(distance(frames[k].camera.mean(), *sequence.camera_truth[k]), 0.05) << k;
    EXPECT_EQ(frames[k].report.statuses[0],
              k == 0 ? DetectionStatus::started : DetectionStatus::used);
    EXPECT_EQ(frames[k].pose_indices[1].has_value(), k >= 4);
  }
}

TEST(FixedLag, LooksAheadJustSoFar) {
  // The right mode leads from some frame on, and is reported from one lag earlier on.
  const Sequence sequence = wrong_at_first();
  const PoseDensity prior(kStart, kStartCovariance);
  // The detector as it is, independent from frame to frame.
  const DetectorNoise noise({{.weight = 1.0, .covariance = isotropic(2.0, 0.005)}},
                            {.weight = 0.05});
  const std::vector<ObjectModel> models{{"0", noise}};
  const auto first_right = [](const SlamRun& result) {
    std::size_t k = 0;
    while (k < result.frames.size() &&
           distance(result.frames[k].objects[0]->mean(), kObjects[0]) > kRight)
      ++k;
    EXPECT_LT(k, result.frames.size());
    return k;
  };
  constexpr std::size_t kLag = 15;
  const std::size_t causal = first_right(run(sequence, prior, models, {}));
  ASSERT_GT(causal, 20U);
  EXPECT_LE(first_right(run_smoothed(sequence, prior, models, {}, {.lag_frames = kLag})),
            causal - kLag);
}

TEST(Smoothing, MotionWithoutOdometry) {
  // Steady motion: smoothing gains most at the start, where the velocity is unknown.
  Sequence sequence = drawn_sequence(4, 1);
  sequence.odometry.clear();
  const PoseDensity prior(kStart, kStartCovariance);
  const auto models = models_with(DetectorNoise({{1.0, kR}}), 1);
  for (const MotionModel model : {MotionModel::constant_velocity, MotionModel::random_walk}) {
    ObjectSlamSettings settings = plain_slam_settings();
    settings.motion.model = model;
    const auto error = [&](const SlamRun& result) {
      double sum = 0.0;
      for (std::size_t k = 0; k < kFrames; ++k)
        sum += std::pow(
            distance(result.frames[k].relative[0]->mean(), *true_relative_pose(sequence, 0, k)), 2);
      return sum;
    };
    const SlamRun causal = run(sequence, prior, models, settings);
    const SlamRun smoothed = run_smoothed(sequence, prior, models, settings, {});
    const SlamRun lagged = run_smoothed(sequence, prior, models, settings, {.lag_frames = 8});
    EXPECT_LT(error(smoothed), error(causal));
    EXPECT_LT(error(lagged), error(causal));
    for (const FrameEstimate& frame : smoothed.frames) {
      const Matrix6d p = frame.camera.covariance();
      EXPECT_GT(p.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
    }
  }
}

TEST(Smoothing, RefusesWhatItCannotSmooth) {
  const Sequence sequence = drawn_sequence(3, 1);
  const PoseDensity prior(kStart, kStartCovariance);
  const auto models = models_with(default_detector_noise(), 1);
  ObjectSlamSettings gaussian_sum;
  gaussian_sum.tracker = GaussianSumSettings{};
  EXPECT_THROW(run_smoothed(sequence, prior, models, gaussian_sum, {}), InvalidInput);
  ObjectSlamSettings considered;
  std::get<MultiObjectSlamSettings>(considered.tracker).filter.camera_gain = 0.0;
  EXPECT_THROW(run_smoothed(sequence, prior, models, considered, {}), InvalidInput);
  EXPECT_THROW(run_smoothed(sequence, prior, models, {}, {.passes = 0}), InvalidInput);
  EXPECT_THROW(run_smoothed(sequence, prior, {}, {}, {}), InvalidInput);
  FixedLagSmoother smoother(prior, models, {}, {.lag_frames = 3});
  smoother.step({.detections = {std::nullopt}});
  EXPECT_THROW(smoother.step({0.1, SE3d(), {std::nullopt}, {{"0", SE3d(), 1.0}}}), InvalidInput);
}

TEST(Smoothing, CanBeStopped) {
  const Sequence sequence = drawn_sequence(3, 1);
  const RunOptions options{.record_hypotheses = false,
                           .progress = [](std::size_t done, std::size_t) { return done < 7; }};
  const SlamRun stopped = run_smoothed(sequence, PoseDensity(kStart, kStartCovariance),
                                       models_with(default_detector_noise(), 1), {}, {}, options);
  EXPECT_EQ(stopped.frames.size(), 7U);
}

}  // namespace
}  // namespace posemix
