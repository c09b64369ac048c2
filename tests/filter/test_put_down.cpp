// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Objects that are put down elsewhere, in the filter of many objects.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "put_down_scene.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::kFlipOfObject;
using testing::nees_of;
using testing::plain_settings;
using testing::pose;
using testing::PutDownScene;
using testing::Runs;
using testing::SceneNoise;

constexpr double kFramePeriod = 0.1;
constexpr std::size_t kPutDown = 6;

bool is_near(const SE3d& truth, const SE3d& mean) {
  return (truth.rotation().inverse() * mean.rotation()).angle() < radians(20.0) &&
         (truth.translation() - mean.translation()).norm() < 0.04;
}

/// The leading hypothesis of an object, seen from the camera: free of the camera's own drift.
bool is_right(const PutDownScene& scene, const MultiObjectFilter& filter, std::size_t j) {
  const auto leading = filter.leading(j);
  if (!leading) return false;
  const SE3d seen = filter.camera().mean().inverse() * filter.hypothesis_means(j)[*leading].pose;
  return is_near(scene.truth[j], scene.camera * seen);
}

MultiObjectFilter put_down_filter(const PutDownScene& scene, const DetectorNoise& noise,
                                  const std::optional<PutDownMotion>& motion) {
  MultiObjectSettings settings = plain_settings();
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)), {},
                           settings);
  for (std::size_t j = 0; j < scene.truth.size(); ++j) filter.add_object({noise}, {}, motion);
  return filter;
}

double squared_error(const SE3d& truth, const SE3d& estimate) {
  return (truth.translation() - estimate.translation()).squaredNorm();
}

struct Course {
  std::vector<int> noticed;  ///< detections until the new place leads, by move
  std::vector<double> nees;  ///< of moved objects that are right, from the camera
  double camera = 0.0;       ///< mean squared error of the camera's position
  double odometry = 0.0;     ///< the same of odometry alone
};

/// 300 frames in which the first half of the objects is put down elsewhere twice.
Course course(std::uint64_t seed, const DetectorNoise& noise,
              const std::optional<PutDownMotion>& motion, int moves, int frames = 300) {
  PutDownScene scene(seed, kPutDown, noise);
  std::vector<std::vector<int>> times(kPutDown);
  RandomStream chance(seed, 5);
  for (std::size_t j = 0; j < kPutDown / 2; ++j) {
    for (int m = 0; m < moves; ++m) {
      const int part = (frames - 80) / moves;
      times[j].push_back(40 + m * part + static_cast<int>(chance.uniform() * (part - 35)));
    }
  }
  MultiObjectFilter filter = put_down_filter(scene, noise, motion);
  SE3d by_odometry = scene.camera;
  Course result;
  std::vector<int> since(kPutDown, -1);
  for (int frame = 0; frame < frames; ++frame) {
    const SE3d odometry = scene.advance();
    by_odometry = by_odometry * odometry;
    filter.predict_with_odometry(odometry, scene.q, kFramePeriod);
    for (std::size_t j = 0; j < kPutDown; ++j) {
      if (std::count(times[j].begin(), times[j].end(), frame) > 0) {
        scene.put_down(j);
        since[j] = 0;
      }
      filter.update(j, scene.detect(j));
      const bool right = is_right(scene, filter, j);
      if (since[j] >= 0) {
        ++since[j];
        if (right || since[j] == 30) {
          result.noticed.push_back(since[j]);
          since[j] = -1;
        }
      }
      if (times[j].empty() || frame < times[j].front() || !right) continue;
      const auto leading = *filter.leading(j);
      result.nees.push_back(
          nees_of(scene.camera.inverse() * scene.truth[j], filter.relative(j, leading)) / 6.0);
    }
    result.camera += squared_error(scene.camera, filter.camera().mean()) / frames;
    result.odometry += squared_error(scene.camera, by_odometry) / frames;
  }
  return result;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TEST(PutDown, IsNoticedWithinFiveDetectionsAndLeavesTheCameraAlone) {
  const DetectorNoise noise =
      SceneNoise{.gross = 0.04, .clutter = 0.02, .mode_time_s = 1.0}.noise();
  std::vector<int> noticed;
  std::vector<double> nees;
  std::vector<double> over_odometry;
  std::vector<double> over_still;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Course moved = course(seed, noise, PutDownMotion{}, 2);
    const Course still = course(seed, noise, PutDownMotion{}, 0);
    noticed.insert(noticed.end(), moved.noticed.begin(), moved.noticed.end());
    nees.push_back(mean_of(moved.nees));
    over_odometry.push_back(std::sqrt(moved.camera / moved.odometry));
    over_still.push_back(std::sqrt(moved.camera / still.camera));
  }
  EXPECT_EQ(noticed.size(), 24U);
  EXPECT_LE(*std::max_element(noticed.begin(), noticed.end()), 5);
  EXPECT_GT(mean_of(nees), 0.8);
  EXPECT_LT(mean_of(nees), 1.25);
  EXPECT_LT(*std::max_element(over_odometry.begin(), over_odometry.end()), 0.5);
  EXPECT_LT(mean_of(over_still), 1.2);
}

