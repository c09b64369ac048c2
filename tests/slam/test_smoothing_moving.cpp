// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "moving_orbit.hpp"
#include "posemix/slam/smoothing.hpp"
#include "posemix/testing/expect.hpp"
#include "smoothing_scene.hpp"

/// Smoothing of recordings in which objects move, and are put down elsewhere.
namespace posemix {
namespace {

using testing::draw;
using testing::expect_same_bits;
using testing::hand;
using testing::isotropic;
using testing::moving_by;
using testing::MovingOrbit;
using testing::nees_of;
using testing::plain_slam;
using testing::pose;
using testing::ray_noise;
using testing::thrown_message;

constexpr std::size_t kLength = 60;
constexpr std::size_t kMoved = 30;  ///< from this frame on the cup is elsewhere
constexpr std::size_t kHand = 2;
constexpr std::size_t kCup = 3;

/// A camera circles a box and a mug, a hand that moves, and a cup that is put down elsewhere.
struct Recorded {
  explicit Recorded(std::uint64_t seed, double odometry_sd_m = 1e-3) {
    MovingOrbit scene(seed);
    scene.q = isotropic(0.05, odometry_sd_m);
    models = testing::static_models();
    models.push_back(hand());
    models.push_back({.id = "cup", .noise = hand().noise, .motion = moving_by(PutDownMotion{})});
    for (const ObjectModel& model : models) sequence.objects.push_back({model.id, {}, {}, {}});
    settings.tracker = plain_slam();
    std::get<MultiObjectSlamSettings>(settings.tracker).moving = testing::plain_moving_settings();
    settings.motion.noise = {scene.q, NoisePer::frame};
    prior.emplace(SE3d::exp(draw(isotropic(0.3, 0.005), scene.stream)) * scene.camera,
                  isotropic(0.3, 0.005));
    SE3d odometry;
    for (std::size_t k = 0; k < kLength; ++k) {
      if (k > 0) odometry = odometry * scene.next();
      const SE3d cup =
          k < kMoved ? pose(0.1, 0, 0.4, -0.15, -0.1, 0.02) : pose(0.1, 0, 1.4, 0.12, -0.15, 0.02);
      sequence.stamps.push_back(0.1 * static_cast<double>(k));
      sequence.odometry.emplace_back(odometry);
      cameras.push_back(scene.camera);
      truth.push_back({scene.moving.truth, cup});
      add(0, scene.detect(0, 0.0, 0.0));
      add(1, scene.detect(1, 0.0, 0.0));
      add(kHand, k % 3 == 2 ? std::nullopt : std::optional(scene.moving.inlier()));
      add(kCup, k % 4 == 1 || k < 2
                    ? std::nullopt
                    : std::optional(scene.moving.erring(cup, hand().noise.components().front())));
    }
  }
  void add(std::size_t object, const std::optional<SE3d>& seen) {
    sequence.objects[object].detections.push_back(seen);
  }
  SlamRun smoothed(const RunOptions& options = {}) const {
    return run_smoothed(sequence, *prior, models, settings, {}, options);
  }
  SlamRun filtered() const { return run(sequence, *prior, models, settings); }

  Sequence sequence;
  std::vector<ObjectModel> models;
  ObjectSlamSettings settings;
  std::optional<PoseDensity> prior;
  std::vector<SE3d> cameras;
  std::vector<std::array<SE3d, 2>> truth;  ///< hand, cup
};

double squared_distance(const PoseDensity& estimate, const SE3d& truth) {
  return (estimate.mean().translation() - truth.translation()).squaredNorm();
}

/// Sums over frames and objects that move.
struct Sums {
  double squares[2] = {};
  double world[2] = {};
  double relative[2] = {};
  double camera = 0.0;
  double count[2] = {};

