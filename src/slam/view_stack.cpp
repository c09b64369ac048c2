// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/view_stack.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

namespace posemix::internal {
namespace {

constexpr int kMaxIterations = 30;
constexpr double kConverged = 1e-11;
/// The variance of an angle that is uniform over a turn [rad^2].
constexpr double kUniformAngle = std::numbers::pi * std::numbers::pi / 3.0;

using PositionRows = Eigen::Matrix<double, 3, 6>;

/// Derivative of the position of Exp(xi) X for X at `position`.
PositionRows position_rows(const Eigen::Vector3d& position) {
  PositionRows rows;
  rows.leftCols<3>() = -SO3d::hat(position);
  rows.rightCols<3>().setIdentity();
  return rows;
}

/// The covariance of the error of a term, along its rows.
Eigen::MatrixXd along_rows(const Matrix6d& covariance, const ViewTerm& term, const SE3d& pose) {
  if (!term.is_turned) return covariance;
  const PositionRows rows = position_rows(pose.translation());
  return rows * covariance * rows.transpose();
}

Eigen::MatrixXd slow_rows(const ViewTerm& term, const SE3d& pose) {
  if (!term.is_turned) return term.slow_factor;
  return position_rows(pose.translation()) * term.slow_factor;
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The turns about axes of symmetry have the variance of a uniform angle: along s = Ad(X) [d; p x
/// d].
Matrix6d axis_covariance(const SE3d& pose, const SymmetryGroup& symmetries) {
  return pose.adjoint_congruence(symmetries.unobserved_covariance());
}

}  // namespace

double ViewStack::correlation(const ViewTerm& a, const ViewTerm& b) const {
  if (a.has_own_slow || b.has_own_slow) return 0.0;
  const Eigen::Vector3d& object = reference_.translation();
  const double angle = angle_between(a.camera_position - object, b.camera_position - object);
  return std::exp(-angle / correlation_.angle_rad -
                  std::abs(a.stamp_s - b.stamp_s) / correlation_.time_s);
}

Eigen::MatrixXd ViewStack::cross_covariance(const Row& row) const {
  Eigen::MatrixXd cross(factor_.rows(), row.size);
  const Eigen::MatrixXd own = slow_rows(row.term, row.pose);
  for (const Row& other : rows_) {
    cross.middleRows(other.begin, other.size) =
        correlation(other.term, row.term) * slow_rows(other.term, other.pose) * own.transpose();
  }
  return cross;
}

void ViewStack::append(const Row& row) {
  const Eigen::Index before = factor_.rows();
  const Matrix6d full = row.term.white + row.term.slow_factor * row.term.slow_factor.transpose();
  Eigen::MatrixXd own = along_rows(full, row.term, row.pose);
  const Eigen::MatrixXd cross = cross_covariance(row);
  const Eigen::MatrixXd left =
      factor_.triangularView<Eigen::Lower>().solve(cross).transpose();  // size x before
  own -= left * left.transpose();
  const Eigen::LLT<Eigen::MatrixXd> corner(own);
  Eigen::MatrixXd design = Eigen::MatrixXd::Zero(row.size, 6);
  Eigen::VectorXd residual;
  if (row.term.is_turned) {
    design = position_rows(reference_.translation());
    residual = row.pose.translation() - reference_.translation();
  } else {
    design.setIdentity();
    residual = (row.pose * reference_.inverse()).log();
  }
  design = corner.matrixL().solve(design - left * design_).eval();
  residual = corner.matrixL().solve(residual - left * residual_).eval();
  factor_.conservativeResizeLike(Eigen::MatrixXd::Zero(before + row.size, before + row.size));
  factor_.bottomLeftCorner(row.size, before) = left;
  factor_.bottomRightCorner(row.size, row.size) = corner.matrixL();
  design_.conservativeResize(before + row.size, 6);
  design_.bottomRows(row.size) = design;
  residual_.conservativeResize(before + row.size);
  residual_.tail(row.size) = residual;
}

void ViewStack::add(const ViewTerm& term, const SymmetryGroup& symmetries) {
  Row row{term, term.pose, factor_.rows(), term.is_turned ? 3 : 6};
  if (rows_.empty()) {
    reference_ = term.pose;
    if (term.is_turned) reference_ = SE3d(SO3d(), term.pose.translation());
  } else if (!term.is_turned && !has_orientation_) {
    reference_ = SE3d(term.pose.rotation(), reference_.translation());
  }
  if (!term.is_turned) {
    if (!symmetries.is_trivial()) {
      row.term.white += axis_covariance(reference_, symmetries);
      const Matrix6d along_object = reference_.inverse().adjoint_congruence(
          Matrix6d(row.term.white + term.slow_factor * term.slow_factor.transpose()));
      const Matrix6d information = Eigen::LLT<Matrix6d>(along_object).solve(Matrix6d::Identity());
      row.pose = symmetries.closest_observed(term.pose, reference_, information);
    }
    has_orientation_ = true;
  }
  append(row);
  rows_.push_back(std::move(row));
}

double ViewStack::log_evidence() const {
  const double log_factor = factor_.diagonal().array().log().sum();
  const auto over = [&](const auto& design) {
    const Eigen::Index unknowns = design.cols();
    const Eigen::LLT<Eigen::MatrixXd> information(Eigen::MatrixXd(design.transpose() * design));
    const Eigen::VectorXd pull = design.transpose() * residual_;
    const double squared =
        residual_.squaredNorm() - information.matrixL().solve(pull).squaredNorm();
    return -0.5 * (squared + log_det(information) +
                   static_cast<double>(factor_.rows() - unknowns) * kLogTwoPi) -
           log_factor;
  };
  if (has_orientation_) return over(design_);
  // All orientations: their volume is 8 pi^2.
  return over(design_.rightCols<3>()) + std::log(8.0 * std::numbers::pi * std::numbers::pi);
}

ConcentratedGaussian<SE3d> ViewStack::solve() const {
  SE3d pose = reference_;
  Eigen::LLT<Matrix6d> information;
  const auto lower = factor_.triangularView<Eigen::Lower>();
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Eigen::VectorXd residual(factor_.rows());
    Design design(factor_.rows(), 6);
    for (const Row& row : rows_) {
      if (row.term.is_turned) {
        residual.segment(row.begin, row.size) = row.pose.translation() - pose.translation();
        design.middleRows(row.begin, row.size) = position_rows(pose.translation());
      } else {
        const Vector6d error = (row.pose * pose.inverse()).log();
        residual.segment(row.begin, row.size) = error;
        design.middleRows(row.begin, row.size) = SE3d::right_jacobian_inverse(error);
      }
    }
    lower.solveInPlace(residual);
    lower.solveInPlace(design);
    Matrix6d sum = design.transpose() * design;
    if (!has_orientation_) sum.topLeftCorner<3, 3>() += Eigen::Matrix3d::Identity() / kUniformAngle;
    information.compute(sum);
    const Vector6d step = information.solve(Vector6d(design.transpose() * residual));
    pose = SE3d::exp(step) * pose;
    if (step.norm() < kConverged) break;
  }
  Matrix6d covariance = information.solve(Matrix6d::Identity());
  symmetrize(covariance);
  return ConcentratedGaussian<SE3d>::trusted(pose, covariance);
}

}  // namespace posemix::internal
