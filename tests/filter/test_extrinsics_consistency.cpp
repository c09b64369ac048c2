// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "multi_object_scene.hpp"

/// Whether the covariances of the poses of cameras on a rig are honest.
namespace posemix {
namespace {

using testing::isotropic;
using testing::OrbitScene;
using testing::plain_settings;
using testing::pose;
using testing::ray_noise;

const SE3d kTrueBodyCamera = pose(0.1, 0.5, -0.2, 0.2, -0.1, 0.05);

/// T_body_camera with an error drawn from the covariance that it states.
ConcentratedGaussian<SE3d> drawn(const SE3d& truth, const Matrix6d& covariance,
                                 RandomStream& random) {
  return {SE3d::exp(testing::draw(covariance, random)) * truth, covariance};
}
double nees(const ConcentratedGaussian<SE3d>& estimate, const SE3d& truth) {
  const Vector6d error = (truth * estimate.mean().inverse()).log();
  return error.dot(Matrix6d(estimate.covariance()).llt().solve(error)) / 6.0;
}

/// Sums of NEES by what they are of.
struct Nees {
  double body = 0, object = 0, relative = 0, extrinsic = 0;
  int count = 0, objects = 0;
};

/// A detector of which part of the detections are half a turn off, and part clutter.
DetectorNoise flipping_noise(double flips, double clutter) {
  const Matrix6d sharp = pose_covariance({0.03, 0.03, 0.02}, {0.004, 0.004, 0.015});
  std::vector<NoiseComponent> components{
      {.weight = 1.0 - flips, .covariance = sharp, .frame = NoiseFrame::ray}};
  if (flips > 0.0) {
    components.push_back({.weight = flips,
                          .covariance = sharp,
                          .frame = NoiseFrame::ray,
                          .offset = pose(0, 0, std::numbers::pi, 0, 0, 0)});
  }
  return DetectorNoise(std::move(components), {.weight = clutter, .volume_m3 = 1.0});
}

/// A detection of an object at `seen` as the model of the detector says.
SE3d detect(const DetectorNoise& noise, const SE3d& seen, RandomStream& random) {
  const double clutter = noise.clutter().weight;
  if (random.uniform() < clutter) {
    Eigen::Vector4d turn;
    for (double& value : turn) value = random.normal();
    const Eigen::Vector3d at(random.uniform(), random.uniform(), random.uniform());
    return {SO3d::from_quaternion(Eigen::Quaterniond(turn)),
            seen.translation() + at - Eigen::Vector3d::Constant(0.5)};
  }
  const auto& components = noise.components();
  const bool is_flipped = components.size() > 1 && random.uniform() < components[1].weight;
  const NoiseComponent& component = components[is_flipped ? 1 : 0];
  const NoiseAtPose at = noise_at(component, seen);
  const SE3d error = at.axes * SE3d::exp(testing::draw(at.covariance, random)) * at.axes.inverse();
  return error * seen * component.offset;
}

/// A rig of two cameras, the second by 2 deg and 2 cm off, or where it is said to be. Returns how
/// far it is off in the end.
double run_rig(std::uint64_t seed, const DetectorNoise& noise, Nees& sum, bool is_exact = false) {
  OrbitScene scene(seed, 3, 0.15, 0.003);
  RandomStream& random = scene.stream;
  MultiObjectFilter filter(drawn(scene.camera, isotropic(0.1, 0.002), random),
                           std::vector<ObjectSensor>(3, {noise}), plain_settings());
  const ConcentratedGaussian<SE3d> prior = drawn(kTrueBodyCamera, isotropic(2.0, 0.02), random);
  filter.add_camera(
      is_exact ? ConcentratedGaussian<SE3d>(kTrueBodyCamera, 1e-12 * prior.covariance()) : prior);
  for (int k = 1; k <= 150; ++k) {
    filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    for (std::size_t object = 0; object < 3; ++object) {
      if (random.uniform() < 0.3) continue;
      const bool is_second = random.uniform() < 0.5;
      const SE3d camera = is_second ? scene.camera * kTrueBodyCamera : scene.camera;
      const SE3d seen = detect(noise, camera.inverse() * scene.truth[object], random);
      filter.update(object, observation_of(seen),
                    is_second ? ObservationSource{.camera = 0} : ObservationSource{});
    }
    if (k % 50 != 0) continue;
    ++sum.count;
    sum.body += nees(filter.camera(), scene.camera);
    sum.extrinsic += nees(filter.extrinsic(0), kTrueBodyCamera);
    for (std::size_t object = 0; object < 3; ++object) {
      const auto world = filter.leading_estimates()[object];
      const SE3d& right = scene.truth[object];
      if ((right.rotation().inverse() * world->world.mean().rotation()).log().norm() > 1.0)
        continue;
      ++sum.objects;
      sum.object += nees(world->world, right);
      sum.relative += nees(world->relative, scene.camera.inverse() * right);
    }
  }
  return (filter.extrinsic(0).mean().translation() - kTrueBodyCamera.translation()).norm();
}

void expect_consistent(double value, const char* name) {
  EXPECT_GT(value, 0.8) << name;
  EXPECT_LT(value, 1.25) << name;
  ::testing::Test::RecordProperty(name, std::to_string(value));
}

TEST(Extrinsics, AreEstimatedWithHonestCovariances) {
  Nees sum;
  double mean_m = 0.0;
  constexpr int kRuns = 60;
  for (int run = 0; run < kRuns; ++run)
    mean_m += run_rig(100 + static_cast<std::uint64_t>(run), flipping_noise(0, 0), sum) / kRuns;
  expect_consistent(sum.body / sum.count, "body");
  expect_consistent(sum.extrinsic / sum.count, "extrinsic");
  expect_consistent(sum.object / sum.objects, "object");
  expect_consistent(sum.relative / sum.objects, "relative");
  EXPECT_LT(mean_m, 0.016);  // half of 3.2 cm, the mean length of 2 cm along each axis
}

/// What the choice among modes costs in consistency is there with an exact rig, too.
TEST(Extrinsics, AreAsHonestAsAnExactRigWhereModesCompete) {
  Nees sum;
  Nees exact;
  constexpr int kRuns = 30;
  for (int run = 0; run < kRuns; ++run) {
    const std::uint64_t seed = 200 + static_cast<std::uint64_t>(run);
    run_rig(seed, flipping_noise(0.3, 0.1), sum);
    run_rig(seed, flipping_noise(0.3, 0.1), exact, true);
  }
  EXPECT_GT(sum.objects, 9 * kRuns * 9 / 10);
  expect_consistent(sum.extrinsic / sum.count, "extrinsic");
  expect_consistent(sum.relative / sum.objects, "relative");
  EXPECT_LT(sum.body / sum.count, 1.1 * exact.body / exact.count);
  EXPECT_LT(sum.object / sum.objects, 1.1 * exact.object / exact.objects);
}

}  // namespace
}  // namespace posemix
