// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_statistics.hpp"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "posemix/base/random.hpp"

namespace posemix {
namespace {

TEST(NoiseStatistics, AutocorrelationOfAFirstOrderProcess) {
  constexpr double kA = 0.8;
  RandomStream stream(6);
  std::vector<ResidualTrack> tracks;
  for (int recording = 0; recording < 20; ++recording) {
    double x = stream.normal() / std::sqrt(1.0 - kA * kA);
    ResidualTrack& track = tracks.emplace_back();
    for (int i = 0; i < 2000; ++i) {
      track.push_back(stream.uniform() < 0.2 ? std::nullopt : std::optional(x));
      x = kA * x + stream.normal();
    }
  }
  const Autocorrelation result = autocorrelation(tracks);
  EXPECT_NEAR(result.lag1, kA, 0.015);
  EXPECT_NEAR(result.at_lag[4], std::pow(kA, 4), 0.04);
  EXPECT_NEAR(result.correlation_frames, (1.0 + kA) / (1.0 - kA), 1.2);
}

TEST(NoiseStatistics, OfFewNumbersByHand) {
  const std::vector<ResidualTrack> tracks{{1.0, std::nullopt, 2.0}, {2.0, 7.0}};
  const AxisStatistics s = axis_statistics(tracks);
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.mean, 3.0);
  EXPECT_DOUBLE_EQ(s.sd, std::sqrt(5.5));
  EXPECT_DOUBLE_EQ(s.median, 2.0);
  EXPECT_DOUBLE_EQ(s.robust_sd, 1.482602218505602 * 0.5);
  EXPECT_NEAR(s.skewness, 13.5 / std::pow(5.5, 1.5), 1e-12);
  EXPECT_NEAR(s.kurtosis, 68.5 / (5.5 * 5.5), 1e-12);
  EXPECT_NEAR(autocorrelation(tracks).lag1, -6.25 / 3.25, 1e-12);
  EXPECT_NEAR(spread_of_means(tracks), 3.0 / std::sqrt(2.0), 1e-12);
  EXPECT_TRUE(std::isnan(axis_statistics({}).mean));
}

}  // namespace
}  // namespace posemix
