// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <vector>

#include "filter/multi_object/global_hypotheses.hpp"
#include "multi_object_scene.hpp"
#include "posemix/testing/numeric_jacobian.hpp"

/// Cameras of a rig whose poses on the body are a part of the state.
namespace posemix {
namespace {

using internal::ActiveLimits;
using internal::GlobalHypotheses;
using internal::JointGaussian;
using internal::MultiObjectState;
using testing::isotropic;
using testing::OrbitScene;
using testing::plain_settings;
using testing::pose;
using testing::ray_noise;

const SE3d kBodyCamera = pose(0.1, 0.5, -0.2, 0.2, -0.1, 0.05);

TEST(Extrinsics, TheErrorOfACameraIsThatOfTheBodyAndOfItsPoseThere) {
  JointGaussian joint(ConcentratedGaussian<SE3d>(testing::kCameraPose, isotropic(1, 0.01)));
  joint.append_extrinsic({pose(0.3, 0.1, 0.2, 1, 2, 3), isotropic(1, 0.01)});
  joint.append_extrinsic({kBodyCamera, isotropic(2, 0.02)});
  const auto seeing = [&](const Eigen::VectorXd& xi) {
    const SE3d body = SE3d::exp(xi.head<6>()) * joint.pose(0);
    const SE3d moved = body * SE3d::exp(xi.tail<6>()) * joint.pose(2) *
                       joint.seeing_camera({.camera = 1}).inverse();
    return Eigen::VectorXd(moved.log());
  };
  Eigen::MatrixXd numeric(6, 18);
  for (Eigen::Index i = 0; i < 18; ++i) {
    numeric.col(i) = testing::derivative_at_zero<double>(
        [&](double s) { return seeing(s * Eigen::VectorXd::Unit(18, i)); });
  }
  EXPECT_LT((joint.seen_by({.camera = 1}) - numeric).norm(), 1e-8);
  Eigen::MatrixXd of_body = Eigen::MatrixXd::Zero(6, 18);
  of_body.leftCols<6>().setIdentity();
  EXPECT_EQ(joint.seen_by({}), of_body);
}

/// Beside an exact camera and without.
TEST(Extrinsics, AreIndependentOfABodyThatIsGiven) {
  for (const bool is_exact : {false, true}) {
    MultiObjectState state({SE3d(), isotropic(0.1, 1e-3)},
                           {{DetectorNoise({{.covariance = isotropic(1.0, 0.01)}})}}, {});
    state.add_camera({kBodyCamera, isotropic(5, 0.05)});
    const auto see = [&](const ObservationSource& source) {
      internal::LogTotals evidence;
      const auto seen = state.observe(0, observation_of(pose(0.1, 0, 0.2, 0, 0, 1)), source);
      state.update(0, seen, internal::Starters(1, true), evidence);
    };
    if (is_exact) see({});
    see({.camera = 0});
    const Matrix6d noise = isotropic(0.1, 1e-3);
    state.set_camera({SE3d(), noise}, 0.1);
    see({.camera = 0});
    state.set_camera({pose(1e-3, 0, 0, 1e-3, 0, 0), noise}, 0.1);
    const Matrix6d cross = state.joint.covariance(0, 1);
    EXPECT_TRUE(cross.isZero(0.0));
  }
}

/// With a body that is known and stays, a camera of uncertain pose on it is a body of uncertain
/// pose. Everything that treats the camera treats extrinsics alike, in all hypotheses.
TEST(Extrinsics, OfABodyThatIsKnownAreTheBodyItself) {
  const Matrix6d tiny = 1e-14 * Matrix6d::Identity();
  const Matrix6d wide = isotropic(2.0, 0.03);
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    OrbitScene scene(seed, 3, 0.1, 0.002);
    const SE3d start = SE3d::exp(testing::draw(wide, scene.stream)) * scene.camera;
    const std::vector<ObjectSensor> sensors(3, {ray_noise(0.1)});
    MultiObjectFilter body({start, wide}, sensors, plain_settings());
    MultiObjectFilter rig({SE3d(), tiny}, sensors, plain_settings());
    rig.add_camera({start, wide});
    // The error of a start is kept beside the joint Gaussian, that of extrinsics is not: a body
    // that is given has all of it in the joint Gaussian until the twentieth detection.
    body.set_camera({start, wide}, 0.0);
    rig.set_camera({SE3d(), tiny}, 0.0);
    for (int k = 0; k < 19; ++k) {
      const std::size_t object = static_cast<std::size_t>(k) % 3;
      const Observation seen = observation_of(scene.detect(object, 0.45, 0.05));
      const ObjectUpdateReport a = body.update(object, seen);
      const ObjectUpdateReport b = rig.update(object, seen, {.camera = 0});
      ASSERT_NEAR(a.log_evidence, b.log_evidence, 1e-4) << "seed " << seed << ", detection " << k;
      ASSERT_EQ(a.started, b.started);
      ASSERT_EQ(body.leading(object), rig.leading(object));
      ASSERT_LT((rig.extrinsic(0).mean() * body.camera().mean().inverse()).log().norm(), 1e-5);
      ASSERT_LT((rig.extrinsic(0).covariance() - body.camera().covariance()).norm(),
                1e-4 * body.camera().covariance().norm());
      const auto ours = rig.hypotheses(object);
      const auto theirs = body.hypotheses(object);
      ASSERT_EQ(ours.size(), theirs.size());
      for (std::size_t h = 0; h < ours.size(); ++h) {
        ASSERT_NEAR(ours[h].log_weight, theirs[h].log_weight, 1e-3);
        ASSERT_LT((ours[h].pose * theirs[h].pose.inverse()).log().norm(), 1e-5);
        ASSERT_LT((ours[h].covariance - theirs[h].covariance).norm(),
                  1e-4 * theirs[h].covariance.norm());
      }
    }
    EXPECT_GT(body.camera_mixture().size() + body.hypotheses(0).size(), 2U);
  }
}

/// Noise of which everything is on: typical, with a slow error.
DetectorNoise full_noise() {
  return DetectorNoise(
      ray_noise().components(), {.weight = 0.2},
      {.slow = SlowError{.covariance = pose_covariance({0.06, 0.06, 0.03}, {0.004, 0.004, 0.03}),
                         .correlation_time_s = 3.0},
       .is_typical = true});
}

/// The same without clutter, with which every object has one hypothesis.
DetectorNoise one_mode_noise() {
  return DetectorNoise(full_noise().components(), {.weight = 0.0}, full_noise().dependence());
}

/// A camera that no observation is from, or whose pose is all but exact, changes nothing.
TEST(Extrinsics, ThatAreAllButExactChangeNothing) {
  for (const bool has_odometry : {true, false}) {
    for (const bool is_used : {false, true}) {
      OrbitScene scene(3, 3, 0.1, 0.002);
      MultiObjectSettings settings;
      settings.has_odometry = has_odometry;
      const std::vector<ObjectSensor> sensors(3, {full_noise()});
      const ConcentratedGaussian<SE3d> start(scene.camera, isotropic(0.1, 0.002));
      MultiObjectFilter exact(start, sensors, settings);
      MultiObjectFilter rig = exact;
      const Matrix6d wide = isotropic(3.0, 0.1);
      rig.add_camera({kBodyCamera, is_used ? Matrix6d(1e-9 * wide) : wide});
      for (int k = 0; k < 80; ++k) {
        const SE3d motion = scene.advance();
        for (MultiObjectFilter* filter : {&exact, &rig}) {
          if (has_odometry) {
            filter->predict_with_odometry(motion, scene.q, 0.1);
          } else {
            filter->predict_constant_velocity(1.0, isotropic(0.2, 0.003), isotropic(0.1, 0.002),
                                              isotropic(2.0, 0.03), 0.1);
          }
        }
        const std::size_t object = static_cast<std::size_t>(k) % 3;
        const Observation seen =
            observation_of(kBodyCamera.inverse() * scene.detect(object, 0.4, 0.05));
        exact.update(object, seen, {.body_camera = kBodyCamera});
        rig.update(object, seen,
                   is_used ? ObservationSource{.camera = 0}
                           : ObservationSource{.body_camera = kBodyCamera});
        ASSERT_LT((exact.joint().covariance() - rig.joint().covariance()).norm(),
                  1e-4 * exact.joint().covariance().norm())
            << "detection " << k;
        ASSERT_LT((exact.camera().mean() * rig.camera().mean().inverse()).log().norm(), 1e-4);
        ASSERT_NEAR(exact.mode_probability(object), rig.mode_probability(object), 1e-3);
        ASSERT_EQ(exact.leading(object), rig.leading(object));
      }
      if (!is_used) {
        EXPECT_LT((rig.extrinsic(0).covariance() - wide).norm(), 1e-9);
      }
    }
  }
}

TEST(Extrinsics, StayWithTheCameraWhereObjectsArePassive) {
  OrbitScene scene(9, 12, 0.1, 0.002);
  const auto filter_with = [&](const ActiveLimits& limits) {
    MultiObjectState state(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                           std::vector<ObjectSensor>(scene.truth.size(), {one_mode_noise()}),
                           plain_settings());
    state.add_camera({kBodyCamera, isotropic(2, 0.02)});
    state.limits = limits;
    return GlobalHypotheses(state);
  };
  GlobalHypotheses dense = filter_with({.dense = 1000});
  GlobalHypotheses few = filter_with({.dense = 9, .most = 9, .kept = 4});
  for (int k = 0; k < 100; ++k) {
    const SE3d motion = scene.advance();
    const std::size_t object = static_cast<std::size_t>(k / 4 + k % 3) % scene.truth.size();
    const bool is_second = k % 2 == 1;
    const SE3d seen = scene.detect(object, 0.0, 0.0);
    const Observation observation = observation_of(is_second ? kBodyCamera.inverse() * seen : seen);
    for (GlobalHypotheses* filter : {&dense, &few}) {
      filter->for_each([&](MultiObjectState& s) { s.predict_with_odometry(motion, scene.q, 0.1); });
      filter->update(object, observation,
                     is_second ? ObservationSource{.camera = 0} : ObservationSource{});
    }
    JointGaussian a = dense.summary().joint;
    JointGaussian b = few.summary().joint;
    // With passive objects another part of the error of the world is in it.
    a.add_world_error(dense.summary().world_error);
    b.add_world_error(few.summary().world_error);
    ASSERT_LT((a.covariance() - b.covariance()).norm(), 1e-7 * a.covariance().norm()) << k;
    ASSERT_LT((a.pose(1) * b.pose(1).inverse()).log().norm(), 1e-7);
  }
  EXPECT_LT(few.summary().joint.active(), few.summary().joint.size());
}

TEST(Extrinsics, ArePredictedWithTheirUncertainty) {
  MultiObjectFilter filter({SE3d(), isotropic(0.1, 0.001)}, {{ray_noise(0.0)}}, plain_settings());
  filter.add_camera({kBodyCamera, isotropic(2, 0.02)});
  const SE3d seen = pose(0.3, 0, 0, 0, 0.1, 0.8);
  filter.update(0, observation_of(seen));
  const auto exact = filter.predicted_detection(0, 0, kBodyCamera);
  const auto uncertain = filter.predicted_detection(0, 0, ObservationSource{.camera = 0});
  EXPECT_LT((exact.mean() * uncertain.mean().inverse()).log().norm(), 1e-12);
  // In the axes of the camera the pose differs by the error of the extrinsic there, exactly.
  const Matrix6d added = kBodyCamera.inverse().adjoint_congruence(isotropic(2, 0.02));
  EXPECT_LT((uncertain.covariance() - exact.covariance() - added).norm(), 1e-9);
  // An object that was seen by that camera alone is known from it as well as it was seen.
  MultiObjectFilter other({SE3d(), isotropic(0.1, 0.001)}, {{ray_noise(0.0)}}, plain_settings());
  other.add_camera({kBodyCamera, isotropic(2, 0.02)});
  other.update(0, observation_of(seen), {.camera = 0});
  EXPECT_LT(other.predicted_detection(0, 0, ObservationSource{.camera = 0}).covariance().trace(),
            other.relative(0, 0).covariance().trace() - 0.9 * isotropic(2, 0.02).trace());
}

TEST(Extrinsics, ThatComeTooLateOrAreNotThereAreRefused) {
  MultiObjectFilter filter({SE3d(), isotropic(1, 0.01)}, {{ray_noise()}}, plain_settings());
  const Observation seen = observation_of(pose(0, 0, 0, 0, 0, 1));
  EXPECT_THROW(filter.update(0, seen, {.camera = 0}), InvalidInput);
  EXPECT_THROW(filter.extrinsic(0), InvalidInput);
  filter.add_camera({kBodyCamera, isotropic(2, 0.02)});
  EXPECT_EQ(filter.extrinsic_count(), 1U);
  EXPECT_THROW(filter.update(0, seen, {.camera = 1}), InvalidInput);
  filter.update(0, seen, {.camera = 0});
  EXPECT_THROW(filter.predicted_detection(0, 0, ObservationSource{.camera = 1}), InvalidInput);
  EXPECT_THROW(filter.add_camera({kBodyCamera, isotropic(2, 0.02)}), InvalidInput);
}

}  // namespace
}  // namespace posemix
