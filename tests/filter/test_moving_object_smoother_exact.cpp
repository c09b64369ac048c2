// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The smoother of one moving object against all sequences of motion models, each of which is a
// linear Gaussian problem that is solved at once: the object does not turn, so that its position
// and velocity are linear, and every axis is one for itself.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "moving_object_scene.hpp"
#include "posemix/filter/moving_object_smoother.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix {
namespace {

using testing::kFramePeriod_s;
constexpr double kDeviation = 0.003;  ///< of a detection [m]
constexpr double kAcceleration = 0.3;
constexpr double kStartSpeedSd = 0.1;  ///< of the velocity of an object that begins to move [m/s]

Vector6d along(double rotation, double translation) { return testing::sds(rotation, translation); }

DetectorNoise noise() {
  return DetectorNoise({{.weight = 1.0 - 1e-9,
                         .covariance = Matrix6d(along(1e-5, kDeviation).cwiseAbs2().asDiagonal())}},
                       {.weight = 1e-9, .volume_m3 = 1.0});
}

ConstantVelocityMotion moving() {
  return {.acceleration_sds = along(1e-7, kAcceleration),
          .frame = MotionFrame::world,
          .start_sds = along(1e-7, kStartSpeedSd),
          .break_rate = 0.0};
}

/// The covariance of the positions p_1 to p_n less p_1 in a sequence of models, in which `moves`
/// says whether the object moves up to a step.
Eigen::MatrixXd motion_covariance(const std::vector<bool>& moves) {
  const auto n = static_cast<Eigen::Index>(moves.size());
  // Rows: positions by step, then the velocity.
  Eigen::MatrixXd p = Eigen::MatrixXd::Zero(n + 1, n + 1);
  if (moves[0]) p(n, n) = kStartSpeedSd * kStartSpeedSd;
  const double q = kAcceleration * kAcceleration;
  for (Eigen::Index k = 1; k < n; ++k) {
    const auto now = static_cast<std::size_t>(k);
    if (moves[now - 1] != moves[now]) {
      p.row(n).setZero();
      p.col(n).setZero();
      if (moves[now]) p(n, n) = kStartSpeedSd * kStartSpeedSd;
    }
    Eigen::MatrixXd f = Eigen::MatrixXd::Identity(n + 1, n + 1);
    f(k, k) = 0.0;
    f(k, k - 1) = 1.0;
    f(k, n) = kFramePeriod_s;
    p = (f * p * f.transpose()).eval();
    if (!moves[now]) continue;
    p(k, k) += q * std::pow(kFramePeriod_s, 3) / 3.0;
    p(k, n) += q * kFramePeriod_s * kFramePeriod_s / 2.0;
    p(n, k) += q * kFramePeriod_s * kFramePeriod_s / 2.0;
    p(n, n) += q * kFramePeriod_s;
  }
  return p.topLeftCorner(n, n);
}

struct Exact {
  Eigen::MatrixXd mean;      ///< steps x 3
  Eigen::MatrixXd variance;  ///< steps x 3
  Eigen::VectorXd moves;     ///< probability, by step
};

/// Given detections of the position, steps x 3.
Exact exact(const Eigen::MatrixXd& seen, double start, double change) {
  const Eigen::Index n = seen.rows();
  Exact result{Eigen::MatrixXd::Zero(n, 3), Eigen::MatrixXd::Zero(n, 3), Eigen::VectorXd::Zero(n)};
  std::vector<double> logs;
  std::vector<Exact> parts;
  for (int sequence = 0; sequence < 1 << n; ++sequence) {
    std::vector<bool> moves;
    double log_weight = 0.0;
    for (Eigen::Index k = 0; k < n; ++k) {
      moves.push_back((sequence >> k & 1) != 0);
      log_weight += k == 0 ? std::log(moves[0] ? start : 1.0 - start)
                           : std::log(moves.end()[-1] == moves.end()[-2] ? 1.0 - change : change);
    }
    if (!std::isfinite(log_weight)) continue;
    // Given the first detection: p = z_1 + its error + the motion.
    const Eigen::MatrixXd p =
        motion_covariance(moves) + Eigen::MatrixXd::Constant(n, n, kDeviation * kDeviation);
    Eigen::MatrixXd s = p.bottomRightCorner(n - 1, n - 1);
    s.diagonal().array() += kDeviation * kDeviation;
    const Eigen::LLT<Eigen::MatrixXd> factor(s);
    const Eigen::MatrixXd gain = factor.solve(p.bottomRows(n - 1)).transpose();
    Exact part{Eigen::MatrixXd(n, 3), Eigen::MatrixXd(n, 3), Eigen::VectorXd(n)};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const Eigen::VectorXd z =
          seen.col(axis).tail(n - 1) - Eigen::VectorXd::Constant(n - 1, seen(0, axis));
      log_weight += log_normal(factor, z);
      part.mean.col(axis) = Eigen::VectorXd::Constant(n, seen(0, axis)) + gain * z;
      part.variance.col(axis) = (p - gain * p.bottomRows(n - 1)).diagonal();
    }
    for (Eigen::Index k = 0; k < n; ++k) part.moves[k] = moves[static_cast<std::size_t>(k)] ? 1 : 0;
    logs.push_back(log_weight);
    parts.push_back(std::move(part));
  }
  const double total = log_sum_exp(logs);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double weight = std::exp(logs[i] - total);
    result.mean += weight * parts[i].mean;
    result.moves += weight * parts[i].moves;
    result.variance += weight * (parts[i].variance + parts[i].mean.cwiseAbs2());
  }
  result.variance -= result.mean.cwiseAbs2();
  return result;
}

