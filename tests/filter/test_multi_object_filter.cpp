// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <limits>

#include "multi_object_scene.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/detector/default_noise.hpp"

namespace posemix {
namespace {

using testing::filter_of;
using testing::isotropic;
using testing::OrbitScene;
using testing::plain_settings;
using testing::pose;
using testing::ray_noise;

double angle_deg(const SE3d& a, const SE3d& b) {
  return degrees((a.rotation().inverse() * b.rotation()).log().norm());
}

bool is_right(const MultiObjectFilter& filter, const OrbitScene& scene, std::size_t object) {
  const auto leader = filter.leading(object);
  if (!leader) return false;
  const SE3d estimate = filter.hypotheses(object)[*leader].pose;
  return angle_deg(estimate, scene.truth[object]) < 20.0 &&
         (estimate.translation() - scene.truth[object].translation()).norm() < 0.1;
}

TEST(MultiObjectFilter, ALateTruthWinsOverAWrongBeginning) {
  OrbitScene scene(1, 1, 0.05, 1e-3);
  MultiObjectFilter filter = filter_of(scene, plain_settings());
  int recovered = -1;
  for (int frame = 0; frame < 80; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    filter.update(0, scene.detect(0, frame < 25 ? 1.0 : 0.0, 0.0));
    if (frame == 24) {
      EXPECT_FALSE(is_right(filter, scene, 0));
    }
    if (recovered < 0 && is_right(filter, scene, 0)) recovered = frame;
  }
  // Recovery needs as many right detections as there were wrong ones, and no more.
  EXPECT_GE(recovered, 40);
  EXPECT_LE(recovered, 56);
}

TEST(MultiObjectFilter, AYoungHypothesisIsKeptThoughEveryOldOneIsHeavier) {
  OrbitScene scene(2, 1, 0.01, 1e-4);
  MultiObjectSettings settings = plain_settings();
  settings.max_hypotheses = 3;
  settings.protected_hypotheses = 1;
  MultiObjectFilter filter = filter_of(scene, settings);
  // Three modes fight for long; the fourth comes late.
  const SE3d quarter = pose(0, 0, 0.5 * std::numbers::pi, 0, 0, 0);
  const auto turned = [&](int turns) {
    SE3d seen = scene.camera.inverse() * scene.truth[0];
    for (int i = 0; i < turns; ++i) seen = seen * quarter;
    return seen;
  };
  for (int frame = 0; frame < 120; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    filter.update(0, turned(1 + frame % 3));
  }
  EXPECT_FALSE(is_right(filter, scene, 0));
  for (int frame = 0; frame < 120; ++frame) {
    filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    filter.update(0, turned(0));
  }
  EXPECT_TRUE(is_right(filter, scene, 0));
}

TEST(MultiObjectFilter, AKnownModeBeginsWithEveryObject) {
  // One detection in five is turned by 90 degrees, the first among them.
  const SE3d turn = pose(0, 0, 0.5 * std::numbers::pi, 0, 0, 0);
  std::vector<NoiseComponent> components = ray_noise().components();
  components.push_back(components.front());
  components.back().weight = 0.2;
  components.back().offset = turn;
  OrbitScene scene(12, 1, 0.02, 3e-4);
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                           {{DetectorNoise(components, {.weight = 0.1, .volume_m3 = 1.0})}},
                           plain_settings());
  for (int frame = 0; frame < 60; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    const SE3d seen = scene.detect(0, 0.0, 0.0);
    filter.update(0, frame % 5 == 0 ? seen * turn : seen);
    if (frame == 0) {
      ASSERT_EQ(filter.hypotheses(0).size(), 2U);
      // The components of the mode without an offset have the weight 0.77, those of the other 0.2.
      const auto list = filter.hypotheses(0);
      EXPECT_NEAR(list[0].log_weight - list[1].log_weight, std::log(0.77 / 0.2), 1e-9);
    }
  }
  EXPECT_TRUE(is_right(filter, scene, 0));
}

TEST(MultiObjectFilter, AGrossErrorMovesNothing) {
  OrbitScene scene(3, 2, 0.01, 1e-4);
  MultiObjectFilter filter = filter_of(scene, plain_settings());
  for (int frame = 0; frame < 20; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    for (const std::size_t j : {0U, 1U}) filter.update(j, scene.detect(j, 0.0, 0.0));
  }
  const auto before = filter.joint();
  const SE3d wrong = scene.camera.inverse() * scene.truth[0] * pose(1.5, 0, 0, 0.2, 0, 0);
  const ObjectUpdateReport report = filter.update(0, wrong);
  EXPECT_TRUE(report.started);
  EXPECT_GT(report.clutter_probability, 0.999);
  const auto after = filter.joint();
  EXPECT_LT((after.mean() * before.mean().inverse()).log().norm(), 1e-6);
  EXPECT_TRUE(after.covariance().isApprox(before.covariance(), 1e-3));
}

/// By the defaults, whose slow error depends on the side from which an object is seen.
TEST(MultiObjectFilter, ADetectionAtTheCameraItselfIsNoEnd) {
  const Matrix6d q = isotropic(1e-3, 2e-3);
  for (const double at : {0.0, 1e-170, 1e-12}) {
    MultiObjectFilter filter(ConcentratedGaussian<SE3d>(SE3d(), q),
                             {{default_detector_noise()}, {default_detector_noise()}}, {});
    const auto see = [&](std::size_t object, const Eigen::Vector3d& t) {
      filter.update(object, SE3d(SO3d(), t));
      filter.predict_with_odometry(SE3d(SO3d(), {0.001, 0.002, 0.003}), q, 0.1);
      const Matrix6d covariance = filter.camera().covariance();
      ASSERT_TRUE(filter.camera().mean().translation().allFinite()) << at;
      ASSERT_EQ(Eigen::LLT<Matrix6d>(covariance).info(), Eigen::Success) << at;
    };
    see(1, {0.3, 0.0, 1.0});
    for (int frame = 0; frame < 5; ++frame) see(0, {0.0, 0.0, frame == 1 ? 1.0 : at});
    see(1, {0.3, 0.0, 1.0});
  }
}

TEST(MultiObjectFilter, CovariancesStayPositiveDefiniteAndWeightsNormalised) {
  OrbitScene scene(4, 4, 0.1, 2e-3);
  MultiObjectSettings settings = plain_settings();
  settings.camera_gain = 0.3;
  settings.camera_rotation_correction = 0.1;
  settings.camera_position_correction = 0.0;
  MultiObjectFilter filter = filter_of(scene, settings);
  for (int frame = 0; frame < 200; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    for (std::size_t j = 0; j < 4; ++j) filter.update(j, scene.detect(j, 0.4, 0.1));
    const Eigen::MatrixXd p = filter.joint().covariance();
    ASSERT_EQ(p, p.transpose());
    ASSERT_EQ(Eigen::LLT<Eigen::MatrixXd>(p).info(), Eigen::Success) << "frame " << frame;
    for (std::size_t j = 0; j < 4; ++j) {
      double sum = std::exp(filter.log_absent(j));
      const auto list = filter.hypotheses(j);
      ASSERT_LE(list.size(), settings.max_hypotheses);
      for (std::size_t h = 0; h < list.size(); ++h) {
        sum += std::exp(list[h].log_weight);
        // Object and camera together are a Gaussian, too.
        const Eigen::MatrixXd r = filter.relative(j, h).covariance();
        ASSERT_EQ(Eigen::LLT<Eigen::MatrixXd>(r).info(), Eigen::Success);
      }
      ASSERT_NEAR(sum, 1.0, 1e-9);
      ASSERT_GE(filter.mode_probability(j), 0.0);
      ASSERT_LE(filter.mode_probability(j), 1.0);
    }
  }
}

TEST(MultiObjectFilter, AConsideredCameraFollowsItsOdometryAlone) {
  OrbitScene scene(5, 2, 0.2, 3e-3);
  MultiObjectSettings settings = plain_settings();
  settings.camera_gain = 0.0;
  MultiObjectFilter filter = filter_of(scene, settings);
  SE3d odometry = scene.camera;
  for (int frame = 0; frame < 50; ++frame) {
    if (frame > 0) {
      const SE3d motion = scene.advance();
      odometry = odometry * motion;
      filter.predict_with_odometry(motion, scene.q, 0.1);
    }
    for (const std::size_t j : {0U, 1U}) filter.update(j, scene.detect(j, 0.2, 0.0));
  }
  // Merging the modes that are given up moves the camera, but far less than its uncertainty.
  EXPECT_LT((filter.camera().mean() * odometry.inverse()).log().norm(), 1e-9);
}

TEST(MultiObjectFilter, EstimatesDoNotFlipBetweenEquivalentPoses) {
  const SymmetryGroup half_turn({pose(0, 0, std::numbers::pi, 0.0, 0, 0)});
  OrbitScene scene(6, 1, 0.02, 3e-4);
  MultiObjectFilter filter = filter_of(scene, plain_settings(), half_turn);
  double farthest = 0.0;
  std::optional<SE3d> last;
  for (int frame = 0; frame < 100; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    const SE3d seen = scene.detect(0, 0.0, 0.0);
    filter.update(0, frame % 2 == 0 ? seen : seen * half_turn.elements()[1]);
    const SE3d now = filter.hypotheses(0)[*filter.leading(0)].pose;
    if (last) farthest = std::max(farthest, angle_deg(*last, now));
    last = now;
  }
  EXPECT_EQ(filter.hypotheses(0).size(), 1U);
  EXPECT_LT(farthest, 15.0);
}

TEST(MultiObjectFilter, AnAxisOfSymmetryTeachesNothingAboutItsAngle) {
  const SymmetryGroup axis({}, {{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()}});
  OrbitScene scene(7, 1, 0.0, 0.0);
  scene.q = isotropic(0.001, 1e-5);
  MultiObjectFilter filter = filter_of(scene, plain_settings(), axis);
  for (int frame = 0; frame < 60; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    const SE3d spin = pose(0, 0, 6.0 * scene.stream.uniform(), 0, 0, 0);
    filter.update(0, scene.detect(0, 0.0, 0.0) * spin);
  }
  ASSERT_EQ(filter.hypotheses(0).size(), 1U);
  const ObjectHypothesis h = filter.hypotheses(0)[0];
  const Matrix6d body = h.pose.inverse().adjoint_congruence(h.covariance);
  EXPECT_LT(degrees(std::sqrt(body(0, 0))), 2.0);
  EXPECT_NEAR(degrees(std::sqrt(body(2, 2))), 180.0 / std::sqrt(3.0), 0.1);  // uniform
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  EXPECT_LT(degrees(std::acos((h.pose.rotation() * z).dot(scene.truth[0].rotation() * z))), 3.0);
}

TEST(MultiObjectFilter, TheNoisesScaleIsLearned) {
  // The detector is four times better than the noise of the filter.
  OrbitScene scene(8, 1, 0.02, 3e-4);
  MultiObjectSettings settings = plain_settings();
  settings.noise_scale_detections = 10.0;
  const NoiseComponent sharp = ray_noise().components().front();
  const DetectorNoise told(
      {{.weight = 0.9, .covariance = 16.0 * sharp.covariance, .frame = NoiseFrame::ray}},
      {.weight = 0.1, .volume_m3 = 1.0});
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                           {{told}}, settings);
  for (int frame = 0; frame < 300; ++frame) {
    if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    filter.update(0, scene.detect(0, 0.0, 0.0));
  }
  const Vector6d scale = filter.noise_scale(0);
  for (const double value : scale) EXPECT_NEAR(value, 0.25, 0.08);
}

