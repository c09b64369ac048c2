// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>
#include <numbers>

#include <gtest/gtest.h>

#include "posemix/slam/evaluation.hpp"
#include "posemix/testing/expect.hpp"
#include "simulation_samples.hpp"

namespace posemix {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace)

double share(const std::vector<bool>& marks) {
  return static_cast<double>(std::count(marks.begin(), marks.end(), true)) /
         static_cast<double>(marks.size());
}

/// Mean length of the runs of `true`.
double mean_run(const std::vector<bool>& marks) {
  std::size_t runs = 0;
  for (std::size_t k = 0; k < marks.size(); ++k) runs += marks[k] && (k == 0 || !marks[k - 1]);
  return share(marks) * static_cast<double>(marks.size()) / static_cast<double>(runs);
}

/// The frames whose error has an angle beyond half a turn.
std::vector<bool> turned(const std::vector<Vector6d>& errors) {
  std::vector<bool> marks;
  for (const Vector6d& error : errors) marks.push_back(error.head<3>().norm() > radians(90.0));
  return marks;
}

std::vector<bool> missed(const SimulatedObject& object) {
  std::vector<bool> marks;
  for (const auto& detection : object.detections) marks.push_back(!detection.has_value());
  return marks;
}

/// Share and mean run of a chain with the given runs, within kBound standard errors: over n frames
/// a share has variance f (1 - f) (1 + r) / ((1 - r) n), and a run, geometric, l (l - 1) per run.
void expect_runs(const std::vector<bool>& marks, const SimulationRuns& runs, double period_s) {
  const double f = runs.fraction;
  const double length = std::max(runs.mean_run_s / period_s, 1.0 / (1.0 - f));
  const double r = 1.0 - 1.0 / (length * (1.0 - f));
  const double n = static_cast<double>(marks.size());
  EXPECT_NEAR(share(marks), f, kBound * std::sqrt(f * (1.0 - f) * (1.0 + r) / ((1.0 - r) * n)));
  const double count = n * f / length;
  EXPECT_NEAR(mean_run(marks), length, kBound * std::sqrt(length * (length - 1.0) / count));
}

SimulationObject quiet_object() {
  return object_with({{1.0, sd_of(Vector3d::Constant(0.01), Vector3d::Constant(1e-5))}});
}

TEST(SimulationDisturbances, MissesComeWithTheirFrequencyAndRunLength) {
  for (const SimulationRuns runs : {SimulationRuns{0.2, 0.0}, SimulationRuns{0.3, 0.7}}) {
    SimulationObject object = quiet_object();
    object.misses = runs;
    const SimulatedSequence simulated = simulate(config_with({object}, 5 * kManyFrames), 21);
    expect_runs(missed(simulated.objects[0]), runs, 0.1);
  }
}

TEST(SimulationDisturbances, FlipsComeWithTheirFrequencyAndRunLength) {
  for (const SimulationRuns runs : {SimulationRuns{0.1, 0.0}, SimulationRuns{0.25, 0.5}}) {
    SimulationObject object = quiet_object();
    object.flips = {runs, Vector3d(0.0, std::numbers::pi, 0.0), Vector3d(0.01, 0.0, 0.0)};
    const SimulatedSequence simulated = simulate(config_with({object}, 5 * kManyFrames), 22);
    const std::vector<bool> marks = turned(errors_of(simulated));
    expect_runs(marks, runs, 0.1);
    const SE3d flip(SO3d::exp(object.flips.rotation_rad), object.flips.translation_m);
    const std::vector<Vector6d> from_flip = errors_of(simulated, flip);
    for (std::size_t k = 0; k < marks.size(); ++k) {
      if (!marks[k]) continue;
      ASSERT_LT(from_flip[k].norm(), 0.01);
    }
  }
}