struct SmootherLoss {
  double mean = 0.0;      ///< largest error in exact standard deviations
  double ratio = 0.0;     ///< largest |log| of the ratio of variances
  double model = 0.0;     ///< mean error of the probability of a model
  double filtered = 0.0;  ///< the same of the filter, which does not know what comes
};

SmootherLoss loss(double start, double rate, const MotionModels& models, int seeds, int steps) {
  const double change = rate > 0.0 ? -0.5 * std::expm1(-2.0 * rate * kFramePeriod_s) : 0.0;
  MovingObjectSettings settings = testing::plain_moving_settings();
  settings.lost_rate = 0.0;
  SmootherLoss result;
  for (int seed = 0; seed < seeds; ++seed) {
    RandomStream stream(static_cast<std::uint64_t>(seed), 5);
    Eigen::MatrixXd seen(steps, 3);
    std::vector<MovingObjectStep> recording;
    const Eigen::Vector3d velocity =
        testing::draw(Matrix6d(kStartSpeedSd * kStartSpeedSd * Matrix6d::Identity()), stream)
            .head<3>();
    for (int k = 0; k < steps; ++k) {
      const double travelled = kFramePeriod_s * std::max(0, k - (start > 0.9 ? 0 : steps / 2));
      const Eigen::Vector3d error =
          testing::draw(Matrix6d(kDeviation * kDeviation * Matrix6d::Identity()), stream).head<3>();
      seen.row(k) = travelled * velocity + error;
      MovingObjectStep step{.observation =
                                observation_of(SE3d(SO3d(), Eigen::Vector3d(seen.row(k))))};
      step.observation.stamp_s = kFramePeriod_s * k;
      recording.push_back(step);
    }
    const MovingObjectSmoothing smoothing =
        smooth_moving_object({noise()}, models, settings, recording);
    const Exact truth = exact(seen, start, change);
    for (int k = 0; k < steps; ++k) {
      const auto& estimate = smoothing.estimates[static_cast<std::size_t>(k)];
      const auto& world = estimate.hypotheses.front().world;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double sd = std::sqrt(truth.variance(k, axis));
        result.mean = std::max(
            result.mean, std::abs(world.mean().translation()[axis] - truth.mean(k, axis)) / sd);
        result.ratio = std::max(
            result.ratio,
            std::abs(std::log(world.covariance()(3 + axis, 3 + axis) / truth.variance(k, axis))));
      }
      const double share = 1.0 / (seeds * steps);
      result.model += share * std::abs(estimate.models.back() - truth.moves[k]);
      result.filtered +=
          share *
          std::abs(smoothing.filtered[static_cast<std::size_t>(k)].models.back() - truth.moves[k]);
    }
  }
  ::testing::Test::RecordProperty(
      "loss", fmt::format("mean {:.4f} sd, log variance {:.4f}, model {:.4f}, of the filter {:.4f}",
                          result.mean, result.ratio, result.model, result.filtered));
  return result;
}

TEST(MovingObjectSmootherExact, IsExactForOneModel) {
  const SmootherLoss result = loss(1.0, 0.0, {.models = {moving()}}, 5, 10);
  EXPECT_LT(result.mean, 1e-3);
  EXPECT_LT(result.ratio, 1e-3);
}

TEST(MovingObjectSmootherExact, LosesLittleByMixingModels) {
  const MotionModels models{.models = {StaticMotion{}, moving()},
                            .rates = (Eigen::MatrixXd(2, 2) << 0.0, 0.5, 0.5, 0.0).finished(),
                            .start = {0.7, 0.3}};
  const SmootherLoss result = loss(0.3, 0.5, models, 20, 10);
  EXPECT_LT(result.mean, 1.0);
  EXPECT_LT(result.model, 0.06);
  EXPECT_LT(result.model, 0.5 * result.filtered);
}

}  // namespace
}  // namespace posemix
