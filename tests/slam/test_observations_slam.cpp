// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// MultiObjectSlam with observations: names, cameras of a rig, detectors, objects on sight.
#include <algorithm>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "filter/scenario.hpp"
#include "posemix/slam/object_slam.hpp"
#include "posemix/slam/run.hpp"
#include "posemix/slam/smoothing.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::pose;

const PoseDensity kSureStart(SE3d(), isotropic(0.1, 0.001));
const SE3d kSeenMug = pose(0.1, 0.2, 0, 0.1, 0, 1);
const SE3d kHalfTurn(SO3d::exp({0.0, 0.0, std::numbers::pi}), Eigen::Vector3d::Zero());

Observation of(const std::string& id, const SE3d& seen, double weight = 0.6) {
  Observation observation{.object = id};
  observation.components = {{.weight = weight, .pose = seen},
                            {.weight = 1.0 - weight, .pose = seen * kHalfTurn}};
  return observation;
}

void expect_refused(MultiObjectSlam& slam, const Observation& observation,
                    const std::string& named) {
  const std::size_t before = slam.detections(0);
  try {
    slam.step({.dt = 0.1, .observations = {observation}});
    ADD_FAILURE() << "accepted what should name " << named;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
  }
  EXPECT_EQ(slam.detections(0), before);
}

TEST(ObservationsSlam, NameTheirObjectAndBringAllTheirModes) {
  MultiObjectSlam slam(kSureStart, {{.id = "box"}, {.id = "mug"}}, {}, {}, true);
  const FrameEstimate e = slam.step({.observations = {of("mug", kSeenMug)}});
  EXPECT_FALSE(e.object("box").world.has_value());
  EXPECT_EQ(e.object("mug").alternatives.size(), 2U);
  EXPECT_EQ(e.object("mug").status, DetectionStatus::started);
  ASSERT_EQ(e.report.observations.size(), 1U);
  EXPECT_EQ(e.report.observations[0].object, 1U);
  EXPECT_EQ(e.report.observations[0].status, CandidateStatus::fresh);
}

TEST(ObservationsSlam, FromTheCamerasOfARigMeetInItsBody) {
  const SE3d left = pose(0, 0.3, 0, -0.1, 0, 0);
  const SE3d right = pose(0, -0.3, 0, 0.1, 0, 0);
  MultiObjectSlam slam(kSureStart, {{.id = "mug"}},
                       {.cameras = {{"left", left}, {"right", right}}});
  Observation a = of("mug", left.inverse() * kSeenMug);
  a.camera = "left";
  Observation b = of("mug", right.inverse() * kSeenMug);
  b.camera = "right";
  const FrameEstimate e = slam.step({.observations = {a, b}});
  EXPECT_LT((e.object("mug").world->mean().inverse() * kSeenMug).log().norm(), 1e-6);
  EXPECT_EQ(slam.detections(0), 2U);
  EXPECT_EQ(slam.filter().hypotheses(0).size(), 2U);
  Observation third = a;
  third.camera = "third";
  expect_refused(slam, third, "there is no camera 'third', expected one of: left, right");
}

TEST(ObservationsSlam, AnyOrderOfAFrameGivesTheSameBits) {
  const auto estimates = [](std::uint64_t shuffles) {
    RandomStream order(shuffles, 2);
    RandomStream noise(5, 3);
    MultiObjectSlam slam(kSureStart, {{.id = "mug"}}, {.on_sight = ObjectModel{}});
    std::optional<FrameEstimate> e;
    for (int frame = 0; frame < 4; ++frame) {
      std::vector<Observation> seen;
      for (const char* id : {"mug", "tag 2", "tag 10", "tag 2"}) {
        Observation one = of(id, kSeenMug * SE3d::exp(testing::draw(isotropic(1.0, 0.01), noise)));
        one.components.push_back({.weight = 0.7, .pose = kSeenMug * pose(0, 0, 3, 0, 0, 0)});
        one.components.push_back({.weight = 0.3, .pose = kSeenMug * pose(0, 3, 0, 0, 0, 0)});
        for (ObservationComponent& component : one.components) component.weight *= 0.5;
        seen.push_back(one);
      }
      const auto shuffle = [&](auto& list) {
        if (shuffles > 0) std::shuffle(list.begin(), list.end(), order);
      };
      for (Observation& one : seen) shuffle(one.components);
      shuffle(seen);
      FrameInput input{.observations = seen};
      if (frame > 0) input.motion = SE3d();
      if (frame > 0) input.dt = 0.1;
      e = slam.step(input);
    }
    std::vector<double> numbers;
    for (const auto& object : e->objects) {
      const Eigen::Matrix4d matrix = object->mean().matrix();
      numbers.insert(numbers.end(), matrix.data(), matrix.data() + matrix.size());
    }
    const auto camera = e->camera.covariance().reshaped();
    numbers.insert(numbers.end(), camera.begin(), camera.end());
    return std::pair(numbers, *e->ids);
  };
  for (std::uint64_t shuffles = 1; shuffles < 12; ++shuffles)
    EXPECT_EQ(estimates(shuffles), estimates(0)) << shuffles;
}

