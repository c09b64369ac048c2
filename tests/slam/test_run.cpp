// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <functional>

#include "filter/scenario.hpp"
#include "posemix/slam/evaluation.hpp"
#include "posemix/slam/method.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::gaussian_noise;
using testing::heavy_tailed_noise;
using testing::isotropic;
using testing::pose;
using testing::thrown_message;

const SE3d kRunObject = pose(0.4, -0.3, 0.2, 0.1, 0.2, 1.1);
const SE3d kRunStart = pose(0.1, 0.2, -0.1, 0.3, -0.2, 0.1);
const PoseDensity kRunPrior(kRunStart, isotropic(0.5, 0.005));

/// Five frames of one object, complete and without errors.
Sequence perfect_sequence() {
  Sequence sequence;
  ObjectRecording object{"mug", {}, {}, {}};
  SE3d camera = kRunStart;
  for (int k = 0; k < 5; ++k) {
    sequence.stamps.push_back(0.1 * k);
    sequence.camera_truth.emplace_back(camera);
    sequence.odometry.emplace_back(kRunStart.inverse() * camera);
    object.detections.emplace_back(camera.inverse() * kRunObject);
    object.world_truth.emplace_back(kRunObject);
    camera = camera * pose(0.02, 0.01, 0.0, 0.01, 0.0, 0.02);
  }
  sequence.objects.push_back(object);
  return sequence;
}

SlamRun run_default(const Sequence& sequence, const RunOptions& options = {}) {
  ObjectSlamSettings settings;
  settings.tracker = GaussianSumSettings{};
  return run(sequence, kRunPrior, {{"mug", gaussian_noise(), std::nullopt}}, settings, options);
}

TEST(Run, PerfectInputGivesPerfectOutput) {
  const Sequence sequence = perfect_sequence();
  const SlamRun result = run_default(sequence);
  ASSERT_EQ(result.frames.size(), 5U);
  const Metrics metrics = evaluate(sequence, result);
  EXPECT_LT(*metrics.camera.position_rmse_m, 1e-12);
  EXPECT_LT(*metrics.objects[0].relative.rotation_rmse_deg, 1e-10);
  EXPECT_LT(*metrics.objects[0].world.position_log_rmse_m, 1e-12);
  EXPECT_EQ(metrics.objects[0].detections, 5U);
  EXPECT_LT(*metrics.objects[0].relative_anees, 1e-12);
}

TEST(Run, OdometryNeedsBothEndsOfAStep) {
  Sequence sequence = perfect_sequence();
  sequence.odometry[2].reset();
  const SlamRun result = run_default(sequence);
  const auto sd = [&](std::size_t k) {
    return std::sqrt(result.frames[k].camera.covariance()(0, 0));
  };
  // Steps 1->2 and 2->3 are unknown motion: the camera gets less certain there than with odometry.
  const SlamRun with_odometry = run_default(perfect_sequence());
  EXPECT_GT(sd(2), std::sqrt(with_odometry.frames[2].camera.covariance()(0, 0)));
  EXPECT_GT(sd(3), std::sqrt(with_odometry.frames[3].camera.covariance()(0, 0)));
}

