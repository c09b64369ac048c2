// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "filter/moving_object_scene.hpp"
#include "filter/multi_object_scene.hpp"
#include "posemix/slam/multi_object_slam.hpp"

/// An object that moves beside two static ones, for the tests of object SLAM.
namespace posemix::testing {

inline MotionModels moving_by(const ObjectMotion& motion) { return {.models = {motion}}; }

inline const ConstantVelocityMotion kMoves{.acceleration_sds = sds(0.3, 0.1), .break_rate = 0.0};

/// A camera that circles two static objects and one that moves.
struct MovingOrbit : OrbitScene {
  explicit MovingOrbit(std::uint64_t seed)
      : OrbitScene(seed, 2, 0.05, 1e-3), moving(seed, SceneNoise{.clutter = 0.02}.noise()) {
    moving.truth = pose(0.3, 0.2, 0.5, 0.0, 0.15, 0.05);
    moving.camera = camera;
  }

  SE3d next() {
    const SE3d motion = advance();
    moving.advance(kMoves, 0.1);
    moving.camera = camera;
    return motion;
  }

  MovingScene moving;
};

inline std::vector<ObjectModel> static_models() {
  return {{.id = "box", .noise = ray_noise()}, {.id = "mug", .noise = ray_noise()}};
}

inline ObjectModel hand(const MotionModels& motion = moving_by(kMoves)) {
  return {.id = "hand", .noise = SceneNoise{.clutter = 0.02}.noise(), .motion = motion};
}

inline MultiObjectSlamSettings plain_slam() { return {.filter = plain_settings()}; }

inline PoseDensity start_near(const SE3d& camera) { return {camera, isotropic(0.3, 0.005)}; }

inline void expect_same_bits(const PoseDensity& a, const PoseDensity& b) {
  EXPECT_EQ(a.mean().matrix(), b.mean().matrix());
  EXPECT_EQ(a.covariance(), b.covariance());
}

}  // namespace posemix::testing
