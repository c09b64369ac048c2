// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <numbers>

#include "filter/multi_object/camera_regression.hpp"
#include "filter/multi_object/shared_world.hpp"
#include "joint_gaussian_scene.hpp"
#include "moving_object_scene.hpp"
#include "multi_object_scene.hpp"

/// The error of the world, eq. (31) of docs/many-objects.md: no detection tells of it, and a
/// hypothesis that does not lead keeps it.
namespace posemix {
namespace {

using internal::ConditionalPose;
using internal::Matrix12d;
using internal::Matrix12x6d;
using internal::WorldError;

/// (N^T B^-1 N)^-1 of camera and objects without slow errors.
Matrix6d by_definition(const internal::JointGaussian& joint) {
  const Eigen::MatrixXd b = joint.covariance();
  Eigen::MatrixXd shift(b.rows(), 6);
  for (std::size_t i = 0; i < joint.size(); ++i) rows(shift, i) = Matrix6d::Identity();
  return (shift.transpose() * b.ldlt().solve(shift)).inverse();
}

TEST(WorldError, IsTheCommonShiftAsItsBestEstimateHasIt) {
  RandomStream stream(51);
  const testing::PairScene scene = testing::pair_scene(1, stream);
  const std::optional<WorldError> world = scene.joint.world_error();
  ASSERT_TRUE(world);
  const Matrix6d expected = by_definition(scene.joint);
  EXPECT_LT((world->covariance - expected).norm(), 1e-9 * expected.norm());
  // An estimate without bias, whose covariance with every pose is its own.
  const auto& weights = world->weights;
  EXPECT_LT((weights.leftCols<6>() + weights.rightCols<6>() - Matrix6d::Identity()).norm(), 1e-9);
  EXPECT_LT((weights * scene.joint.covariance().leftCols<6>() - expected).norm(),
            1e-9 * expected.norm());
}

TEST(WorldError, NoDetectionTellsOfIt) {
  RandomStream stream(52);
  testing::PairScene scene = testing::pair_scene(1, stream);
  const Matrix6d before = scene.joint.world_error()->covariance;
  const Matrix6d camera = scene.joint.covariance(kCamera, kCamera);
  for (int k = 0; k < 5; ++k) {
    scene.joint.update(scene.objects[0],
                       testing::explanation(scene.joint, scene.objects[0], 1.0, stream), {}, {});
  }
  EXPECT_LT(scene.joint.covariance(kCamera, kCamera).trace(), camera.trace());
  EXPECT_LT((scene.joint.world_error()->covariance - before).norm(), 1e-6 * before.norm());
}

/// A pose that was seen from the camera, with this covariance of what is between them.
ConditionalPose seen_from(const Matrix6d& camera, const Matrix6d& between) {
  ConditionalPose pose{SE3d(), {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
  pose.covariance.topLeftCorner<6, 6>() = camera + between;
  pose.cross_covariance.topRows<6>() = camera;
  return pose;
}

TEST(WorldError, APoseThatIsNotSeenKeepsIt) {
  const Matrix6d world = 1e-4 * Matrix6d::Identity();
  const Matrix6d local = 1e-6 * Matrix6d::Identity();
  const WorldError error{world, {}};
  // The camera moves and is seen again by what it sees, a thousand times.
  const internal::CameraMoments near{Vector6d::Zero(), world + local};
  const internal::CameraMoments far{Vector6d::Zero(), world + 2.0 * local};
  ConditionalPose with = seen_from(near.covariance, local);
  ConditionalPose without = with;
  for (int k = 0; k < 1000; ++k) {
    internal::CameraRegression(far, near, {error, error}).carry(with);
    internal::CameraRegression(far, near).carry(without);
  }
  EXPECT_LT((with.cross_covariance.topRows<6>() - world).norm(), 1e-9);
  EXPECT_LT(without.cross_covariance.norm(), 1e-3 * world.norm());
  // What is between them grows from what was measured to what is known of each, no further.
  const Matrix6d cross = with.cross_covariance.topRows<6>();
  const Matrix6d between =
      with.covariance.topLeftCorner<6, 6>() + near.covariance - cross - cross.transpose();
  EXPECT_GT(between.trace(), local.trace());
  EXPECT_LT(between.trace(), 3.1 * local.trace());
}

TEST(WorldError, IsNotSharedByWhatAGivenCameraSaw) {
  const Matrix6d world = 1e-4 * Matrix6d::Identity();
  const Matrix6d camera = 2.0 * world;
  const internal::CameraMoments moments{Vector6d::Zero(), camera};
  const internal::SharedWorld shared(WorldError{world, {}}, moments);
  EXPECT_TRUE(shared.regression(seen_from(camera, world)));
  ConditionalPose apart = seen_from(camera, world);
  apart.cross_covariance.setZero();
  EXPECT_FALSE(shared.regression(apart));
  // Known in the world better than the camera: less than the world's error is left.
  ConditionalPose known = seen_from(camera, world);
  known.covariance.topLeftCorner<6, 6>() = 0.5 * world;
  EXPECT_FALSE(shared.regression(known));
  EXPECT_FALSE(internal::SharedWorld({}, moments).regression(seen_from(camera, world)));
  EXPECT_FALSE(
      internal::SharedWorld(WorldError{camera, {}}, moments).regression(seen_from(camera, world)));
}

/// With typical noise, whose gain is reduced, the error of the world of a few poses changes.
TEST(WorldError, HypothesesStayPositiveDefiniteByTheDefaults) {
  for (const double far_m : {0.0, 90.0, 1000.0}) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      testing::OrbitScene scene(seed, 6, 1.0, 0.02);
      const SE3d shift(SO3d(), {far_m, -0.5 * far_m, 0.2 * far_m});
      DetectorNoise typical(testing::ray_noise().components(), testing::ray_noise().clutter(),
                            {.is_typical = true});
      MultiObjectFilter filter(
          ConcentratedGaussian<SE3d>(shift * scene.camera, testing::isotropic(0.1, 0.002)),
          std::vector<ObjectSensor>(6, {typical}), MultiObjectSettings{});
      for (int frame = 0; frame < 150; ++frame) {
        filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
        for (std::size_t j = 0; j < 6; ++j) filter.update(j, scene.detect(j, 0.3, 0.1));
        if (frame % 3 > 0) continue;
        for (std::size_t j = 0; j < 6; ++j) {
          for (std::size_t h = 0; h < filter.hypotheses(j).size(); ++h) {
            const Matrix6d seen = filter.relative(j, h).covariance();
            ASSERT_EQ(Eigen::LLT<Matrix6d>(seen).info(), Eigen::Success)
                << far_m << " m, seed " << seed << ", frame " << frame;
          }
        }
      }
    }
  }
}

/// T_camera_object of the truth or of its flip, whichever is nearer.
SE3d nearest_mode(const SE3d& seen, const SE3d& estimate) {
  const SE3d flipped = seen * testing::pose(0, 0, std::numbers::pi, 0, 0, 0);
  const auto angle_from = [&](const SE3d& from) {
    return (from.rotation().inverse() * estimate.rotation()).log().norm();
  };
  return angle_from(seen) < angle_from(flipped) ? seen : flipped;
}

/// A detection of an object or of its flip, with the components and the clutter of ray_noise().
SE3d detection_as_stated(testing::OrbitScene& scene, std::size_t object) {
  RandomStream& stream = scene.stream;
  const SE3d flip = testing::pose(0, 0, stream.uniform() < 0.5 ? 0.0 : std::numbers::pi, 0, 0, 0);
  const SE3d mode = scene.camera.inverse() * scene.truth[object] * flip;
  const DetectorNoise noise = testing::ray_noise();
  double chance = stream.uniform();
  for (const NoiseComponent& component : noise.components()) {
    chance -= component.weight;
    if (chance >= 0.0) continue;
    const NoiseAtPose at = noise_at(component, mode);
    return at.axes * SE3d::exp(testing::draw(at.covariance, stream)) * at.axes.inverse() * mode;
  }
  const Eigen::Vector3d place(stream.uniform(), stream.uniform(), stream.uniform());
  return {SO3d::exp(2.0 * testing::normals(stream)),
          mode.translation() + place - Eigen::Vector3d::Constant(0.5)};
}

/// Five objects, each of which the detector sees flipped every other time, for good. The camera in
/// the world becomes too sure there (docs/reliability.md); what is seen from it does not.
TEST(WorldError, WhereModesCompeteForGoodPosesFromTheCameraAreAsSureAsTheyAreRight) {
  constexpr std::size_t kFlipped = 5;
  constexpr int kFrames = 300;
  constexpr int kFound = 100;  // before, something else that was detected first may lead
  double nees = 0.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    testing::OrbitScene scene(seed, kFlipped, 0.05, 6e-4);
    MultiObjectFilter filter = testing::filter_of(scene, testing::plain_settings());
    for (int frame = 0; frame < kFrames; ++frame) {
      if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
      for (std::size_t j = 0; j < kFlipped; ++j) filter.update(j, detection_as_stated(scene, j));
      if (frame < kFound) continue;
      const auto estimates = filter.leading_estimates();
      for (std::size_t j = 0; j < kFlipped; ++j) {
        const ConcentratedGaussian<SE3d>& seen = estimates[j].value().relative;
        const SE3d nearest = nearest_mode(scene.camera.inverse() * scene.truth[j], seen.mean());
        nees += testing::nees_of(nearest, seen) / 6.0;
      }
    }
  }
  EXPECT_GT(nees, 0.8 * 3 * (kFrames - kFound) * kFlipped);
  EXPECT_LT(nees, 1.25 * 3 * (kFrames - kFound) * kFlipped);
}

}  // namespace
}  // namespace posemix
