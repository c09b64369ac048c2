// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <algorithm>

#include "joint_gaussian_scene.hpp"
#include "multi_object_scene.hpp"
#include "posemix/testing/expect.hpp"
#include "world_error_scene.hpp"

/// The error of the world, eq. (31) of docs/many-objects.md: a shift of camera and objects of which
/// no detection tells. It is kept beside them, and is in all that is reported.
namespace posemix {
namespace {

/// Every pose moves with the world.
internal::WorldMoves moved_as_one(const internal::JointGaussian& joint) {
  internal::WorldMoves moved(joint.size(), Matrix6d::Zero());
  for (std::size_t i = 0; i < joint.size(); ++i)
    if (joint.is_in_world(i)) moved[i].setIdentity();
  return moved;
}

/// (N^T B^-1 N)^-1.
Matrix6d by_definition(const internal::JointGaussian& joint) {
  const Eigen::MatrixXd b = joint.covariance();
  const internal::WorldMoves moved = moved_as_one(joint);
  Eigen::MatrixXd shift(b.rows(), 6);
  for (std::size_t i = 0; i < joint.size(); ++i) rows(shift, i) = moved[i];
  return (shift.transpose() * b.ldlt().solve(shift)).inverse();
}

TEST(WorldError, IsTheShiftThatIsLeftWhenAllIsSeen) {
  RandomStream stream(51);
  const testing::PairScene scene = testing::pair_scene(1, stream);
  const auto information = scene.joint.world_information(moved_as_one(scene.joint));
  ASSERT_TRUE(information);
  const Matrix6d expected = by_definition(scene.joint);
  EXPECT_LT((information->inverse() - expected).norm(), 1e-9 * expected.norm());
}

TEST(WorldError, NoDetectionTellsOfIt) {
  RandomStream stream(52);
  testing::PairScene scene = testing::pair_scene(1, stream);
  const Matrix6d before = by_definition(scene.joint);
  const Matrix6d camera = scene.joint.covariance(kCamera, kCamera);
  for (int k = 0; k < 5; ++k) {
    scene.joint.update(scene.objects[0],
                       testing::explanation(scene.joint, scene.objects[0], 1.0, stream), {}, {});
  }
  EXPECT_LT(scene.joint.covariance(kCamera, kCamera).trace(), camera.trace());
  EXPECT_LT((by_definition(scene.joint) - before).norm(), 1e-6 * before.norm());
}

TEST(WorldError, LeavesTheRestAsItIs) {
  RandomStream stream(53);
  testing::PairScene scene = testing::pair_scene(1, stream);
  internal::JointGaussian& joint = scene.joint;
  const internal::WorldMoves moved = moved_as_one(joint);
  const Eigen::MatrixXd before = joint.covariance();
  const Matrix6d d = 0.9 * by_definition(joint);
  joint.take_out(d, moved);
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(joint.covariance()).info(), Eigen::Success);
  EXPECT_LT((by_definition(joint) - d / 9.0).norm(), 1e-9 * d.norm());
  joint.add_world_error(d);
  EXPECT_LT((joint.covariance() - before).norm(), 1e-12 * before.norm());
}

/// Three objects, two of which are seen flipped at times, after some frames.
MultiObjectFilter filter_with_modes(testing::OrbitScene& scene, int frames = 30) {
  MultiObjectFilter filter(
      ConcentratedGaussian<SE3d>(scene.camera, testing::start_covariance()),
      std::vector<ObjectSensor>(scene.truth.size(), ObjectSensor{testing::ray_noise()}),
      testing::plain_settings());
  for (int frame = 0; frame < frames; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    for (std::size_t j = 0; j < scene.truth.size(); ++j)
      filter.update(j, scene.detect(j, j == 0 ? 0.0 : 0.4, 0.1));
  }
  return filter;
}

void expect_same(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& expected,
                 double tolerance = 1e-9) {
  EXPECT_LT(testing::relative_difference(actual, expected), tolerance);
}

TEST(WorldError, IsInEverythingThatIsReported) {
  testing::OrbitScene scene(3, 3, 0.05, 6e-4);
  const MultiObjectFilter filter = filter_with_modes(scene);
  // The part that is kept beside the joint Gaussian.
  const Matrix6d least = 0.98 * testing::start_covariance();
  const Matrix6d camera = filter.camera().covariance();
  EXPECT_TRUE(testing::is_at_least(camera, least));
  const auto cameras = filter.camera_mixture();
  EXPECT_GE(cameras.size(), 2U);  // or the mixture was not what is tested
  for (const auto& component : cameras.components())
    EXPECT_TRUE(testing::is_at_least(component.density.covariance(), least));
  const ConcentratedGaussian<PoseStackd> joint = filter.joint();
  expect_same(joint.covariance().topLeftCorner<6, 6>(), camera);
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(joint.covariance()).info(), Eigen::Success);
  for (std::size_t j = 0; j < scene.truth.size(); ++j) {
    const auto places = filter.object_mixture(j);
    for (const auto& component : places.components())
      EXPECT_TRUE(testing::is_at_least(component.density.covariance(), least));
    const std::size_t leading = filter.leading(j).value();
    const ObjectHypothesis hypothesis = filter.hypotheses(j)[leading];
    const auto at = static_cast<Eigen::Index>(6 * filter.pose_index(j).value());
    const LeadingEstimate estimate = filter.leading_estimates()[j].value();
    const auto own = joint.covariance().block<6, 6>(at, at);
    const auto cross = joint.covariance().block<6, 6>(at, 0);
    expect_same(hypothesis.covariance, own);
    expect_same(estimate.world.covariance(), own);
    expect_same(hypothesis.cross_covariance, cross);
    // It is no part of what is seen from the camera.
    expect_same(estimate.relative.covariance(), filter.relative(j, leading).covariance());
  }
  std::vector<std::optional<std::size_t>> all(scene.truth.size(), 0);
  const Eigen::MatrixXd chosen = filter.joint_state(all).covariance;
  expect_same(chosen.topLeftCorner<6, 6>(), camera);
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(chosen).info(), Eigen::Success);
}

