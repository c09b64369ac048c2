// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The rig, the odometry's noise and the sequence file of a folder of fiducials.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/base/error.hpp"
#include "posemix/base/random.hpp"
#include "posemix/base/units.hpp"
#include "posemix/fiducial/fiducial_sequence.hpp"
#include "posemix/fiducial/rig_calibration.hpp"
#include "posemix/fiducial/tag_odometry.hpp"

namespace posemix {
namespace {

const SE3d kFlip(SO3d::exp({0.0, 0.7, 0.0}), Eigen::Vector3d::Zero());

Vector6d normal6(RandomStream& random, double rotation, double translation) {
  Vector6d n;
  for (int i = 0; i < 6; ++i) n[i] = random.normal() * (i < 3 ? rotation : translation);
  return n;
}

Observation seen(const std::string& camera, const std::string& tag, double stamp, const SE3d& pose,
                 RandomStream& random, double first = 0.9) {
  Observation observation;
  observation.camera = camera;
  observation.object = tag;
  observation.stamp_s = stamp;
  const SE3d measured = pose * SE3d::exp(normal6(random, radians(0.3), 0.003));
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << Eigen::Vector3d::Constant(std::pow(radians(0.3), 2)),
      Eigen::Vector3d::Constant(9e-6);
  observation.components.push_back({.weight = first, .pose = measured, .covariance = covariance});
  if (first < 1.0) {
    observation.components.push_back(
        {.weight = 1.0 - first, .pose = measured * kFlip, .covariance = covariance});
  }
  return observation;
}

const SE3d kSecond(SO3d::exp({0.1, 1.2, 0.0}), {0.2, 0.0, 0.05});
const SE3d kThird(SO3d::exp({0.1, 2.4, 0.3}), {0.3, 0.1, -0.1});

std::vector<RigCamera> three_cameras() {
  return {{.name = "a", .rig_camera = StatedPose{}}, {.name = "b"}, {.name = "c"}};
}

/// The first camera shares tags with the second, the second with the third. One in three has its
/// wrong pose in front.
std::vector<Observation> shared_sightings() {
  RandomStream random(3);
  std::vector<Observation> list;
  for (int i = 0; i < 60; ++i) {
    const SE3d tag(SO3d::exp({2.5 + 0.3 * random.normal(), 0.3, 0.0}),
                   {0.3 * random.normal(), 0.2, 1.5});
    const double first = i % 3 == 0 ? 0.4 : 0.9;
    const std::string id = std::to_string(i % 4);
    list.push_back(seen("b", id, i, tag, random, first));
    if (i % 2 == 0) {
      list.push_back(seen("a", id, i, kSecond * tag, random, 0.9));
    } else {
      list.push_back(seen("c", id, i, kThird.inverse() * kSecond * tag, random, 0.9));
    }
  }
  return list;
}

TEST(RigCalibration, FindsCamerasThatShareTags) {
  std::vector<RigCamera> cameras = three_cameras();
  EXPECT_TRUE(calibrate_rig(shared_sightings(), cameras).empty());
  const Vector6d second = (cameras[1].rig_camera->pose.inverse() * kSecond).log();
  const Vector6d third = (cameras[2].rig_camera->pose.inverse() * kThird).log();
  EXPECT_LT(second.head<3>().norm(), radians(0.4));
  EXPECT_LT(second.tail<3>().norm(), 0.015);
  EXPECT_LT(third.head<3>().norm(), radians(0.8));
  EXPECT_LT(third.tail<3>().norm(), 0.03);
  const Vector6d sd = cameras[1].rig_camera->covariance->diagonal().cwiseSqrt();
  EXPECT_GT(sd[0], radians(0.2));
  EXPECT_LT(sd[0], radians(1.0));
}

TEST(RigCalibration, NamesCamerasThatShareNone) {
  std::vector<Observation> list = shared_sightings();
  std::erase_if(list, [](const Observation& o) { return o.camera == "b"; });
  std::vector<RigCamera> cameras = three_cameras();
  EXPECT_EQ(calibrate_rig(list, cameras), (std::vector<std::string>{"b", "c"}));
  list.front().camera = "nobody";
  EXPECT_THROW(calibrate_rig(list, cameras), InvalidInput);
  // Without any pose the first camera is the rig.
  cameras = {{.name = "a"}};
  EXPECT_TRUE(calibrate_rig({}, cameras).empty());
  EXPECT_TRUE(cameras.front().rig_camera.has_value());
}

TEST(RigCalibration, LeavesObservationsOfUnknownCamerasOut) {
  FiducialFolder folder;
  folder.cameras = three_cameras();
  folder.fiducials.observations = shared_sightings();
  std::erase_if(folder.fiducials.observations, [](const auto& o) { return o.camera == "b"; });
  EXPECT_EQ(complete_rig(folder).size(), 2U);
  for (const Observation& o : folder.fiducials.observations) EXPECT_EQ(o.camera, "a");
}

/// A rig that goes forward past tags, with odometry of the given noise per square root of a second.
struct Drive {
  std::vector<Observation> observations;
  std::vector<StampedPose> odometry;
};

Drive drive(double rotation, double translation) {
  constexpr double kStep = 0.1;
  RandomStream random(5);
  Drive result;
  SE3d rig;
  SE3d odometry;
  const SE3d motion(SO3d::exp({0.0, 0.01, 0.0}), {0.0, 0.0, 0.03});
  SE3d tag;
  for (int i = 0; i < 6000; ++i) {
    if (i % 60 == 0) tag = rig * SE3d(SO3d::exp({2.9, 0.2, 0.0}), {0.2, 0.1, 2.5});
    result.observations.push_back(seen("a", std::to_string(i / 60), i * kStep, rig.inverse() * tag,
                                       random, i % 7 == 0 ? 0.6 : 0.999));
    result.odometry.push_back({i * kStep, odometry});
    rig = rig * motion;
    odometry =
        odometry * motion *
        SE3d::exp(normal6(random, rotation * std::sqrt(kStep), translation * std::sqrt(kStep)));
  }
  return result;
}

TEST(TagOdometry, LearnsTheNoiseOfTheWalk) {
  const std::vector<RigCamera> cameras{{.name = "a", .rig_camera = StatedPose{}}};
  for (const auto& [rotation, translation] : {std::pair(0.3, 0.02), std::pair(1.0, 0.1)}) {
    const Drive one = drive(radians(rotation), translation);
    const auto learned = fit_tag_odometry(one.observations, cameras, one.odometry);
    ASSERT_TRUE(learned.has_value());
    // Student's t with four degrees of freedom takes a normal error for up to 1.3 times as wide.
    EXPECT_GT(degrees(learned->rotation_sd), 0.85 * rotation);
    EXPECT_LT(degrees(learned->rotation_sd), 1.45 * rotation);
    EXPECT_GT(learned->translation_sd, 0.85 * translation);
    EXPECT_LT(learned->translation_sd, 1.45 * translation);
    EXPECT_GT(learned->pairs, 100U);
  }
}

TEST(TagOdometry, NeedsEnoughPairs) {
  const std::vector<RigCamera> cameras{{.name = "a", .rig_camera = StatedPose{}}};
  Drive one = drive(0.01, 0.02);
  one.observations.resize(100);
  EXPECT_FALSE(fit_tag_odometry(one.observations, cameras, one.odometry).has_value());
  EXPECT_FALSE(fit_tag_odometry(one.observations, cameras, {}).has_value());
}

TEST(FiducialSequence, HasRigOdometryAndKnownTags) {
  FiducialFolder folder;
  folder.cameras = three_cameras();
  folder.fiducials.observations = shared_sightings();
  complete_rig(folder);
  folder.odometry = drive(0.01, 0.02).odometry;
  Matrix6d tight = 1e-8 * Matrix6d::Identity();
  for (const int id : {0, 1, 99})
    folder.tags.priors[id] = StatedPose{SE3d(SO3d(), {1.0 * id, 0.0, 0.0}), tight};
  std::string text = format_fiducial_sequence(folder);
  const auto has = [&](const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(has("odometry = \"odometry.tum\""));
  EXPECT_TRUE(has("start = {pose = \"unknown\"}"));
  EXPECT_TRUE(has("name = \"c\""));
  EXPECT_TRUE(
      has("prior = {pose = [1, 0, 0, 0, 0, 0, 1], rotation_sd_deg = [1, 1, 1], "
          "translation_sd_m = [0.01, 0.01, 0.01]}"));
  EXPECT_FALSE(has("\"99\"")) << "was not seen";
  // A single known tag is no survey.
  folder.tags.priors.erase(1);
  text = format_fiducial_sequence(folder);
  EXPECT_FALSE(has("unknown"));
  EXPECT_FALSE(has("prior"));
}

TEST(FiducialSequence, OdometryIsThatOfTheRig) {
  const SE3d mounted(SO3d::exp({0.0, 0.0, 3.0}), {0.02, 0.01, 0.0});
  const SE3d rig(SO3d::exp({0.1, 0.5, 0.0}), {1.0, 2.0, 3.0});
  const auto odometry = odometry_of_rig({{0.1, std::nullopt}, {0.0, rig * mounted}}, mounted);
  EXPECT_LT((odometry[0].pose->inverse() * rig).log().norm(), 1e-12);
  EXPECT_FALSE(odometry[1].pose.has_value());
}

}  // namespace
}  // namespace posemix
