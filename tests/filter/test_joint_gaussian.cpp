// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The joint Gaussian whose blocks become passive, against the same with all blocks active.
#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "filter/multi_object/multi_object_state.hpp"
#include "joint_gaussian_scene.hpp"
#include "multi_object_scene.hpp"

namespace posemix::internal {
namespace {

using posemix::testing::isotropic;
using posemix::testing::PairScene;
using posemix::testing::worst_difference;

constexpr double kSmallNoise = 1e-2;  ///< of detections, a factor: what turns little is linear

/// Two joint Gaussians of the same objects, the second one after other detections of the objects
/// that stay active, once with all blocks active and once with the others passive.
class PassiveBlocks : public ::testing::Test {
 protected:
  PassiveBlocks() {
    for (const std::size_t object : active) {
      for (std::size_t k = 0; k < scene.joint.blocks_of(object); ++k) keeps[object + k] = true;
    }
    for (std::size_t i = scene.joint.size(); i-- > 0;) all.emplace_back(i, i);  // the last first
    detect(dense_other);
    first.rebase(keeps);
  }

  /// The same detections of all active objects, one after the other.
  void detect(JointGaussian& joint) {
    for (const std::size_t object : active)
      joint.update(object, posemix::testing::explanation(joint, object, kSmallNoise, stream), {},
                   {});
  }

  RandomStream stream{41};
  PairScene scene = posemix::testing::pair_scene(5, stream, kSmallNoise);
  std::vector<std::size_t> active{scene.objects[1], scene.objects[2]};
  std::vector<bool> keeps = std::vector<bool>(scene.joint.size(), false);
  BlockPairs all;
  JointGaussian dense_other = scene.joint;
  JointGaussian first = scene.joint;
};

TEST_F(PassiveBlocks, KeepTheirMoments) {
  EXPECT_LT(first.active(), first.size());
  EXPECT_LT(worst_difference(first, scene.joint), 1e-12);
}

// Detections of others tell nothing new of what a passive pose is given the active ones.
TEST_F(PassiveBlocks, OfAnotherStateKeepTheirMomentsAsWell) {
  JointGaussian same = scene.joint;
  same.rebase_like(first, all);
  EXPECT_EQ(same.active(), first.active());
  EXPECT_LT(worst_difference(same, scene.joint), 1e-6);
  JointGaussian other = dense_other;
  other.rebase_like(first, all);
  EXPECT_EQ(other.active(), first.active());
  EXPECT_LT(worst_difference(other, dense_other), 1e-6);
}

TEST_F(PassiveBlocks, OfAMixtureHaveTheMomentsOfThatOfDenseOnes) {
  JointGaussian other = dense_other;
  other.rebase_like(first, all);
  for (const double weight : {0.3, 0.7}) {
    JointGaussian expected = scene.joint;
    expected.mix(weight, dense_other, all);
    JointGaussian mixed = first;
    mixed.mix(weight, other, all);
    EXPECT_LT(mixed.active(), mixed.size());
    EXPECT_LT(worst_difference(mixed, expected), 1e-4) << weight;
  }
}

// One of the two is detected after the others became passive in both.
TEST_F(PassiveBlocks, FollowTheActiveOnesIntoAMixture) {
  JointGaussian other = first;
  JointGaussian expected = scene.joint;
  JointGaussian dense = scene.joint;
  RandomStream same = stream;
  detect(other);
  stream = same;
  detect(dense);
  EXPECT_LT(worst_difference(other, dense), 1e-6);
  JointGaussian mixed = first;
  mixed.mix(0.4, other, all);
  expected.mix(0.4, dense, all);
  EXPECT_LT(mixed.active(), mixed.size());
  EXPECT_LT(worst_difference(mixed, expected), 1e-4);
}

// To the last bit: what comes later reads one half of it.
TEST(JointGaussian, StaysSymmetricWithConstantVelocity) {
  posemix::testing::OrbitScene scene(8, 3, 0.05, 1e-3);
  MultiObjectState state(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                         std::vector<ObjectSensor>(3, {posemix::testing::ray_noise(0.1)}),
                         posemix::testing::plain_settings());
  for (int k = 0; k < 20; ++k) {
    scene.advance();
    state.predict_constant_velocity(1.0, isotropic(0.1, 1e-3), isotropic(0.2, 2e-3),
                                    isotropic(2.0, 0.05), 0.1);
    const Eigen::MatrixXd covariance = state.joint.covariance();
    EXPECT_EQ(covariance, covariance.transpose()) << k;
    const std::size_t j = static_cast<std::size_t>(k) % 3;
    const Observation seen = observation_of(scene.detect(j, 0.0, 0.0));
    const ObservedDetection observed = state.observe(j, seen, {});
    LogTotals evidence;
    state.update(j, observed, Starters(1, !observed.explained.front()), evidence);
  }
}

}  // namespace
}  // namespace posemix::internal