TEST(ObservationsSlam, CalibrateACameraThatIsNotKnownExactly) {
  const Matrix6d off = isotropic(2, 0.02);
  const SE3d right = pose(0, -0.3, 0, 0.1, 0, 0);
  const SE3d stated = right * SE3d::exp(Vector6d::Constant(0.015));
  ObjectModel mug{.id = "mug",
                  .noise = DetectorNoise({{.covariance = isotropic(0.2, 0.001)}}, {.weight = 0.05},
                                         {.slow = std::nullopt})};
  MultiObjectSlam slam(kSureStart, {mug},
                       {.cameras = {{"body", SE3d()},
                                    {"right", stated, off},
                                    {"third", SE3d(), Matrix6d(Matrix6d::Zero())}}});
  Observation a{.object = "mug", .components = {{.pose = kSeenMug}}};
  a.camera = "body";
  Observation b{.object = "mug", .components = {{.pose = right.inverse() * kSeenMug}}};
  b.camera = "right";
  slam.step({.observations = {a, b}});
  for (int k = 0; k < 5; ++k) slam.step({.dt = 0.1, .motion = SE3d(), .observations = {a, b}});
  const std::vector<BodyCamera> cameras = slam.estimated_cameras();
  ASSERT_EQ(cameras.size(), 3U);
  EXPECT_TRUE(cameras[0].is_exact());
  EXPECT_TRUE(cameras[2].is_exact());
  EXPECT_LT((cameras[1].body_camera.inverse() * right).log().norm(), 2e-3);
  EXPECT_LT(cameras[1].covariance->trace(), 0.05 * off.trace());
  // The result is an input of the next run.
  EXPECT_NO_THROW(MultiObjectSlam(kSureStart, {mug}, {.cameras = cameras}));
  EXPECT_EQ(slam.filter().extrinsic_count(), 1U);
  EXPECT_EQ(slam.pose_index(0), 1U);
}

TEST(ObservationsSlam, RefuseACovarianceOfACameraThatIsNone) {
  Matrix6d indefinite = isotropic(1, 0.01);
  indefinite(3, 3) = -1.0;
  EXPECT_THROW(MultiObjectSlam(kSureStart, {}, {.cameras = {{"left", SE3d(), indefinite}}}),
               InvalidInput);
  const BodyCamera uncertain{"left", SE3d(), isotropic(1, 0.01)};
  ObjectSlamSettings settings;
  settings.tracker = MultiObjectSlamSettings{.cameras = {uncertain}};
  EXPECT_THROW(FixedLagSmoother(kSureStart, {{.id = "mug"}}, settings, SmoothingSettings{}),
               InvalidInput);
}

TEST(ObservationsSlam, OfDetectorsHaveTheNoiseOfEach) {
  ObjectModel mug{.id = "mug"};
  mug.detectors.emplace("sharp",
                        DetectorNoise({{.covariance = isotropic(0.2, 0.001)}}, {.weight = 0.1}));
  MultiObjectSlam slam(kSureStart, {mug});
  Observation sharp = of("mug", kSeenMug);
  sharp.detector = "sharp";
  const FrameEstimate e = slam.step({.observations = {sharp}});
  EXPECT_LT(e.object("mug").relative->covariance()(0, 0), 1.1 * isotropic(0.2, 0.001)(0, 0));
  Observation other = sharp;
  other.detector = "blunt";
  expect_refused(slam, other, "no detector 'blunt', expected one of: sharp");
}

