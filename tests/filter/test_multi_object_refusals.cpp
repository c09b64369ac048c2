// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Cholesky>

#include "multi_object_scene.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::filter_of;
using testing::isotropic;
using testing::OrbitScene;
using testing::plain_settings;
using testing::thrown_message;

/// A filter of one object, which was detected.
MultiObjectFilter filter_that_has_seen() {
  const OrbitScene scene(1, 1, 0.05, 1e-3);
  MultiObjectFilter filter = filter_of(scene, plain_settings());
  filter.update(0, scene.camera.inverse() * scene.truth[0]);
  return filter;
}

TEST(MultiObjectFilter, RefusesWhatItDoesNotKnow) {
  const OrbitScene scene(1, 1, 0.05, 1e-3);
  MultiObjectFilter filter = filter_of(scene, plain_settings());
  EXPECT_THROW(filter.update(1, SE3d()), InvalidInput);
  const auto refused = [&](auto change) {
    MultiObjectSettings settings = plain_settings();
    change(settings);
    EXPECT_THROW(filter_of(scene, settings), InvalidInput);
  };
  refused([](auto& s) { s.max_hypotheses = 0; });
  refused([](auto& s) { s.explained_probability = 1.0; });
  refused([](auto& s) { s.merge_probability = -0.1; });
  refused([](auto& s) { s.score_memory = 1.5; });
  refused([](auto& s) { s.camera_gain = 1.5; });
  refused([](auto& s) { s.camera_rotation_correction = -0.1; });
  refused([](auto& s) { s.camera_position_correction = 1.1; });
  refused([](auto& s) { s.default_clutter = 1.0; });
  refused([](auto& s) { s.max_global_hypotheses = 0; });
  refused([](auto& s) { s.split_loss = -1.0; });
}

TEST(MultiObjectFilter, RefusesWhatIsNotFiniteAndStaysAsItWas) {
  MultiObjectFilter filter = filter_that_has_seen();
  const Eigen::MatrixXd before = filter.joint().covariance();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const SE3d bad(SO3d(), {0.0, nan, 0.0});
  const Matrix6d q = isotropic(0.1, 1e-3);
  EXPECT_THROW(filter.update(0, bad), InvalidInput);
  EXPECT_THROW(filter.predict_with_odometry(bad, q, 0.1), InvalidInput);
  EXPECT_THROW(filter.predict_with_odometry(SE3d(), nan * q, 0.1), InvalidInput);
  EXPECT_THROW(filter.predict_with_odometry(SE3d(), -q, 0.1), InvalidInput);
  EXPECT_THROW(filter.predict_random_walk(q, -0.1), InvalidInput);
  EXPECT_THROW(filter.predict_constant_velocity(1.0, q, q, nan * q, 0.1), InvalidInput);
  EXPECT_EQ(filter.joint().covariance(), before);
}

TEST(MultiObjectFilter, RefusesANoiseThatIsNegativeInSomeDirectionAndStaysAsItWas) {
  MultiObjectFilter filter = filter_that_has_seen();
  const Eigen::MatrixXd before = filter.joint().covariance();
  const Matrix6d good = isotropic(0.1, 1e-3);
  Matrix6d bad = good;
  bad(0, 5) = bad(5, 0) = 2.0 * std::sqrt(good(0, 0) * good(5, 5));
  const auto refused = [&](const std::string& what, const auto& action) {
    EXPECT_EQ(thrown_message(action), what + " is not positive semidefinite");
    EXPECT_EQ(filter.joint().covariance(), before);
  };
  refused("noise of the odometry", [&] { filter.predict_with_odometry(SE3d(), bad, 0.1); });
  refused("noise of the random walk", [&] { filter.predict_random_walk(bad, 0.1); });
  const auto moved = [&](const Matrix6d& q, const Matrix6d& q_motion, const Matrix6d& at_rest) {
    filter.predict_constant_velocity(1.0, q, q_motion, at_rest, 0.1);
  };
  refused("noise of the pose", [&] { moved(bad, good, good); });
  refused("noise of the motion", [&] { moved(good, bad, good); });
  refused("covariance of the motion at rest", [&] { moved(good, good, bad); });
}

TEST(MultiObjectFilter, ComputesWithTheSymmetricPartOfANoise) {
  testing::expect_the_symmetric_part_to_count([](const Matrix6d& q) {
    MultiObjectFilter filter = filter_that_has_seen();
    filter.predict_with_odometry(SE3d(), q, 0.1);
    filter.predict_random_walk(q, 0.1);
    filter.predict_constant_velocity(1.0, q, q, q, 0.1);
    return Eigen::MatrixXd(filter.joint().covariance());
  });
}