struct FalseMoves {
  std::size_t detections = 0;
  std::size_t moves = 0;
  std::size_t right = 0;
};

FalseMoves false_moves(const DetectorNoise& noise, const PutDownMotion& motion, const Runs& runs,
                       int seeds, int frames) {
  FalseMoves result;
  for (int seed = 0; seed < seeds; ++seed) {
    PutDownScene scene(static_cast<std::uint64_t>(seed), kPutDown, noise, runs);
    MultiObjectFilter filter = put_down_filter(scene, noise, motion);
    std::vector<bool> was_right(kPutDown, true);
    for (int frame = 0; frame < frames; ++frame) {
      filter.predict_with_odometry(scene.advance(), scene.q, kFramePeriod);
      for (std::size_t j = 0; j < kPutDown; ++j) {
        filter.update(j, scene.detect(j, frame > 200));
        if (frame < 200) continue;
        const bool right = is_right(scene, filter, j);
        result.moves += was_right[j] && !right ? 1 : 0;
        was_right[j] = right;
        ++result.detections;
        result.right += right ? 1 : 0;
      }
    }
  }
  return result;
}

TEST(PutDown, IsNotSeenInRunsOfKnownFlips) {
  const DetectorNoise noise =
      SceneNoise{.gross = 0.04, .clutter = 0.02, .flips = 0.25, .mode_time_s = 3.0}.noise();
  const FalseMoves result = false_moves(noise, {}, {.length = 30, .part = 0.25}, 16, 700);
  EXPECT_LE(result.moves, result.detections / 10000);
}

TEST(PutDown, IsNotSeenInRunsOfFlipsThatTheNoiseDoesNotKnow) {
  const DetectorNoise noise =
      SceneNoise{.gross = 0.04, .clutter = 0.25, .mode_time_s = 3.0}.noise();
  const FalseMoves result = false_moves(noise, {}, {.length = 30, .part = 0.25}, 1, 700);
  EXPECT_LE(result.moves, result.detections / 10000);
}

TEST(PutDown, IsAsProbableInRunsElsewhereAsTheRatesSay) {
  const DetectorNoise noise =
      SceneNoise{.gross = 0.04, .clutter = 0.25, .mode_time_s = 3.0}.noise();
  const FalseMoves result = false_moves(
      noise, {.jump_rate = 1e-4},
      {.length = 30, .part = 0.25, .flip = pose(0.5, 0.2, 1.0, 0.2, -0.1, 0.1)}, 1, 700);
  EXPECT_LE(result.moves, result.detections / 10000);
}

/// Log odds of the two heaviest places, the newer over the older.
double log_odds(std::vector<HypothesisMean> places) {
  if (places.size() < 2) return 0.0;
  return std::log(places[1].probability / places[0].probability);
}

// Where the camera is known the weights are those of the filter of one object that moves.
TEST(PutDown, HasTheOddsOfTheFilterOfOneObject) {
  const DetectorNoise noise = SceneNoise{.gross = 0.0, .clutter = 0.1, .mode_time_s = 2.0}.noise();
  const PutDownMotion motion{.jump_rate = 0.05, .volume_m3 = 2.0};
  MovingObjectSettings alone = testing::plain_moving_settings();
  alone.lost_rate = 0.0;
  MovingObjectFilter one({noise}, {.models = {motion}}, alone);
  const ConcentratedGaussian<SE3d> camera(testing::scene_camera(), isotropic(1e-3, 1e-6));
  MultiObjectFilter many(camera, {}, plain_settings());
  many.add_object({noise}, {}, motion);
  const SE3d here = camera.mean().inverse() * pose(0.3, 0.2, 0.5, 0.02, -0.03, 0.01);
  const SE3d there = here * pose(0.5, 1.0, 0.4, 0.2, 0.1, 0.1);
  for (int k = 0; k < 60; ++k) {
    const SE3d seen = k < 50 ? here : there;
    Observation observation = observation_of(seen);
    observation.stamp_s = kFramePeriod * k;
    one.update(observation, exact_camera(camera.mean()));
    many.set_camera(camera, kFramePeriod);
    many.update(0, seen);
    if (k < 50) continue;
    std::vector<HypothesisMean> places;
    for (const auto& h : one.estimate().hypotheses)
      places.push_back({h.world.mean(), h.probability, h.id});
    std::sort(places.begin(), places.end(),
              [](const auto& a, const auto& b) { return a.id < b.id; });
    EXPECT_NEAR(log_odds(many.hypothesis_means(0)), log_odds(places), 0.05) << k;
  }
}

