// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "noise_axes.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix::internal {
namespace {

using Matrix12x6d = Eigen::Matrix<double, 12, 6>;

/// A component that explains the detection by less than this share of the best is left out.
constexpr double kLeastLogShare = -9.0;

/// Moments of a mixture of children in one tangent space, summed up child by child.
class ChildMoments {
 public:
  explicit ChildMoments(const Matrix12d& prior) : prior_(prior) {}

  /// A child that the detection does not move.
  void add_unmoved(double weight) { second_.noalias() += weight * prior_; }

  void add(double weight, const Vector12d& mean, const Matrix12d& covariance) {
    mean_ += weight * mean;
    second_.noalias() += weight * (covariance + mean * mean.transpose());
  }

  PairMoments moments() const {
    Matrix12d covariance = second_ - mean_ * mean_.transpose();
    symmetrize(covariance);
    return {mean_, covariance};
  }

 private:
  const Matrix12d& prior_;
  Vector12d mean_ = Vector12d::Zero();
  Matrix12d second_ = Matrix12d::Zero();
};

/// The covariance with standard deviations times `scale`.
Matrix6d scaled(const Matrix6d& covariance, const Vector6d& scale) {
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

/// P H^T with H = [-I I].
Matrix12x6d times_ht(const Matrix12d& p) { return p.rightCols<6>() - p.leftCols<6>(); }

/// K = P H^T S^-1 with S = H P H^T + R; the camera's rows with R multiplied by a factor.
Matrix12x6d gain(const Matrix12x6d& p_ht, const Matrix6d& difference, const Matrix6d& noise,
                 double camera_factor) {
  const Eigen::LLT<Matrix6d> s(difference + noise);
  if (camera_factor == 1.0) return s.solve(p_ht.transpose()).transpose();
  Matrix12x6d k;
  k.bottomRows<6>() = s.solve(p_ht.bottomRows<6>().transpose()).transpose();
  if (std::isinf(camera_factor)) {
    k.topRows<6>().setZero();
  } else {
    const Eigen::LLT<Matrix6d> weaker(difference + camera_factor * noise);
    k.topRows<6>() = weaker.solve(p_ht.topRows<6>().transpose()).transpose();
  }
  return k;
}

}  // namespace

Matrix6d component_noise(const Pair& pair, const NoiseComponent& component,
                         const ObjectSensor& sensor) {
  const NoiseAtPose at = noise_at(component, pair.camera_object());
  return (pair.camera * at.axes).adjoint_congruence(scaled(at.covariance, sensor.noise_scale));
}

PairInnovation innovation(const Pair& pair, const SE3d& detected, const NoiseComponent& component,
                          const ObjectSensor& sensor) {
  const SE3d expected = pair.camera_object();
  const NoiseAtPose at = noise_at(component, expected);
  PairInnovation result;
  result.axes = pair.camera * at.axes;
  result.noise = result.axes.adjoint_congruence(scaled(at.covariance, sensor.noise_scale));
  result.update_noise =
      component.update_covariance
          ? result.axes.adjoint_congruence(scaled(at.update_covariance, sensor.noise_scale))
          : result.noise;
  SE3d seen = detected * component.offset.inverse();
  const SymmetryGroup& symmetries = sensor.symmetries;
  if (!symmetries.is_trivial()) {
    const Matrix6d local =
        pair.object.inverse().adjoint_congruence(Matrix6d(pair.difference() + result.noise));
    seen = symmetries.closest(seen, expected, local.inverse());
    const Matrix6d unobserved = pair.object.adjoint_congruence(symmetries.unobserved_covariance());
    result.noise += unobserved;
    result.update_noise += unobserved;
  }
  result.residual = (pair.camera * seen * pair.object.inverse()).log();
  return result;
}

Explanation explain(const Pair& pair, const SE3d& detected, const ObjectSensor& sensor) {
  const auto& components = sensor.noise.components();
  const Matrix6d difference = pair.difference();
  Explanation result;
  result.squared_distance = std::numeric_limits<double>::infinity();
  result.innovations.reserve(components.size());
  std::vector<double>& shares = result.shares;
  shares.reserve(components.size() + 1);

  // Evidence of every component, log w + log N(z; 0, H P H^T + R), and of clutter.
  for (const NoiseComponent& component : components) {
    result.innovations.push_back(innovation(pair, detected, component, sensor));
    const PairInnovation& seen = result.innovations.back();
    const Eigen::LLT<Matrix6d> s(difference + seen.noise);
    const bool ok = s.info() == Eigen::Success;
    const double squared =
        ok ? s.matrixL().solve(seen.residual).squaredNorm() : result.squared_distance;
    shares.push_back(ok ? std::log(component.weight) -
                              0.5 * (squared + log_det(s) + 6.0 * kLogTwoPi)
                        : -std::numeric_limits<double>::infinity());
    result.squared_distance = std::min(result.squared_distance, squared);
  }
  shares.push_back(sensor.noise.log_clutter_density());
  result.log_evidence = log_sum_exp(shares);

  // Shares, without those that hardly count.
  const double most = *std::max_element(shares.begin(), shares.end());
  double kept = 0.0;
  for (double& share : shares) {
    share = share < most + kLeastLogShare ? 0.0 : std::exp(share - result.log_evidence);
    kept += share;
  }
  for (double& share : shares) share /= kept;
  return result;
}

PairUpdate observe(const Pair& pair, const SE3d& detected, const ObjectSensor& sensor,
                   double camera_gain_noise, bool averages) {
  const Explanation seen_as = explain(pair, detected, sensor);
  PairUpdate result;
  result.squared_distance = seen_as.squared_distance;
  result.log_evidence = seen_as.log_evidence;
  if (!std::isfinite(result.log_evidence)) {
    result.posterior.covariance = pair.covariance;
    return result;
  }

  // One child per component, and their moments.
  ChildMoments children(pair.covariance);
  const Matrix12x6d p_ht = times_ht(pair.covariance);
  const Matrix6d difference = pair.difference();
  for (std::size_t i = 0; i < seen_as.innovations.size(); ++i) {
    const double weight = seen_as.shares[i];
    if (weight == 0.0) continue;
    const PairInnovation& seen = seen_as.innovations[i];
    const Matrix6d& noise = averages ? seen.update_noise : seen.noise;
    const Matrix12x6d k = gain(p_ht, difference, noise, camera_gain_noise);
    // Joseph's form for whatever gain: P - K H P - P H^T K^T + K S K^T.
    const Matrix12d kt = k * p_ht.transpose();
    const Matrix12d covariance =
        pair.covariance - kt - kt.transpose() + k * (difference + noise) * k.transpose();
    children.add(weight, k * seen.residual, covariance);
  }
  if (seen_as.shares.back() > 0.0) children.add_unmoved(seen_as.shares.back());
  result.posterior = children.moments();
  result.inlier_probability = seen_as.shares.front();
  result.clutter_probability = seen_as.shares.back();
  const PairInnovation& inlier = seen_as.innovations.front();
  const SE3d to_axes = inlier.axes.inverse();
  result.residual = to_axes.adjoint_blocks().times(inlier.residual);
  result.residual_variance =
      to_axes.adjoint_congruence(Matrix6d(difference + inlier.noise)).diagonal();
  return result;
}

}  // namespace posemix::internal
