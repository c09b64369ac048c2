// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "posemix/mixture/log_weights.hpp"

namespace posemix::internal {
namespace {

using Matrix12x6d = Eigen::Matrix<double, 12, 6>;

/// Log of the probability, relative to that of the most probable component, below which a component
/// is left out.
constexpr double kLeastLogRatio = -9.0;

/// Moments of a mixture of children in one tangent space, summed up child by child, eq. (4).
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

/// K = P H^T S^-1 with S = H P H^T + R. In the camera's rows R is multiplied by a factor.
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
  std::vector<double>& terms = result.probabilities;
  terms.reserve(components.size() + 1);

  // Evidence of every component and of clutter, eq. (3): e_c = log w_c + log N(z_c; 0, S_c).
  for (const NoiseComponent& component : components) {
    result.innovations.push_back(innovation(pair, detected, component, sensor));
    const PairInnovation& seen = result.innovations.back();
    const Eigen::LLT<Matrix6d> s(difference + seen.noise);
    const bool ok = s.info() == Eigen::Success;
    const double squared =
        ok ? s.matrixL().solve(seen.residual).squaredNorm() : result.squared_distance;
    terms.push_back(ok ? std::log(component.weight) - 0.5 * (squared + log_det(s) + 6.0 * kLogTwoPi)
                       : -std::numeric_limits<double>::infinity());
    result.squared_distance = std::min(result.squared_distance, squared);
  }
  terms.push_back(sensor.noise.log_clutter_density());
  result.log_evidence = log_sum_exp(terms);

  // Probabilities, without components that hardly count.
  const double most = *std::max_element(terms.begin(), terms.end());
  double kept = 0.0;
  for (double& term : terms) {
    term = term < most + kLeastLogRatio ? 0.0 : std::exp(term - result.log_evidence);
    kept += term;
  }
  for (double& term : terms) term /= kept;
  return result;
}

PairUpdate observe(const Pair& pair, const SE3d& detected, const ObjectSensor& sensor,
                   double camera_gain_noise, GainCovariance gain_covariance) {
  const Explanation seen_as = explain(pair, detected, sensor);
  PairUpdate result;
  result.squared_distance = seen_as.squared_distance;
  result.log_evidence = seen_as.log_evidence;
  if (!std::isfinite(result.log_evidence)) {
    result.posterior.covariance = pair.covariance;
    return result;
  }

  // One child per component and one for clutter, and their moments, eq. (4).
  ChildMoments children(pair.covariance);
  const Matrix12x6d p_ht = times_ht(pair.covariance);
  const Matrix6d difference = pair.difference();
  for (std::size_t i = 0; i < seen_as.innovations.size(); ++i) {
    const double weight = seen_as.probabilities[i];
    if (weight == 0.0) continue;
    const PairInnovation& seen = seen_as.innovations[i];
    const Matrix6d& noise = noise_in_gain(seen, gain_covariance);
    const Matrix12x6d k = gain(p_ht, difference, noise, camera_gain_noise);
    // Joseph's form, right for every gain: P - K H P - P H^T K^T + K S K^T.
    const Matrix12d kt = k * p_ht.transpose();
    const Matrix12d covariance =
        pair.covariance - kt - kt.transpose() + k * (difference + noise) * k.transpose();
    children.add(weight, k * seen.residual, covariance);
  }
  if (seen_as.probabilities.back() > 0.0) children.add_unmoved(seen_as.probabilities.back());
  result.posterior = children.moments();
  result.inlier_probability = seen_as.probabilities.front();
  result.clutter_probability = seen_as.probabilities.back();
  const PairInnovation& inlier = seen_as.innovations.front();
  const SE3d to_axes = inlier.axes.inverse();
  result.residual = to_axes.adjoint_blocks().times(inlier.residual);
  result.residual_variance =
      to_axes.adjoint_congruence(Matrix6d(difference + inlier.noise)).diagonal();
  return result;
}

}  // namespace posemix::internal
