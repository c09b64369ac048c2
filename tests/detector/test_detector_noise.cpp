// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/detector_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "detector/view_turn.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/detector/default_noise.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::thrown_message;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Matrix6d covariance(double scale = 1.0) {
  return scale * pose_covariance({0.02, 0.03, 0.01}, {0.004, 0.005, 0.02});
}

DetectorNoise with(const NoiseDependence& dependence) {
  return DetectorNoise({{.covariance = covariance()}}, {.weight = 0.1}, dependence);
}

TEST(DetectorNoise, TheSlowErrorDecaysWithViewAndTime) {
  const SlowError slow{covariance(), 10.0, radians(60.0)};
  EXPECT_DOUBLE_EQ(slow.correlation(0.0, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(slow.correlation(10.0, 0.0), std::exp(-1.0));
  EXPECT_DOUBLE_EQ(slow.correlation(5.0, radians(30.0)), std::exp(-1.0));
  EXPECT_DOUBLE_EQ(SlowError{}.correlation(1e9, 3.0), 1.0);
}

TEST(DetectorNoise, ACameraAtTheObjectSeesNoSideOfIt) {
  const SE3d seen(SO3d(), {0.1, -0.2, 1.0});
  for (const double at : {0.0, -0.0, 5e-324, 1e-170}) {
    const SE3d here(SO3d::exp({0.1, 0.2, 0.3}), {at, at, at});
    EXPECT_EQ(view_angle(here, seen), 0.0) << at;
    EXPECT_EQ(view_angle(seen, here), 0.0) << at;
    EXPECT_EQ(internal::view_turn(here, seen), Eigen::Vector3d::Zero()) << at;
    EXPECT_EQ(internal::view_turn(here, here), Eigen::Vector3d::Zero()) << at;
  }
  // Detectors do answer so.
  const SE3d near(SO3d(), {0.0, 0.0, 3e-12});
  EXPECT_NEAR(internal::view_turn(near, seen).norm(), view_angle(near, seen), 1e-15);
}

TEST(DetectorNoise, AsWhiteAddsWhatLasts) {
  const DetectorNoise noise(
      {{.weight = 0.7, .covariance = covariance()},
       {.weight = 0.2, .covariance = covariance(4.0), .run_length = 5.0}},
      {.weight = 0.1},
      {.slow = SlowError{.covariance = covariance(2.0)}, .common = covariance(0.5)});
  EXPECT_FALSE(noise.is_white());
  const DetectorNoise white = noise.as_white();
  EXPECT_TRUE(white.is_white());
  EXPECT_TRUE(white.components()[0].covariance.isApprox(covariance(3.5), 1e-14));
  EXPECT_TRUE(white.components()[1].covariance.isApprox(covariance(6.5), 1e-14));
  EXPECT_EQ(white.components()[1].run_length, 1.0);
  EXPECT_NEAR(white.clutter().weight, 0.1, 1e-15);
  EXPECT_TRUE(noise.single_gaussian().components()[0].covariance.isApprox(
      covariance((0.7 * 3.5 + 0.2 * 6.5) / 0.9), 1e-14));
}

// What is assumed slow is taken off the white part, so that their sum is what was given.
TEST(DetectorNoise, AnAssumedSlowErrorKeepsTheWholeNoise) {
  const DetectorNoise given({{.weight = 0.6, .covariance = covariance(4.0)},
                             {.weight = 0.4, .covariance = covariance()}});
  const DetectorNoise split = with_assumed_slow_error(given);
  ASSERT_TRUE(split.dependence().slow.has_value());
  EXPECT_EQ(split.dependence().slow->correlation_angle_rad, kAssumedCorrelationAngle);
  const DetectorNoise whole = split.as_white();
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(whole.components()[i].covariance.isApprox(given.components()[i].covariance, 1e-15));
    EXPECT_EQ(Eigen::LLT<Matrix6d>(split.components()[i].covariance).info(), Eigen::Success);
  }
  const DetectorNoise stated = default_detector_noise();
  EXPECT_EQ(with_assumed_slow_error(stated).dependence().slow->covariance,
            stated.dependence().slow->covariance);
}

TEST(DetectorNoise, TheScaleOfTheSlowErrorIsByAxis) {
  ObjectSensor sensor{with({.slow = SlowError{.covariance = covariance()}})};
  sensor.slow_scale[5] = 0.5;
  Matrix6d expected = covariance();
  expected(5, 5) *= 0.25;
  EXPECT_TRUE(sensor.slow_covariance()->isApprox(expected, 1e-15));
  EXPECT_FALSE(ObjectSensor{with({})}.slow_covariance().has_value());
}

TEST(DetectorNoise, RefusesWhatIsNoModel) {
  const auto refused = [](const NoiseDependence& dependence) {
    return thrown_message([&] { with(dependence); });
  };
  Matrix6d indefinite = covariance();
  indefinite(0, 0) = -1e-4;
  Matrix6d half = covariance();
  half(2, 2) = 0.0;
  EXPECT_NE(refused({.slow = SlowError{.covariance = indefinite}}), "");
  EXPECT_NE(refused({.slow = SlowError{.covariance = half}}), "");
  EXPECT_NE(refused({.slow = SlowError{.covariance = kNan * covariance()}}), "");
  EXPECT_EQ(refused({.slow = SlowError{covariance(), 0.0}}),
            "detector noise: correlation time of the slow error is 0, expected a positive number");
  EXPECT_EQ(
      refused({.slow = SlowError{covariance(), 1.0, kNan}}),
      "detector noise: correlation angle of the slow error is nan, expected a positive number");
  EXPECT_NE(refused({.common = indefinite}), "");
  EXPECT_NE(refused({.common = kInfinity * covariance()}), "");
  EXPECT_EQ(refused({.common = half}), "");  // what is exact in some direction
  EXPECT_EQ(refused({.mode_time_s = -1.0}),
            "detector noise: mode time is -1, expected a finite number >= 0");
  EXPECT_NE(refused({.mode_time_s = kNan}), "");
  const auto refused_component = [](NoiseComponent component) {
    return thrown_message([&] { DetectorNoise({component}); });
  };
  EXPECT_EQ(refused_component({.covariance = covariance(), .run_length = 0.5}),
            "detector noise: run length of component 0 is 0.5, expected a finite number >= 1");
  EXPECT_EQ(
      refused_component({.covariance = covariance(), .offset = SE3d(SO3d(), {kNan, 0.0, 0.0})}),
      "detector noise: offset of component 0 holds a value that is not finite");
}

}  // namespace
}  // namespace posemix
