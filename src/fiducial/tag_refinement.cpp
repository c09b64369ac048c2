// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "tag_refinement.hpp"

#include <Eigen/QR>
#include <unsupported/Eigen/NonLinearOptimization>

namespace posemix::internal {
namespace {

using Residual = Eigen::Matrix<double, 8, 1>;
using Jacobian = Eigen::Matrix<double, 8, 6>;

constexpr int kMostEvaluations = 200;
constexpr double kTolerance = 1e-13;  ///< of step and squared error, relative
/// Error of a corner that the camera cannot see, which the search avoids [px].
constexpr double kUnseen = 1e6;

/// The reprojection errors of T_camera_tag Exp(n) at n = 0.
struct Reprojection {
  Residual residual;  ///< [px]
  Jacobian jacobian;  ///< with respect to n
  bool seen = true;
};

Reprojection reprojection(const SE3d& camera_tag, const TagCorners& corners, double size,
                          const CameraModel& camera) {
  const Eigen::Matrix3d r = camera_tag.rotation().matrix();
  const std::array<Eigen::Vector3d, 4> points = tag_points(size);
  Reprojection out;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::Vector3d& point = points[static_cast<std::size_t>(i)];
    const std::optional<Projection> image = project(camera, r * point + camera_tag.translation());
    if (!image) {
      out.residual.setConstant(kUnseen);
      out.jacobian.setZero();
      out.seen = false;
      return out;
    }
    out.residual.segment<2>(2 * i) = image->pixel - corners[static_cast<std::size_t>(i)];
    const Eigen::Matrix<double, 2, 3> along = image->jacobian * r;
    out.jacobian.block<2, 3>(2 * i, 0) = -along * SO3d::hat(point);
    out.jacobian.block<2, 3>(2 * i, 3) = along;
  }
  return out;
}

/// What Eigen's port of MINPACK minimises, a function of n of T_camera_tag = start Exp(n).
struct Problem {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;

  const SE3d& start;
  const TagCorners& corners;
  double size;
  const CameraModel& camera;

  static int inputs() { return 6; }
  static int values() { return 8; }

  Reprojection at(const Eigen::VectorXd& n) const {
    return reprojection(start * SE3d::exp(n), corners, size, camera);
  }
  int operator()(const Eigen::VectorXd& n, Eigen::VectorXd& errors) const {
    errors = at(n).residual;
    return 0;
  }
  int df(const Eigen::VectorXd& n, Eigen::MatrixXd& jacobian) const {
    jacobian = at(n).jacobian * SE3d::right_jacobian(n);
    return 0;
  }
};

}  // namespace

std::optional<TagMinimum> refined(const SE3d& start, const TagCorners& corners, double size,
                                  const CameraModel& camera) {
  Problem problem{start, corners, size, camera};
  Eigen::LevenbergMarquardt<Problem> search(problem);
  search.parameters.maxfev = kMostEvaluations;
  search.parameters.ftol = kTolerance;
  search.parameters.xtol = kTolerance;
  Eigen::VectorXd n = Eigen::VectorXd::Zero(6);
  search.minimize(n);
  if (!n.allFinite()) return std::nullopt;

  TagMinimum found;
  found.pose = start * SE3d::exp(n);
  const Reprojection end = reprojection(found.pose, corners, size, camera);
  if (!end.seen || !end.residual.allFinite()) return std::nullopt;
  found.squared_error = end.residual.squaredNorm();
  found.information = end.jacobian.transpose() * end.jacobian;
  return found;
}

}  // namespace posemix::internal
