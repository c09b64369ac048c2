// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/smoothing.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>

#include "posemix/slam/evaluation.hpp"
#include "simulation_samples.hpp"
#include "smoothing_scene.hpp"

namespace posemix {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::distance;
using testing::drawn_sequence;
using testing::isotropic;
using testing::kFrames;
using testing::kObjects;
using testing::kQ;
using testing::kR;
using testing::kStart;
using testing::kStartCovariance;
using testing::models_with;
using testing::plain_slam_settings;
using testing::pose;

/// All frames at once: Gauss-Newton on camera and object poses of every frame with a dense
/// information matrix, derived from the model alone. Like the smoother, it is of first order in the
/// errors, which are small here.
class Batch {
 public:
  Batch(const Sequence& sequence, double odometry_camera_fraction)
      : sequence_(sequence),
        share_(odometry_camera_fraction),
        per_frame_(1 + sequence.objects.size()) {
    for (std::size_t k = 0; k < kFrames; ++k) {
      poses_.push_back(*sequence.camera_truth[k]);
      for (std::size_t j = 0; j + 1 < per_frame_; ++j) poses_.push_back(kObjects[j]);
    }
    for (int iteration = 0; iteration < 8; ++iteration) iterate();
  }

  const SE3d& at(std::size_t frame, std::size_t pose) const {
    return poses_[frame * per_frame_ + pose];
  }
  /// The covariance of xi_b - xi_a at one frame; of xi_a alone if both are the same.
  Matrix6d covariance(std::size_t frame, std::size_t a, std::size_t b) const {
    MatrixXd h = MatrixXd::Zero(6, covariance_.rows());
    h.middleCols<6>(row(frame, b)) = Matrix6d::Identity();
    if (a != b) h.middleCols<6>(row(frame, a)) = -Matrix6d::Identity();
    return h * covariance_ * h.transpose();
  }

 private:
  Eigen::Index row(std::size_t frame, std::size_t pose) const {
    return 6 * static_cast<Eigen::Index>(frame * per_frame_ + pose);
  }

  /// A factor N(z; xi_to - xi_from, covariance), or N(z; xi_to, covariance).
  void add(std::optional<Eigen::Index> from, Eigen::Index to, const Vector6d& z,
           const Matrix6d& covariance) {
    const Matrix6d w = covariance.inverse();
    information_.block<6, 6>(to, to) += w;
    pull_.segment<6>(to) += w * z;
    if (!from) return;
    information_.block<6, 6>(*from, *from) += w;
    information_.block<6, 6>(*from, to) -= w;
    information_.block<6, 6>(to, *from) -= w;
    pull_.segment<6>(*from) -= w * z;
  }

  void iterate() {
    const Eigen::Index n = row(kFrames, 0);
    information_ = MatrixXd::Zero(n, n);
    pull_ = VectorXd::Zero(n);
    add(std::nullopt, row(0, 0), (kStart * at(0, 0).inverse()).log(), kStartCovariance);
    for (std::size_t k = 1; k < kFrames; ++k) add_motion(k);
    for (std::size_t k = 0; k < kFrames; ++k) {
      for (std::size_t j = 0; j + 1 < per_frame_; ++j) {
        const auto& seen = sequence_.objects[j].detections[k];
        if (!seen) continue;
        const SE3d& object = at(k, j + 1);
        add(row(k, 0), row(k, j + 1), (at(k, 0) * *seen * object.inverse()).log(),
            object.adjoint_congruence(kR));
      }
    }
    covariance_ = information_.inverse();
    const VectorXd step = covariance_ * pull_;
    for (std::size_t i = 0; i < poses_.size(); ++i)
      poses_[i] = SE3d::exp(step.segment<6>(6 * static_cast<Eigen::Index>(i))) * poses_[i];
  }

  void add_motion(std::size_t k) {
    const auto& before = sequence_.odometry[k - 1];
    const auto& now = sequence_.odometry[k];
    const bool known = before && now;
    const SE3d moved = at(k - 1, 0) * (known ? before->inverse() * *now : SE3d());
    const Matrix6d q = known ? Matrix6d(share_ * kQ) : isotropic(5.0, 0.1);
    add(row(k - 1, 0), row(k, 0), (moved * at(k, 0).inverse()).log(), moved.adjoint_congruence(q));
    for (std::size_t pose = 1; pose < per_frame_; ++pose) {
      // Without a drift, a negligible one.
      const Matrix6d drift = (known ? 1.0 - share_ : 0.0) * kQ + 1e-14 * Matrix6d::Identity();
      add(row(k - 1, pose), row(k, pose), (at(k - 1, pose) * at(k, pose).inverse()).log(),
          at(k, pose).adjoint_congruence(drift));
    }
  }

