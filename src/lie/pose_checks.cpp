// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/pose_checks.hpp"

#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

/// Of eigenvalues and of rows of zero variance, for a matrix whose variances are scaled to one.
constexpr double kRounding = 1e-9;

/// Whether the eigenvalues of a symmetric matrix are not negative, whatever the units of the rows:
/// scaled to ones on the diagonal. A row of zero variance must be zero up to rounding, which is a
/// part of the largest variance there and of that of the column.
bool is_semidefinite(const Matrix6d& covariance) {
  if (covariance.diagonal().minCoeff() < 0.0) return false;
  if (Eigen::LLT<Matrix6d>(covariance).info() == Eigen::Success) return true;
  const Vector6d scale =
      covariance.diagonal().unaryExpr([](double v) { return v > 0.0 ? 1.0 / std::sqrt(v) : 0.0; });
  const Matrix6d scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
  const double largest = covariance.diagonal().maxCoeff();
  const Vector6d rounding =
      kRounding *
      (largest * covariance.diagonal().cwiseMax(kRounding * kRounding * largest)).cwiseSqrt();
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (scale[i] == 0.0 && (covariance.col(i).cwiseAbs().array() > rounding.array()).any())
      return false;
  }
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(scaled, Eigen::EigenvaluesOnly).eigenvalues()[0] >=
         -kRounding;
}

}  // namespace

bool is_valid_pose(const SE3d& pose) {
  return pose.translation().allFinite() && pose.rotation().quaternion().coeffs().allFinite() &&
         pose.translation().cwiseAbs().maxCoeff() <= kFarthestPosition;
}

void check_pose(const SE3d& pose, std::string_view name) {
  if (is_valid_pose(pose)) return;
  const Eigen::Vector3d& position = pose.translation();
  if (!position.allFinite() || !pose.rotation().quaternion().coeffs().allFinite())
    throw InvalidInput(fmt::format("{} holds a value that is not finite", name));
  throw InvalidInput(fmt::format("{} has a position of {:g} m, expected at most {:g} m", name,
                                 position.cwiseAbs().maxCoeff(), kFarthestPosition));
}

void check_variances(const Matrix6d& covariance, std::string_view name) {
  if (!covariance.allFinite())
    throw InvalidInput(fmt::format("{} holds a value that is not finite", name));
  const double largest = covariance.diagonal().maxCoeff();
  if (largest > kLargestVariance) {
    throw InvalidInput(fmt::format("{} has a variance of {:g}, expected at most {:g} (rad^2, m^2)",
                                   name, largest, kLargestVariance));
  }
}

void check_noise(const Matrix6d& covariance, std::string_view name) {
  check_variances(covariance, name);
  if (covariance.diagonal().minCoeff() < 0.0)
    throw InvalidInput(fmt::format("{} has a negative variance", name));
  const double largest = covariance.cwiseAbs().maxCoeff();
  if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() > kRounding * largest)
    throw InvalidInput(fmt::format("{} is not symmetric", name));
  Matrix6d symmetric = covariance;
  symmetrize(symmetric);
  if (!is_semidefinite(symmetric))
    throw InvalidInput(fmt::format("{} is not positive semidefinite", name));
}

}  // namespace posemix
