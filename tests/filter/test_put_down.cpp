// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Objects that are put down elsewhere, in the filter of many objects.
#include <algorithm>
#include <cmath>
#include <cstdlib>
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

constexpr double kStep = 0.1;
constexpr std::size_t kObjects = 6;

int seeds_of(int otherwise) {
  const char* given = std::getenv("PUTDOWN_SEEDS");
  return given ? std::atoi(given) : otherwise;
}
int first_seed() {
  const char* given = std::getenv("PUTDOWN_FIRST");
  return given ? std::atoi(given) : 0;
}

bool is_at(const SE3d& truth, const SE3d& mean) {
  return (truth.rotation().inverse() * mean.rotation()).angle() < radians(20.0) &&
         (truth.translation() - mean.translation()).norm() < 0.04;
}

/// The leading hypothesis of an object, seen from the camera: free of the camera's own drift.
bool is_right(const PutDownScene& scene, const MultiObjectFilter& filter, std::size_t j) {
  const auto leading = filter.leading(j);
  if (!leading) return false;
  const SE3d seen = filter.camera().mean().inverse() * filter.hypothesis_means(j)[*leading].pose;
  return is_at(scene.truth[j], scene.camera * seen);
}

MultiObjectFilter filter_of(const PutDownScene& scene, const DetectorNoise& noise,
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
  std::vector<int> noticed;     ///< detections until the new place leads, by move
  std::vector<double> nees;     ///< of moved objects that are right, from the camera
  std::vector<double> world;    ///< the same in the world
  double camera = 0.0;          ///< mean squared error of the camera's position
  double odometry = 0.0;        ///< the same of odometry alone
  double camera_nees = 0.0;
  std::size_t wrong = 0;        ///< detections after which an object is wrong, and all
  std::size_t all = 0;
};

