// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "multi_object_scene.hpp"
#include "posemix/density/pose_stack.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::OrbitScene;
using testing::plain_settings;
using testing::ray_noise;

MultiObjectFilter make(const OrbitScene& scene, const MultiObjectSettings& settings) {
  std::vector<ObjectSensor> sensors(scene.truth.size(), {ray_noise()});
  return {ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)), sensors, settings};
}

void see_all(MultiObjectFilter& filter, OrbitScene& scene, int frames) {
  for (int k = 0; k < frames; ++k) {
    filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    for (std::size_t j = 0; j < scene.truth.size(); ++j)
      filter.update(j, scene.detect(j, 0.2, 0.0));
  }
}

// To forget is to marginalise: the oracle is a filter that keeps the object.
TEST(Forget, TheRestIsAsBefore) {
  OrbitScene scene(1, 3, 0.3, 5e-3);
  MultiObjectFilter kept = make(scene, plain_settings());
  see_all(kept, scene, 8);
  MultiObjectFilter filter = kept;
  filter.forget(1);

  EXPECT_FALSE(filter.leading(1).has_value());
  EXPECT_TRUE(filter.hypotheses(1).empty());
  EXPECT_EQ(filter.log_absent(1), 0.0);
  EXPECT_EQ(filter.mode_probability(1), 0.0);
  EXPECT_EQ(filter.pose_index(0), std::optional<std::size_t>(1));
  EXPECT_EQ(filter.pose_index(1), std::nullopt);
  EXPECT_EQ(filter.pose_index(2), std::optional<std::size_t>(2));
  ASSERT_EQ(filter.joint().mean().size(), 3U);

  for (int k = 0; k < 3; ++k) {
    const SE3d odometry = scene.advance();
    for (MultiObjectFilter* f : {&kept, &filter}) f->predict_with_odometry(odometry, scene.q, 0.1);
    for (const std::size_t j : {std::size_t{0}, std::size_t{2}}) {
      const SE3d seen = scene.detect(j, 0.2, 0.0);
      for (MultiObjectFilter* f : {&kept, &filter}) f->update(j, seen);
    }
    // Rounding of 8 frames, far below the standard deviations of 1e-3.
    EXPECT_TRUE(filter.camera().mean().is_approx(kept.camera().mean(), 1e-9));
    EXPECT_TRUE(filter.camera().covariance().isApprox(kept.camera().covariance(), 1e-6));
    for (const std::size_t j : {std::size_t{0}, std::size_t{2}}) {
      const auto a = filter.relative(j, *filter.leading(j));
      const auto b = kept.relative(j, *kept.leading(j));
      EXPECT_TRUE(a.mean().is_approx(b.mean(), 1e-9));
      EXPECT_TRUE(a.covariance().isApprox(b.covariance(), 1e-6));
    }
  }
}

TEST(Forget, TheObjectBeginsAnew) {
  OrbitScene scene(2, 2, 0.3, 5e-3);
  MultiObjectFilter filter = make(scene, {});
  see_all(filter, scene, 20);
  ASSERT_FALSE(filter.noise_scale(0).isOnes(1e-3));
  filter.forget(0);
  EXPECT_TRUE(filter.noise_scale(0).isOnes(0.0));
  const ObjectUpdateReport report = filter.update(0, scene.camera.inverse() * scene.truth[0]);
  EXPECT_TRUE(report.started);
  EXPECT_EQ(filter.hypotheses(0).size(), 1U);
  EXPECT_EQ(filter.hypotheses(0).front().detections, 1U);
  EXPECT_EQ(filter.pose_index(1), std::optional<std::size_t>(1));
  EXPECT_EQ(filter.pose_index(0), std::optional<std::size_t>(2));
}

// The reported covariance of the camera must not jump when the last object with detections is
// forgotten.
TEST(Forget, TheLastOneLeavesTheCamera) {
  OrbitScene scene(3, 1, 0.3, 5e-3);
  MultiObjectFilter filter = make(scene, {});
  see_all(filter, scene, 5);
  const auto before = filter.camera();
  filter.forget(0);
  EXPECT_TRUE(filter.camera().mean().is_approx(before.mean(), 1e-15));
  EXPECT_TRUE(filter.camera().covariance().isApprox(before.covariance(), 1e-12));
  EXPECT_EQ(filter.joint().mean().size(), 1U);
}

TEST(Forget, TheCamerasMotionStays) {
  OrbitScene scene(4, 2, 0.3, 5e-3);
  MultiObjectFilter kept = make(scene, plain_settings());
  kept.update(0, scene.detect(0, 0.0, 0.0));
  const Matrix6d q = isotropic(0.2, 0.002);
  const auto step = [&](MultiObjectFilter& filter) {
    filter.predict_constant_velocity(1.0, q, q, isotropic(2.0, 0.02), 0.1);
  };
  for (int k = 0; k < 4; ++k) {
    step(kept);
    scene.advance();
    for (const std::size_t j : {std::size_t{0}, std::size_t{1}})
      kept.update(j, scene.detect(j, 0.0, 0.0));
  }
  MultiObjectFilter filter = kept;
  filter.forget(0);  // its pose is before that of the motion
  step(kept);
  step(filter);
  EXPECT_TRUE(filter.camera().mean().is_approx(kept.camera().mean(), 1e-12));
  EXPECT_TRUE(filter.camera().covariance().isApprox(kept.camera().covariance(), 1e-9));
}

TEST(Forget, RefusesWhatIsNotThere) {
  OrbitScene scene(5, 1, 0.3, 5e-3);
  MultiObjectFilter filter = make(scene, {});
  EXPECT_THROW(filter.forget(1), InvalidInput);
  filter.forget(0);  // never seen: nothing to do
  EXPECT_EQ(filter.joint().mean().size(), 1U);
}

}  // namespace
}  // namespace posemix
