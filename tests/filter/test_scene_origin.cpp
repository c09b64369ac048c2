// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "filter/multi_object/state_fields.hpp"
#include "joint_gaussian_scene.hpp"
#include "multi_object_scene.hpp"

/// The world in which the multi-object filter computes has its origin near the camera
/// (docs/many-objects.md): nothing depends on where it is.
namespace posemix::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using posemix::testing::OrbitScene;

/// A camera with a motion, and objects, some with slow errors; of five, three are passive.
JointGaussian joint_in_part_passive() {
  RandomStream stream(17);
  const posemix::testing::PairScene scene = posemix::testing::pair_scene(5, stream);
  JointGaussian joint = scene.joint;
  joint.append_motion(SE3d(SO3d(), {0.1, 0.0, 0.0}), posemix::testing::isotropic(1.0, 0.01));
  std::vector<bool> keeps(joint.size(), false);
  for (const std::size_t object : {scene.objects[0], scene.objects[3]}) {
    for (std::size_t k = 0; k < joint.blocks_of(object); ++k) keeps[object + k] = true;
  }
  joint.rebase(keeps);
  return joint;
}

/// T P T^T with Ad of the shift at every pose in the world.
MatrixXd moved_densely(const JointGaussian& joint, const Eigen::Vector3d& shift) {
  MatrixXd t = MatrixXd::Identity(offset(joint.size()), offset(joint.size()));
  for (std::size_t i = 0; i < joint.size(); ++i)
    if (joint.is_in_world(i)) block(t, i, i) = SE3d(SO3d(), shift).adjoint();
  return t * joint.covariance() * t.transpose();
}

JointGaussian moved_joint(JointGaussian joint, const Eigen::Vector3d& shift) {
  MovedBases shared;
  joint.add_passive_rows(shared);
  joint.move_world(WorldShift(shift), shared);
  return joint;
}

void expect_moved(const JointGaussian& moved, const JointGaussian& before,
                  const Eigen::Vector3d& shift) {
  ASSERT_EQ(moved.size(), before.size());
  const MatrixXd expected = moved_densely(before, shift);
  EXPECT_LT((moved.covariance() - expected).norm(), 1e-12 * expected.norm());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (!moved.is_pose(i)) continue;
    const Eigen::Vector3d by = moved.pose(i).translation() - before.pose(i).translation();
    EXPECT_LT((by - (before.is_in_world(i) ? shift : Eigen::Vector3d::Zero())).norm(), 1e-12) << i;
  }
}

TEST(SceneOrigin, OfAJointGaussianIsThatOfItsCovariance) {
  const Eigen::Vector3d shift(12.0, -40.0, 3.0);
  const JointGaussian before = joint_in_part_passive();
  ASSERT_LT(before.active(), before.size());
  const JointGaussian after = moved_joint(before, shift);
  expect_moved(after, before, shift);
  // What becomes active later, and what later shifts the world.
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!before.is_pose(i)) continue;
    JointGaussian a = before, b = after;
    a.activate(i);
    b.activate(i);
    expect_moved(b, a, shift);
    expect_moved(moved_joint(a, shift), a, shift);
    const Matrix6d error = posemix::testing::isotropic(3.0, 0.2);
    a.add_world_error(error);
    b.add_world_error(WorldShift(shift)(error));
    expect_moved(b, a, shift);
    expect_moved(moved_joint(a, shift), a, shift);
  }
}

/// Joint Gaussians that share a base share it after the move.
TEST(SceneOrigin, OfSeveralJointGaussiansIsThatOfTheirBase) {
  const Eigen::Vector3d shift(0.0, 70.0, -5.0);
  const JointGaussian a = joint_in_part_passive();
  JointGaussian b = a;
  std::size_t passive = 0;
  while (b.is_active(passive)) ++passive;
  b.activate(passive);
  const auto base_of = [](JointGaussian& joint) {
    return std::get<4>(StateFields<JointGaussian>::tie(joint)).get();
  };
  JointGaussian moved_a = a, moved_b = b;
  MovedBases shared;
  b.add_passive_rows(shared);
  a.add_passive_rows(shared);
  moved_b.move_world(WorldShift(shift), shared);
  moved_a.move_world(WorldShift(shift), shared);
  EXPECT_EQ(base_of(moved_a), base_of(moved_b));
  expect_moved(moved_a, a, shift);
  expect_moved(moved_b, b, shift);
}

