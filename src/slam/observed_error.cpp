// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/observed_error.hpp"

#include <limits>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "posemix/base/error.hpp"
#include "posemix/slam/evaluation.hpp"

namespace posemix {
namespace {

constexpr double kLengthM = 0.1;  ///< of translation against rotation in the choice of the image

/// Two directions across an axis: coordinate directions where the axis is one.
Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  const Eigen::Vector3d start = Eigen::Vector3d::Unit((largest + 1) % 3);
  Eigen::Matrix<double, 3, 2> directions;
  directions.col(0) = (start - axis.dot(start) * axis).normalized();
  directions.col(1) = axis.cross(directions.col(0));
  return directions;
}

ObservedPart along(const Eigen::Matrix<double, 6, Eigen::Dynamic>& directions, const Vector6d& e,
                   const Matrix6d& covariance) {
  return {directions.transpose() * e, directions.transpose() * covariance * directions};
}

void check_sizes(const ObservedPart& part) {
  const Eigen::Index n = part.error.size();
  if (part.covariance.rows() == n && part.covariance.cols() == n) return;
  throw InvalidInput(fmt::format("the covariance of an error of {} entries is {} x {}", n,
                                 part.covariance.rows(), part.covariance.cols()));
}

}  // namespace

double ObservedPart::nees() const {
  check_sizes(*this);
  if (error.size() == 0) return 0.0;
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  return factor.matrixL().solve(error).squaredNorm();
}

Eigen::VectorXd ObservedPart::whitened() const {
  check_sizes(*this);
  if (error.size() == 0) return error;
  const Eigen::VectorXd inverse_sd = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation =
      inverse_sd.asDiagonal() * covariance * inverse_sd.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(correlation);
  return eigen.operatorInverseSqrt() * (inverse_sd.asDiagonal() * error);
}

ErrorReduction::ErrorReduction(const SymmetryGroup& symmetries) : symmetries_(symmetries) {
  const std::vector<SymmetryAxis>& axes = symmetries_.axes();
  rotation_ = Eigen::Matrix3d::Identity();
  if (axes.empty()) return;
  point_ = axes.front().point;
  if (axes.size() == 1) {
    rotation_ = across(axes.front().direction);
  } else {
    rotation_.resize(3, 0);
  }
}

SE3d ErrorReduction::nearest(const SE3d& truth, const SE3d& estimate) const {
  if (symmetries_.is_trivial()) return truth;
  Matrix6d information = Matrix6d::Identity();
  information.bottomRightCorner<3, 3>() /= kLengthM * kLengthM;
  return symmetries_.closest(truth, estimate, information);
}

ObservedError ErrorReduction::operator()(const PoseDensity& estimate, const SE3d& truth) const {
  const SE3d to_point(SO3d(), point_);
  const SE3d body = estimate.mean() * to_point;
  const SE3d to_body = body.inverse();
  const Vector6d e = (to_body * nearest(truth, estimate.mean()) * to_point).log();
  const Matrix6d p = to_body.adjoint_congruence(estimate.covariance());
  const auto rotations = static_cast<Eigen::Index>(rotation_dof());
  Eigen::Matrix<double, 6, Eigen::Dynamic> directions =
      Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, rotations + 3);
  directions.topLeftCorner(3, rotations) = rotation_;
  directions.bottomRightCorner<3, 3>().setIdentity();
  const Matrix6d observed = directions * directions.transpose();
  return {along(directions, e, p), along(directions.leftCols(rotations), e, p),
          along(directions.rightCols<3>(), e, p), observed * e, observed * p * observed};
}

double ErrorReduction::nees(const PoseDensity& estimate, const SE3d& truth) const {
  if (symmetries_.is_trivial()) return squared_normalized_error(estimate, truth);
  return (*this)(estimate, truth).pose.nees();
}

Eigen::MatrixXd ErrorReduction::rotation_covariance(const PoseDensity& estimate) const {
  const Eigen::Matrix<double, 3, Eigen::Dynamic> directions =
      estimate.mean().rotation().matrix() * rotation_;
  return directions.transpose() * estimate.covariance().topLeftCorner<3, 3>() * directions;
}

}  // namespace posemix
