// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/config/noise_toml.hpp"

#include <gtest/gtest.h>

#include "posemix/base/random.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/detector_noise.hpp"
#include "posemix/detector/default_noise.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::relative_difference;
using testing::thrown_message;

DetectorNoise read_back(const std::string& toml) {
  const TomlDocument document = TomlDocument::parse(toml, "noise.toml");
  DetectorNoise noise = read_detector_noise(document.root().get_table("noise").get_table("cup"));
  document.finish();
  return noise;
}

Matrix6d full_covariance(std::uint64_t seed) {
  RandomStream stream(seed);
  Matrix6d root;
  for (double& entry : root.reshaped()) entry = stream.normal();
  Matrix6d full = 1e-3 * (root * root.transpose() + Matrix6d::Identity());
  symmetrize(full);
  return full;
}

void expect_same(const NoiseDependence& a, const NoiseDependence& b) {
  ASSERT_EQ(a.slow.has_value(), b.slow.has_value());
  if (a.slow) {
    EXPECT_LT(relative_difference(b.slow->covariance, a.slow->covariance), 1e-14);
    EXPECT_EQ(a.slow->correlation_time_s, b.slow->correlation_time_s);
    EXPECT_DOUBLE_EQ(a.slow->correlation_angle_rad, b.slow->correlation_angle_rad);
  }
  ASSERT_EQ(a.common.has_value(), b.common.has_value());
  if (a.common) {
    EXPECT_LT(relative_difference(*b.common, *a.common), 1e-14);
  }
  EXPECT_EQ(a.mode_time_s, b.mode_time_s);
  EXPECT_EQ(a.is_typical, b.is_typical);
}

/// Oracle: the model itself, entry by entry.
void expect_same(const DetectorNoise& a, const DetectorNoise& b) {
  ASSERT_EQ(a.components().size(), b.components().size());
  for (std::size_t i = 0; i < a.components().size(); ++i) {
    const NoiseComponent& x = a.components()[i];
    const NoiseComponent& y = b.components()[i];
    EXPECT_NEAR(x.weight, y.weight, 1e-15);
    EXPECT_EQ(x.frame, y.frame);
    EXPECT_LT(relative_difference(y.covariance, x.covariance), 1e-14);
    EXPECT_TRUE(y.offset.is_approx(x.offset, 1e-14));
    EXPECT_EQ(x.run_length, y.run_length);
  }
  EXPECT_NEAR(a.clutter().weight, b.clutter().weight, 1e-15);
  if (a.clutter().weight > 0.0) {
    EXPECT_EQ(a.clutter().volume_m3, b.clutter().volume_m3);
  }
  expect_same(a.dependence(), b.dependence());
}

TEST(NoiseToml, ModelsReadBackAsTheyWere) {
  RandomStream stream(4);
  Eigen::VectorXd xi(6);
  stream.fill_normal(xi);
  const Matrix6d ray = pose_covariance({0.1, 0.2, 0.3}, {5e-3, 6e-3, 0.05});
  const Matrix6d common = pose_covariance({0.01, 0.0, 0.02}, {1e-3, 2.0 / 3.0 * 1e-3, 0.0});
  const std::vector<DetectorNoise> models{
      DetectorNoise(
          {{.weight = 0.7, .covariance = full_covariance(1), .offset = SE3d::exp(xi)},
           {.weight = 0.3, .covariance = pose_covariance({0.1, 0.2, 0.3}, {1e-3, 1.0, 0.3})}}),
      DetectorNoise({{.weight = 0.7,
                      .covariance = ray,
                      .frame = NoiseFrame::ray,
                      .run_length = 61.0 + 1.0 / 3.0}},
                    {.weight = 0.3, .volume_m3 = 2.5},
                    {.slow = SlowError{ray, 12.5, 1.0 / 3.0}, .common = common}),
      DetectorNoise({{.covariance = full_covariance(2), .frame = NoiseFrame::camera}}, {},
                    {.slow = SlowError{full_covariance(3)}, .mode_time_s = 1.0 / 7.0}),
      default_detector_noise()};
  for (const DetectorNoise& noise : models)
    expect_same(noise, read_back(format_noise_toml("cup", noise)));
}

TEST(NoiseToml, RefusesANameThatIsNoKey) {
  const DetectorNoise noise = default_detector_noise();
  EXPECT_EQ(thrown_message([&] { format_noise_toml("my cup", noise); }),
            "noise model: the name is 'my cup', expected letters, digits, '_' and '-'");
  EXPECT_NE(thrown_message([&] { format_noise_toml("", noise); }), "");
}

TEST(NoiseToml, OdometryIsWrittenAsAMotionModel) {
  OdometryNoise noise{.sd_per_sqrt_s = Vector6d::Zero(),
                      .jitter_sd = Vector6d::Constant(1e-3),
                      .sd_per_sqrt_s_error = Vector6d::Constant(1e-4),
                      .jitter_sd_error = Vector6d::Constant(1e-4),
                      .windows = {{.seconds = 0.1,
                                   .independent = 100.0,
                                   .variance = Vector6d::Zero(),
                                   .fitted = Vector6d::Zero()}},
                      .recordings = 2,
                      .scene_distance_m = 0.62,
                      .scene_distance_error_m = 0.05};
  noise.sd_per_sqrt_s << radians(0.2), radians(0.1), radians(0.3), 1e-3, 2e-3, 1.5e-3;
  const TomlDocument document = TomlDocument::parse(format_odometry_toml(noise), "odometry.toml");
  const TomlTable motion = document.root().get_table("motion");
  EXPECT_EQ(motion.get_string("model"), "odometry");
  const TomlTable table = motion.get_table("noise");
  EXPECT_EQ(table.get_string("per"), "second");
  const Eigen::VectorXd rotation = table.get_vector("rotation_sd_deg", 3);
  const Eigen::VectorXd translation = table.get_vector("translation_sd_m", 3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(rotation[i] / degrees(noise.sd_per_sqrt_s[i]), 1.0, 5e-3);
    EXPECT_NEAR(translation[i] / noise.sd_per_sqrt_s[3 + i], 1.0, 5e-3);
  }
  EXPECT_EQ(table.get_double("scene_distance_m"), 0.62);
  document.finish();
}

}  // namespace
}  // namespace posemix
