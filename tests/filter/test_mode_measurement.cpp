// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "filter/scenario.hpp"
#include "posemix/filter/mode_measurement.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::pose;

struct ModeScene {
  SE3d camera = pose(0.3, -0.2, 0.5, 0.4, 0.1, -0.6);
  SE3d object = pose(0.1, 0.2, -0.4, 0.2, 0, 0.5);
  SE3d detected = camera.inverse() * object * pose(0.02, 0, 0, 0, 0.01, 0);
  Matrix6d covariance = isotropic(2.0, 0.01);

  ModeState state() const {
    ModeState state{.camera = camera, .object = object};
    state.covariance.topLeftCorner<6, 6>() = isotropic(1.0, 0.01);
    return state;
  }
};

// One component and no clutter: the factor is the Gaussian of that component.
TEST(ModeMeasurement, TheInformationIsThatOfTheComponent) {
  const ModeScene scene;
  const ObjectSensor sensor{DetectorNoise({{.covariance = scene.covariance}})};
  const ModeMeasurement seen = measure_mode(scene.state(), scene.detected, sensor);
  const Matrix6d in_world = scene.object.adjoint_congruence(scene.covariance);
  EXPECT_TRUE(seen.information.isApprox(in_world.inverse(), 1e-9));
  const Vector6d residual = (scene.camera * scene.detected * scene.object.inverse()).log();
  EXPECT_TRUE(seen.pull.isApprox(seen.information * residual, 1e-9));
  EXPECT_EQ(seen.inlier_probability, 1.0);
  EXPECT_EQ(seen.clutter_probability, 0.0);
}

TEST(ModeMeasurement, ARunOfDetectionsHasTheInformationOfOne) {
  const ModeScene scene;
  const ObjectSensor sensor{DetectorNoise({{.covariance = scene.covariance, .run_length = 4.0}})};
  const ModeMeasurement seen = measure_mode(scene.state(), scene.detected, sensor);
  const Matrix6d in_world = scene.object.adjoint_congruence(scene.covariance);
  EXPECT_TRUE(seen.information.isApprox(0.25 * in_world.inverse(), 1e-9));
}

// z = Log(...) - A b, where A turns the axes of the noise into those of the world.
TEST(ModeMeasurement, TheSlowErrorIsTakenOffTheResidual) {
  const ModeScene scene;
  const ObjectSensor sensor{DetectorNoise({{.covariance = scene.covariance}}, {},
                                          {.slow = SlowError{.covariance = scene.covariance}})};
  ModeState state = scene.state();
  state.slow << 0.01, 0.0, -0.02, 0.001, 0.002, 0.0;
  state.covariance.bottomRightCorner<6, 6>() = scene.covariance;
  const ModeMeasurement seen = measure_mode(state, scene.detected, sensor);
  EXPECT_TRUE(seen.slow_map.isApprox(scene.object.adjoint(), 1e-12));
  const Vector6d residual = (scene.camera * scene.detected * scene.object.inverse()).log();
  EXPECT_TRUE(seen.pull.isApprox(seen.information * (residual - seen.slow_map * state.slow), 1e-9));
}

}  // namespace
}  // namespace posemix
