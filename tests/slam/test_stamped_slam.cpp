// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/stamped_slam.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "filter/scenario.hpp"
#include "posemix/slam/state.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::pose;

struct Odometry {
  double stamp_s;
  SE3d odom_body;
};
using Input = std::variant<Observation, Odometry>;

const PoseDensity kStampedStart(SE3d(), isotropic(0.1, 0.001));

/// A body that moves at constant speed, with odometry at 20 Hz and two objects whose two-peaked
/// observations come between, from two cameras.
std::vector<Input> recording(double seconds) {
  RandomStream stream(4, 1);
  const SE3d flip(SO3d::exp({0.0, 0.0, std::numbers::pi}), Eigen::Vector3d::Zero());
  const auto body_at = [](double t) {
    return SE3d::exp(t * (Vector6d() << 0.0, 0.1, 0.2, 0.1, 0.0, 0.05).finished());
  };
  std::vector<Input> inputs;
  for (int k = 0; k <= static_cast<int>(20 * seconds); ++k)
    inputs.emplace_back(Odometry{0.05 * k, body_at(0.05 * k)});
  for (int k = 0; k < static_cast<int>(14 * seconds); ++k) {
    const double t = 0.01 + 0.07 * k;
    if (t > seconds) break;
    for (const char* id : {"mug", "box"}) {
      const SE3d object = pose(0.2, 0.1, 0.4, id[0] == 'm' ? 0.3 : -0.2, 0.1, 1.0);
      const SE3d seen =
          body_at(t).inverse() * object * SE3d::exp(testing::draw(isotropic(1.0, 0.005), stream));
      Observation observation{.object = id, .stamp_s = t};
      observation.components = {{.weight = 0.6, .pose = seen},
                                {.weight = 0.4, .pose = seen * flip}};
      inputs.emplace_back(observation);
    }
  }
  return inputs;
}

double stamp_of_input(const Input& input) {
  if (const auto* observation = std::get_if<Observation>(&input)) return observation->stamp_s;
  return std::get<Odometry>(input).stamp_s;
}

StampAdmission give_to(StampedSlam& slam, const Input& input) {
  if (const auto* observation = std::get_if<Observation>(&input)) return slam.add(*observation);
  const auto& odometry = std::get<Odometry>(input);
  return slam.add_odometry(odometry.stamp_s, odometry.odom_body);
}

StampedSlam make_stamped(const StampedSlamSettings& stamped = {}) {
  return StampedSlam(kStampedStart, {{.id = "mug"}, {.id = "box"}}, {}, {}, stamped);
}

void expect_same(const EstimateAtStamp& a, const EstimateAtStamp& b) {
  EXPECT_EQ(a.stamp_s, b.stamp_s);
  EXPECT_EQ(a.estimate.camera.mean().matrix(), b.estimate.camera.mean().matrix());
  EXPECT_EQ(a.estimate.camera.covariance(), b.estimate.camera.covariance());
  ASSERT_EQ(a.estimate.objects.size(), b.estimate.objects.size());
  for (std::size_t j = 0; j < a.estimate.objects.size(); ++j) {
    ASSERT_EQ(a.estimate.objects[j].has_value(), b.estimate.objects[j].has_value());
    if (!a.estimate.objects[j]) continue;
    EXPECT_EQ(a.estimate.objects[j]->mean().matrix(), b.estimate.objects[j]->mean().matrix());
    EXPECT_EQ(a.estimate.objects[j]->covariance(), b.estimate.objects[j]->covariance());
    EXPECT_EQ(a.estimate.mode_probabilities[j], b.estimate.mode_probabilities[j]);
  }
}

std::vector<Input> sorted(std::vector<Input> inputs) {
  std::stable_sort(inputs.begin(), inputs.end(), [](const Input& a, const Input& b) {
    return stamp_of_input(a) < stamp_of_input(b);
  });
  return inputs;
}