/// A way of 100 m past 60 objects, of which most are passive in the end.
struct Way {
  bool on_a_rig = false;
  bool has_velocity = false;
  double flips = 0.0;
};

constexpr std::size_t kPassed = 60;

/// Two of the objects are known from the beginning. The world has its origin at `shift` from that
/// of the scene.
MultiObjectFilter filter_after(const Way& way, const WorldShift& world) {
  OrbitScene scene(5, 0, 0.02, 4e-3);
  for (std::size_t j = 0; j < kPassed; ++j) {
    const double along = 1.8 * static_cast<double>(j);
    scene.truth.push_back(
        posemix::testing::pose(0.1 * along, 0.2, 0.3, along, j % 2 == 0 ? 1.0 : -1.0, 0.2));
  }
  scene.camera = SE3d(SO3d::exp({0.0, 0.0, 0.1}), {-1.0, 0.0, 0.5});
  NoiseDependence dependence;
  dependence.slow =
      SlowError{.covariance = pose_covariance({0.02, 0.02, 0.02}, {0.004, 0.004, 0.01}),
                .correlation_time_s = 3.0};
  const ObjectSensor sensor{
      DetectorNoise(posemix::testing::ray_noise().components(), {.weight = 0.05}, dependence), {}};
  const ConcentratedGaussian<SE3d> start(scene.camera, posemix::testing::isotropic(0.3, 0.01));
  MultiObjectFilter filter(world(start), std::vector<ObjectSensor>(kPassed - 2, sensor), {});
  ObservationSource source;
  if (way.on_a_rig)
    source.camera = filter.add_camera({SE3d(), posemix::testing::isotropic(0.2, 0.002)});
  for (std::size_t j = kPassed - 2; j < kPassed; ++j) {
    const ConcentratedGaussian<SE3d> place(scene.truth[j], posemix::testing::isotropic(1.0, 0.05));
    filter.add_object(sensor, ObjectPrior{world(place), 0.9});
  }
  const SE3d motion(SO3d::exp({0.0, 0.0, 1e-3}), SO3d::exp({0.0, 0.0, -0.1}).matrix().col(0));
  for (int frame = 0; frame < 100; ++frame) {
    scene.camera = scene.camera * motion;
    if (way.has_velocity) {
      filter.predict_constant_velocity(1.0, scene.q, scene.q, posemix::testing::isotropic(5.0, 1.0),
                                       0.1);
    } else {
      filter.predict_with_odometry(
          motion * SE3d::exp(posemix::testing::draw(scene.q, scene.stream)), scene.q, 0.1);
    }
    for (std::size_t j = 0; j < kPassed; ++j) {
      const double ahead = scene.truth[j].translation().x() - scene.camera.translation().x();
      if (ahead > 0.0 && ahead < 5.0)
        filter.update(j, observation_of(scene.detect(j, way.flips, 0.0)), source);
    }
  }
  return filter;
}

void expect_near(const ConcentratedGaussian<SE3d>& a, const ConcentratedGaussian<SE3d>& b) {
  const Vector6d apart = (a.mean() * b.mean().inverse()).log();
  EXPECT_LT(apart.dot(a.covariance().llt().solve(apart)), 1e-8);
  EXPECT_LT((a.covariance() - b.covariance()).norm(), 1e-4 * a.covariance().norm());
}