  void add(const Recorded& recorded, const SlamRun& run) {
    for (std::size_t k = 0; k < kLength; ++k) {
      const FrameEstimate& frame = run.frames[k];
      camera += squared_distance(frame.camera, recorded.cameras[k]);
      for (std::size_t i = 0; i < 2; ++i) {
        const std::size_t object = kHand + i;
        if (!frame.objects[object]) continue;
        const SE3d& truth = recorded.truth[k][i];
        squares[i] += squared_distance(*frame.objects[object], truth);
        world[i] += nees_of(truth, *frame.objects[object]) / 6.0;
        relative[i] +=
            nees_of(recorded.cameras[k].inverse() * truth, *frame.relative[object]) / 6.0;
        count[i] += 1.0;
      }
    }
  }
};

TEST(SmoothingMoving, ErrorsAreSmallerThanTheFiltersAndAsStated) {
  Sums filtered;
  Sums smoothed;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Recorded recorded(seed);
    filtered.add(recorded, recorded.filtered());
    smoothed.add(recorded, recorded.smoothed());
  }
  for (std::size_t i = 0; i < 2; ++i) {
    SCOPED_TRACE(i == 0 ? "hand" : "cup");
    EXPECT_EQ(smoothed.count[i], filtered.count[i]);
    EXPECT_LT(smoothed.squares[i], 0.75 * filtered.squares[i]);
    EXPECT_NEAR(smoothed.world[i] / smoothed.count[i], 1.0, 0.3);
    EXPECT_NEAR(smoothed.relative[i] / smoothed.count[i], 1.0, 0.3);
  }
  EXPECT_LT(smoothed.camera, filtered.camera);
}

/// The recording before a camera whose poses are given with an error, but for some.
Recorded with_given_camera(std::uint64_t seed) {
  Recorded recorded(seed);
  RandomStream stream(seed, 21);
  recorded.settings.motion.model = MotionModel::given;
  recorded.settings.motion.noise = {isotropic(0.3, 0.003), NoisePer::frame};
  recorded.settings.motion.unknown_motion = {isotropic(3.0, 0.05), NoisePer::second};
  for (std::size_t k = 0; k < kLength; ++k) {
    const SE3d error = SE3d::exp(draw(isotropic(0.3, 0.003), stream));
    recorded.sequence.odometry[k] = recorded.cameras[k] * error;
    if (k % 20 == 7) recorded.sequence.odometry[k].reset();
  }
  return recorded;
}

TEST(SmoothingMoving, AGivenCameraIsSmoothedToo) {
  Sums filtered;
  Sums smoothed;
  double camera = 0.0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Recorded recorded = with_given_camera(seed);
    filtered.add(recorded, recorded.filtered());
    const SlamRun run = recorded.smoothed();
    smoothed.add(recorded, run);
    for (std::size_t k = 0; k < kLength; ++k)
      camera += nees_of(recorded.cameras[k], run.frames[k].camera) / (6.0 * 12.0 * kLength);
  }
  EXPECT_NEAR(camera, 1.0, 0.25);
  EXPECT_LT(smoothed.camera, filtered.camera);
  for (std::size_t i = 0; i < 2; ++i) {
    SCOPED_TRACE(i == 0 ? "hand" : "cup");
    EXPECT_LT(smoothed.squares[i], 0.8 * filtered.squares[i]);
    EXPECT_NEAR(smoothed.world[i] / smoothed.count[i], 1.0, 0.3);
    // That of the hand has the error of an image once more than is right.
    EXPECT_LT(smoothed.relative[i] / smoothed.count[i], 1.3);
  }
}

TEST(SmoothingMoving, WhatIsSeenFromACameraOfPoorOdometryIsAsStated) {
  Sums smoothed;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Recorded recorded(seed, 5e-3);
    // A hand alone: nothing but the odometry tells how the camera moves.
    std::swap(recorded.models[0], recorded.models[kHand]);
    std::swap(recorded.sequence.objects[0], recorded.sequence.objects[kHand]);
    recorded.models.resize(1, recorded.models[0]);
    recorded.sequence.objects.resize(1, recorded.sequence.objects[0]);
    const SlamRun run = recorded.smoothed();
    for (std::size_t k = 0; k < kLength; ++k) {
      const SE3d truth = recorded.cameras[k].inverse() * recorded.truth[k][0];
      smoothed.relative[0] += nees_of(truth, *run.frames[k].relative[0]) / 6.0;
      smoothed.count[0] += 1.0;
    }
  }
  EXPECT_NEAR(smoothed.relative[0] / smoothed.count[0], 1.0, 0.25);
}