/// The reported Gaussian of a filter without modes is that of the Kalman filter: what is kept
/// beside it changes nothing.
TEST(WorldError, ChangesNothingWhereNothingIsApproximated) {
  const auto camera_after = [](double part) {
    testing::OrbitScene scene(4, 3, 0.05, 6e-4);
    const NoiseComponent inlier = testing::ray_noise().components().front();
    const DetectorNoise noise({{.weight = 1.0, .covariance = inlier.covariance}}, {.weight = 0.0});
    MultiObjectFilter filter(
        ConcentratedGaussian<SE3d>(scene.camera, part * testing::start_covariance()),
        std::vector<ObjectSensor>(3, ObjectSensor{noise}), testing::plain_settings());
    for (int frame = 0; frame < 50; ++frame) {
      if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
      for (std::size_t j = 0; j < 3; ++j) filter.update(j, scene.detect(j, 0.0, 0.0));
    }
    return filter.camera();
  };
  const ConcentratedGaussian<SE3d> whole = camera_after(1.0);
  const ConcentratedGaussian<SE3d> without = camera_after(1e-6);
  const Matrix6d difference = whole.covariance() - without.covariance();
  expect_same(difference, (1.0 - 1e-6) * testing::start_covariance());
  EXPECT_LT((whole.mean().inverse() * without.mean()).log().norm(), 1e-9);
}

