// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/slow_error_fit.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "detector/slow_error_likelihood.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/lie/pose_covariance.hpp"
#include "posemix/testing/expect.hpp"
#include "simulated_slow_errors.hpp"

namespace posemix {
namespace {

using testing::slow_recordings;
using testing::SlowSimulation;
using testing::thrown_message;

Vector6d deviations(double rotation_deg, double translation) {
  Vector6d sd;
  sd << Eigen::Vector3d::Constant(radians(rotation_deg)), Eigen::Vector3d::Constant(translation);
  return sd;
}

/// The component that EM would fit to all of the errors; its gate leaves out no inlier.
NoiseComponent inlier_of(const SlowSimulation& s) {
  const Vector6d variance =
      s.white_sd.cwiseAbs2() + s.slow_sd.cwiseAbs2() + s.common_sd.cwiseAbs2();
  return {.covariance = 4.0 * variance.asDiagonal().toDenseMatrix(),
          .frame = s.along_ray ? NoiseFrame::ray : NoiseFrame::object};
}

SlowErrorFit fit_of(const SlowSimulation& simulation, std::uint64_t seed) {
  return fit_slow_error(slow_recordings(simulation, seed), inlier_of(simulation));
}

/// Every estimate is within so many of its standard errors of the value.
void expect_within(const Vector6d& estimate, const Vector6d& error, const Vector6d& truth,
                   double errors = 3.0) {
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    EXPECT_GT(error[axis], 0.0) << axis;
    EXPECT_LT(std::abs(estimate[axis] - truth[axis]), errors * error[axis]) << axis;
  }
}

SlowSimulation by_angle() {
  return {.white_sd = deviations(2.0, 0.004),
          .slow_sd = deviations(4.0, 0.012),
          .angle_rad = radians(60.0)};
}

SlowSimulation by_time() {
  return {.white_sd = deviations(2.0, 0.004), .slow_sd = deviations(4.0, 0.012), .time_s = 10.0};
}

TEST(SlowErrorFit, FindsAnErrorThatDecaysWithTheView) {
  const SlowSimulation simulation = by_angle();
  const SlowErrorFit fit = fit_of(simulation, 1);
  ASSERT_TRUE(fit.slow.has_value());
  EXPECT_EQ(fit.models[fit.chosen].decay, SlowErrorDecay::angle);
  EXPECT_FALSE(fit.common.has_value());
  EXPECT_TRUE(fit.is_jackknife);
  EXPECT_EQ(fit.recordings, 12U);
  EXPECT_TRUE(std::isinf(fit.slow->correlation_time_s));
  EXPECT_NEAR(fit.slow->correlation_angle_rad, simulation.angle_rad,
              3.0 * fit.correlation_angle_error_rad);
  EXPECT_LT(fit.correlation_angle_error_rad, 0.5 * simulation.angle_rad);
  expect_within(fit.white_sd, fit.white_sd_error, simulation.white_sd);
  expect_within(fit.slow_sd, fit.slow_sd_error, simulation.slow_sd);
  EXPECT_LT((fit.white.diagonal().cwiseSqrt() - fit.white_sd).norm(), 1e-12);
  EXPECT_LT((fit.slow->covariance.diagonal().cwiseSqrt() - fit.slow_sd).norm(), 1e-12);
}

TEST(SlowErrorFit, FindsAnErrorThatDecaysWithTheViewAlongTheRay) {
  SlowSimulation simulation = by_angle();
  simulation.along_ray = true;
  simulation.slow_sd[2] = radians(2.0);
  simulation.slow_sd[5] = 0.05;
  simulation.white_sd[5] = 0.02;
  const SlowErrorFit fit = fit_of(simulation, 2);
  ASSERT_TRUE(fit.slow.has_value());
  EXPECT_EQ(fit.models[fit.chosen].decay, SlowErrorDecay::angle);
  EXPECT_NEAR(fit.slow->correlation_angle_rad, simulation.angle_rad,
              3.0 * fit.correlation_angle_error_rad);
  EXPECT_EQ(fit.slow_sd[0], fit.slow_sd[1]);
  EXPECT_EQ(fit.slow_sd[3], fit.slow_sd[4]);
  expect_within(fit.white_sd, fit.white_sd_error, simulation.white_sd);
  expect_within(fit.slow_sd, fit.slow_sd_error, simulation.slow_sd);
}

/// A camera that moves steadily makes time and view the same; one that rests now and then does not.
TEST(SlowErrorFit, FindsAnErrorThatDecaysWithTime) {
  SlowSimulation simulation = by_time();
  std::vector<NoiseTrack> tracks;
  RandomStream stream(3);
  for (std::size_t r = 0; r < simulation.recordings; ++r) {
    testing::SlowRecording recording = testing::slow_recording(simulation, stream);
    // The same errors at other views: in every second block of 20 frames the camera rests.
    std::size_t at = 0;
    for (std::size_t frame = 0; frame < recording.truth.size(); ++frame) {
      at += (frame / 20) % 2 == 0 ? 1 : 0;
      const SE3d truth = testing::circling_truth(at, 0.3);
      const SE3d before = *recording.truth[frame];
      if (recording.detected[frame])
        recording.detected[frame] = truth * (before.inverse() * *recording.detected[frame]);
      recording.truth[frame] = truth;
    }
    tracks.push_back(noise_track(recording.truth, recording.detected, r, recording.stamps_s));
  }
  const SlowErrorFit fit = fit_slow_error(tracks, inlier_of(simulation));
  ASSERT_TRUE(fit.slow.has_value());
  EXPECT_EQ(fit.models[fit.chosen].decay, SlowErrorDecay::time);
  EXPECT_TRUE(std::isinf(fit.slow->correlation_angle_rad));
  EXPECT_NEAR(fit.slow->correlation_time_s, 10.0, 3.0 * fit.correlation_time_error_s);
  EXPECT_LT(fit.correlation_time_error_s, 5.0);
  expect_within(fit.white_sd, fit.white_sd_error, simulation.white_sd);
  expect_within(fit.slow_sd, fit.slow_sd_error, simulation.slow_sd);
}

TEST(SlowErrorFit, PrefersWhiteErrorsWhereTheyAreWhite) {
  SlowSimulation simulation{.white_sd = deviations(2.0, 0.004)};
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 6U}) {
    simulation.recordings = seed == 6 ? 1 : 6;
    const SlowErrorFit fit = fit_of(simulation, seed);
    EXPECT_FALSE(fit.slow.has_value()) << seed;
    EXPECT_FALSE(fit.common.has_value()) << seed;
    EXPECT_EQ(fit.is_jackknife, seed != 6);
    EXPECT_TRUE(std::isnan(fit.correlation_angle_error_rad));
    expect_within(fit.white_sd, fit.white_sd_error, simulation.white_sd, 3.5);
  }
}