TEST(ObservationsSlam, OfUnknownObjectsAreRefusedOrBeginOne) {
  MultiObjectSlam strict(kSureStart, {{.id = "mug"}});
  expect_refused(strict, of("tag_7", kSeenMug), "there is no object 'tag_7', expected one of: mug");
  MultiObjectSlam slam(kSureStart, {}, {.on_sight = ObjectModel{}});
  slam.step({.observations = {of("tag_7", kSeenMug)}});
  const FrameEstimate e =
      slam.step({.dt = 0.1,
                 .motion = SE3d(),
                 .observations = {of("tag_9", kSeenMug), of("tag_7", kSeenMug)}});
  ASSERT_EQ(slam.objects().size(), 2U);
  EXPECT_EQ(slam.objects()[0].id, "tag_7");
  EXPECT_EQ(slam.objects()[1].id, "tag_9");
  EXPECT_TRUE(e.object("tag_9").world.has_value());
  EXPECT_EQ(slam.detections(0), 2U);
}

TEST(ObservationsSlam, OfAClassAreAssociatedByTheirNearestComponent) {
  MultiObjectSlam slam(kSureStart,
                       {{.id = "nut_1", .class_id = "nut"}, {.id = "nut_2", .class_id = "nut"}});
  const SE3d first = kSeenMug;
  const SE3d second = pose(0, 0, 0, -0.3, 0.1, 1.2);
  const auto nut = [](const SE3d& seen) {
    Observation observation = of("", seen);
    observation.class_id = "nut";
    return observation;
  };
  const FrameEstimate before = slam.step({.observations = {nut(first), nut(second)}});
  // The heavier component is the other mode now, and each is of the same instance as before.
  const FrameEstimate e =
      slam.step({.dt = 0.1,
                 .motion = SE3d(),
                 .observations = {nut(second * kHalfTurn), nut(first * kHalfTurn)}});
  ASSERT_EQ(e.report.observations.size(), 2U);
  EXPECT_EQ(e.report.observations[0].object, before.report.observations[1].object);
  EXPECT_EQ(e.report.observations[1].object, before.report.observations[0].object);
  EXPECT_NE(e.report.observations[0].object, e.report.observations[1].object);
  for (const auto& report : e.report.observations)
    EXPECT_EQ(report.status, CandidateStatus::assigned);
}

TEST(ObservationsSlam, MustNameAnObjectOrAClass) {
  MultiObjectSlam slam(kSureStart, {{.id = "mug"}});
  expect_refused(slam, of("", kSeenMug), "neither object nor class_id");
  Observation both = of("mug", kSeenMug);
  both.class_id = "mug";
  expect_refused(slam, both, "both object and class_id");
  Observation heavy = of("mug", kSeenMug);
  heavy.components[0].weight = 2.0;
  expect_refused(slam, heavy, "observations[0]: ");
}

TEST(ObservationsSlam, InARecordingAreUsedByTheMultiObjectFilterAndTheirBestByOthers) {
  Sequence sequence;
  ObjectRecording mug;
  mug.id = "mug";
  for (int k = 0; k < 10; ++k) {
    sequence.stamps.push_back(0.1 * k);
    sequence.odometry.emplace_back(SE3d());
    sequence.observations.push_back({of("mug", kSeenMug)});
    mug.detections.emplace_back(kSeenMug);
  }
  sequence.objects = {mug};
  const std::vector<ObjectModel> models{{.id = "mug"}};
  const SlamRun mixture = run(sequence, kSureStart, models, {});
  EXPECT_EQ(mixture.hypotheses[0].size(), 2U);
  const SlamRun best = run(sequence, kSureStart, models, {.tracker = GaussianSumSettings{}});
  EXPECT_LT((best.frames.back().objects[0]->mean().inverse() * kSeenMug).log().norm(), 1e-3);
  const SlamRun smoothed = run_smoothed(sequence, kSureStart, models, {}, {});
  EXPECT_LT((smoothed.frames.back().objects[0]->mean().inverse() * kSeenMug).log().norm(), 1e-3);
}

}  // namespace
}  // namespace posemix