TEST(WorldError, IsToldByWhatIsKnownInTheWorld) {
  testing::OrbitScene scene(5, 3, 0.05, 6e-4);
  MultiObjectFilter filter = filter_with_modes(scene);
  const Matrix6d before = filter.camera().covariance();
  const Matrix6d object = filter.hypotheses(1)[filter.leading(1).value()].covariance;
  const SE3d place = testing::pose(0, 0, 0.4, 0.1, -0.1, 0.0);
  const std::size_t known =
      filter.add_object(ObjectSensor{testing::ray_noise()},
                        ObjectPrior{{place, testing::isotropic(0.01, 1e-4)}, 0.99});
  expect_same(filter.camera().covariance(), before);
  scene.truth.push_back(place);
  for (int k = 0; k < 100; ++k) filter.update(known, scene.detect(known, 0.0, 0.0));
  const Matrix6d after = filter.camera().covariance();
  EXPECT_LT(after.diagonal().tail<3>().minCoeff(), 0.3 * testing::start_covariance()(3, 3));
  EXPECT_LT(filter.hypotheses(1)[filter.leading(1).value()].covariance.trace(), object.trace());
  EXPECT_FALSE(testing::is_at_least(after, 0.98 * testing::start_covariance()));
}

TEST(WorldError, StaysWithTheObjectsWhereTheCameraIsGivenOrLost) {
  testing::OrbitScene scene(6, 3, 0.05, 6e-4);
  const MultiObjectFilter filter = filter_with_modes(scene);
  const Matrix6d object = filter.hypotheses(1)[0].covariance;
  MultiObjectFilter given = filter;
  const ConcentratedGaussian<SE3d> camera(scene.camera, testing::isotropic(0.01, 1e-4));
  given.set_camera(camera, 0.1);
  expect_same(given.camera().covariance(), camera.covariance());
  expect_same(given.hypotheses(1)[0].covariance, object);
  EXPECT_LT(given.hypotheses(1)[0].cross_covariance.norm(), 1e-15);
  MultiObjectFilter lost = filter;
  lost.predict_random_walk(testing::isotropic(200.0, 0.1), 1.0);
  expect_same(lost.hypotheses(1)[0].covariance, object);
  // It is all that they share then.
  const Matrix6d shared = lost.hypotheses(1)[0].cross_covariance;
  expect_same(lost.hypotheses(2)[0].cross_covariance, shared);
  EXPECT_TRUE(testing::is_at_least(shared, 0.98 * testing::start_covariance()));
  const Matrix6d at_camera =
      filter.camera().mean().inverse().adjoint_congruence(filter.camera().covariance());
  const Matrix6d lost_at_camera =
      lost.camera().mean().inverse().adjoint_congruence(lost.camera().covariance());
  EXPECT_GT(lost_at_camera(3, 3), at_camera(3, 3));
}

using internal::GlobalHypotheses;
using internal::MultiObjectState;

GlobalHypotheses hypotheses_of(const testing::OrbitScene& scene,
                               const MultiObjectSettings& settings) {
  return GlobalHypotheses(MultiObjectState(
      {scene.camera, testing::start_covariance()},
      std::vector<ObjectSensor>(scene.truth.size(), ObjectSensor{testing::ray_noise()}), settings));
}

void see_all(testing::OrbitScene& scene, GlobalHypotheses& filter, double flips) {
  for (std::size_t j = 0; j < scene.truth.size(); ++j)
    filter.update(j, observation_of(scene.detect(j, flips, 0.1)), {});
}

/// However improbable, and however well it knows the world: it became less certain by a tenth with
/// every part that was taken out, until it had no covariance.
TEST(WorldError, LeavesEveryGlobalHypothesisACovariance) {
  testing::OrbitScene scene(7, 4, 0.05, 6e-4);
  GlobalHypotheses filter = hypotheses_of(scene, {});
  for (int frame = 0; frame < 300; ++frame) {
    scene.advance();
    filter.for_each([&](MultiObjectState& state) {
      state.predict_constant_velocity(1.0, testing::isotropic(0.2, 0.003),
                                      testing::isotropic(0.2, 0.003), testing::isotropic(2.0, 0.03),
                                      0.1);
    });
    see_all(scene, filter, 0.3);
    filter.for_each([&](MultiObjectState& state) {
      const Eigen::MatrixXd b = state.joint.covariance();
      const Eigen::VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
      const Eigen::MatrixXd scaled = scale.asDiagonal() * b * scale.asDiagonal();
      const Eigen::LLT<Eigen::MatrixXd> factor(scaled);
      ASSERT_EQ(factor.info(), Eigen::Success) << frame;
      ASSERT_GT(factor.rcond(), 1e-9) << frame;
    });
  }
}

