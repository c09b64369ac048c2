// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The multi-object filter where its camera is known far worse than a detection.
#include <cmath>

#include <gtest/gtest.h>

#include "multi_object_scene.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::isotropic;

/// Odometry that is lost in one direction, and detections that go on: rounding leaves nothing of
/// the camera, and so nothing that would tell of the noise, but numbers.
TEST(MultiObjectFilter, GoesOnWhereTheCameraIsKnownFarWorseThanADetection) {
  const DetectorNoise noise({{1.0, isotropic(3.0, 0.01), NoiseFrame::ray}},
                            {.weight = 0.05, .volume_m3 = 0.013});
  const auto at = [](double turn, double x, double y, double z) {
    return SE3d(SO3d::exp({0.6, turn, -0.7}), {x, y, z});
  };
  for (const double wide : {1e6, 1e7, 9e7}) {
    for (int aside = 0; aside < 10; ++aside) {
      MultiObjectFilter filter({at(-1.5, -0.4, 0.3, 1.0), isotropic(3.0, 0.05)}, {{noise}, {noise}},
                               {});
      filter.update(0, at(0.2, 0.3, 0.9, -0.4));
      Matrix6d q = isotropic(0.6, 0.01);
      q(3, 3) = wide * wide;
      filter.predict_with_odometry(SE3d(SO3d(), {0.01 * aside, -0.05, -0.08}), q, 0.1);
      for (int k = 0; k < 4; ++k) {
        const std::size_t object = k % 2 == 0 ? 0 : 1;
        filter.update(object, at(0.6 - 0.5 * k, -0.8, 0.2 + 0.2 * k, 0.3));
        EXPECT_TRUE(filter.noise_scale(object).allFinite()) << wide << ' ' << aside << ' ' << k;
        for (const ObjectHypothesis& h : filter.hypotheses(object))
          EXPECT_TRUE(h.covariance.allFinite()) << wide << ' ' << aside << ' ' << k;
      }
    }
  }
}

// Odometry says by its noise that it knows nothing; what was left behind is found again.
TEST(MultiObjectFilter, FindsWhatItLeftWhateverTheNoiseOfTheOdometry) {
  const DetectorNoise noise({{1.0, isotropic(3.0, 0.01)}});
  const SE3d camera(SO3d::exp({0.6, -1.5, -0.7}), {-0.4, 0.3, 1.0});
  const SE3d seen(SO3d::exp({0.2, 0.1, -0.3}), {0.1, -0.2, 0.8});
  const SE3d moved(SO3d::exp({0.05, 0.1, 0.0}), {0.1, 0.05, -0.05});
  for (const double rotation : {0.01, 1e3, 9e7}) {
    for (const double position : {0.01, 1e4, 1e6, 9e7}) {
      Matrix6d q = isotropic(1.0, position);
      q.topLeftCorner<3, 3>() = rotation * rotation * Eigen::Matrix3d::Identity();
      q(3, 3) *= 0.1;
      MultiObjectFilter filter({camera, isotropic(0.5, 0.005)}, {{noise}}, {});
      for (int k = 0; k < 5; ++k) filter.update(0, seen);
      for (int k = 0; k < 50; ++k) filter.predict_with_odometry(SE3d(), q, 0.1);
      for (int k = 0; k < 5; ++k) {
        filter.update(0, moved * seen);
        EXPECT_EQ(Eigen::LLT<Matrix6d>(filter.camera().covariance()).info(), Eigen::Success);
        const auto relative = filter.relative(0, 0);
        EXPECT_LT((relative.mean().inverse() * moved * seen).log().norm(), 0.1)
            << rotation << ' ' << position << ' ' << k;
      }
    }
  }
}

// A camera that is lost in the world may see an object; the noise of its next motion counts then.
TEST(MultiObjectFilter, AMotionCountsBesideAnObjectHoweverUncertainTheWorldIs) {
  const DetectorNoise noise({{1.0, isotropic(3.0, 0.01)}});
  const SE3d seen(SO3d::exp({0.2, 0.1, -0.3}), {0.1, -0.2, 0.8});
  MultiObjectFilter filter({SE3d(), isotropic(0.5, 0.005)}, {{noise}}, {});
  filter.predict_with_odometry(SE3d(), isotropic(1.0, 1e6), 0.1);
  filter.update(0, seen);
  const double before = filter.relative(0, 0).covariance()(3, 3);
  filter.predict_with_odometry(SE3d(), isotropic(1.0, 20.0), 0.1);
  EXPECT_NEAR(filter.relative(0, 0).covariance()(3, 3) - before, 400.0, 40.0);
}

TEST(MultiObjectFilter, FindsAnObjectWithACameraThatIsGivenWithAnyCovariance) {
  const DetectorNoise noise({{1.0, isotropic(3.0, 0.01)}});
  const SE3d seen(SO3d::exp({0.2, 0.1, -0.3}), {0.1, -0.2, 0.8});
  for (const double wide : {1e3, 1e5, 9e7}) {
    for (int row = 0; row < 6; ++row) {
      MultiObjectFilter filter({SE3d(), isotropic(0.5, 0.005)}, {{noise}}, {});
      filter.update(0, seen);
      Matrix6d given = isotropic(0.5, 0.01);
      given(row, row) = wide * wide;
      for (int k = 0; k < 20; ++k) {
        if (k % 5 == 0) filter.set_camera({SE3d(SO3d(), {0.01, 0.02, 0.03}), given}, 0.1);
        filter.update(0, seen);
        // About the origin, rounding of 9e7 rad is more than the variance of the camera's place.
        if (row >= 3 || wide < 1e6) {
          EXPECT_EQ(Eigen::LLT<Matrix6d>(filter.camera().covariance()).info(), Eigen::Success);
        }
        EXPECT_TRUE(filter.camera().covariance().allFinite());
        EXPECT_LT((filter.relative(0, 0).mean().inverse() * seen).log().norm(), 0.1)
            << wide << ' ' << row << ' ' << k;
      }
    }
  }
}

}  // namespace
}  // namespace posemix