TEST(StampedSlam, AnyOrderWithinTheHistoryGivesTheSameBits) {
  const std::vector<Input> inputs = sorted(recording(6.0));
  StampedSlam in_order = make_stamped();
  for (const Input& input : inputs) give_to(in_order, input);
  const EstimateAtStamp expected = in_order.finish().value();
  EXPECT_EQ(in_order.counts().replayed + in_order.counts().too_late, 0U);
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    // Every input comes up to 0.9 s late.
    RandomStream stream(seed, 2);
    std::vector<std::pair<double, Input>> arrivals;
    for (const Input& input : inputs)
      arrivals.emplace_back(stamp_of_input(input) + 0.9 * stream.uniform(), input);
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    StampedSlam late = make_stamped({.checkpoints = 1 + seed});
    for (std::size_t k = 0; k < arrivals.size(); ++k) {
      give_to(late, arrivals[k].second);
      if (k % (seed + 1) == 0) late.estimate();  // asking changes nothing
    }
    EXPECT_GT(late.counts().replayed, 100U);
    EXPECT_EQ(late.counts().too_late, 0U);
    expect_same(late.finish().value(), expected);
  }
}

TEST(StampedSlam, OlderInputIsRefusedAndCounted) {
  StampedSlam slam = make_stamped();
  for (const Input& input : sorted(recording(3.0))) give_to(slam, input);
  const EstimateAtStamp before = slam.estimate().value();
  Observation old = std::get<Observation>(recording(1.0).back());
  old.stamp_s = 1.5;
  EXPECT_EQ(slam.add(old), StampAdmission::too_late);
  EXPECT_EQ(slam.add_odometry(1.51, SE3d()), StampAdmission::too_late);
  EXPECT_EQ(slam.counts().too_late, 2U);
  expect_same(slam.estimate().value(), before);
}

TEST(StampedSlam, AStampThatJumpsBackIsAnErrorOrAReset) {
  for (const StampJump choice : {StampJump::refuse, StampJump::reset}) {
    StampedSlam slam = make_stamped({.jump_back_s = 2.0, .on_jump_back = choice});
    for (const Input& input : sorted(recording(4.0))) give_to(slam, input);
    const EstimateAtStamp before = slam.estimate().value();
    if (choice == StampJump::refuse) {
      EXPECT_THROW(slam.add_odometry(0.5, SE3d()), InvalidInput);
      expect_same(slam.estimate().value(), before);
      continue;
    }
    StampedSlam fresh = make_stamped();
    for (const Input& input : sorted(recording(1.0))) {
      give_to(slam, input);
      give_to(fresh, input);
    }
    EXPECT_EQ(slam.counts().resets, 1U);
    expect_same(slam.finish().value(), fresh.finish().value());
  }
}

TEST(StampedSlam, ObservationsWaitForOdometryAndAreAppliedAtTheirTime) {
  StampedSlam slam = make_stamped();
  const auto body_at = [](double t) { return pose(0, 0, 0, 0.2 * t, 0, 0); };
  slam.add_odometry(0.0, body_at(0.0));
  Observation seen{.object = "mug", .stamp_s = 0.25};
  const SE3d mug = pose(0.1, 0, 0, 0, 0, 1);
  seen.components = {{.pose = body_at(0.25).inverse() * mug}};
  slam.add(seen);
  EXPECT_EQ(slam.waiting(), 1U);
  EXPECT_FALSE(slam.estimate()->estimate.object("mug").world.has_value());
  slam.add_odometry(0.5, body_at(0.5));
  EXPECT_EQ(slam.waiting(), 0U);
  const EstimateAtStamp now = slam.estimate().value();
  EXPECT_EQ(now.stamp_s, 0.5);
  EXPECT_LT((now.estimate.object("mug").world->mean().inverse() * mug).log().norm(), 1e-9);
}

TEST(StampedSlam, WithoutOdometryForLongObservationsAreFramesOfUnknownMotion) {
  StampedSlam slam = make_stamped({.history_s = 0.5});
  slam.add_odometry(0.0, SE3d());
  for (int k = 1; k <= 20; ++k) {
    Observation seen{.object = "mug", .stamp_s = 0.1 * k};
    seen.components = {{.pose = pose(0.1, 0, 0, 0, 0, 1)}};
    slam.add(seen);
  }
  EXPECT_NEAR(slam.estimate()->stamp_s, 0.9, 1e-9);
  EXPECT_NEAR(slam.finish()->stamp_s, 2.0, 1e-9);
}