/// A walk of the camera that one global hypothesis takes beyond any rotation, and the other not.
TEST(WorldError, IsTheSameInAllWhereTheCameraIsLostInOne) {
  int parted = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    testing::OrbitScene scene(seed, 3, 0.05, 6e-4);
    GlobalHypotheses filter = hypotheses_of(scene, testing::plain_settings());
    for (int frame = 0; frame < 30; ++frame) {
      const SE3d motion = scene.advance();
      filter.for_each(
          [&](MultiObjectState& state) { state.predict_with_odometry(motion, scene.q, 0.1); });
      see_all(scene, filter, 0.4);
    }
    std::vector<double> variances;
    filter.for_each([&](MultiObjectState& state) {
      const Matrix6d camera = state.reported_camera().covariance();
      variances.push_back(camera.diagonal().head<3>().maxCoeff());
    });
    const auto [least, most] = std::minmax_element(variances.begin(), variances.end());
    if (*most == *least) continue;
    ++parted;
    Matrix6d walk = 1e-12 * Matrix6d::Identity();
    walk.diagonal().head<3>().setConstant(kUniformRotationVariance - 0.5 * (*most + *least));
    filter.for_each([&](MultiObjectState& state) { state.predict_random_walk(walk, 0.1); });
    filter.for_each([&](MultiObjectState& state) {
      EXPECT_EQ(state.world_error, filter.first().world_error);
      EXPECT_TRUE(testing::is_at_least(state.world_error, 0.98 * testing::start_covariance()));
    });
  }
  EXPECT_GT(parted, 3);
}

/// A shift of the world moves what is passive as it moves what is active.
TEST(WorldError, ReachesPassiveObjects) {
  RandomStream stream(61);
  internal::JointGaussian joint(
      ConcentratedGaussian<SE3d>(SE3d(), testing::random_covariance(0.1, 0.1, stream)));
  for (int k = 0; k < 4; ++k) {
    internal::ConditionalPose object{
        SE3d(), {}, internal::Matrix12d::Zero(), internal::Matrix12x6d::Zero()};
    if (k % 2 == 1) object.slow = Vector6d::Zero();
    object.covariance.topLeftCorner<6, 6>() =
        joint.covariance(kCamera, kCamera) + testing::random_covariance(0.1, 0.1, stream);
    object.covariance.bottomRightCorner<6, 6>() = testing::random_covariance(0.1, 0.1, stream);
    object.cross_covariance.topRows<6>() = joint.covariance(kCamera, kCamera);
    joint.append(object);
  }
  internal::JointGaussian dense = joint;
  std::vector<bool> keeps(joint.size(), false);
  keeps[kCamera] = keeps[1] = true;
  joint.rebase(keeps);
  ASSERT_LT(joint.active(), dense.active());
  const Matrix6d shift = testing::random_covariance(0.2, 0.05, stream);
  joint.add_world_error(shift);
  Eigen::MatrixXd expected = dense.covariance();
  for (std::size_t i = 0; i < dense.size(); ++i) {
    for (std::size_t k = 0; k < dense.size(); ++k)
      if (dense.is_pose(i) && dense.is_pose(k)) block(expected, i, k) += shift;
  }
  dense.add_world_error(shift);
  EXPECT_LT((dense.covariance() - expected).norm(), 1e-13);
  EXPECT_LT((joint.covariance() - expected).norm(), 1e-12);
}

}  // namespace
}  // namespace posemix
