// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Smoothing of a rig whose cameras see an object from two sides, by a detector with slow errors.
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/detector/default_noise.hpp"
#include "smoothing_scene.hpp"

namespace posemix {
namespace {

using testing::draw;
using testing::isotropic;
using testing::pose;

constexpr int kRigFrames = 40;
constexpr std::uint64_t kRigSeeds = 12;
const SE3d kRigObject = pose(0.3, 0.2, 0.1, 0, 0, 1.0);

struct SmoothedRig {
  double nees = 0.0;      ///< of the object from the body per degree of freedom, over all frames
  double square_m = 0.0;  ///< mean of its squared distance
  std::size_t count = 0;

  double mean_nees() const { return nees / static_cast<double>(count); }
  double rms_mm() const { return 1e3 * std::sqrt(square_m / static_cast<double>(count)); }
};

ObjectSlamSettings rig_settings(const SE3d& second) {
  MultiObjectSlamSettings tracker;
  tracker.cameras = {{"first", SE3d()}, {"second", second}};
  ObjectSlamSettings settings{.motion = {}, .tracker = tracker};
  settings.motion.noise = {isotropic(0.02, 2e-4), NoisePer::frame};
  return settings;
}

/// Slow errors of the cameras are one process over the direction that they see from.
SmoothedRig smooth_rig(double apart_deg, int cameras, std::size_t lag_frames, double turn_rad) {
  const DetectorNoise noise = default_detector_noise();
  const SlowError slow = *noise.dependence().slow;
  const NoiseComponent& white = noise.components().front();
  const SE3d place(SO3d(), kRigObject.translation());
  const SE3d second =
      place * pose(0, apart_deg * std::numbers::pi / 180.0, 0, 0, 0, 0) * place.inverse();
  const SE3d motion = place * pose(0, turn_rad, 0, 0, 0, 0) * place.inverse();
  const Matrix6d start = isotropic(0.05, 1e-3);
  const double with_other = slow.correlation(0.0, radians(apart_deg));
  const double a = slow.correlation(0.0, turn_rad);
  SmoothedRig result;
  for (std::uint64_t seed = 1; seed <= kRigSeeds; ++seed) {
    RandomStream stream(seed, 13);
    const auto other_than = [&](const Vector6d& one) -> Vector6d {
      return with_other * one +
             std::sqrt(1.0 - with_other * with_other) * draw(slow.covariance, stream);
    };
    FixedLagSmoother smoother({SE3d::exp(draw(start, stream)).inverse(), start}, {{.id = "mug"}},
                              rig_settings(second), {.lag_frames = lag_frames});
    std::vector<Vector6d> b{draw(slow.covariance, stream)};
    b.push_back(other_than(b[0]));
    SE3d body;
    std::vector<SE3d> bodies;
    std::vector<FrameEstimate> estimates;
    for (int frame = 0; frame < kRigFrames; ++frame) {
      FrameInput input{.dt = 0.1};
      if (frame > 0) {
        body = body * motion;
        input.motion = motion * SE3d::exp(draw(isotropic(0.02, 2e-4), stream)).inverse();
        const Vector6d fresh = draw(slow.covariance, stream);
        const Vector6d fresh_other = other_than(fresh);
        b[0] = a * b[0] + std::sqrt(1.0 - a * a) * fresh;
        b[1] = a * b[1] + std::sqrt(1.0 - a * a) * fresh_other;
      }
      for (int camera = 0; camera < cameras; ++camera) {
        const SE3d seen = (body * (camera == 0 ? SE3d() : second)).inverse() * kRigObject;
        const NoiseAtPose at = noise_at(white, seen);
        Vector6d error = b[static_cast<std::size_t>(camera)];
        error.tail<3>() *= seen.translation().norm();
        error += draw(at.covariance, stream);
        Observation one = observation_of(at.axes * SE3d::exp(error) * at.axes.inverse() * seen);
        one.object = "mug";
        one.camera = camera == 0 ? "first" : "second";
        input.observations.push_back(one);
      }
      bodies.push_back(body);
      if (auto estimate = smoother.step(input)) estimates.push_back(*estimate);
    }
    for (FrameEstimate& rest : smoother.finish()) estimates.push_back(std::move(rest));
    EXPECT_EQ(estimates.size(), bodies.size());
    for (std::size_t k = 5; k < estimates.size(); ++k) {
      const PoseDensity& found = *estimates[k].relative[0];
      const SE3d truth = bodies[k].inverse() * kRigObject;
      const Vector6d error = (truth * found.mean().inverse()).log();
      result.nees += error.dot(found.covariance().llt().solve(error)) / 6.0;
      result.square_m += (truth.translation() - found.mean().translation()).squaredNorm();
      ++result.count;
    }
  }
  return result;
}

/// Two cameras in place of one: they know more of the object, and what they say is true.
TEST(SmoothingRig, CamerasHaveSlowErrorsOfTheirOwn) {
  for (const std::size_t lag : {std::size_t{5}, std::size_t{0}}) {
    const SmoothedRig one = smooth_rig(0.0, 1, lag, 0.0);
    for (const double turn : {0.0, 0.02}) {
      const SmoothedRig two = smooth_rig(60.0, 2, lag, turn);
      EXPECT_GT(two.mean_nees(), 0.5) << lag;
      EXPECT_LT(two.mean_nees(), 1.6) << lag;
      EXPECT_LT(two.rms_mm(), 0.6 * one.rms_mm()) << lag;
    }
  }
}

}  // namespace
}  // namespace posemix
