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

/// The detector's slow error of the second test: as large as the white one, for half a second.
SlowError slow_error() { return {.covariance = kR, .correlation_time_s = 0.5}; }

/// All frames at once: Gauss-Newton on camera and object poses and slow errors of every frame with
/// a dense information matrix, derived from the model alone. Like the smoother, it is of first
/// order in the errors, which are small here.
class Batch {
 public:
  Batch(const Sequence& sequence, bool has_slow)
      : sequence_(sequence),
        poses_per_frame_(1 + sequence.objects.size()),
        blocks_per_frame_(poses_per_frame_ + (has_slow ? sequence.objects.size() : 0)),
        slow_(kFrames * sequence.objects.size(), Vector6d::Zero()) {
    for (std::size_t k = 0; k < kFrames; ++k) {
      poses_.push_back(*sequence.camera_truth[k]);
      for (std::size_t j = 0; j < sequence.objects.size(); ++j) poses_.push_back(kObjects[j]);
    }
    for (int iteration = 0; iteration < 8; ++iteration) iterate();
  }

  const SE3d& at(std::size_t frame, std::size_t pose) const {
    return poses_[frame * poses_per_frame_ + pose];
  }
  /// The covariance of xi_b - xi_a at one frame; of xi_a alone if both are the same.
  Matrix6d covariance(std::size_t frame, std::size_t a, std::size_t b) const {
    MatrixXd h = MatrixXd::Zero(6, covariance_.rows());
    h.middleCols<6>(row(frame, b)) = Matrix6d::Identity();
    if (a != b) h.middleCols<6>(row(frame, a)) = -Matrix6d::Identity();
    return h * covariance_ * h.transpose();
  }

 private:
  struct Term {
    Eigen::Index row;
    Matrix6d jacobian;
  };

  bool has_slow() const { return blocks_per_frame_ > poses_per_frame_; }
  Eigen::Index row(std::size_t frame, std::size_t block) const {
    return 6 * static_cast<Eigen::Index>(frame * blocks_per_frame_ + block);
  }
  Eigen::Index slow_row(std::size_t frame, std::size_t object) const {
    return row(frame, poses_per_frame_ + object);
  }
  Vector6d& slow(std::size_t frame, std::size_t object) {
    return slow_[frame * sequence_.objects.size() + object];
  }

  /// A factor N(z; sum of jacobian x, covariance).
  void add(const std::vector<Term>& terms, const Vector6d& z, const Matrix6d& covariance) {
    const Matrix6d w = covariance.inverse();
    for (const Term& a : terms) {
      pull_.segment<6>(a.row) += a.jacobian.transpose() * w * z;
      for (const Term& b : terms)
        information_.block<6, 6>(a.row, b.row) += a.jacobian.transpose() * w * b.jacobian;
    }
  }

  void iterate() {
    const Eigen::Index n = row(kFrames, 0);
    const Matrix6d one = Matrix6d::Identity();
    information_ = MatrixXd::Zero(n, n);
    pull_ = VectorXd::Zero(n);
    add({{row(0, 0), one}}, (kStart * at(0, 0).inverse()).log(), kStartCovariance);
    for (std::size_t k = 0; k < kFrames; ++k) {
      if (k > 0) add_motion(k);
      for (std::size_t j = 0; j < sequence_.objects.size(); ++j) {
        if (has_slow()) add_slow(k, j);
        add_detection(k, j);
      }
    }
    covariance_ = information_.inverse();
    const VectorXd step = covariance_ * pull_;
    for (std::size_t k = 0; k < kFrames; ++k) {
      for (std::size_t i = 0; i < poses_per_frame_; ++i) {
        SE3d& pose = poses_[k * poses_per_frame_ + i];
        pose = SE3d::exp(step.segment<6>(row(k, i))) * pose;
      }
      for (std::size_t j = 0; has_slow() && j < sequence_.objects.size(); ++j)
        slow(k, j) += step.segment<6>(slow_row(k, j));
    }
  }

  void add_detection(std::size_t k, std::size_t j) {
    const auto& seen = sequence_.objects[j].detections[k];
    if (!seen) return;
    const Matrix6d one = Matrix6d::Identity();
    const SE3d& object = at(k, j + 1);
    std::vector<Term> terms{{row(k, 0), -one}, {row(k, j + 1), one}};
    if (has_slow()) terms.push_back({slow_row(k, j), object.adjoint()});
    const Vector6d z = (at(k, 0) * *seen * object.inverse()).log() - object.adjoint() * slow(k, j);
    add(terms, z, object.adjoint_congruence(kR));
  }

  void add_slow(std::size_t k, std::size_t j) {
    const Matrix6d one = Matrix6d::Identity();
    if (k == 0) return add({{slow_row(0, j), one}}, -slow(0, j), slow_error().covariance);
    const double dt = sequence_.stamps[k] - sequence_.stamps[k - 1];
    const double a = std::exp(-dt / slow_error().correlation_time_s);
    add({{slow_row(k - 1, j), -a * one}, {slow_row(k, j), one}}, a * slow(k - 1, j) - slow(k, j),
        (1.0 - a * a) * slow_error().covariance);
  }

  void add_motion(std::size_t k) {
    const auto& before = sequence_.odometry[k - 1];
    const auto& now = sequence_.odometry[k];
    const Matrix6d one = Matrix6d::Identity();
    const bool known = before && now;
    const SE3d moved = at(k - 1, 0) * (known ? before->inverse() * *now : SE3d());
    add({{row(k - 1, 0), -one}, {row(k, 0), one}}, (moved * at(k, 0).inverse()).log(),
        moved.adjoint_congruence(known ? kQ : isotropic(5.0, 0.1)));
    for (std::size_t i = 1; i < poses_per_frame_; ++i) {
      add({{row(k - 1, i), -one}, {row(k, i), one}}, (at(k - 1, i) * at(k, i).inverse()).log(),
          1e-14 * one);  // objects stand still
    }
  }

  const Sequence& sequence_;
  std::size_t poses_per_frame_;
  std::size_t blocks_per_frame_;
  std::vector<SE3d> poses_;
  std::vector<Vector6d> slow_;
  MatrixXd information_;
  VectorXd pull_;
  MatrixXd covariance_;
};

double difference(const Matrix6d& a, const Matrix6d& expected) {
  const Matrix6d l = expected.llt().matrixL();
  const Matrix6d white = l.inverse() * a * l.inverse().transpose() - Matrix6d::Identity();
  return white.cwiseAbs().maxCoeff();
}

class SmoothingAgainstBatch : public ::testing::TestWithParam<bool> {};

TEST_P(SmoothingAgainstBatch, Agrees) {
  const Sequence sequence = drawn_sequence(1, 2);
  NoiseDependence dependence;
  if (GetParam()) dependence.slow = slow_error();
  const DetectorNoise noise({{1.0, kR}}, {}, dependence);
  const SlamRun smoothed =
      run_smoothed(sequence, PoseDensity(kStart, kStartCovariance), models_with(noise, 2),
                   plain_slam_settings(), {.passes = 5});
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

INSTANTIATE_TEST_SUITE_P(SlowError, SmoothingAgainstBatch, ::testing::Bool());

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
