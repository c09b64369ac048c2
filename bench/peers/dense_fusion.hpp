// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>

#include "dense_lie.hpp"

/// The product of two uncertain poses by Gauss and Newton's iteration (Barfoot and Furgale 2014).
namespace dense {

template <class S>
struct UncertainPose {
  Pose<S> mean;
  Matrix6<S> covariance;
};

template <class S>
void append(std::vector<double>& numbers, const UncertainPose<S>& pose) {
  append(numbers, pose.mean);
  append(numbers, pose.covariance);
}

/// Adds one factor of the product, linearised at x, to the information and to what pulls x.
template <class S>
void add_factor(const UncertainPose<S>& factor, const Pose<S>& x, Matrix6<S>& information,
                Vector6<S>& pull) {
  const Vector6<S> residual = log(x * factor.mean.inverse());
  const Matrix6<S> jacobian = left_jacobian_inverse(residual);
  const Matrix6<S> weighted = factor.covariance.llt().solve(jacobian);
  information += jacobian.transpose() * weighted;
  pull -= weighted.transpose() * residual;
}

/// Until the step is below 1e-12, as the others, or with many digits to nothing.
template <class S>
UncertainPose<S> fused(const UncertainPose<S>& a, const UncertainPose<S>& b) {
  UncertainPose<S> result = a;
  for (int i = 0; i < 50; ++i) {
    Matrix6<S> information = Matrix6<S>::Zero();
    Vector6<S> pull = Vector6<S>::Zero();
    add_factor(a, result.mean, information, pull);
    add_factor(b, result.mean, information, pull);
    const Eigen::LLT<Matrix6<S>> factor(information);
    const Vector6<S> step = factor.solve(pull);
    result.mean = exp(step) * result.mean;
    result.covariance = factor.solve(Matrix6<S>::Identity());
    if (step.norm() < (std::is_same_v<S, double> ? S(1e-12) : S(1e-24))) break;
  }
  return result;
}

template <class S>
struct VectorPeak {
  Vector6<S> mean;
  Matrix6<S> covariance;
};

template <class S>
void append(std::vector<double>& numbers, const VectorPeak<S>& peak) {
  append(numbers, peak.mean);
  append(numbers, peak.covariance);
}

/// The product of two Gaussians on R^6 by the gain of a Kalman filter. `log_overlap`, if given,
/// gets the log of its integral less a constant.
template <class S>
VectorPeak<S> fused(const VectorPeak<S>& a, const VectorPeak<S>& b, S* log_overlap = nullptr) {
  const Eigen::LLT<Matrix6<S>> sum(a.covariance + b.covariance);
  const Matrix6<S> gain = sum.solve(a.covariance).transpose();
  const Vector6<S> d = b.mean - a.mean;
  if (log_overlap) {
    const Matrix6<S> root = sum.matrixL();
    *log_overlap = -root.diagonal().array().log().sum() - d.dot(sum.solve(d)) / 2;
  }
  return {a.mean + gain * d, a.covariance - gain * a.covariance};
}

/// The Gaussian with the moments of two.
template <class S>
VectorPeak<S> merged(const VectorPeak<S>& a, const VectorPeak<S>& b, S w_a, S w_b) {
  const Vector6<S> d = b.mean - a.mean;
  return {a.mean + w_b * d,
          w_a * a.covariance + w_b * b.covariance + (w_a * w_b) * d * d.transpose()};
}

}  // namespace dense
