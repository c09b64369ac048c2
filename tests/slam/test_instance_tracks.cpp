// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Existence and health of instances as the tracker reports them.
#include "posemix/slam/instance_tracks.hpp"

#include <gtest/gtest.h>

#include "posemix/base/error.hpp"
#include "posemix/slam/run.hpp"
#include "posemix/slam/stamped_slam.hpp"
#include "slam/searched_image.hpp"

namespace posemix {
namespace {

using std::string_literals::operator""s;

const SE3d kPlace(SO3d(), {0.0, 0.0, 1.0});

/// Tracks of two objects of a class, driven by hand.
class Driven {
 public:
  Driven() : tracks_({}, {}, 3, 0.02) {
    tracks_.add(false, "bolt");
    tracks_.add(false, "bolt");
  }
  /// A frame, with an image of a detector where one is named, in which the first object is seen.
  void frame(double dt, const char* detector, bool seen, const SE3d& place = kPlace) {
    tracks_.begin(dt);
    if (detector) tracks_.look("", detector, SE3d());
    if (seen)
      tracks_.detected(0, {.detector = detector, .of_class = true, .inlier_probability = 1.0});
    tracks_.end(std::vector<TrackedPlace>{{place}, {}});
  }
  InstanceTracks& tracks() { return tracks_; }

