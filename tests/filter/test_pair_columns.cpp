// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "joint_gaussian_scene.hpp"
#include "posemix/base/units.hpp"

/// The update of a joint Gaussian in the columns of what a detection sees. Oracle: the same by
/// dense products and factors, JointGaussian::update_densely.
namespace posemix::internal {
namespace {

using posemix::testing::explanation;
using posemix::testing::pair_scene;
using posemix::testing::PairScene;
using posemix::testing::worst_difference;

void expect_the_same(const PairScene& scene, std::size_t index, double weight,
                     const GainFactors& factors, RandomStream& stream, double bound = 1e-11) {
  SCOPED_TRACE(fmt::format("{} objects, block {}, weight {}, gains {} and {}", scene.objects.size(),
                           index, weight, factors.camera, factors.slow));
  const Explanation leading = explanation(scene.joint, index, scene.noise, stream);
  const Matrix6d camera = scene.joint.covariance(kCamera, kCamera);
  CameraAlternative alternative;
  alternative.weight = weight;
  alternative.mean = camera.llt().matrixL() * posemix::testing::random_vector(0.3, stream);
  alternative.covariance = 0.7 * camera;
  JointGaussian found = scene.joint;
  JointGaussian expected = scene.joint;
  const CameraChange change = found.update(index, leading, alternative, factors);
  const CameraChange reference = expected.update_densely(index, leading, alternative, factors);
  EXPECT_LT(worst_difference(found, expected), bound);
  EXPECT_EQ(found.covariance(), found.covariance().transpose());
  EXPECT_LT((change.mean - reference.mean).norm(), 1e-12);
  EXPECT_LT((change.covariance - reference.covariance).norm(),
            1e-11 * (reference.covariance.norm() + camera.norm()));
  EXPECT_LT((change.error_covariance.get() - reference.error_covariance.get()).norm(),
            1e-11 * camera.norm());
}

TEST(PairColumns, TheUpdateIsThatByDenseProducts) {
  by_every_instruction_set([] {
    RandomStream stream(21);
    for (const std::size_t objects : {1u, 2u, 5u, 10u}) {
      const PairScene scene = pair_scene(objects, stream);
      for (const std::size_t index : {scene.objects.front(), scene.objects.back()}) {
        for (const double weight : {0.0, 1e-3, 0.4, 0.9}) {
          expect_the_same(scene, index, weight, {}, stream);
          expect_the_same(scene, index, weight, {.camera = 0.2, .slow = 0.3}, stream);
          expect_the_same(scene, index, weight, {.camera = 0.0, .slow = 1.0}, stream);
        }
      }
    }
  });
}

/// The world is shifted by so much: rotations about its origin move everything.
PairScene seen_from(const SE3d& shift, const PairScene& scene) {
  PairScene result = scene;
  for (std::size_t k = 0; k < scene.joint.size(); ++k) {
    if (!scene.joint.is_pose(k)) continue;
    result.joint.set_pose(k, shift * scene.joint.pose(k));
    Eigen::MatrixXd by = Eigen::MatrixXd::Identity(6, 6);
    by = shift.adjoint();
    if (result.joint.blocks_of(k) > 1) {
      Eigen::MatrixXd both = Eigen::MatrixXd::Identity(12, 12);
      both.topLeftCorner<6, 6>() = by;
      by = both;
    }
    result.joint.transform(k, by);
  }
  return result;
}

// A detection where a slow error is known much worse than what is left of the pose.
TEST(PairColumns, ASmallNoiseLosesNoMoreThanWithDenseProducts) {
  RandomStream stream(23);
  for (const double noise : {1e-1, 1e-2, 1e-3, 1e-4}) {
    const PairScene scene = pair_scene(3, stream, noise);
    for (const std::size_t index : scene.objects) {
      expect_the_same(scene, index, 0.0, {}, stream, 1e-13);
      // The factor of a covariance in which `noise` is left of a variance loses digits of it.
      expect_the_same(scene, index, 0.4, {}, stream, 1e-11 / (noise * noise));
    }
  }
}

TEST(PairColumns, FarFromTheOriginTheUpdateIsWhatItIsThere) {
  RandomStream stream(24);
  const PairScene near = pair_scene(3, stream);
  for (const double distance : {1e2, 1e4, 1e5}) {
    const SE3d shift(SO3d(), {distance, 0.0, 0.0});
    for (const std::size_t index : near.objects) {
      SCOPED_TRACE(fmt::format("{} m, block {}", distance, index));
      const Explanation leading = explanation(near.joint, index, near.noise, stream);
      Explanation far_leading = leading;
      for (Innovation& seen : far_leading.innovations) {
        seen.residual = shift.adjoint() * seen.residual;
        seen.covariance = shift.adjoint_congruence(seen.covariance);
        seen.noise = shift.adjoint_congruence(seen.noise);
        seen.slow_map = shift.adjoint() * seen.slow_map;
      }
      PairScene expected = near;
      expected.joint.update_densely(index, leading, {}, {});
      PairScene far = seen_from(shift, near);
      far.joint.update(index, far_leading, {}, {});
      // A rotation of a third of a radian moves what is `distance` away by more than it is known,
      // to 3 mm: of sixteen digits twice that ratio's are lost.
      const double lost = distance * 0.3 / 0.003;
      const PairScene back = seen_from(shift.inverse(), far);
      EXPECT_LT(worst_difference(back.joint, expected.joint), 1e-16 * lost * lost);
    }
  }
}

TEST(PairColumns, ANearlySingularCovarianceIsLeftToDenseProducts) {
  RandomStream stream(22);
  PairScene scene = pair_scene(2, stream);
  // Of another object hardly anything is left, given the camera.
  ConditionalPose object{SE3d(), {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
  const Matrix6d known = scene.joint.covariance(kCamera, kCamera);
  object.covariance.topLeftCorner<6, 6>() = known + 1e-10 * Matrix6d::Identity();
  object.cross_covariance.topRows<6>() = known;
  scene.joint.append(object);
  const std::size_t index = scene.objects.front();
  const Explanation leading = explanation(scene.joint, index, scene.noise, stream);
  const CameraAlternative alternative{0.4, Vector6d::Zero(),
                                      0.7 * scene.joint.covariance(kCamera, kCamera)};
  JointGaussian found = scene.joint;
  JointGaussian expected = scene.joint;
  found.update(index, leading, alternative, {});
  expected.update_densely(index, leading, alternative, {});
  EXPECT_EQ(found.covariance(), expected.covariance());
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!found.is_pose(k)) continue;
    EXPECT_EQ(found.pose(k).matrix(), expected.pose(k).matrix());
  }
}

}  // namespace
}  // namespace posemix::internal
