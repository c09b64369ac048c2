// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_correlation.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "simulated_detections.hpp"

namespace posemix {
namespace {

using testing::normal_vector;
using testing::pose_before_camera;
using testing::ray_deviations;

TEST(DependentFrames, OfFewNumbersByHand) {
  // (1 + 1)^2 + (1 - 1)^2 over 4 squares, and (2 + 2 + 2)^2 over 12.
  EXPECT_DOUBLE_EQ(
      dependent_frames(std::vector<ResidualTrack>{{1.0, 1.0}, {1.0, std::nullopt, -1.0}})
          .about_zero,
      1.0);
  EXPECT_DOUBLE_EQ(dependent_frames(std::vector<ResidualTrack>{{2.0, 2.0, 2.0}}).about_zero, 3.0);
  EXPECT_TRUE(std::isnan(dependent_frames({}).about_zero));
}

TEST(BiasSd, OfRecordingsWithoutScatterIsTheRootMeanSquareOfTheirMeans) {
  const std::vector<ResidualTrack> tracks{ResidualTrack(20, 3.0), ResidualTrack(10, -1.0),
                                          ResidualTrack(9, 50.0)};
  EXPECT_DOUBLE_EQ(bias_sd(tracks, 1.0), std::sqrt(5.0));
  EXPECT_TRUE(std::isnan(bias_sd({}, 1.0)));
}

/// Whitened residuals w = b + x with x a first-order process of unit variance, x' = a x + ..., and
/// b a bias per recording of variance 1/4, in every coordinate.
TEST(NoiseCorrelation, OfAFirstOrderProcessWithBiases) {
  constexpr double kA = 0.8;
  constexpr int kFrames = 1000;
  constexpr int kRecordings = 60;
  RandomStream stream(3);
  std::vector<NoiseTrack> tracks;
  for (int recording = 0; recording < kRecordings; ++recording) {
    const Vector6d bias = 0.5 * normal_vector(stream);
    Vector6d x = normal_vector(stream);
    NoiseTrack& track = tracks.emplace_back();
    for (int i = 0; i < kFrames; ++i) {
      x = kA * x + std::sqrt(1.0 - kA * kA) * normal_vector(stream);
      track.emplace_back();
      if (stream.uniform() < 0.1) continue;
      const SE3d truth = pose_before_camera(stream);
      const Vector6d n = (bias + x).cwiseProduct(ray_deviations());
      const Eigen::Vector3d t = truth.translation();
      const SO3d turn =
          SO3d::from_quaternion(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), t));
      const SO3d to_object = truth.rotation().inverse() * turn;
      Vector6d of_object;
      of_object << to_object * Eigen::Vector3d(n.head<3>()),
          to_object * Eigen::Vector3d(t.norm() * n.tail<3>());
      track.back() = NoiseObservation{truth, truth * SE3d::exp(of_object)};
    }
  }
  const NoiseComponent inlier{.covariance = ray_deviations().cwiseAbs2().asDiagonal(),
                              .frame = NoiseFrame::ray};
  const NoiseCorrelation found = noise_correlation(tracks, inlier);
  // (1 + a) / (1 - a) = 9 frames for the process, thinned by the missing tenth; for whole
  // recordings (9 + n / 4) / (1 + 1 / 4) with n = 900 detections, with a standard error of sqrt(2 /
  // 360).
  EXPECT_NEAR(found.inlier.within, 9.0, 1.5);
  EXPECT_NEAR(found.inlier.about_zero / ((9.0 + 225.0) / 1.25), 1.0, 0.2);
  for (Eigen::Index i = 0; i < 6; ++i) {
    // Standard error of a deviation from 60 values: 1 / sqrt(120).
    EXPECT_NEAR(found.bias_sd[i] / (0.5 * ray_deviations()[i]), 1.0, 0.28) << i;
  }
  EXPECT_LT(found.outlier_share, 5e-3);
}

/// Outliers come ten at a time, in one recording more often than in the other.
TEST(NoiseCorrelation, RunsOfOutliers) {
  const SE3d truth(SO3d(), {0.0, 0.0, 1.0});
  const SE3d far(SO3d::exp({0.0, 2.0, 0.0}), {0.0, 0.0, 1.0});
  std::vector<NoiseTrack> tracks(2);
  for (std::size_t i = 0; i < 400; ++i) {
    tracks[0].push_back(NoiseObservation{truth, i % 40 < 10 ? far : truth});
    tracks[1].push_back(NoiseObservation{truth, i % 20 < 10 ? far : truth});
    tracks[0].emplace_back();  // a miss breaks no run
  }
  const NoiseCorrelation found =
      noise_correlation(tracks, {.covariance = Matrix6d(0.01 * Matrix6d::Identity())});
  EXPECT_EQ(found.inliers, 500U);
  EXPECT_DOUBLE_EQ(found.outlier_share, 3.0 / 8.0);
  EXPECT_DOUBLE_EQ(found.outlier_run, 10.0);
  // 2 (400 / 8)^2 over 800 p (1 - p).
  EXPECT_NEAR(found.outlier.about_zero, 5000.0 / (800.0 * 15.0 / 64.0), 1e-9);
}

}  // namespace
}  // namespace posemix
