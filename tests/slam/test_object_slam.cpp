// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "filter/scenario.hpp"
#include "posemix/slam/object_slam.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::gaussian_noise;
using testing::isotropic;
using testing::pose;
using testing::thrown_message;

const ConcentratedGaussian<SE3d> kStartPrior(pose(0.1, 0.2, -0.1, 0.3, -0.2, 0.1),
                                             isotropic(0.5, 0.005));
const SE3d kStill = pose(0.4, -0.3, 0.2, 0.1, 0.2, 1.1);

ObjectModel gaussian_model(const std::string& id) { return {id, gaussian_noise(), std::nullopt}; }

/// Uses the Gaussian-sum filter, whose results are known exactly; the code around it is the same
/// for both filters.
ObjectSlam make_slam(ObjectSlamSettings settings = {}) {
  settings.tracker = GaussianSumSettings{};
  return ObjectSlam(kStartPrior, {gaussian_model("a"), gaussian_model("b")}, settings);
}

/// A frame of which nothing but detections is given, as the first one may be.
FrameInput detected(std::vector<std::optional<SE3d>> detections) {
  return {.detections = std::move(detections)};
}

std::optional<SE3d> seen_from(const SE3d& camera = kStartPrior.mean()) {
  return camera.inverse() * kStill;
}

TEST(ObjectSlamTest, FramesWithNothingAreValid) {
  ObjectSlam slam = make_slam();
  const FrameReport first = slam.step(detected({std::nullopt, std::nullopt})).report;
  EXPECT_EQ(first.statuses, std::vector(2, DetectionStatus::none));
  EXPECT_EQ(slam.estimate().mean().size(), 1U);
  slam.step({0.1, std::nullopt, {std::nullopt, std::nullopt}});
  EXPECT_TRUE(slam.estimate().mean()[kCamera].is_approx(kStartPrior.mean(), 1e-12));
  EXPECT_FALSE(slam.pose_index(0).has_value());
}

TEST(ObjectSlamTest, ObjectsEnterInTheOrderSeenAndAtAnyFrame) {
  ObjectSlam slam = make_slam();
  slam.step(detected({std::nullopt, std::nullopt}));
  EXPECT_EQ(slam.step({0.1, SE3d(), {std::nullopt, seen_from()}}).report.statuses[1],
            DetectionStatus::started);
  EXPECT_EQ(slam.pose_index(1), std::optional<std::size_t>(1));
  const FrameReport report = slam.step({0.1, SE3d(), {seen_from(), seen_from()}}).report;
  EXPECT_EQ(report.statuses[0], DetectionStatus::started);
  EXPECT_EQ(report.statuses[1], DetectionStatus::used);
  EXPECT_EQ(slam.pose_index(0), std::optional<std::size_t>(2));
  EXPECT_EQ(slam.estimate().mean().size(), 3U);
}

TEST(ObjectSlamTest, MissingOdometryIsARandomWalkOfTheUnknownMotion) {
  ObjectSlamSettings settings;
  settings.motion.unknown_motion = {isotropic(10.0, 0.1), NoisePer::second};
  ObjectSlam known = make_slam(settings);
  ObjectSlam unknown = make_slam(settings);
  for (ObjectSlam* slam : {&known, &unknown}) slam->step(detected({std::nullopt, std::nullopt}));
  known.step({0.5, SE3d(), {std::nullopt, std::nullopt}});
  unknown.step({0.5, std::nullopt, {std::nullopt, std::nullopt}});
  const Matrix6d added = unknown.estimate().covariance() - kStartPrior.covariance();
  EXPECT_TRUE(
      added.isApprox(kStartPrior.mean().adjoint_congruence(0.5 * isotropic(10.0, 0.1)), 1e-9));
  EXPECT_LT(known.estimate().covariance()(0, 0), unknown.estimate().covariance()(0, 0));
}

TEST(ObjectSlamTest, IndependentStartKeepsTheGivenCovarianceAndNoCrossTerms) {
  ObjectModel independent = gaussian_model("a");
  independent.independent_start = isotropic(4.0, 0.1);
  ObjectSlamSettings settings;
  settings.tracker = GaussianSumSettings{};
  ObjectSlam slam(kStartPrior, {independent}, settings);
  slam.step(detected({seen_from()}));
  const Eigen::MatrixXd p = slam.estimate().covariance();
  EXPECT_TRUE(p.bottomRightCorner(6, 6).isApprox(isotropic(4.0, 0.1), 1e-14));
  EXPECT_EQ(p.topRightCorner(6, 6).cwiseAbs().maxCoeff(), 0.0);
}