TEST(StampedSlam, ObservationsOfOneStampAreTakenInAFixedOrder) {
  const std::vector<Input> inputs = recording(0.5);
  std::vector<Observation> at_once;
  for (const Input& input : inputs) {
    if (const auto* observation = std::get_if<Observation>(&input)) {
      at_once.push_back(*observation);
      at_once.back().stamp_s = 0.25;
    }
  }
  StampedSlam forwards = make_stamped();
  StampedSlam backwards = make_stamped();
  for (StampedSlam* slam : {&forwards, &backwards}) slam->add_odometry(0.0, SE3d());
  for (const Observation& observation : at_once) forwards.add(observation);
  std::reverse(at_once.begin(), at_once.end());
  for (const Observation& observation : at_once) backwards.add(observation);
  for (StampedSlam* slam : {&forwards, &backwards}) slam->add_odometry(0.5, SE3d());
  expect_same(forwards.estimate().value(), backwards.estimate().value());
}

TEST(StampedSlam, RefusesWhatIsNotValidAndChangesNothing) {
  StampedSlam slam = make_stamped();
  for (const Input& input : sorted(recording(1.0))) give_to(slam, input);
  const EstimateAtStamp before = slam.estimate().value();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Observation seen{.object = "mug", .stamp_s = 1.0};
  EXPECT_THROW(slam.add(seen), InvalidInput);  // no components
  seen.components = {{.pose = SE3d()}};
  Observation unknown = seen;
  unknown.object = "cup";
  EXPECT_THROW(slam.add(unknown), InvalidInput);
  Observation nowhere = seen;
  nowhere.stamp_s = nan;
  EXPECT_THROW(slam.add(nowhere), InvalidInput);
  Observation future = seen;
  future.stamp_s = 1e6;
  EXPECT_THROW(slam.add(future), InvalidInput);
  EXPECT_THROW(slam.add_odometry(nan, SE3d()), InvalidInput);
  EXPECT_THROW(slam.add_odometry(1.0, SE3d()), InvalidInput);  // there is one already
  EXPECT_THROW(slam.add_odometry(1.1, SE3d(SO3d(), {nan, 0, 0})), InvalidInput);
  // With which no frame after it could be computed.
  EXPECT_THROW(slam.add_odometry(1.1, SE3d(SO3d(), {1e160, 0, 0})), InvalidInput);
  expect_same(slam.estimate().value(), before);
  EXPECT_THROW(make_stamped({.history_s = -1.0}), InvalidInput);
  EXPECT_THROW(make_stamped({.history_s = 5.0, .jump_back_s = 1.0}), InvalidInput);
  EXPECT_THROW(make_stamped({.checkpoints = 0}), InvalidInput);
  StampedSlam walk(kStampedStart, {{.id = "mug"}}, {}, {.model = MotionModel::random_walk});
  EXPECT_THROW(walk.add_odometry(0.0, SE3d()), InvalidInput);
}

/// A pose of which double precision holds nothing is refused where it is given: behind it, no frame
/// could be computed any more. One that is only far away is taken.
TEST(StampedSlam, AGivenPoseFarAwayEndsNoSession) {
  MotionSettings motion{.model = MotionModel::given};
  motion.noise = {isotropic(0.1, 0.001), NoisePer::frame};
  StampedSlam slam(kStampedStart, {{.id = "mug"}}, {}, motion);
  const auto see = [&](double stamp, const SE3d& body) {
    slam.add_odometry(stamp, body);
    Observation seen{.object = "mug", .stamp_s = stamp};
    seen.components = {{.pose = pose(0, 0, 0, 0, 0, 1)}};
    slam.add(seen);
    return slam.estimate()->estimate.object("mug").world->mean().translation();
  };
  see(0.0, SE3d());
  const SE3d nothing(SO3d(), {0.0, 2.4e7, 0.0});
  EXPECT_THROW(slam.add_odometry(0.1, nothing), InvalidInput);
  const Eigen::Vector3d near = see(0.1, SE3d());
  EXPECT_LT((near - Eigen::Vector3d(0.0, 0.0, 1.0)).norm(), 0.05);
  see(0.2, SE3d(SO3d(), {0.0, 2e4, 0.0}));
  for (int k = 3; k < 30; ++k) EXPECT_TRUE(see(0.1 * k, SE3d()).allFinite());

  // A frame that is refused changes nothing.
  MultiObjectSlam frames(kStampedStart, {{.id = "mug"}}, {}, motion);
  FrameInput input{.dt = 0.0, .detections = {pose(0, 0, 0, 0, 0, 1)}};
  input.camera = SE3d();
  frames.step(input);
  const std::string before = state_bytes(frames);
  input.dt = 0.1;
  input.camera = nothing;
  EXPECT_THROW(frames.step(input), InvalidInput);
  EXPECT_EQ(state_bytes(frames), before);
}

