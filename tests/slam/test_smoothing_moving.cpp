// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "moving_recording.hpp"
#include "posemix/testing/expect.hpp"
#include "smoothing_scene.hpp"

/// Smoothing of recordings in which objects move, and are put down elsewhere.
namespace posemix {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace)

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

/// A place of which nothing is left between two looks.
TEST(SmoothingMoving, WhatIsPutDownAndLostIsSmoothedToo) {
  Sequence sequence;
  sequence.objects.push_back({.id = "mug"});
  for (int k = 0; k < 20; ++k) {
    sequence.stamps.push_back(100.0 * k);
    sequence.objects[0].detections.emplace_back(SE3d(SO3d(), {0.0, 0.0, 0.8}));
  }
  const ObjectModel mug{.id = "mug", .motion = moving_by(PutDownMotion{})};
  ObjectSlamSettings settings;
  settings.tracker = MultiObjectSlamSettings{};
  settings.motion.model = MotionModel::random_walk;
  const SlamRun run =
      run_smoothed(sequence, {SE3d(), isotropic(0.3, 0.005)}, {mug}, settings, {}, {});
  ASSERT_EQ(run.frames.size(), 20U);
  int lost = 0;
  for (const FrameEstimate& frame : run.frames) {
    const auto probability = frame.mode_probabilities[0];
    if (!probability) continue;
    EXPECT_TRUE(*probability >= 0.0 && *probability <= 1.0);
    if (*probability == 0.0) ++lost;
  }
  EXPECT_GT(lost, 0);
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
    // When it was moved between two detections is not known.
    const bool is_seen = recorded.sequence.objects[kCup].detections[k].has_value();
    EXPECT_GT(*frame.mode_probabilities[kCup], is_seen ? 0.99 : 0.4);
    EXPECT_LT(*frame.mode_probabilities[kCup], 1.0);
    EXPECT_EQ(frame.object("hand").motion_models.size(), 1U);
    EXPECT_EQ(frame.healths.size(), 4U);
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
  EXPECT_LT(distance(a.frames[40].camera.mean(), b.frames[40].camera.mean()), 0.005);
  for (std::size_t j = 0; j < 2; ++j) {
    ASSERT_TRUE(b.frames[40].objects[j]);
    EXPECT_LT(distance(a.frames[40].objects[j]->mean(), b.frames[40].objects[j]->mean()), 0.01);
  }
  for (std::size_t j = kHand; j <= kCup; ++j)
    EXPECT_LT(distance(a.frames[40].objects[j]->mean(), b.frames[40].objects[j]->mean()), 0.02);
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

TEST(SmoothingMoving, FramesWithoutDetectionsTellNothing) {
  const Recorded recorded(10);
  Recorded with_gap = recorded;
  for (std::size_t k = 20; k < 50; ++k) with_gap.sequence.objects[kHand].detections[k].reset();
  const SlamRun filtered = with_gap.filtered();
  const SlamRun smoothed = with_gap.smoothed();
  const auto variance = [](const SlamRun& run, std::size_t k) {
    return run.frames[k].relative[kHand]->covariance().diagonal().tail<3>().sum();
  };
  for (std::size_t k = 0; k < kLength; ++k)
    EXPECT_LT(variance(smoothed, k), 1.05 * variance(filtered, k)) << k;
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

TEST(SmoothingMoving, ShowsItsProgressAfterTheFilterAndCanBeStoppedThen) {
  const Recorded recorded(5);
  std::size_t calls = 0;
  recorded.smoothed({.progress = [&](std::size_t, std::size_t) { return ++calls > 0; }});
  EXPECT_EQ(calls, 2 * kLength);
  calls = 0;
  const SlamRun run = recorded.smoothed(
      {.progress = [&](std::size_t, std::size_t) { return ++calls < kLength + 20; }});
  EXPECT_EQ(run.frames.size(), 20U);
  EXPECT_EQ(run.hypotheses.size(), 4U);
}

TEST(SmoothingMoving, ObjectsMayHaveAnyIds) {
  const Recorded recorded(5);
  Recorded other = recorded;
  for (const auto& [object, id] : {std::pair(0, "cup (place 1)"), std::pair(1, "cup (place 1)'")})
    other.models[object].id = other.sequence.objects[object].id = id;
  const SlamRun run = other.smoothed();
  // Sums may be taken in another order, that of the ids.
  const SE3d camera = recorded.smoothed().frames.back().camera.mean();
  EXPECT_LT((camera.inverse() * run.frames.back().camera.mean()).log().norm(), 1e-9);
  EXPECT_EQ(*run.frames.back().ids, *other.filtered().frames.back().ids);
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
  // Before the filter runs.
  EXPECT_NE(thrown_message([&] {
              recorded.smoothed({.progress = [](std::size_t, std::size_t) -> bool {
                throw std::logic_error("the filter ran");
              }});
            }).find("object 'cup' is put down elsewhere and has 2 noise models"),
            std::string::npos);
}

}  // namespace
}  // namespace posemix
