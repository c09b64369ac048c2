// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "filter/scenario.hpp"
#include "posemix/slam/evaluation.hpp"
#include "posemix/testing/expect.hpp"

/// Metrics of objects whose symmetries are declared.
namespace posemix {
namespace {

using testing::gaussian_noise;
using testing::isotropic;
using testing::pose;
using testing::thrown_message;

const SE3d kSymmetric = pose(0.4, -0.3, 0.2, 0.1, 0.2, 1.1);
const SE3d kFirstCamera = pose(0.1, 0.2, -0.1, 0.3, -0.2, 0.1);
constexpr std::size_t kMetricFrames = 40;

SE3d turn_about_z(double angle) {
  return SE3d(SO3d::exp(Eigen::Vector3d(0, 0, angle)), Eigen::Vector3d::Zero());
}

/// One object, detected with small errors; its truth is turned about its own z axis by `angle`
/// times the frame's number.
Sequence sequence_turned_by(double angle) {
  RandomStream stream(1);
  Sequence sequence;
  ObjectRecording object{"can", {}, {}, {}};
  SE3d camera = kFirstCamera;
  for (std::size_t k = 0; k < kMetricFrames; ++k) {
    Vector6d n;
    for (double& x : n) x = 0.01 * stream.normal();
    sequence.stamps.push_back(0.1 * static_cast<double>(k));
    sequence.camera_truth.emplace_back(camera);
    sequence.odometry.emplace_back(kFirstCamera.inverse() * camera);
    object.detections.emplace_back(camera.inverse() * kSymmetric * SE3d::exp(n));
    object.world_truth.emplace_back(kSymmetric * turn_about_z(angle * static_cast<double>(k)));
    camera = camera * pose(0.02, 0.01, 0.0, 0.01, 0.0, 0.02);
  }
  sequence.objects.push_back(object);
  return sequence;
}

SlamRun run_of(const Sequence& sequence) {
  ObjectSlamSettings settings;
  settings.tracker = GaussianSumSettings{};
  const PoseDensity prior(kFirstCamera, isotropic(0.5, 0.005));
  return run(sequence, prior, {{"can", gaussian_noise(), std::nullopt}}, settings);
}

ObjectMetrics metrics_of(double angle, const std::vector<SymmetryGroup>& symmetries) {
  const Sequence sequence = sequence_turned_by(angle);
  return evaluate(sequence, run_of(sequence), symmetries).objects[0];
}

TEST(SymmetricMetrics, TheTurnOfTheTruthAboutADeclaredAxisIsNoError) {
  const SymmetryGroup any_turn = SymmetryGroup::turns(Eigen::Vector3d::UnitZ(), 0);
  const ObjectMetrics still = metrics_of(0.0, {any_turn});
  const ObjectMetrics turned = metrics_of(0.7, {any_turn});
  const ObjectMetrics plain = metrics_of(0.7, {});
  EXPECT_GT(*plain.relative.rotation_rmse_deg, 60.0);
  EXPECT_LT(*plain.right_mode_share, 0.3);
  EXPECT_LT(*turned.relative.rotation_rmse_deg, 1.0);
  EXPECT_EQ(*turned.right_mode_share, 1.0);
  for (const auto errors :
       {&ObjectMetrics::world, &ObjectMetrics::relative, &ObjectMetrics::detection_relative}) {
    EXPECT_NEAR(*(turned.*errors).rotation_rmse_deg, *(still.*errors).rotation_rmse_deg, 1e-6);
    EXPECT_NEAR(*(turned.*errors).position_rmse_m, *(still.*errors).position_rmse_m, 1e-9);
  }
  EXPECT_NEAR(*turned.relative_anees, *still.relative_anees, 1e-4);
  EXPECT_NEAR(*turned.right_mode_anees, *still.right_mode_anees, 1e-4);
  EXPECT_NEAR(*turned.world_consistency.rotation_anees, *still.world_consistency.rotation_anees,
              1e-4);
  EXPECT_NEAR(*turned.relative_consistency.anees, *turned.relative_anees, 1e-9);
}

TEST(SymmetricMetrics, AnImageOfTheTruthIsTheTruth) {
  const ObjectMetrics turned =
      metrics_of(std::numbers::pi, {SymmetryGroup::turns(Eigen::Vector3d::UnitZ(), 2)});
  const ObjectMetrics still = metrics_of(0.0, {});
  EXPECT_NEAR(*turned.relative.rotation_rmse_deg, *still.relative.rotation_rmse_deg, 1e-9);
  EXPECT_NEAR(*turned.relative_anees, *still.relative_anees, 1e-9);
  EXPECT_EQ(*turned.right_mode_share, 1.0);
}

TEST(SymmetricMetrics, WithoutSymmetriesNothingChanges) {
  const ObjectMetrics none = metrics_of(0.01, {});
  const ObjectMetrics identity = metrics_of(0.01, {SymmetryGroup()});
  EXPECT_EQ(*none.relative_anees, *identity.relative_anees);
  EXPECT_EQ(*none.relative.rotation_rmse_deg, *identity.relative.rotation_rmse_deg);
  // The mean of e^T P^-1 e / 6 on the left is that along the axes of the estimate.
  EXPECT_NEAR(*none.relative_anees, *none.relative_consistency.anees, 1e-9);
}

TEST(SymmetricMetrics, AGroupPerObjectIsNeeded) {
  const Sequence sequence = sequence_turned_by(0.0);
  const std::vector<SymmetryGroup> two(2);
  EXPECT_EQ(thrown_message([&] { return evaluate(sequence, run_of(sequence), two); }),
            "evaluation: got the symmetries of 2 objects, expected 1");
}

/// A frame whose estimate T_camera_object is off by a turn [deg] about the object's z axis and by
/// millimetres along its x.
void set_frame(std::size_t k, std::optional<double> estimate, std::optional<double> detection,
               Sequence& sequence, SlamRun& run) {
  const SE3d truth = sequence.camera_truth[k]->inverse() * *sequence.objects[0].world_truth[k];
  const auto off = [&](double size) {
    return truth * SE3d(SO3d::exp({0, 0, radians(size)}), Eigen::Vector3d(1e-3 * size, 0, 0));
  };
  run.frames[k].relative[0].reset();
  sequence.objects[0].detections[k].reset();
  if (estimate) run.frames[k].relative[0] = PoseDensity(off(*estimate), isotropic(1.0, 0.01));
  if (detection) sequence.objects[0].detections[k] = off(*detection);
}

TEST(PairedMetrics, AreMediansOverTheFramesWithBoth) {
  Sequence sequence = sequence_turned_by(0.0);
  SlamRun run = run_of(sequence);
  for (std::size_t k = 0; k < kMetricFrames; ++k)
    set_frame(k, std::nullopt, std::nullopt, sequence, run);
  set_frame(3, 1.0, 2.0, sequence, run);
  set_frame(4, 7.0, 4.0, sequence, run);
  set_frame(5, 3.0, 100.0, sequence, run);  // a gross error moves no median
  set_frame(6, 50.0, std::nullopt, sequence, run);
  set_frame(7, std::nullopt, 60.0, sequence, run);
  set_frame(8, 5.0, 5.0, sequence, run);
  sequence.camera_truth[8].reset();
  const PairedErrors paired = evaluate(sequence, run).objects[0].paired;
  EXPECT_EQ(paired.frames, 3U);
  EXPECT_NEAR(*paired.estimate.rotation_deg, 3.0, 1e-9);
  EXPECT_NEAR(*paired.estimate.position_m, 0.003, 1e-12);
  EXPECT_NEAR(*paired.detection.rotation_deg, 4.0, 1e-9);
  EXPECT_NEAR(*paired.detection.position_m, 0.004, 1e-12);
  // About a declared axis a turn is no error.
  const std::vector<SymmetryGroup> any_turn{SymmetryGroup::turns(Eigen::Vector3d::UnitZ(), 0)};
  const PairedErrors free = evaluate(sequence, run, any_turn).objects[0].paired;
  EXPECT_NEAR(*free.estimate.rotation_deg, 0.0, 1e-6);
  EXPECT_NEAR(*free.detection.position_m, 0.004, 1e-12);
  for (std::size_t k = 3; k < 6; ++k) set_frame(k, 1.0, std::nullopt, sequence, run);
  const PairedErrors none = evaluate(sequence, run).objects[0].paired;
  EXPECT_EQ(none.frames, 0U);
  EXPECT_FALSE(none.estimate.rotation_deg || none.detection.position_m);
}

}  // namespace
}  // namespace posemix