TEST(ObjectSlamTest, ConstantVelocityKeepsTheMotionInTheState) {
  ObjectSlamSettings settings;
  settings.motion.model = MotionModel::constant_velocity;
  ObjectSlam slam = make_slam(settings);
  slam.step(detected({seen_from(), std::nullopt}));
  EXPECT_EQ(slam.estimate().mean().size(), 3U);
  EXPECT_EQ(slam.pose_index(0), std::optional<std::size_t>(2));
  SE3d camera = kStartPrior.mean();
  const SE3d motion = pose(0.01, 0.0, -0.01, 0.01, 0.0, 0.0);
  for (int frame = 0; frame < 80; ++frame) {
    camera = camera * motion;
    slam.step({0.1, std::nullopt, {seen_from(camera), std::nullopt}});
  }
  EXPECT_LT((slam.estimate().mean()[kMotion] * motion.inverse()).log().norm(), 2e-3);
}

TEST(ObjectSlamTest, TheDefaultIsTheMultiObjectFilterAndSaysWhatBecameOfDetections) {
  ObjectSlam slam(kStartPrior, {{.id = "a"}, {.id = "b"}}, {});
  ASSERT_NE(slam.multi_object(), nullptr);
  EXPECT_EQ(slam.step(detected({seen_from(), std::nullopt})).report.statuses,
            (std::vector{DetectionStatus::started, DetectionStatus::none}));
  EXPECT_EQ(slam.step({0.1, SE3d(), {seen_from(), std::nullopt}}).report.statuses[0],
            DetectionStatus::used);
  const std::optional<SE3d> flipped = *seen_from() * pose(0, 3.0, 0, 0, 0, 0);
  EXPECT_EQ(slam.step({0.1, SE3d(), {flipped, std::nullopt}}).report.statuses[0],
            DetectionStatus::birth);
  for (int i = 0; i < 5; ++i) slam.step({0.1, SE3d(), {seen_from(), std::nullopt}});
  EXPECT_EQ(slam.step({0.1, SE3d(), {flipped, std::nullopt}}).report.statuses[0],
            DetectionStatus::doubted);
  EXPECT_EQ(slam.pose_index(0), std::optional<std::size_t>(1));
  EXPECT_FALSE(slam.pose_index(1).has_value());
  EXPECT_EQ(slam.multi_object()->hypotheses(0).size(), 2U);
  EXPECT_EQ(slam.posterior().size(), 1U);
  // Without odometry for a frame the camera is as uncertain as the unknown motion.
  const double known = slam.estimate().covariance()(0, 0);
  slam.step({0.1, std::nullopt, {std::nullopt, std::nullopt}});
  EXPECT_GT(slam.estimate().covariance()(0, 0),
            known + 0.9 * MotionSettings().unknown_motion.over(0.1)(0, 0));
}

TEST(ObjectSlamTest, AnIndependentStartIsRefusedByTheMultiObjectFilter) {
  ObjectModel independent = gaussian_model("a");
  independent.independent_start = isotropic(4.0, 0.1);
  EXPECT_THROW(ObjectSlam(kStartPrior, {independent}, {}), InvalidInput);
}

TEST(ObjectSlamTest, TimeAndMotionBeforeTheFirstFrameDoNotMatter) {
  ObjectSlam bare = make_slam();
  ObjectSlam told = make_slam();
  bare.step(detected({seen_from(), std::nullopt}));
  told.step({-1.0, pose(0.1, 0.2, 0.3, 1.0, 2.0, 3.0), {seen_from(), std::nullopt}});
  EXPECT_EQ(bare.estimate().mean()[kCamera].matrix(), told.estimate().mean()[kCamera].matrix());
  EXPECT_EQ(bare.estimate().covariance(), told.estimate().covariance());
}