TEST(Run, ProgressCountsFramesAndCanStop) {
  std::vector<std::size_t> seen;
  RunOptions options;
  options.record_hypotheses = true;
  options.progress = [&](std::size_t done, std::size_t all) {
    EXPECT_EQ(all, 5U);
    seen.push_back(done);
    return done < 3;
  };
  const SlamRun result = run_default(perfect_sequence(), options);
  EXPECT_EQ(seen, (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(result.frames.size(), 3U);
  EXPECT_EQ(result.frames[1].hypotheses.size(), 1U);
  EXPECT_EQ(run_default(perfect_sequence()).frames[1].hypotheses.size(), 0U);
}

TEST(Run, RiekfHasOneHypothesisAndTheSecondMomentOfTheNoise) {
  const SlamMethod& riekf = find_slam_method("riekf");
  const auto models = riekf.models({{"mug", heavy_tailed_noise(), std::nullopt}});
  EXPECT_EQ(models[0].noise.components().size(), 1U);
  const double variance = models[0].noise.components()[0].covariance(2, 2);
  EXPECT_NEAR(variance, 0.7 * std::pow(radians(4), 2) + 0.3 * std::pow(radians(12), 2), 1e-12);
  const SlamRun result = run(perfect_sequence(), kRunPrior, models, riekf.settings());
  EXPECT_EQ(result.posterior.size(), 1U);
}

TEST(Run, RefusesASequenceThatIsNotOne) {
  const auto expect_refused = [](const std::function<void(Sequence&)>& damage) {
    Sequence sequence = perfect_sequence();
    damage(sequence);
    EXPECT_THROW(run_default(sequence), InvalidInput);
  };
  expect_refused([](Sequence& s) { s.stamps.clear(); });
  expect_refused([](Sequence& s) { s.stamps[3] = s.stamps[2]; });
  expect_refused([](Sequence& s) { s.stamps[3] = std::numeric_limits<double>::quiet_NaN(); });
  expect_refused([](Sequence& s) { s.odometry.pop_back(); });
  expect_refused([](Sequence& s) { s.camera_truth.pop_back(); });
  expect_refused([](Sequence& s) { s.objects[0].detections.pop_back(); });
  expect_refused([](Sequence& s) { s.objects[0].world_truth.pop_back(); });
  expect_refused([](Sequence& s) { s.objects[0].relative_truth.resize(2); });
  expect_refused([](Sequence& s) { s.objects.push_back(s.objects[0]); });
  EXPECT_THROW(run(perfect_sequence(), kRunPrior, {}, {}), InvalidInput);
}

TEST(Run, RefusesModelsOfOtherObjects) {
  Sequence sequence = perfect_sequence();
  sequence.objects.push_back(sequence.objects[0]);
  sequence.objects[1].id = "box";
  const std::vector<ObjectModel> swapped{{"mug", gaussian_noise()}, {"cup", gaussian_noise()}};
  const char* message = "object model 1 is 'cup', but recorded object 1 is 'box'";
  EXPECT_EQ(thrown_message([&] { return run(sequence, kRunPrior, swapped, {}); }), message);
  EXPECT_EQ(thrown_message([&] { return run_smoothed(sequence, kRunPrior, swapped, {}, {}); }),
            message);
}

TEST(Evaluate, RefusesARunThatIsNotOfTheSequence) {
  const Sequence sequence = perfect_sequence();
  SlamRun result = run_default(sequence);
  Sequence shorter = sequence;
  shorter.stamps.resize(3);
  EXPECT_EQ(thrown_message([&] { return evaluate(shorter, result); }),
            "the run has 5 frames, the sequence 3");
  Sequence more = sequence;
  more.objects.push_back(more.objects[0]);
  EXPECT_EQ(thrown_message([&] { return evaluate(more, result); }),
            "the run has 1 objects, expected 2");
  result.frames.clear();
  EXPECT_EQ(thrown_message([&] { return evaluate(sequence, result); }), "the run has no frame");
}

TEST(Evaluate, ErrorsAreThoseOfAKnownDisplacement) {
  // Truth displaced by a known motion of the world: camera error by hand, relative error zero.
  Sequence sequence = perfect_sequence();
  const SlamRun result = run_default(sequence);
  const SE3d shift = pose(0.0, 0.0, radians(3.0), 0.02, 0.0, 0.0);
  for (auto& truth : sequence.camera_truth) truth = shift * *truth;
  for (auto& truth : sequence.objects[0].world_truth) truth = shift * *truth;
  const Metrics metrics = evaluate(sequence, result);
  EXPECT_NEAR(*metrics.camera.rotation_rmse_deg, 3.0, 1e-9);
  EXPECT_NEAR(*metrics.objects[0].world.rotation_rmse_deg, 3.0, 1e-9);
  // Log(T_est T_true^-1) = Log(shift^-1) at every frame.
  EXPECT_NEAR(*metrics.camera.position_log_rmse_m, shift.inverse().log().tail<3>().norm(), 1e-9);
  double squared = 0.0;
  for (const FrameEstimate& frame : result.frames) {
    const SE3d& estimate = frame.camera.mean();
    squared += ((shift * estimate).translation() - estimate.translation()).squaredNorm() / 5.0;
  }
  EXPECT_NEAR(*metrics.camera.position_rmse_m, std::sqrt(squared), 1e-9);
  EXPECT_LT(*metrics.objects[0].relative.rotation_rmse_deg, 1e-9);
}

TEST(Evaluate, RelativeAneesIsTheSquaredErrorOverTheVariance) {
  Sequence sequence = perfect_sequence();
  const SlamRun result = run_default(sequence);
  // Truth displaced along one axis of the camera by two standard deviations, scaled by
  // correlation-free P^-1.
  double expected = 0.0;
  for (std::size_t k = 0; k < 5; ++k) {
    const PoseDensity& relative = *result.frames[k].relative[0];
    Vector6d error = Vector6d::Zero();
    error(3) = 0.01;
    sequence.objects[0].relative_truth.emplace_back(SE3d::exp(error) * relative.mean());
    expected += error.dot(relative.covariance().inverse() * error) / 30.0;
  }
  EXPECT_NEAR(*evaluate(sequence, result).objects[0].relative_anees, expected, 1e-6 * expected);
}

TEST(Evaluate, IsEmptyWithoutTruth) {
  Sequence sequence = perfect_sequence();
  sequence.camera_truth.clear();
  sequence.objects[0].world_truth.clear();
  const Metrics metrics = evaluate(sequence, run_default(sequence));
  EXPECT_FALSE(metrics.camera.position_rmse_m.has_value());
  EXPECT_FALSE(metrics.objects[0].relative.rotation_rmse_deg.has_value());
  EXPECT_FALSE(metrics.objects[0].detection_relative.position_rmse_m.has_value());
  EXPECT_FALSE(metrics.objects[0].relative_anees.has_value());
}

TEST(Evaluate, RelativeTruthAndCameraGiveTheWorldPose) {
  Sequence sequence = perfect_sequence();
  ObjectRecording& object = sequence.objects[0];
  object.world_truth.clear();
  for (const auto& camera : sequence.camera_truth)
    object.relative_truth.emplace_back(camera->inverse() * kRunObject);
  object.relative_truth[2].reset();
  EXPECT_TRUE(true_world_pose(sequence, 0, 1)->is_approx(kRunObject, 1e-12));
  EXPECT_FALSE(true_world_pose(sequence, 0, 2).has_value());
  EXPECT_FALSE(true_relative_pose(sequence, 0, 2).has_value());
}

}  // namespace
}  // namespace posemix
