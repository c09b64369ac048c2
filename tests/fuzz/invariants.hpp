// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <string>

#include <Eigen/Eigenvalues>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/lie/se3.hpp"
#include "posemix/mixture/mixture.hpp"
#include "target.hpp"

/// What holds for every pose, covariance and mixture.
namespace posemix::fuzzing {

inline void expect_pose(const SE3d& pose) {
  expect(pose.translation().allFinite(), "a translation that is not finite");
  expect(std::abs(pose.rotation().quaternion().norm() - 1.0) < 1e-9,
         "a quaternion whose length is not one");
}

/// The covariance scaled to ones on the diagonal.
template <class Matrix>
Matrix correlations(const Matrix& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().array().rsqrt();
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

/// Their smallest eigenvalue.
template <class Matrix>
double least_correlation(const Matrix& covariance) {
  return Eigen::SelfAdjointEigenSolver<Matrix>(correlations(covariance), Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

/// Up to this the correlations of a covariance may be wrong by rounding.
inline constexpr double kRounding = 1e-9;

/// Finite, and symmetric and positive definite up to rounding: scaled to ones on the diagonal, no
/// entry differs from its mirror image and no eigenvalue lies below zero by more than that.
template <class Matrix>
void expect_covariance(const Matrix& covariance, const std::string& what,
                       double rounding = kRounding) {
  expect(covariance.allFinite(), what + ": a covariance that is not finite");
  expect((covariance.diagonal().array() > 0.0).all(), what + ": a variance that is not positive");
  const Eigen::MatrixXd scaled = correlations(covariance);
  const double asymmetry = (scaled - scaled.transpose()).cwiseAbs().maxCoeff();
  expect(asymmetry < rounding,
         what + ": a covariance that is not symmetric, by " + std::to_string(asymmetry));
  const double least = least_correlation(covariance);
  expect(least > -rounding,
         what + ": a covariance with a negative eigenvalue, " + std::to_string(least));
}

template <class G>
void expect_density(const ConcentratedGaussian<G>& density, const std::string& what) {
  expect_covariance(density.covariance(), what);
}
inline void expect_density(const ConcentratedGaussian<SE3d>& density, const std::string& what) {
  expect_pose(density.mean());
  expect_covariance(density.covariance(), what);
}

template <class D>
void expect_weights(const Mixture<D>& mixture, const std::string& what) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mixture.size(); ++i) {
    expect(!std::isnan(mixture[i].log_weight) && mixture[i].log_weight < 1e-9,
           what + ": a weight that is none");
    sum += mixture.weight(i);
  }
  expect(std::abs(sum - 1.0) < 1e-9, what + ": weights whose sum is not one");
}

}  // namespace posemix::fuzzing