TEST(MultiObjectFilter, RefusesWhatIsFartherThanAnythingAndStaysAsItWas) {
  MultiObjectFilter filter = filter_that_has_seen();
  const Eigen::MatrixXd before = filter.joint().covariance();
  const Matrix6d q = isotropic(0.1, 1e-3);
  for (const double far : {1.1e8, 1e155, 1e300}) {
    const SE3d away(SO3d(), {0.0, far, 0.0});
    EXPECT_THROW(filter.update(0, away), InvalidInput) << far;
    EXPECT_THROW(filter.predict_with_odometry(away, q, 0.1), InvalidInput) << far;
    EXPECT_THROW(filter.set_camera({away, q}, 0.1), InvalidInput) << far;
    EXPECT_THROW(filter.predict_with_odometry(SE3d(), 1e20 * far * q, 0.1), InvalidInput) << far;
    EXPECT_THROW(filter.predict_random_walk(q, far * far), InvalidInput) << far;
    EXPECT_EQ(filter.joint().covariance(), before) << far;
  }
}

/// The smallest eigenvalue of the correlations of all poses.
double definiteness(const MultiObjectFilter& filter) {
  const Eigen::MatrixXd p = filter.joint().covariance();
  const Eigen::VectorXd scale = p.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlations = scale.asDiagonal() * p * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlations, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

TEST(MultiObjectFilter, IsDefiniteForAnyPriorThatItTakesAndRefusesOthers) {
  const Matrix6d noise = isotropic(1e-3, 1e-3);
  const ObjectSensor sensor{DetectorNoise({NoiseComponent{1.0, noise}}, Clutter{0.01, 1.0})};
  const SE3d first(SO3d::exp({0.2, 0.3, 1.0}), {1, 2, 0.5}), second(SO3d(), {-1, 1, 0.5});
  for (const double wide : {1e1, 1e2, 1e3, 3e3}) {
    Matrix6d prior = noise;
    prior.bottomRightCorner<3, 3>() *= std::pow(wide / 1e-3, 2);
    MultiObjectFilter filter({SE3d(), prior}, {sensor}, {});
    filter.add_object(sensor, ObjectPrior{{first, noise}, 1.0});
    for (int frame = 0; frame < 5; ++frame) {
      filter.update(1, first);
      filter.update(0, second);
      EXPECT_GT(definiteness(filter), 0.0) << wide;
    }
  }
  Matrix6d prior = noise;
  prior(4, 4) = 1e8;
  const std::string why =
      " has a standard deviation of 1e+04 m and the detection one of 0.001 m; expected at most "
      "3.2e+06 times as much, which double precision holds";
  EXPECT_EQ(thrown_message([&] {
              MultiObjectFilter({SE3d(), prior}, {sensor}, {});
            }),
            "the pose of the camera" + why);
  ObjectSensor two{DetectorNoise({NoiseComponent{1.0, isotropic(1.0, 1.0)}}, Clutter{0.01, 1.0})};
  two.other_detectors.push_back(sensor.noise);
  MultiObjectFilter filter({SE3d(), noise}, {sensor}, {});
  for (const ObjectSensor& refused : {sensor, two}) {
    EXPECT_EQ(thrown_message([&] {
                filter.add_object(refused, ObjectPrior{{first, prior}, 1.0});
              }),
              "the prior" + why);
    EXPECT_EQ(filter.object_count(), 1U);
  }
}

TEST(MultiObjectFilter, IsDefiniteForAnyNoiseThatItTakesAndRefusesOthers) {
  const auto sensor_of = [](double slow_m) {
    const Matrix6d noise = isotropic(1e-3, 1e-3);
    Matrix6d slow = noise;
    slow(4, 4) = slow_m * slow_m;
    return ObjectSensor{DetectorNoise({NoiseComponent{1.0, noise}}, Clutter{0.01, 1.0},
                                      {.slow = SlowError{.covariance = slow}})};
  };
  const SE3d seen(SO3d::exp({0.2, 0.3, 1.0}), {0.1, 0.2, 0.5});
  for (const double wide : {1e-1, 1e1, 1e2, 1e3, 3e3}) {
    MultiObjectFilter filter({SE3d(), isotropic(1e-3, 1e-3)}, {sensor_of(wide)}, {});
    for (int frame = 0; frame < 5; ++frame) {
      filter.update(0, seen);
      filter.predict_with_odometry(SE3d(SO3d(), {0.01, 0.0, 0.0}), isotropic(1e-3, 1e-3), 0.1);
      EXPECT_GT(definiteness(filter), 0.0) << wide;
    }
  }
  const std::string why =
      "the slow error of a detector has a standard deviation of 1e+04 m and the detection one of "
      "0.001 m; expected at most 3.2e+06 times as much, which double precision holds";
  const ObjectSensor refused = sensor_of(1e4);
  EXPECT_EQ(thrown_message([&] {
              MultiObjectFilter({SE3d(), isotropic(1e-3, 1e-3)}, {refused}, {});
            }),
            why);
  ObjectSensor second = sensor_of(1.0);
  second.other_detectors.push_back(refused.noise);
  MultiObjectFilter filter({SE3d(), isotropic(1e-3, 1e-3)}, {sensor_of(1.0)}, {});
  for (const ObjectSensor& sensor : {refused, second})
    EXPECT_EQ(thrown_message([&] { filter.add_object(sensor); }), why);
  Matrix6d wide = isotropic(1e-3, 1e-3);
  wide(4, 4) = 1e8;
  const ObjectSensor uneven{DetectorNoise({NoiseComponent{1.0, wide}}, Clutter{0.01, 1.0})};
  EXPECT_EQ(thrown_message([&] { filter.add_object(uneven); }),
            "a component of a detector's noise has a standard deviation of 1e+04 m and the "
            "detection one of 0.001 m; expected at most 3.2e+06 times as much, which double "
            "precision holds");
  EXPECT_EQ(filter.object_count(), 1U);
}

TEST(MultiObjectFilter, RefusesAllOfAFilterThatWasMovedFrom) {
  OrbitScene scene(6, 1, 0.01, 1e-4);
  MultiObjectFilter filter = filter_of(scene, plain_settings());
  const MultiObjectFilter taken = std::move(filter);
  EXPECT_EQ(taken.object_count(), 1U);
  // NOLINTBEGIN(bugprone-use-after-move): what is tested.
  EXPECT_THROW(filter.object_count(), InvalidInput);
  EXPECT_THROW(filter.camera(), InvalidInput);
  EXPECT_THROW(filter.camera_mixture(), InvalidInput);
  EXPECT_THROW(filter.update(0, SE3d()), InvalidInput);
  EXPECT_THROW(MultiObjectFilter{filter}, InvalidInput);
  const Matrix6d q = isotropic(0.1, 1e-3);
  const std::string expected = "the filter was moved from; expected one with a state";
  EXPECT_EQ(thrown_message([&] { filter.predict_with_odometry(SE3d(), q, 0.1); }), expected);
  EXPECT_EQ(thrown_message([&] { filter.predict_random_walk(q, 0.1); }), expected);
  EXPECT_EQ(thrown_message([&] { filter.predict_constant_velocity(1.0, q, q, q, 0.1); }), expected);
  EXPECT_EQ(thrown_message([&] { filter.set_camera({SE3d(), q}, 0.1); }), expected);
  filter = taken;
  EXPECT_EQ(filter.object_count(), 1U);
  // NOLINTEND(bugprone-use-after-move)
}

TEST(MultiObjectFilter, RefusesIndicesAtWhichThereIsNothing) {
  OrbitScene scene(6, 2, 0.01, 1e-4);
  MultiObjectFilter filter = filter_of(scene, plain_settings());
  filter.update(0, scene.detect(0, 0.0, 0.0));
  const auto expect_refused = [](const char* message, const auto& action) {
    EXPECT_EQ(thrown_message(action), message);
  };
  const char* no_object = "there is no object 2; there are 2";
  expect_refused(no_object, [&] { return filter.hypotheses(2); });
  expect_refused(no_object, [&] { return filter.leading(2); });
  expect_refused(no_object, [&] { return filter.mode_probability(2); });
  expect_refused(no_object, [&] { return filter.log_absent(2); });
  expect_refused(no_object, [&] { return filter.object_mixture(2); });
  expect_refused("object 1 has no hypothesis; it was not detected",
                 [&] { return filter.object_mixture(1); });
  expect_refused(no_object, [&] { return filter.noise_scale(2); });
  expect_refused(no_object, [&] { return filter.sensor(2); });
  expect_refused(no_object, [&] { return filter.pose_index(2); });
  expect_refused(no_object, [&] { return filter.relative(2, 0); });
  expect_refused(no_object, [&] { return filter.unseen_covariance(2, SE3d()); });
  expect_refused(no_object, [&] { return filter.update(2, SE3d()); });
  expect_refused(no_object, [&] { filter.forget(2); });
  expect_refused("object 0 has 1 hypotheses; there is none at index 1",
                 [&] { return filter.relative(0, 1); });
  expect_refused("object 1 has 0 hypotheses; there is none at index 0",
                 [&] { return filter.relative(1, 0); });
  using Modes = std::vector<std::optional<std::size_t>>;
  expect_refused("hypotheses of 1 objects, but there are 2",
                 [&] { return filter.joint_of(Modes{0}); });
  expect_refused("object 1 has 0 hypotheses; there is none at index 0", [&] {
    return filter.joint_of(Modes{0, 0});
  });
  EXPECT_EQ(filter.joint_of(Modes{0, std::nullopt}).mean().size(), 2U);
}

}  // namespace
}  // namespace posemix