TEST(ObjectSlamTest, AStepGivesObjectsByIndexAndById) {
  ObjectSlam slam(kStartPrior, {gaussian_model("mug"), gaussian_model("box")},
                  {.record_hypotheses = true});
  const FrameEstimate estimate = slam.step(detected({std::nullopt, seen_from()}));
  EXPECT_EQ(estimate.index_of("box"), 1U);
  const ObjectEstimate box = estimate.object("box");
  ASSERT_TRUE(box.world.has_value());
  EXPECT_TRUE(box.world->mean().is_approx(kStill, 1e-9));
  EXPECT_EQ(box.world->covariance(), estimate.objects[1]->covariance());
  EXPECT_TRUE(box.relative->mean().is_approx(*seen_from(), 1e-9));
  EXPECT_EQ(box.mode_probability, slam.multi_object()->mode_probability(1));
  EXPECT_EQ(box.status, DetectionStatus::started);
  ASSERT_EQ(box.alternatives.size(), 1U);
  EXPECT_TRUE(box.alternatives[0].pose.is_approx(kStill, 1e-9));
  const ObjectEstimate mug = estimate.object("mug");
  EXPECT_FALSE(mug.world || mug.relative || mug.mode_probability);
  EXPECT_EQ(mug.status, DetectionStatus::none);
  EXPECT_EQ(thrown_message([&] { return estimate.object("cup"); }),
            "there is no object 'cup', expected one of: mug, box");
}

TEST(ObjectSlamTest, HypothesesAreRecordedWhereAskedFor) {
  ObjectSlam bare(kStartPrior, {gaussian_model("a")});
  EXPECT_TRUE(bare.step(detected({seen_from()})).alternatives.empty());
  const ObjectSlamSettings sum{.tracker = GaussianSumSettings{}, .record_hypotheses = true};
  ObjectSlam recording(kStartPrior, {gaussian_model("a")}, sum);
  const FrameEstimate estimate = recording.step(detected({seen_from()}));
  EXPECT_EQ(estimate.hypotheses.size(), recording.posterior().size());
  EXPECT_TRUE(make_slam().step(detected({seen_from(), seen_from()})).hypotheses.empty());
}

TEST(ObjectSlamTest, IsTheTrackerOfItsSettings) {
  const std::vector<ObjectModel> models{gaussian_model("a"), gaussian_model("b")};
  MultiObjectSlam multi_object(kStartPrior, models);
  GaussianSumSlam gaussian_sum(kStartPrior, models);
  ParticleSlam particles(kStartPrior, models);
  const auto expect_same = [&](auto& tracker, const TrackerSettings& settings) {
    ObjectSlam slam(kStartPrior, models, {.tracker = settings});
    for (const auto& detections :
         {std::vector{seen_from(), seen_from()}, std::vector{seen_from(), {}}}) {
      const FrameInput input{0.1, pose(0.01, 0.0, 0.0, 0.0, 0.01, 0.0), detections};
      const FrameEstimate expected = tracker.step(input);
      EXPECT_EQ(slam.step(input).camera.covariance(), expected.camera.covariance());
    }
    EXPECT_EQ(slam.posterior().size(), tracker.posterior().size());
    EXPECT_EQ(slam.pose_index(1), tracker.pose_index(1));
    EXPECT_EQ(slam.detections(0), 2U);
    EXPECT_EQ(slam.objects()[1].id, "b");
  };
  expect_same(multi_object, MultiObjectSlamSettings{});
  expect_same(gaussian_sum, GaussianSumSettings{});
  expect_same(particles, ParticleFilterSettings{});
}

TEST(ObjectSlamTest, ACopyGoesItsOwnWay) {
  for (const TrackerSettings& tracker :
       {TrackerSettings(MultiObjectSlamSettings{}),
        TrackerSettings(ParticleFilterSettings{.particles = 20})}) {
    ObjectSlam slam(kStartPrior, {gaussian_model("a")}, {.tracker = tracker});
    slam.step(detected({seen_from()}));
    ObjectSlam copy = slam;
    const FrameInput input{0.1, SE3d(), {seen_from()}};
    const Eigen::MatrixXd covariance = slam.step(input).camera.covariance();
    EXPECT_NE(copy.estimate().covariance(), slam.estimate().covariance());
    EXPECT_EQ(copy.step(input).camera.covariance(), covariance);
  }
}

TEST(ObjectSlamTest, RefusesTwoModelsOfOneId) {
  EXPECT_EQ(thrown_message([] {
              return ObjectSlam(kStartPrior, {gaussian_model("a"), gaussian_model("a")});
            }),
            "two object models have the id 'a'");
}