TEST(StampedSlam, WithoutAnOdometryModelEveryObservationIsAppliedAtOnce) {
  StampedSlam slam(kStampedStart, {{.id = "mug"}}, {}, {.model = MotionModel::random_walk});
  EXPECT_FALSE(slam.estimate().has_value());
  Observation seen{.object = "mug", .stamp_s = 3.0};
  seen.components = {{.pose = pose(0, 0, 0, 0, 0, 1)}};
  slam.add(seen);
  EXPECT_EQ(slam.estimate()->stamp_s, 3.0);
  EXPECT_TRUE(slam.estimate()->estimate.object("mug").world.has_value());
}

TEST(StampedSlam, AnObjectThatMovesIsPredictedOverAnyTime) {
  ObjectModel mug{.id = "mug"};
  mug.motion = calm_and_agile();
  StampedSlam slam(PoseDensity(SE3d(), 1e-8 * Matrix6d::Identity()), {mug}, {},
                   {.model = MotionModel::still});
  Observation seen = observation_of(SE3d(SO3d(), {0.0, 0.0, 1.0}));
  seen.object = "mug";
  slam.add(seen);
  slam.estimate();
  for (const double later : {10.0, 3500.0, 1e6})
    EXPECT_TRUE(slam.slam().object_at(0, later).has_value()) << later;
}

TEST(StampedSlam, AnImageWithoutDetectionsTellsThatAnObjectIsLost) {
  StampedSlam slam(PoseDensity(SE3d(), 1e-8 * Matrix6d::Identity()), {{.id = "mug"}}, {},
                   {.model = MotionModel::random_walk});
  Observation seen = observation_of(SE3d(SO3d(), {0.0, 0.0, 1.0}));
  seen.object = "mug";
  for (int k = 0; k < 20; ++k) {
    seen.stamp_s = k;
    slam.add(seen);
  }
  EXPECT_NE(slam.estimate()->estimate.object("mug").health, TrackHealth::lost);
  for (int k = 20; k < 40; ++k) EXPECT_EQ(slam.add_image(k), StampAdmission::taken);
  EXPECT_EQ(slam.estimate()->estimate.object("mug").health, TrackHealth::lost);
  EXPECT_TRUE(slam.estimate()->estimate.object("mug").register_again);
  EXPECT_EQ(slam.add_image(38.5), StampAdmission::replayed);
}

/// A detector that is far too sure, or a camera that was lost for an hour, does not stop a session.
TEST(StampedSlam, GoesOnWhereTheCameraIsKnownFarWorseThanADetection) {
  for (const double variance : {1e-12, 1e-18, 1e-40}) {
    for (const double gap_s : {1.0, 3500.0}) {
      StampedSlam slam(kStampedStart, {{.id = "mug"}}, {}, {.model = MotionModel::random_walk});
      Observation seen = observation_of(SE3d(SO3d(), {0.0, 0.0, 1.0}));
      seen.object = "mug";
      for (int k = 0; k < 12; ++k) {
        seen.stamp_s = k + (k < 6 ? 0.0 : gap_s);
        seen.components[0].covariance.reset();
        if (k % 3 == 0) seen.components[0].covariance = variance * Matrix6d::Identity();
        slam.add(seen);
        ASSERT_NO_THROW(slam.estimate()) << variance << ' ' << gap_s << ' ' << k;
      }
      const auto& mug = slam.estimate()->estimate.objects[0];
      ASSERT_TRUE(mug.has_value());
      EXPECT_TRUE(mug->covariance().allFinite());
      EXPECT_EQ(slam.estimate()->stamp_s, seen.stamp_s);
    }
  }
}

}  // namespace
}  // namespace posemix