TEST(MultiObjectFilter, DetectionsOfOneModeCountOnceForItsProbability) {
  // Ten flipped detections within a hundredth of the mode time say no more than one.
  const auto probability_after = [](double mode_time_s) {
    OrbitScene scene(9, 1, 0.001, 1e-5);
    const DetectorNoise noise(ray_noise().components(), ray_noise().clutter(),
                              {.mode_time_s = mode_time_s});
    MultiObjectFilter filter(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                             {{noise}}, plain_settings());
    for (int frame = 0; frame < 10; ++frame) {
      if (frame > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
      filter.update(0, scene.detect(0, 1.0, 0.0));
    }
    return filter.mode_probability(0);
  };
  EXPECT_GT(probability_after(0.0), 1.0 - 1e-9);
  EXPECT_NEAR(probability_after(100.0), 0.77, 0.1);
}

TEST(MultiObjectFilter, ConstantVelocityIsThatOfTheGaussianSumFilter) {
  const Matrix6d q = isotropic(0.1, 1e-3);
  const Matrix6d q_motion = isotropic(0.2, 2e-3);
  const Matrix6d at_rest = isotropic(5.0, 0.05);
  OrbitScene scene(10, 1, 0.0, 0.0);
  const DetectorNoise noise({{1.0, isotropic(2.0, 0.01)}});
  MultiObjectSettings settings = plain_settings();
  settings.has_odometry = false;
  const ConcentratedGaussian<SE3d> start(scene.camera, isotropic(0.1, 0.002));
  MultiObjectFilter filter(start, {{noise}}, settings);
  Hypothesis reference(PoseStackd(std::vector<SE3d>{start.mean()}), start.covariance());
  reference = with_independent_pose(reference, SE3d(), at_rest);
  scene.q = isotropic(1e-6, 1e-9);
  for (int frame = 0; frame < 20; ++frame) {
    if (frame > 0) {
      scene.advance();
      filter.predict_constant_velocity(1.0, q, q_motion, at_rest, 0.1);
      reference = predict_constant_velocity(std::move(reference), 1.0, q, q_motion);
    }
    const SE3d seen = scene.camera.inverse() * scene.truth[0] *
                      SE3d::exp(testing::draw(isotropic(2.0, 0.01), scene.stream));
    filter.update(0, seen);
    const Detection detection{2, seen, &noise};
    const NoiseComponent* component = &noise.components().front();
    reference =
        frame == 0
            ? with_detected_object(reference, seen, *component)
            : update(reference, std::span(&detection, 1), std::span(&component, 1)).posterior;
  }
  const auto camera = marginal(reference, kCamera);
  EXPECT_LT((filter.camera().mean() * camera.mean().inverse()).log().norm(), 1e-9);
  EXPECT_TRUE(filter.camera().covariance().isApprox(camera.covariance(), 1e-6));
}

// At its first detection nothing is known of an object's slow error yet, and hence nothing of the
// error in common with another object but for the camera's.
TEST(MultiObjectFilter, TheJointStateHasTheSlowErrorsOfAllObjectsInOrder) {
  const OrbitScene scene(9, 3, 0.05, 1e-3);
  std::vector<ObjectSensor> sensors;
  for (const double factor : {1.0, 4.0, 9.0}) {
    NoiseDependence dependence;
    dependence.slow = SlowError{.covariance = factor * isotropic(1.0, 0.01)};
    sensors.push_back({DetectorNoise(ray_noise().components(), {.weight = 0.23}, dependence)});
  }
  MultiObjectFilter filter({scene.camera, isotropic(0.1, 0.002)}, sensors, plain_settings());
  for (std::size_t j = 0; j < 3; ++j) filter.update(j, scene.camera.inverse() * scene.truth[j]);
  const JointState state = filter.joint_state(std::vector<std::optional<std::size_t>>{0, {}, 0});
  ASSERT_EQ(state.poses.size(), 3U);
  ASSERT_EQ(state.slow.size(), 12);
  ASSERT_EQ(state.covariance.rows(), 30);
  EXPECT_TRUE(state.slow.isZero(0.0));
  EXPECT_TRUE(state.covariance.block(18, 18, 6, 6).isApprox(isotropic(1.0, 0.01)));
  EXPECT_TRUE(state.covariance.block(24, 24, 6, 6).isApprox(9.0 * isotropic(1.0, 0.01)));
  EXPECT_LT(state.covariance.block(18, 24, 6, 6).norm(), 1e-12);
  // With the camera, and each with its own object alone.
  EXPECT_LT(state.covariance.block(18, 0, 12, 6).norm(), 1e-12);
  EXPECT_GT(state.covariance.block(18, 6, 6, 6).norm(), 1e-5);
  EXPECT_LT(state.covariance.block(18, 12, 6, 6).norm(), 1e-12);
  EXPECT_GT(state.covariance.block(24, 12, 6, 6).norm(), 1e-5);
}

}  // namespace
}  // namespace posemix
