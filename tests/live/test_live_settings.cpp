// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "live_scene.hpp"
#include "posemix/base/units.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using namespace testing;

std::string message_of(const std::string& text) {
  return thrown_message([&] { live_settings(text); });
}

TEST(LiveSettingsFile, WithoutAnythingEveryClassIsAnObject) {
  const LiveSettings settings = live_settings("");
  ASSERT_EQ(settings.sources.size(), 1u);
  EXPECT_EQ(topic_name(settings.node, settings.sources[0].topic), "/posemix/detections");
  EXPECT_EQ(settings.sources[0].detector, "");
  EXPECT_TRUE(settings.tracker.on_sight);
  EXPECT_TRUE(settings.models.empty());
  EXPECT_EQ(settings.motion.model, MotionModel::odometry);
  EXPECT_EQ(settings.stamped.on_jump_back, StampJump::reset);
  EXPECT_TRUE(settings.starts_at_odometry);
  EXPECT_NEAR(settings.start.covariance()(0, 0), std::pow(radians(0.05), 2), 1e-15);
}

TEST(LiveSettingsFile, SourcesGiveTheirNoiseToAllObjects) {
  const LiveSettings settings = live_settings(R"(
[[sources]]
name = "rough"
topic = "/rough"
noise = "wide"
reliability = "reliable"
[[sources]]
name = "fine"
type = "Detection2DArray"
frame = "/optical"
[[objects]]
id = "mug"
[[objects]]
id = "box"
noise = "wide"
detectors = {fine = "wide"}
[on_sight]
[noise.wide]
components = [{rotation_sd_deg = 5, translation_sd_m = 0.05}]
clutter = {weight = 0.1}
slow = "none"
)");
  ASSERT_EQ(settings.sources.size(), 2u);
  EXPECT_TRUE(settings.sources[0].reliable);
  EXPECT_TRUE(settings.sources[1].flat);
  EXPECT_EQ(settings.sources[1].detector, "fine");
  EXPECT_EQ(settings.sources[1].frame, "optical");
  const auto sd_of = [](const DetectorNoise& noise) {
    return std::sqrt(noise.components()[0].covariance(5, 5));
  };
  const double typical = sd_of(default_detector_noise());
  for (const ObjectModel& model : {settings.models[0], *settings.tracker.on_sight}) {
    EXPECT_NEAR(sd_of(model.noise), 0.05, 1e-12);
    EXPECT_EQ(sd_of(model.detectors.at("fine")), typical);
  }
  EXPECT_NEAR(sd_of(settings.models[1].detectors.at("fine")), 0.05, 1e-12);
}

TEST(LiveSettingsFile, ObjectsThatAreDeclaredAreAllUnlessTheFileSaysOtherwise) {
  EXPECT_FALSE(live_settings("[[objects]]\nid = \"mug\"\n").tracker.on_sight);
  const LiveSettings moving = live_settings(
      "[on_sight]\nmotion = {model = \"random_walk\"}\n[filter]\nmax_hypotheses = 5\n");
  EXPECT_EQ(moving.tracker.filter.max_hypotheses, 5u);
  EXPECT_FALSE(is_static(moving.tracker.on_sight->motion));
}

TEST(LiveSettingsFile, ReadsFramesTimesAndStart) {
  const LiveSettings settings = live_settings(R"(
[live]
name = "arm"
world_frame = "base"
odom_frame = "base"
odometry_topic = "/odom"
cameras = ["left", "right"]
max_gap_s = 0.5
queue_size = 7
least_existence = 0
publish_tf = false
use_sim_time = true
[motion]
model = "given"
[stamped]
history_s = 2
on_jump_back = "refuse"
[camera.start]
pose = [1, 0, 0, 0, 0, 0, 1]
rotation_sd_deg = 1
translation_sd_m = 0.1
[output]
images = 50
)");
  EXPECT_EQ(topic_name(settings.node, "~/objects"), "/arm/objects");
  EXPECT_EQ(settings.node.cameras, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(settings.node.queue_size, 7u);
  EXPECT_TRUE(settings.node.use_sim_time);
  EXPECT_EQ(settings.motion.model, MotionModel::given);
  EXPECT_EQ(settings.stamped.history_s, 2.0);
  EXPECT_EQ(settings.stamped.on_jump_back, StampJump::refuse);
  EXPECT_FALSE(settings.starts_at_odometry);
  EXPECT_EQ(settings.start.mean().translation().x(), 1.0);
  EXPECT_EQ(settings.report_images, 50u);
}

TEST(LiveSettingsFile, WhatIsWrongIsNamedWithItsLine) {
  EXPECT_NE(message_of("[live]\nworld = \"map\"\n").find("live.toml:3"), std::string::npos);
  EXPECT_NE(message_of("[live]\nname = \"a-b\"\n").find("expected letters, digits and '_'"),
            std::string::npos);
  EXPECT_NE(message_of("[live]\nmax_gap_s = 0\n").find("live.max_gap_s"), std::string::npos);
  EXPECT_NE(message_of("[[sources]]\nname = \"a\"\n[[sources]]\nname = \"a\"\n")
                .find("another source has already"),
            std::string::npos);
  EXPECT_NE(message_of("[[sources]]\ntype = \"Detection2DArray\"\npose = \"bbox\"\n")
                .find("have no pose"),
            std::string::npos);
  EXPECT_NE(message_of("[[sources]]\nnoise = \"wide\"\n").find("no table [noise.wide]"),
            std::string::npos);
  EXPECT_NE(message_of("[[objects]]\nid = \"mug\"\ndetectors = {other = \"default\"}\n")
                .find("expected names of [[sources]]"),
            std::string::npos);
  EXPECT_NE(message_of("[filter]\nmethod = \"gm-iekf\"\n").find("expected \"multi_object\""),
            std::string::npos);
  EXPECT_NE(message_of("[filter]\nsmooth = \"full\"\n").find("expected \"none\""),
            std::string::npos);
  EXPECT_NE(message_of("[stamped]\nhistory_s = 20\n").find("expected at least history_s"),
            std::string::npos);
  EXPECT_NE(message_of("[[objects]]\nid = \"mug\"\ndetections = \"mug.txt\"\n").find("detections"),
            std::string::npos);
}

}  // namespace
}  // namespace posemix