 private:
  InstanceTracks tracks_;
};

TEST(InstanceTracks, ASlowDetectorBesideAFastOneConfirmsItsObjects) {
  Driven driven;
  for (int k = 0; k < 300; ++k) {
    driven.frame(1.0 / 30.0, "tags", false);
    if (k % 30 == 0) driven.frame(1e-3, "slow", true);
  }
  EXPECT_TRUE(driven.tracks().is_confirmed(0));
  EXPECT_EQ(driven.tracks().health(0, 1.0), TrackHealth::good);
}

TEST(InstanceTracks, WhatNobodyLooksAtStaysAsItWas) {
  Driven driven;
  for (int k = 0; k < 30; ++k) driven.frame(0.5, "usual", true);
  const double before = *driven.tracks().existence(0);
  for (int k = 0; k < 100; ++k) driven.frame(100.0, nullptr, false);
  EXPECT_EQ(*driven.tracks().existence(0), before);
  EXPECT_EQ(driven.tracks().health(0, 1.0), TrackHealth::good);
}

TEST(InstanceTracks, AnObjectWhosePlaceIsNotKnownIsLost) {
  InstanceTracks tracks({}, {.register_again_s = 1.0}, 3, 0.02);
  tracks.add(true, "");
  const auto frame = [&](double place_probability, bool seen) {
    tracks.begin(0.4);
    if (seen) {
      tracks.look("", "", SE3d());
      tracks.detected(0, {.inlier_probability = 1.0});
    }
    tracks.end(std::vector<TrackedPlace>{{kPlace, place_probability}});
  };
  frame(1.0, true);
  EXPECT_EQ(tracks.health(0, 1.0), TrackHealth::good);
  frame(0.2, false);
  EXPECT_EQ(tracks.health(0, 0.2), TrackHealth::ambiguous);
  for (int k = 0; k < 3; ++k) {
    EXPECT_FALSE(tracks.should_register(0));
    frame(0.05, false);
  }
  EXPECT_EQ(tracks.health(0, 0.05), TrackHealth::lost);
  EXPECT_TRUE(tracks.should_register(0));
  frame(0.99, true);
  EXPECT_EQ(tracks.health(0, 0.99), TrackHealth::good);
  EXPECT_FALSE(tracks.should_register(0));
}

TEST(InstanceTracks, LostIsSaidUntilADetectionAndThenNotAnyMore) {
  Driven driven;
  for (int k = 0; k < 30; ++k) driven.frame(0.5, "usual", true);
  for (int k = 0; k < 15; ++k) driven.frame(0.5, "usual", false);
  EXPECT_EQ(driven.tracks().health(0, 1.0), TrackHealth::lost);
  // Its prediction leaves the view, which is no news of it.
  for (int k = 0; k < 15; ++k) driven.frame(0.5, "usual", false, SE3d(SO3d(), {5.0, 0.0, 1.0}));
  EXPECT_EQ(driven.tracks().health(0, 1.0), TrackHealth::lost);
  EXPECT_TRUE(driven.tracks().should_register(0));
  for (int k = 0; k < 3; ++k) driven.frame(0.5, "usual", true);
  EXPECT_EQ(driven.tracks().health(0, 1.0), TrackHealth::good);
  EXPECT_FALSE(driven.tracks().should_register(0));
}

TEST(InstanceTracks, ASingleDetectionNearTheLensDoesNotWidenTheView) {
  Driven driven;
  for (int k = 0; k < 30; ++k) driven.frame(0.5, "usual", true);
  InstanceTracks& tracks = driven.tracks();
  tracks.begin(0.5);
  tracks.look("", "usual", SE3d());
  tracks.detected(1, {.detector = "usual", .of_class = true});
  tracks.end(std::vector<TrackedPlace>{{kPlace}, {SE3d(SO3d(), {0.05, 0.05, 0.02})}});
  for (int k = 0; k < 30; ++k) driven.frame(0.5, "usual", false, SE3d(SO3d(), {1.2, 0.0, 1.0}));
  EXPECT_EQ(tracks.health(0, 1.0), TrackHealth::good);
}

/// Odometry at 30 Hz and a detector at 5 Hz that is always right, up to a frame.
Sequence slowly_detected(int last_frame) {
  Sequence sequence;
  sequence.objects.emplace_back();
  sequence.objects[0].id = "mug";
  for (int k = 0; k < 300; ++k) {
    const bool seen = k % 6 == 0 && k <= last_frame;
    sequence.stamps.push_back(k / 30.0);
    sequence.odometry.push_back(SE3d());
    sequence.objects[0].detections.push_back(seen ? std::optional(kPlace) : std::nullopt);
  }
  return sequence;
}

FrameEstimate last_estimate(const Sequence& sequence) {
  const PoseDensity start(SE3d(), 1e-8 * Matrix6d::Identity());
  return run(sequence, start, {{.id = "mug"}}, ObjectSlamSettings()).frames.back();
}

TEST(InstanceTracks, StampsOfOdometryAloneAreNoImages) {
  EXPECT_GT(last_estimate(slowly_detected(300)).existences[0].value(), 0.99);
}

TEST(InstanceTracks, AnObjectAloneInViewIsLostWhereTheRecordingNamesItsImages) {
  Sequence sequence = slowly_detected(150);
  EXPECT_EQ(last_estimate(sequence).healths[0], TrackHealth::good);
  sequence.images.resize(300);
  for (std::size_t k = 0; k < 300; k += 6) sequence.images[k] = {""};
  EXPECT_EQ(last_estimate(sequence).healths[0], TrackHealth::lost);
  EXPECT_TRUE(last_estimate(sequence).register_again[0]);
  // The same images with the object in all of them.
  const auto images = sequence.images;
  sequence = slowly_detected(300);
  sequence.images = images;
  EXPECT_EQ(last_estimate(sequence).healths[0], TrackHealth::good);
  sequence.images.pop_back();
  EXPECT_THROW(last_estimate(sequence), InvalidInput);
}

/// Existence of a mug that one detector sees once a second, while another one sees a nut for three
/// seconds and then nothing, ten times a second.
double beside_another(const std::optional<std::string>& empty_of) {
  StampedSlam slam(PoseDensity(SE3d(), 1e-8 * Matrix6d::Identity()), {{.id = "mug"}, {.id = "nut"}},
                   {}, {.model = MotionModel::still});
  const auto see = [&](const char* object, const char* detector, double stamp_s) {
    slam.add({.object = object,
              .components = {{.pose = kPlace}},
              .detector = detector,
              .stamp_s = stamp_s});
  };
  for (int k = 0; k < 300; ++k) {
    if (k % 10 == 0) see("mug", "mugs", 0.1 * k);
    if (k < 30) {
      see("nut", "nuts", 0.1 * k + 0.05);
    } else {
      slam.add_image(0.1 * k + 0.05, "", empty_of);
    }
  }
  return slam.finish()->estimate.existences[0].value();
}

TEST(InstanceTracks, WhatOneDetectorDoesNotFindMayBeThereForAnother) {
  EXPECT_GT(beside_another("nuts"), 0.999);
  EXPECT_LT(beside_another(std::nullopt), 0.5) << "searched by both";
}

// A name that means another image would be refused when it is played, again and again.
TEST(InstanceTracks, ADetectorWithAnAtInItsNameIsOne) {
  EXPECT_LT(beside_another("mugs"), 0.5);
  const PoseDensity start(SE3d(), 1e-8 * Matrix6d::Identity());
  StampedSlam rig(start, {{.id = "mug"}}, {.cameras = {{.name = "a"}}});
  EXPECT_EQ(rig.add_image(0.0, "a", "yolo@v2"), StampAdmission::taken);
  EXPECT_NO_THROW(rig.finish());
  // Where a camera has such a name it is the one.
  rig = StampedSlam(start, {{.id = "mug"}}, {.cameras = {{.name = "a"}, {.name = "a@yolo"}}});
  EXPECT_THROW(rig.add_image(0.0, "a", "yolo"), InvalidInput);
  EXPECT_THROW(rig.add_image(0.0, "a", "yolo@v2"), InvalidInput);
  EXPECT_NO_THROW(rig.finish());
}

TEST(InstanceTracks, AnImageIsOfADetectorThatAnObjectHas) {
  const DetectorNoise noise = ObjectModel().noise;
  const PoseDensity start(SE3d(), 1e-8 * Matrix6d::Identity());
  const ObjectModel mug{.id = "mug", .detectors = {{"yolo", noise}}};
  const auto take = [&](const MultiObjectSlamSettings& settings, const ObjectModel& other) {
    MultiObjectSlam slam(start, {mug, other}, settings);
    slam.step({.images = {"@yolo", "@tags"}});
  };
  const ObjectModel box{.id = "box", .detectors = {{"tags", noise}}};
  EXPECT_NO_THROW(take({}, box));
  EXPECT_NO_THROW(take({}, {.id = "box"}));  // which takes any name
  try {
    take({}, {.id = "box", .detectors = {{"yolo", noise}}});
    ADD_FAILURE() << "an image of a detector that no object has is taken";
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "got an image of detector 'tags', expected one of: yolo");
  }
  EXPECT_NO_THROW(take({.on_sight = ObjectModel{}}, {.id = "box", .detectors = {{"yolo", noise}}}));
  StampedSlam stamped(start, {mug}, {});
  EXPECT_THROW(stamped.add_image(0.0, "", "tags"), InvalidInput);
  EXPECT_EQ(stamped.add_image(0.0, "", "yolo"), StampAdmission::taken);
}

TEST(InstanceTracks, AnImageIsNamedByItsCameraAndByADetector) {
  const std::vector<BodyCamera> cameras{{.name = "left"}, {.name = "a@b"}};
  const auto image = [&](const std::string& name) {
    const auto found = internal::searched_image(cameras, name);
    return std::pair(found.camera, found.detector.value_or("all"));
  };
  EXPECT_EQ(image("left"), std::pair("left"s, "all"s));
  EXPECT_EQ(image("left@tags"), std::pair("left"s, "tags"s));
  EXPECT_EQ(image("left@"), std::pair("left"s, ""s));
  EXPECT_EQ(image("a@b"), std::pair("a@b"s, "all"s));
  EXPECT_EQ(image("a@b@tags"), std::pair("a@b"s, "tags"s));
  EXPECT_EQ(image("left@yolo@v2"), std::pair("left"s, "yolo@v2"s));
  EXPECT_EQ(internal::searched_image({}, "@yolo@v2").detector, "yolo@v2");
  EXPECT_THROW(image("right@tags"), InvalidInput);
  EXPECT_THROW(image(""), InvalidInput);
  EXPECT_EQ(internal::searched_image({}, "@tags").detector, "tags");
  EXPECT_EQ(internal::name_of({"left", "tags"}), "left@tags");
}

}  // namespace
}  // namespace posemix