  const Sequence& sequence_;
  double share_;
  std::size_t per_frame_;
  std::vector<SE3d> poses_;
  MatrixXd information_;
  VectorXd pull_;
  MatrixXd covariance_;
};

/// Largest relative difference, measured in units of the expected covariance.
double difference(const Matrix6d& a, const Matrix6d& expected) {
  const Matrix6d l = expected.llt().matrixL();
  const Matrix6d white = l.inverse() * a * l.inverse().transpose() - Matrix6d::Identity();
  return white.cwiseAbs().maxCoeff();
}

class SmoothingAgainstBatch : public ::testing::TestWithParam<double> {};

TEST_P(SmoothingAgainstBatch, Agrees) {
  const Sequence sequence = drawn_sequence(1, 2);
  const ObjectSlamSettings settings = plain_slam_settings(GetParam());
  const SlamRun smoothed =
      run_smoothed(sequence, PoseDensity(kStart, kStartCovariance),
                   models_with(DetectorNoise({{1.0, kR}}), 2), settings, {.passes = 5});
  const Batch batch(sequence, GetParam());
  ASSERT_EQ(smoothed.frames.size(), kFrames);
  for (std::size_t k = 0; k < kFrames; ++k) {
    const FrameEstimate& frame = smoothed.frames[k];
    // Standard deviations are above 1e-3; where means and Jacobians are taken differs in second
    // order, 1e-2 of the error squared over the error.
    EXPECT_LT(distance(frame.camera.mean(), batch.at(k, 0)), 2e-5) << k;
    EXPECT_LT(difference(frame.camera.covariance(), batch.covariance(k, 0, 0)), 0.01) << k;
    for (std::size_t j = 0; j < 2; ++j) {
      ASSERT_EQ(frame.relative[j].has_value(), j == 0 || k >= 4);
      if (!frame.relative[j]) continue;
      EXPECT_LT(distance(frame.objects[j]->mean(), batch.at(k, j + 1)), 2e-5) << k;
      const Matrix6d relative =
          frame.camera.mean().adjoint_congruence(frame.relative[j]->covariance());
      EXPECT_LT(difference(relative, batch.covariance(k, 0, j + 1)), 0.01) << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(CameraShare, SmoothingAgainstBatch, ::testing::Values(1.0, 0.2));

TEST(Smoothing, IsConsistentAndBetterThanTheFilter) {
  // One frame per run, for the errors of frames depend on each other.
  constexpr int kRuns = 150;
  constexpr std::size_t kAt = 10;
  const auto models = models_with(DetectorNoise({{1.0, kR}}), 2);
  const PoseDensity prior(kStart, kStartCovariance);
  double camera = 0.0;
  double relative = 0.0;
  double causal = 0.0;
  double smooth = 0.0;
  for (int run_index = 0; run_index < kRuns; ++run_index) {
    const Sequence sequence = drawn_sequence(static_cast<std::uint64_t>(run_index), 2);
    const auto smoothed = run_smoothed(sequence, prior, models, plain_slam_settings(), {});
    const auto filtered = run(sequence, prior, models, plain_slam_settings());
    camera += squared_normalized_error(smoothed.frames[kAt].camera, *sequence.camera_truth[kAt]);
    const SE3d truth = *true_relative_pose(sequence, 1, kAt);
    relative += squared_normalized_error(*smoothed.frames[kAt].relative[1], truth);
    smooth += std::pow(distance(smoothed.frames[kAt].relative[1]->mean(), truth), 2);
    causal += std::pow(distance(filtered.frames[kAt].relative[1]->mean(), truth), 2);
  }
  const boost::math::chi_squared expected(6.0 * kRuns);
  for (const double sum : {camera, relative}) {
    EXPECT_GT(sum, boost::math::quantile(expected, 0.001));
    EXPECT_LT(sum, boost::math::quantile(expected, 0.999));
  }
  // With 20 further frames of which 13 show the object, the variance more than halves.
  EXPECT_LT(smooth, 0.5 * causal);
}

}  // namespace
}  // namespace posemix