/// All that is reported, `b` being that of a filter whose world is `world` of that of `a`.
void expect_same_reports(const MultiObjectFilter& a, const MultiObjectFilter& b,
                         const WorldShift& world) {
  const WorldShift back = world.inverse();
  expect_near(a.camera(), back(b.camera()));
  ASSERT_EQ(a.camera_mixture().size(), b.camera_mixture().size());
  expect_near(a.camera_mixture()[0].density, back(b.camera_mixture()[0].density));
  const auto leading = a.leading_estimates();
  const auto others = b.leading_estimates();
  for (std::size_t j = 0; j < kPassed; ++j) {
    ASSERT_EQ(a.leading(j), b.leading(j)) << j;
    if (!a.leading(j)) continue;
    const auto x = a.hypotheses(j);
    const auto y = b.hypotheses(j);
    ASSERT_EQ(x.size(), y.size()) << j;
    for (std::size_t h = 0; h < x.size(); ++h) {
      const auto there = ConcentratedGaussian<SE3d>::trusted(y[h].pose, y[h].covariance);
      expect_near(ConcentratedGaussian<SE3d>::trusted(x[h].pose, x[h].covariance), back(there));
      EXPECT_LT((x[h].cross_covariance - back(y[h].cross_covariance)).norm(),
                1e-4 * x[h].covariance.norm());
      EXPECT_TRUE(back(b.hypothesis_means(j)[h].pose).is_approx(x[h].pose, 1e-5));
      expect_near(a.relative(j, h), b.relative(j, h));
      expect_near(a.predicted_detection(j, h), b.predicted_detection(j, h));
    }
    expect_near(leading[j]->world, back(others[j]->world));
    expect_near(leading[j]->relative, others[j]->relative);
    ASSERT_EQ(a.object_mixture(j).size(), b.object_mixture(j).size());
    expect_near(a.object_mixture(j)[0].density, back(b.object_mixture(j)[0].density));
  }
}

/// The same of the joint densities, of which the motion is none of the world.
void expect_same_joint(const MultiObjectFilter& a, const MultiObjectFilter& b,
                       const WorldShift& world, bool has_velocity) {
  std::vector<std::optional<std::size_t>> led;
  for (std::size_t j = 0; j < kPassed; ++j) led.push_back(a.leading(j));
  for (const bool is_reported : {true, false}) {
    const ConcentratedGaussian<PoseStackd> here = is_reported ? a.joint() : a.joint_of(led);
    const ConcentratedGaussian<PoseStackd> there = is_reported ? b.joint() : b.joint_of(led);
    const WorldShift back = world.inverse();
    MatrixXd covariance = there.covariance();
    std::size_t moved = 0;
    for (std::size_t i = 0; i < here.mean().size(); ++i) {
      const bool is_there = (back(there.mean()[i])).is_approx(here.mean()[i], 1e-5);
      if (!is_there) {
        EXPECT_TRUE(there.mean()[i].is_approx(here.mean()[i], 1e-6)) << i;
        continue;
      }
      ++moved;
      back.move_rows(rows(covariance, i));
      back.move_columns(columns(covariance, i));
    }
    EXPECT_EQ(moved, here.mean().size() - (has_velocity ? 1 : 0));
    EXPECT_LT((covariance - here.covariance()).norm(), 1e-4 * here.covariance().norm());
  }
}

/// Of three worlds the origins are left behind at other places of the way, the first at 50 m.
TEST(SceneOrigin, MovesAlongAWayAndNothingChanges) {
  const Way ways[] = {{}, {.on_a_rig = true}, {.has_velocity = true}, {.flips = 0.3}};
  for (const Way& way : ways) {
    const WorldShift none(Eigen::Vector3d::Zero());
    const MultiObjectFilter a = filter_after(way, none);
    ASSERT_GT(a.camera().mean().translation().norm(), 90.0);
    for (const double along : {17.0, -49.0, 2e4, 1e6}) {
      const WorldShift world(Eigen::Vector3d(along, 0.3 * along, 5.0));
      const MultiObjectFilter b = filter_after(way, world);
      expect_same_reports(a, b, world);
      expect_same_joint(a, b, world, way.has_velocity);
    }
  }
}

}  // namespace
}  // namespace posemix::internal