/// 300 frames in which the first half of the objects is put down elsewhere twice.
Course course(std::uint64_t seed, const DetectorNoise& noise,
              const std::optional<PutDownMotion>& motion, int moves, int frames = 300) {
  PutDownScene scene(seed, kObjects, noise);
  std::vector<std::vector<int>> times(kObjects);
  RandomStream chance(seed, 5);
  for (std::size_t j = 0; j < kObjects / 2; ++j) {
    for (int m = 0; m < moves; ++m) {
      const int part = (frames - 80) / moves;
      times[j].push_back(40 + m * part + static_cast<int>(chance.uniform() * (part - 35)));
    }
  }
  MultiObjectFilter filter = filter_of(scene, noise, motion);
  SE3d by_odometry = scene.camera;
  Course result;
  std::vector<int> since(kObjects, -1);
  for (int frame = 0; frame < frames; ++frame) {
    const SE3d odometry = scene.advance();
    by_odometry = by_odometry * odometry;
    filter.predict_with_odometry(odometry, scene.q, kStep);
    for (std::size_t j = 0; j < kObjects; ++j) {
      if (std::count(times[j].begin(), times[j].end(), frame) > 0) {
        scene.put_down(j);
        since[j] = 0;
      }
      filter.update(j, scene.detect(j));
      const bool right = is_right(scene, filter, j);
      if (std::getenv("PUTDOWN_TRACE") && !right && frame > 5) {
        fmt::print("frame {} object {} since {} absent {:.2f}\n", frame, j, since[j], filter.log_absent(j));
        const SE3d see = scene.camera * filter.camera().mean().inverse();
        for (const auto& h : filter.hypotheses(j)) {
          const SE3d at = see * h.pose;
          fmt::print("   id {} p {:.3g} score {:.1f} n {} off {:.3f} m {:.1f} deg sd {:.4f} {:.4f}\n", h.id, h.probability, h.score, h.detections,
            (at.translation() - scene.truth[j].translation()).norm(),
            degrees((scene.truth[j].rotation().inverse() * at.rotation()).angle()), std::sqrt(h.covariance(0,0)), std::sqrt(h.covariance(3,3)));
        }
      }
      if (since[j] >= 0) {
        ++since[j];
        if (right || since[j] == 30) {
          result.noticed.push_back(since[j]);
          since[j] = -1;
        }
      }
      if (frame < 20) continue;
      ++result.all;
      result.wrong += right ? 0 : 1;
      if (times[j].empty() || frame < times[j].front() || !right) continue;
      const auto leading = *filter.leading(j);
      result.nees.push_back(
          nees_of(scene.camera.inverse() * scene.truth[j], filter.relative(j, leading)) / 6.0);
      const ObjectHypothesis h = filter.hypotheses(j)[leading];
      result.world.push_back(
          nees_of(scene.truth[j], ConcentratedGaussian<SE3d>(h.pose, h.covariance)) / 6.0);
    }
    result.camera += squared_error(scene.camera, filter.camera().mean()) / frames;
    result.odometry += squared_error(scene.camera, by_odometry) / frames;
    result.camera_nees += nees_of(scene.camera, filter.camera()) / 6.0 / frames;
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
  std::vector<double> nees, world, over_odometry, over_static, over_moved_static, camera_nees, static_nees;
  std::size_t wrong = 0;
  const int seeds = seeds_of(6);
  for (int seed = first_seed(); seed < first_seed() + seeds; ++seed) {
    const auto s = static_cast<std::uint64_t>(seed);
    const Course moved = course(s, noise, PutDownMotion{}, 2);
    const Course still = course(s, noise, PutDownMotion{}, 0);
    const Course fixed = course(s, noise, {}, 0);
    noticed.insert(noticed.end(), moved.noticed.begin(), moved.noticed.end());
    nees.push_back(mean_of(moved.nees));
    world.push_back(mean_of(moved.world));
    wrong += still.wrong;
    over_odometry.push_back(std::sqrt(moved.camera / moved.odometry));
    over_static.push_back(std::sqrt(moved.camera / still.camera));
    over_moved_static.push_back(std::sqrt(still.camera / fixed.camera));
    camera_nees.push_back(moved.camera_nees);
    if (std::getenv("PUTDOWN_SHOW"))
      fmt::print("seed {} camera nees {:.2f} still {:.2f} fixed {:.2f} ratio {:.3f} world {:.2f} relative {:.2f} worst noticed {} wrong moved {} still {} fixed {}\n", seed,
                 moved.camera_nees, still.camera_nees, fixed.camera_nees, over_static.back(), world.back(), nees.back(),
                 *std::max_element(moved.noticed.begin(), moved.noticed.end()), moved.wrong, still.wrong, fixed.wrong);
    static_nees.push_back(fixed.camera_nees);
  }
  const auto within = std::count_if(noticed.begin(), noticed.end(), [](int n) { return n <= 5; });
  const double mean = std::accumulate(noticed.begin(), noticed.end(), 0.0) / static_cast<double>(noticed.size());
  fmt::print("moves {} within 5: {} mean {:.2f} worst {}\n", noticed.size(), within, mean,
             *std::max_element(noticed.begin(), noticed.end()));
  fmt::print("wrong while still {}\n", wrong);
  const auto show = [](const char* name, const std::vector<double>& v) {
    fmt::print("{} mean {:.3f} worst {:.3f} least {:.3f}\n", name, mean_of(v),
               *std::max_element(v.begin(), v.end()), *std::min_element(v.begin(), v.end()));
  };
  show("nees relative", nees);
  show("nees world", world);
  show("camera over odometry", over_odometry);
  show("camera over still", over_static);
  show("still with motion over without", over_moved_static);
  show("camera nees", camera_nees);
  show("camera nees, no motion", static_nees);
  EXPECT_GE(static_cast<double>(within), 0.99 * static_cast<double>(noticed.size()));
}

struct FalseMoves {
  std::size_t detections = 0;
  std::size_t moves = 0;
  std::size_t right = 0;
};

FalseMoves false_moves(const DetectorNoise& noise, const PutDownMotion& motion, const Runs& runs,
                       int seeds, int frames) {
  FalseMoves result;
  for (int seed = first_seed(); seed < first_seed() + seeds; ++seed) {
    PutDownScene scene(static_cast<std::uint64_t>(seed), kObjects, noise, runs);
    MultiObjectFilter filter = filter_of(scene, noise, motion);
    std::vector<bool> was_right(kObjects, true);
    for (int frame = 0; frame < frames; ++frame) {
      filter.predict_with_odometry(scene.advance(), scene.q, kStep);
      for (std::size_t j = 0; j < kObjects; ++j) {
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
  fmt::print("detections {} false moves {} right {:.5f}\n", result.detections, result.moves,
             static_cast<double>(result.right) / static_cast<double>(result.detections));
  return result;
}

TEST(PutDown, IsNotSeenInRunsOfKnownFlips) {
  const DetectorNoise noise =
      SceneNoise{.gross = 0.04, .clutter = 0.02, .flips = 0.25, .mode_time_s = 3.0}.noise();
  const FalseMoves result =
      false_moves(noise, {}, {.length = 30, .part = 0.25}, seeds_of(2), 1200);
  EXPECT_LE(result.moves, result.detections / 10000);
}

TEST(PutDown, IsNotSeenInRunsOfFlipsThatTheNoiseDoesNotKnow) {
  const DetectorNoise noise =
      SceneNoise{.gross = 0.04, .clutter = 0.25, .mode_time_s = 3.0}.noise();
  const FalseMoves result =
      false_moves(noise, {}, {.length = 30, .part = 0.25}, seeds_of(2), 1200);
  EXPECT_LE(result.moves, result.detections / 10000);
}

TEST(PutDown, IsAsProbableInRunsElsewhereAsTheRatesSay) {
  const DetectorNoise noise =
      SceneNoise{.gross = 0.04, .clutter = 0.25, .mode_time_s = 3.0}.noise();
  const FalseMoves result =
      false_moves(noise, {.jump_rate = 1e-4},
                  {.length = 30, .part = 0.25, .flip = pose(0.5, 0.2, 1.0, 0.2, -0.1, 0.1)},
                  seeds_of(2), 1200);
  EXPECT_LE(result.moves, result.detections / 10000);
}

}  // namespace
}  // namespace posemix
