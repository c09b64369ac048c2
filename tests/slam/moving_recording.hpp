// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "moving_orbit.hpp"
#include "posemix/slam/smoothing.hpp"

/// A recording in which objects move, for the tests of smoothing.
namespace posemix::testing {

inline constexpr std::size_t kLength = 60;
inline constexpr std::size_t kMoved = 30;  ///< from this frame on the cup is elsewhere
inline constexpr std::size_t kHand = 2;
inline constexpr std::size_t kCup = 3;

/// A camera circles a box and a mug, a hand that moves, and a cup that is put down elsewhere.
struct Recorded {
  explicit Recorded(std::uint64_t seed, double odometry_sd_m = 1e-3) {
    MovingOrbit scene(seed);
    scene.q = isotropic(0.05, odometry_sd_m);
    models = static_models();
    models.push_back(hand());
    models.push_back({.id = "cup", .noise = hand().noise, .motion = moving_by(PutDownMotion{})});
    for (const ObjectModel& model : models) sequence.objects.push_back({model.id, {}, {}, {}});
    settings.tracker = plain_slam();
    std::get<MultiObjectSlamSettings>(settings.tracker).moving = plain_moving_settings();
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

inline double squared_distance(const PoseDensity& estimate, const SE3d& truth) {
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

}  // namespace posemix::testing