TEST(SlowErrorFit, SeparatesTheErrorInCommon) {
  SlowSimulation simulation = by_angle();
  simulation.angle_rad = radians(20.0);
  simulation.common_sd = deviations(5.0, 0.02);
  simulation.common_sd[1] = 0.0;
  simulation.recordings = 20;
  const SlowErrorFit fit = fit_of(simulation, 4);
  ASSERT_TRUE(fit.common.has_value());
  ASSERT_TRUE(fit.slow.has_value());
  EXPECT_TRUE(fit.models[fit.chosen].common);
  EXPECT_NEAR(fit.slow->correlation_angle_rad, simulation.angle_rad,
              3.0 * fit.correlation_angle_error_rad);
  expect_within(fit.slow_sd, fit.slow_sd_error, simulation.slow_sd);
  for (const Eigen::Index axis : {0, 2, 3, 4, 5}) {
    EXPECT_NEAR(fit.common_sd[axis], simulation.common_sd[axis], 3.0 * fit.common_sd_error[axis]);
    EXPECT_NEAR((*fit.common)(axis, axis), std::pow(fit.common_sd[axis], 2), 1e-12);
  }
  EXPECT_LT(fit.common_sd[1], radians(2.0));
}

/// Over repetitions, the distance from the truth by the standard error has a mean square of about
/// one: of 6 white, 6 slow and one angle for each.
TEST(SlowErrorFit, StandardErrorsAgreeWithTheScatter) {
  SlowSimulation simulation = by_angle();
  simulation.frames = 80;
  constexpr int kRepetitions = 16;
  double white = 0.0;
  double slow = 0.0;
  double angle = 0.0;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    const SlowErrorFit fit = fit_of(simulation, 100 + static_cast<std::uint64_t>(repetition));
    ASSERT_TRUE(fit.slow.has_value());
    white += (fit.white_sd - simulation.white_sd).cwiseQuotient(fit.white_sd_error).squaredNorm();
    slow += (fit.slow_sd - simulation.slow_sd).cwiseQuotient(fit.slow_sd_error).squaredNorm();
    angle += std::pow(
        (fit.slow->correlation_angle_rad - simulation.angle_rad) / fit.correlation_angle_error_rad,
        2);
  }
  EXPECT_NEAR(white / (6.0 * kRepetitions), 1.0, 0.5);
  EXPECT_NEAR(slow / (6.0 * kRepetitions), 1.0, 0.5);
  EXPECT_NEAR(angle / kRepetitions, 1.0, 1.0);
}

/// The component that EM would fit, with the shape of the errors that were drawn; its gate leaves
/// out no inlier.
NoiseComponent drawn_inlier(const std::vector<NoiseTrack>& tracks) {
  Vector6d squares = Vector6d::Zero();
  double count = 0.0;
  for (const NoiseTrack& track : tracks) {
    for (const auto& seen : track) {
      if (!seen) continue;
      squares += detection_residual(seen->truth, seen->detected, NoiseFrame::object).cwiseAbs2();
      count += 1.0;
    }
  }
  return {.covariance = (4.0 / count * squares).asDiagonal().toDenseMatrix()};
}