TEST(SmoothingMoving, AnObjectIsAtItsPlacesAndTheJointPosteriorHoldsTheLast) {
  const Recorded recorded(3);
  const SlamRun run = recorded.smoothed({.record_hypotheses = true, .progress = {}});
  ASSERT_EQ(run.frames.size(), kLength);
  for (std::size_t k = 0; k < kLength; ++k) {
    SCOPED_TRACE(k);
    const FrameEstimate& frame = run.frames[k];
    EXPECT_EQ(frame.objects[kCup].has_value(), k >= 2);
    if (!frame.objects[kCup]) continue;
    EXPECT_LT(std::sqrt(squared_distance(*frame.objects[kCup], recorded.truth[k][1])), 0.02);
    EXPECT_GT(*frame.mode_probabilities[kCup], 0.99);
    EXPECT_EQ(frame.object("hand").motion_models.size(), 1U);
    EXPECT_TRUE(frame.object("hand").twist.has_value());
    EXPECT_FALSE(frame.alternatives[kHand].empty());
    EXPECT_FALSE(frame.pose_indices[kHand]);
  }
  // The camera, the box, the mug and both places of the cup.
  EXPECT_EQ(run.posterior.components().front().density.mean().size(), 5U);
  EXPECT_NE(run.frames[kMoved].pose_indices[kCup], run.frames[kMoved - 1].pose_indices[kCup]);
  EXPECT_EQ(run.pose_indices, run.frames.back().pose_indices);
  ASSERT_EQ(run.hypotheses.size(), 4U);
  EXPECT_FALSE(run.hypotheses[kHand].empty());
  EXPECT_FALSE(run.hypotheses[kCup].empty());
}

TEST(SmoothingMoving, ObservationsGiveWhatDetectionsGive) {
  const Recorded recorded(4);
  Recorded other = recorded;
  other.sequence.observations.resize(kLength);
  for (std::size_t k = 0; k < kLength; ++k) {
    for (const ObjectRecording& object : recorded.sequence.objects) {
      if (!object.detections[k]) continue;
      Observation seen = observation_of(*object.detections[k]);
      seen.object = object.id;
      other.sequence.observations[k].push_back(seen);
    }
  }
  const SlamRun a = recorded.smoothed();
  const SlamRun b = other.smoothed();
  for (std::size_t k = 0; k < kLength; ++k) {
    expect_same_bits(a.frames[k].camera, b.frames[k].camera);
    for (std::size_t j = 0; j < recorded.models.size(); ++j) {
      ASSERT_EQ(a.frames[k].objects[j].has_value(), b.frames[k].objects[j].has_value());
      if (a.frames[k].objects[j])
        expect_same_bits(*a.frames[k].objects[j], *b.frames[k].objects[j]);
    }
  }
}

TEST(SmoothingMoving, DetectionsOfAClassAreSmoothedAsTheFilterAssignsThem) {
  const Recorded recorded(8);
  Recorded other = recorded;
  other.sequence.candidates.resize(kLength);
  for (const std::size_t j : {1U, 0U}) {
    other.models[j].class_id = "crate";
    for (std::size_t k = 0; k < kLength; ++k) {
      auto& seen = other.sequence.objects[j].detections[k];
      if (seen) other.sequence.candidates[k].push_back({"crate", *seen, 0.9});
      seen.reset();
    }
  }
  // Somewhere else, once: an instance has begun for none of it.
  other.sequence.candidates[20].push_back({"crate", pose(0, 0, 0, 0.3, 0.3, 1.0), 0.9});
  const SlamRun a = recorded.smoothed();
  const SlamRun b = other.smoothed();
  ASSERT_EQ(b.frames.size(), kLength);
  EXPECT_LT(testing::distance(a.frames[40].camera.mean(), b.frames[40].camera.mean()), 0.005);
  for (std::size_t j = 0; j < 2; ++j) {
    ASSERT_TRUE(b.frames[40].objects[j]);
    EXPECT_LT(testing::distance(a.frames[40].objects[j]->mean(), b.frames[40].objects[j]->mean()),
              0.01);
  }
  for (std::size_t j = kHand; j <= kCup; ++j)
    EXPECT_LT(testing::distance(a.frames[40].objects[j]->mean(), b.frames[40].objects[j]->mean()),
              0.02);
}

