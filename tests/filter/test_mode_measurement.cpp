// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "filter/scenario.hpp"
#include "posemix/filter/mode_measurement.hpp"

namespace posemix {
namespace {

using testing::isotropic;
using testing::pose;

// One component and no clutter: the factor is the Gaussian of that component.
TEST(ModeMeasurement, TheInformationIsOfTheChosenCovariance) {
  const Matrix6d covariance = isotropic(2.0, 0.01);
  const ObjectSensor sensor{DetectorNoise(
      {{.weight = 1.0, .covariance = covariance, .update_covariance = 4.0 * covariance}})};
  const SE3d camera = pose(0.3, -0.2, 0.5, 0.4, 0.1, -0.6);
  const SE3d object = pose(0.1, 0.2, -0.4, 0.2, 0, 0.5);
  const SE3d detected = camera.inverse() * object * pose(0.02, 0, 0, 0, 0.01, 0);
  const auto measured = [&](GainCovariance gain_covariance) {
    return measure_mode(camera, object, isotropic(1.0, 0.01), detected, sensor, gain_covariance);
  };
  const ModeMeasurement likelihood = measured(GainCovariance::likelihood);
  const ModeMeasurement update = measured(GainCovariance::update);
  const Matrix6d in_world = object.adjoint_congruence(covariance);
  EXPECT_TRUE(likelihood.information.isApprox(in_world.inverse(), 1e-9));
  EXPECT_TRUE(update.information.isApprox(0.25 * in_world.inverse(), 1e-9));
  const Vector6d residual = (camera * detected * object.inverse()).log();
  EXPECT_TRUE(likelihood.pull.isApprox(likelihood.information * residual, 1e-9));
  EXPECT_EQ(likelihood.inlier_probability, 1.0);
  EXPECT_EQ(likelihood.clutter_probability, 0.0);
}

}  // namespace
}  // namespace posemix