TEST(ObjectSlamTest, RefusesInputOfTheWrongShape) {
  ObjectSlam slam = make_slam();
  EXPECT_THROW(slam.step(detected({std::nullopt})), InvalidInput);
  slam.step(detected({std::nullopt, std::nullopt}));
  EXPECT_THROW(slam.step({0.0, SE3d(), {std::nullopt, std::nullopt}}), InvalidInput);
  EXPECT_THROW(slam.step({-1.0, SE3d(), {std::nullopt, std::nullopt}}), InvalidInput);
  EXPECT_THROW(slam.step({0.1, SE3d(), {std::nullopt}}), InvalidInput);
  ObjectSlamSettings settings;
  settings.motion.period_s = 0.0;
  EXPECT_THROW(make_slam(settings), InvalidInput);
}

const std::vector<TrackerSettings> kTrackers{MultiObjectSlamSettings{}, GaussianSumSettings{},
                                             ParticleFilterSettings{.particles = 5}};

TEST(ObjectSlamTest, EveryTrackerRefusesAnObjectThatThereIsNot) {
  for (const TrackerSettings& tracker : kTrackers) {
    const ObjectSlam slam(kStartPrior, {gaussian_model("a"), gaussian_model("b")},
                          {.tracker = tracker});
    EXPECT_EQ(thrown_message([&] { return slam.pose_index(2); }),
              "there is no object 2; there are 2");
    EXPECT_EQ(thrown_message([&] { return slam.detections(7); }),
              "there is no object 7; there are 2");
  }
}

TEST(ObjectSlamTest, EveryTrackerRefusesATimeThatIsNotFiniteAndStaysAsItWas) {
  for (const TrackerSettings& tracker : kTrackers) {
    ObjectSlam slam(kStartPrior, {gaussian_model("a")}, {.tracker = tracker});
    slam.step(detected({seen_from()}));
    const Eigen::MatrixXd before = slam.estimate().covariance();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(thrown_message([&] {
                slam.step({kInfinity, SE3d(), {seen_from()}});
              }),
              "frame: dt is inf s, expected a positive and finite time");
    EXPECT_THROW(slam.step({std::nan(""), SE3d(), {seen_from()}}), InvalidInput);
    EXPECT_EQ(slam.estimate().covariance(), before);
  }
}

TEST(ObjectSlamTest, EveryTrackerRefusesANoiseOfTheMotionThatIsNone) {
  const auto expect_refused = [](const char* name, ProcessNoise MotionSettings::*noise) {
    Matrix6d indefinite = Matrix6d::Identity();
    indefinite(0, 1) = indefinite(1, 0) = 2.0;
    // Rotations of a nanoradian beside metres.
    Matrix6d small_indefinite = Matrix6d::Identity();
    small_indefinite.topLeftCorner<3, 3>() = 1e-18 * indefinite.topLeftCorner<3, 3>();
    Matrix6d skew = Matrix6d::Identity();
    skew(0, 1) = 0.5;
    for (const TrackerSettings& tracker : kTrackers) {
      const auto message = [&](const Matrix6d& covariance) {
        MotionSettings motion;
        (motion.*noise).covariance = covariance;
        return thrown_message([&] {
          return ObjectSlam(kStartPrior, {gaussian_model("a")},
                            {.motion = motion, .tracker = tracker});
        });
      };
      const std::string begin = std::string("motion: ") + name;
      EXPECT_EQ(message(-Matrix6d::Identity()), begin + " has a negative variance");
      EXPECT_EQ(message(indefinite), begin + " is not positive semidefinite");
      EXPECT_EQ(message(small_indefinite), begin + " is not positive semidefinite");
      EXPECT_EQ(message(skew), begin + " is not symmetric");
      EXPECT_EQ(message(std::nan("") * skew), begin + " holds a value that is not finite");
      EXPECT_EQ(message(Matrix6d::Zero()), "");
    }
  };
  expect_refused("noise", &MotionSettings::noise);
  expect_refused("walk", &MotionSettings::walk);
  expect_refused("motion_noise", &MotionSettings::motion_noise);
  expect_refused("unknown_motion", &MotionSettings::unknown_motion);
}

TEST(ObjectSlamTest, DetectionsMayBeGivenById) {
  const ObjectSlam slam = make_slam();
  const auto detections = detections_by_id(slam.objects(), {{"b", *seen_from()}});
  ASSERT_EQ(detections.size(), 2U);
  EXPECT_FALSE(detections[0].has_value());
  EXPECT_TRUE(detections[1]->is_approx(*seen_from(), 1e-12));
  EXPECT_EQ(thrown_message([&] {
              return detections_by_id(slam.objects(), {{"cup", SE3d()}});
            }),
            "there is no object 'cup', expected one of: a, b");
}

}  // namespace
}  // namespace posemix