TEST(SmoothingMoving, NoObjectIsForgottenBecauseOfHowItBegan) {
  Recorded recorded(9);
  recorded.sequence.observations.resize(kLength);
  for (std::size_t k = 0; k < kLength; ++k) {
    for (std::size_t j = 0; j < 2; ++j) {
      Observation seen = observation_of(*recorded.sequence.objects[j].detections[k]);
      (j == 0 ? seen.object : seen.class_id) = recorded.models[j].id;
      // Twice in the first image, as by two cameras.
      recorded.sequence.observations[k].resize(
          recorded.sequence.observations[k].size() + (j == 0 && k == 0 ? 2 : 1), seen);
    }
  }
  EXPECT_TRUE(recorded.smoothed().frames.front().objects[0]);
  recorded.models[0].prior = ObjectPrior{PoseDensity(SE3d(), isotropic(30.0, 1.0)), 0.95};
  const SlamRun run = recorded.smoothed();
  EXPECT_LT(run.frames.front().objects[0]->covariance()(3, 3), 1e-3);
  EXPECT_TRUE(run.frames.back().objects[1]);

  MultiObjectSlamSettings settings = plain_slam();
  settings.on_sight = ObjectModel{.id = "any", .noise = ray_noise()};
  recorded.settings.tracker = settings;
  recorded.sequence.observations[20][0].object = "later";
  EXPECT_NE(thrown_message([&] { recorded.smoothed(); }).find("objects begin on sight"),
            std::string::npos);
}

TEST(SmoothingMoving, ARunThatIsStoppedHasTheFramesSoFar) {
  const Recorded recorded(5);
  for (const std::size_t last : {std::size_t{1}, std::size_t{20}}) {
    const SlamRun run = recorded.smoothed({.progress = [&](std::size_t done, std::size_t all) {
      EXPECT_EQ(all, kLength);
      return done < last;
    }});
    EXPECT_EQ(run.frames.size(), last);
  }
}

TEST(SmoothingMoving, ARecordingInWhichAllMovesIsSmoothed) {
  Recorded recorded(6);
  for (const std::size_t gone : {kCup, std::size_t{1}, std::size_t{0}}) {
    recorded.models.erase(recorded.models.begin() + static_cast<std::ptrdiff_t>(gone));
    recorded.sequence.objects.erase(recorded.sequence.objects.begin() +
                                    static_cast<std::ptrdiff_t>(gone));
  }
  const SlamRun run = recorded.smoothed();
  ASSERT_EQ(run.frames.size(), kLength);
  EXPECT_LT(std::sqrt(squared_distance(*run.frames[30].relative[0],
                                       recorded.cameras[30].inverse() * recorded.truth[30][0])),
            0.03);
}

TEST(SmoothingMoving, RefusesWhatItCannotDo) {
  Recorded recorded(7);
  EXPECT_NE(thrown_message([&] {
              run_smoothed(recorded.sequence, *recorded.prior, recorded.models, recorded.settings,
                           {.lag_frames = 3});
            }).find("smoothing by a fixed lag: object 'hand' moves"),
            std::string::npos);
  Recorded of_class(7);
  of_class.models.erase(of_class.models.begin() + kHand, of_class.models.end());
  of_class.sequence.objects.resize(2, of_class.sequence.objects[0]);
  of_class.sequence.candidates.resize(kLength);
  of_class.sequence.candidates[1].push_back({"box", SE3d(), 0.9});
  EXPECT_NE(thrown_message([&] {
              run_smoothed(of_class.sequence, *of_class.prior, of_class.models, of_class.settings,
                           {.lag_frames = 3});
            }).find("smoothing by a fixed lag: detections that name a class"),
            std::string::npos);
  recorded.models[kCup].detectors = {{"other", ray_noise()}};
  EXPECT_NE(thrown_message([&] {
              recorded.smoothed();
            }).find("object 'cup' is put down elsewhere and has 2 noise models"),
            std::string::npos);
}

}  // namespace
}  // namespace posemix