/// A slow error that never changes is one draw per recording and axis: the deviations of few draws
/// have the shape of chance, which that of the white errors does not follow.
class ConstantSlowError : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ConstantSlowError, LeavesTheWhiteErrorAsItIs) {
  SlowSimulation simulation{.white_sd = deviations(1.0, 0.003), .slow_sd = deviations(4.0, 0.012)};
  simulation.recordings = GetParam();
  for (std::uint64_t seed = 201; seed <= 204; ++seed) {
    const std::vector<NoiseTrack> tracks = slow_recordings(simulation, seed);
    const SlowErrorFit fit = fit_slow_error(tracks, drawn_inlier(tracks));
    expect_within(fit.white_sd, fit.white_sd_error, simulation.white_sd, 4.0);
    // In the object's frame an error that never changes may be called slow or in common.
    const bool is_slow = fit.slow.has_value();
    ASSERT_TRUE(is_slow || fit.common.has_value());
    const Vector6d& sd = is_slow ? fit.slow_sd : fit.common_sd;
    const Vector6d& error = is_slow ? fit.slow_sd_error : fit.common_sd_error;
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      // The logs are what is estimated: their distribution is more symmetric.
      EXPECT_LT(std::abs(std::log(sd[axis] / simulation.slow_sd[axis])),
                4.0 * error[axis] / sd[axis])
          << seed << " " << axis;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, ConstantSlowError, ::testing::Values(1U, 3U, 4U, 8U));

/// Without stamps there is the angle alone.
TEST(SlowErrorFit, TakesTheAngleAloneWithoutStamps) {
  std::vector<NoiseTrack> tracks = slow_recordings(by_angle(), 5);
  for (NoiseTrack& track : tracks) {
    for (auto& seen : track) {
      if (seen) seen->stamp_s = std::numeric_limits<double>::quiet_NaN();
    }
  }
  const SlowErrorFit fit = fit_slow_error(tracks, inlier_of(by_angle()));
  ASSERT_TRUE(fit.slow.has_value());
  EXPECT_EQ(fit.models.size(), 4U);
  EXPECT_TRUE(std::isnan(seconds_per_frame(tracks)));
}

TEST(SlowErrorFit, TakesWhatItIsGiven) {
  const SlowSimulation simulation = by_angle();
  std::vector<NoiseTrack> tracks = slow_recordings(simulation, 6);
  const SlowErrorFit one = fit_slow_error(std::span(tracks).first(1), inlier_of(simulation));
  EXPECT_FALSE(one.is_jackknife);
  EXPECT_FALSE(one.common.has_value());
  tracks[0].resize(3);
  const SlowErrorFit few = fit_slow_error(std::span(tracks).first(1), inlier_of(simulation));
  EXPECT_FALSE(few.slow.has_value());
  EXPECT_TRUE(few.models.empty());
  EXPECT_EQ(few.white, inlier_of(simulation).covariance);
  EXPECT_TRUE(fit_slow_error({}, inlier_of(simulation)).models.empty());
  for (auto& seen : tracks[1]) {
    if (seen) seen->stamp_s = -seen->stamp_s;
  }
  EXPECT_NE(thrown_message([&] {
              fit_slow_error(tracks, inlier_of(simulation));
            }).find("expected an order in which neither decreases"),
            std::string::npos);
}

/// Oracle: the density of the whole track as one Gaussian.
TEST(SlowErrorLikelihood, IsThatOfTheJointGaussian) {
  SlowSimulation simulation = by_angle();
  simulation.along_ray = true;
  simulation.common_sd = deviations(3.0, 0.01);
  simulation.frames = 12;
  simulation.recordings = 1;
  const auto tracks = internal::slow_tracks(slow_recordings(simulation, 7), inlier_of(simulation));
  ASSERT_EQ(tracks.size(), 1U);
  const auto& rows = tracks[0].rows;
  ASSERT_GT(rows.size(), 5U);
  internal::SlowVariances v{.white = deviations(2.0, 0.003).cwiseAbs2(),
                            .slow = deviations(3.0, 0.01).cwiseAbs2(),
                            .angle_rad = 0.5,
                            .time_s = 3.0,
                            .common = deviations(1.0, 0.02).cwiseAbs2(),
                            .has_common = true};
  v.slow[2] = 0.01;
  v.common[4] = 0.0;
  const auto size = static_cast<Eigen::Index>(6 * rows.size());
  Eigen::MatrixXd covariance(size, size);
  Eigen::VectorXd residual(size);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    residual.segment<6>(row) = rows[i].residual;
    double passed = 0.0;
    for (std::size_t j = i; j < rows.size(); ++j) {
      if (j > i) passed += rows[j].angle_rad / v.angle_rad + rows[j].time_s / v.time_s;
      const auto column = static_cast<Eigen::Index>(6 * j);
      Matrix6d block =
          rows[i].from_object * v.common.asDiagonal() * rows[j].from_object.transpose();
      block += (std::exp(-passed) * v.slow).asDiagonal();
      if (i == j) block += v.white.asDiagonal();
      covariance.block<6, 6>(row, column) = block;
      covariance.block<6, 6>(column, row) = block.transpose();
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  EXPECT_NEAR(internal::log_likelihood(tracks[0], v), log_normal(factor, residual), 1e-8);
}

}  // namespace
}  // namespace posemix