TEST(SimulationDisturbances, OutliersAreOneWrongPosePerRunUniformInRotationAndBox) {
  const SimulationRuns runs{0.5, 0.6};
  SimulationObject object = quiet_object();
  object.outliers = {runs, Vector3d(0.1, 0.2, 0.4)};
  const SimulatedSequence simulated = simulate(config_with({object}, 10 * kManyFrames), 23);
  std::vector<bool> marks;
  std::vector<SE3d> wrong;
  SampleMoments positions(3);
  SampleMoments axes(1);
  const SimulatedObject& recorded = simulated.objects[0];
  for (std::size_t k = 0; k < recorded.detections.size(); ++k) {
    const SE3d error = recorded.relative_truth[k].pose().inverse() * recorded.detections[k]->pose();
    marks.push_back(error.log().norm() > 0.01);
    if (!marks.back()) continue;
    const bool starts = marks.size() == 1 || !marks[marks.size() - 2];
    if (starts) {
      wrong.push_back(error);
      positions.add(error.translation());
      axes.add(Eigen::VectorXd::Constant(1, error.rotation().matrix().trace()));
    } else {
      ASSERT_TRUE(error.is_approx(wrong.back(), 0.01));
    }
  }
  expect_runs(marks, runs, 0.1);
  const Vector3d variance = object.outliers.box_m.cwiseAbs2() / 3.0;
  EXPECT_LT(positions.worst_score(Vector3d::Zero(), variance.asDiagonal()), kBound);
  // Under the uniform distribution the trace, the character of SO(3), has mean 0 and variance 1.
  EXPECT_LT(axes.worst_score(Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Ones(1, 1)), kBound);
}

TEST(SimulationDisturbances, SharesOfNoneAndAllAreExact) {
  SimulationObject object = quiet_object();
  object.flips = {{1.0, 0.5}, Vector3d(std::numbers::pi, 0.0, 0.0), Vector3d::Zero()};
  object.misses = {0.0, 3.0};
  const SimulatedSequence flipped = simulate(config_with({object}, 500), 24);
  EXPECT_EQ(share(missed(flipped.objects[0])), 0.0);
  EXPECT_EQ(share(turned(errors_of(flipped))), 1.0);
  object.misses = {1.0, 0.0};
  EXPECT_EQ(share(missed(simulate(config_with({object}, 500), 24).objects[0])), 1.0);
}

TEST(SimulationDisturbances, DisturbancesLeaveTheOtherFramesAsTheyWere) {
  SimulationObject object = object_with({{1.0, small_sd()}, {0.5, small_sd()}});
  object.correlation_s = 0.4;
  const SimulatedSequence plain = simulate(config_with({object}, 400), 25);
  object.misses = {0.2, 0.5};
  object.flips = {{0.2, 0.5}, Vector3d(0.0, 0.0, 2.0), Vector3d::Zero()};
  object.outliers.runs = {0.2, 0.5};
  object.hidden_frames = 10;
  const SimulatedSequence disturbed = simulate(config_with({object}, 400), 25);
  std::size_t same = 0;
  for (std::size_t k = 0; k < 400; ++k) {
    const auto& detection = disturbed.objects[0].detections[k];
    same += detection && detection->billionths == plain.objects[0].detections[k]->billionths;
  }
  EXPECT_NEAR(static_cast<double>(same), 0.8 * 0.8 * 0.8 * 390.0, 60.0);
}

TEST(SimulationDisturbances, LateObjectIsAbsentBefore) {
  SimulationObject late = quiet_object();
  late.hidden_frames = 200;
  const Sequence sequence = simulate(config_with({late}, 300), 26).sequence();
  validate(sequence);
  for (std::size_t k = 0; k < 300; ++k) {
    EXPECT_EQ(sequence.objects[0].detections[k].has_value(), k >= 200) << "frame " << k;
    EXPECT_TRUE(sequence.objects[0].relative_truth[k].has_value());
  }
}

TEST(SimulationDisturbances, ClaimedNoiseHasAModeForTheFlips) {
  SimulationObject object = object_with({{3.0, small_sd()}, {1.0, small_sd()}});
  object.noise[1].offset_rotation_rad = Vector3d(0.0, 0.0, 0.5);
  EXPECT_EQ(object_model(object).noise.components().size(), 2U);
  object.flips = {{0.2, 1.0}, Vector3d(0.0, 0.0, 1.0), Vector3d(0.0, 0.1, 0.0)};
  const ObjectModel model = object_model(object);
  const std::vector<NoiseComponent>& components = model.noise.components();
  ASSERT_EQ(components.size(), 4U);
  const std::array<double, 4> weights{0.6, 0.2, 0.15, 0.05};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(components[i].weight, weights[i], 1e-12);
  const SE3d flip(SO3d::exp(Vector3d(0.0, 0.0, 1.0)), Vector3d(0.0, 0.1, 0.0));
  EXPECT_TRUE(components[2].offset.is_approx(flip, 1e-12));
  EXPECT_TRUE(components[3].offset.is_approx(flip * components[1].offset, 1e-12));
  EXPECT_EQ(components[3].covariance, covariance_of(small_sd()));
  object.claimed = {{1.0, sd_of(Vector3d::Ones(), Vector3d::Ones())}};
  EXPECT_EQ(object_model(object).noise.components().size(), 1U);
}