TEST(PutDown, ARateOfZeroIsNone) {
  PutDownScene scene(3, 2, SceneNoise{}.noise());
  MultiObjectFilter with =
      put_down_filter(scene, SceneNoise{}.noise(), PutDownMotion{.jump_rate = 0.0});
  MultiObjectFilter without = put_down_filter(scene, SceneNoise{}.noise(), {});
  for (int k = 0; k < 20; ++k) {
    const SE3d odometry = scene.advance();
    for (MultiObjectFilter* f : {&with, &without}) f->predict_with_odometry(odometry, scene.q, 0.1);
    const SE3d seen = scene.detect(0);
    for (MultiObjectFilter* f : {&with, &without}) f->update(0, seen);
  }
  EXPECT_EQ(with.joint().covariance(), without.joint().covariance());
  EXPECT_EQ(with.camera().mean().matrix(), without.camera().mean().matrix());
  EXPECT_THROW(with.add_object({SceneNoise{}.noise()}, {}, PutDownMotion{.jump_rate = -1.0}),
               InvalidInput);
}

// A gross error at the birth would make all right detections after it look like a run.
TEST(PutDown, AnObjectIsFirstAsUncertainAsTheWidestComponentOfTheNoise) {
  const SE3d seen = pose(0.3, 0.2, 0.5, 0.02, -0.03, 0.8);
  const NoiseComponent wide{.weight = 0.2, .covariance = isotropic(6.0, 0.03)};
  const NoiseComponent sharp{.weight = 0.7, .covariance = isotropic(2.0, 0.01)};
  const Matrix6d expected = seen.adjoint_congruence(wide.covariance);
  for (const auto& components : {std::vector{sharp, wide}, std::vector{wide, sharp}}) {
    const DetectorNoise noise(components, {.weight = 0.1, .volume_m3 = 1.0});
    MultiObjectFilter filter({SE3d(), isotropic(0.1, 0.002)}, {}, plain_settings());
    filter.add_object({noise}, {}, PutDownMotion{});
    filter.update(0, seen);
    EXPECT_TRUE(filter.relative(0, 0).covariance().isApprox(expected, 1e-9));
  }
}

// What is forgotten may be put down elsewhere again, and is found.
TEST(PutDown, AnObjectThatWasForgottenIsFound) {
  PutDownScene scene(4, 1, SceneNoise{}.noise());
  MultiObjectFilter filter = put_down_filter(scene, SceneNoise{}.noise(), PutDownMotion{});
  for (int k = 0; k < 20; ++k) {
    if (k == 10) filter.forget(0);
    filter.predict_with_odometry(scene.advance(), scene.q, kFramePeriod);
    filter.update(0, scene.camera.inverse() * scene.truth[0]);
  }
  EXPECT_TRUE(is_right(scene, filter, 0));
}

TEST(GivenCamera, IsIndependentOfWhatWasBefore) {
  PutDownScene scene(5, 2, SceneNoise{}.noise());
  MultiObjectFilter filter = put_down_filter(scene, SceneNoise{}.noise(), {});
  for (int k = 0; k < 10; ++k) {
    filter.predict_with_odometry(scene.advance(), scene.q, kFramePeriod);
    for (const std::size_t j : {0U, 1U}) filter.update(j, scene.detect(j));
  }
  const Eigen::MatrixXd before = filter.joint().covariance();
  const ConcentratedGaussian<SE3d> given(scene.camera, isotropic(0.5, 0.004));
  filter.set_camera(given, kFramePeriod);
  const Eigen::MatrixXd after = filter.joint().covariance();
  EXPECT_EQ(filter.camera().mean().matrix(), scene.camera.matrix());
  EXPECT_EQ(filter.camera().covariance(), given.covariance());
  EXPECT_TRUE(after.topRightCorner(6, 12).isZero(0.0));
  EXPECT_EQ(after.bottomRightCorner(12, 12), before.bottomRightCorner(12, 12));
  EXPECT_THROW(filter.set_camera(given, -1.0), InvalidInput);
  EXPECT_THROW(filter.set_camera(ConcentratedGaussian<SE3d>::trusted(SE3d(), -given.covariance()),
                                 kFramePeriod),
               InvalidInput);
}

// On an arm whose pose errs by 0.5 degrees and 4 mm anew in each image.
TEST(GivenCamera, ObjectsAreAveragesOverImages) {
  const DetectorNoise noise = SceneNoise{.gross = 0.0, .clutter = 0.02}.noise();
  const Matrix6d arm = isotropic(0.5, 4e-3);
  double nees = 0.0;
  constexpr int kSeeds = 30;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    PutDownScene scene(seed, 1, noise);
    MultiObjectFilter filter = put_down_filter(scene, noise, PutDownMotion{});
    for (int k = 0; k < 40; ++k) {
      scene.advance();
      const SE3d given = SE3d::exp(testing::draw(arm, scene.stream)) * scene.camera;
      filter.set_camera({given, arm}, kFramePeriod);
      filter.update(0, scene.detect(0));
    }
    const ObjectHypothesis h = filter.hypotheses(0)[*filter.leading(0)];
    EXPECT_LT((h.pose.translation() - scene.truth[0].translation()).norm(), 0.01);
    nees += nees_of(scene.truth[0], ConcentratedGaussian<SE3d>(h.pose, h.covariance)) / 6 / kSeeds;
  }
  EXPECT_GT(nees, 0.75);
  EXPECT_LT(nees, 1.3);
}

}  // namespace
}  // namespace posemix