TEST(SimulationDisturbances, FilterToldTheTruthIsConsistent) {
  SimulationObject can = object_with({{1.0, small_sd()}}, "can");
  SimulationObject box = object_with({{1.0, small_sd()}}, "box");
  box.position_m.y() = 0.3;
  box.hidden_frames = 30;
  const SimulationConfig config = config_with({can, box}, 60);
  double anees = 0.0;
  constexpr std::uint64_t kRuns = 40;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    const SimulatedSequence simulated = simulate(config, seed);
    ObjectSlamSettings settings;
    settings.tracker = GaussianSumSettings{};
    settings.motion = motion_settings(config);
    const Sequence sequence = simulated.sequence();
    const SlamRun result = run(sequence, camera_prior(config, simulated),
                               {object_model(can), object_model(box)}, settings);
    const Metrics metrics = evaluate(sequence, result);
    for (const ObjectMetrics& object : metrics.objects) anees += *object.relative_anees;
  }
  // A run's errors are strongly correlated in time: about 6 degrees of freedom per object and run.
  const double objects = 2.0 * kRuns;
  const auto [low, high] = chi_square_band(6.0 * objects);
  EXPECT_GT(anees * 6.0, low);
  EXPECT_LT(anees * 6.0, high);
}

TEST(SimulationDisturbances, PosesAreRoundedToBillionthsWithAPositiveLastComponent) {
  SimulationObject object = quiet_object();
  object.position_m = Vector3d(0.1234567894, -0.1234567896, 0.0);
  object.rotation_rad = Vector3d(0.0, -std::numbers::pi, 0.0);
  const SimulatedPose pose = simulate(config_with({object}, 1), 1).objects[0].world_truth;
  EXPECT_EQ(pose.billionths,
            (std::array<std::int64_t, 7>{123456789, -123456790, 0, 0, 1000000000, 0, 0}));
  EXPECT_EQ(pose.pose().translation().x(), 0.123456789);
}

TEST(SimulationDisturbances, ImpossibleSettingsAreNamed) {
  const auto message_for = [](auto change) {
    SimulationConfig config = config_with({quiet_object()}, 10);
    change(config);
    return thrown_message([&] { simulate(config, 1); });
  };
  using C = SimulationConfig;
  const auto expect = [&](auto change, const std::string& part) {
    const std::string message = message_for(change);
    EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
  };
  expect([](C& c) { c.path.frames = 0; }, "path frames is 0, expected a number in [1, 1e+07]");
  expect([](C& c) { c.path.range.mean_m = 0.5; }, "smallest range, 0.4 m, must exceed");
  expect([](C& c) { c.odometry.rotation_rad.y() = -1.0; },
         "odometry standard deviation of rotation");
  expect([](C& c) { c.claimed_odometry = sd_of(-Vector3d::Ones(), Vector3d::Ones()); }, "claimed");
  expect([](C& c) { c.objects[0].id = ""; }, "an object has no id");
  expect([](C& c) { c.objects.push_back(c.objects[0]); }, "object id 'mug' occurs twice");
  expect([](C& c) { c.objects[0].noise.clear(); }, "'mug': there is no noise component");
  expect([](C& c) { c.objects[0].noise[0].weight = 0.0; }, "weight of noise is 0");
  expect([](C& c) { c.objects[0].misses.fraction = 1.5; }, "fraction of misses is 1.5");
  expect([](C& c) { c.objects[0].flips.runs.mean_run_s = -1.0; }, "mean run is -1");
  expect([](C& c) { c.objects[0].correlation_s = std::nan(""); }, "correlation time is nan");
  expect([](C& c) { c.objects[0].hidden_frames = 10; }, "is hidden for 10 of 10 frames");
}

}  // namespace
}  // namespace posemix
