// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "posemix/base/error.hpp"
#include "posemix/detector/symmetry.hpp"

/// Nearest equivalent poses.
namespace posemix {
namespace {

constexpr int kMostSteps = 4;
constexpr double kSmallestGain = 1e-6;  ///< of the cost, below which no step is made

SE3d about(const Eigen::Vector3d& point, const SO3d& rotation) {
  return SE3d(rotation, point - rotation * point);
}

/// A motion g of the group and the motion that remains, rest = (X g)^-1 reference, z = Log(rest).
struct Equivalent {
  Equivalent(const SE3d& g, const SE3d& left, const Matrix6d& information)
      : motion(g), rest(left), z(rest.log()), cost(z.dot(information.lazyProduct(z))) {}

  SE3d motion;
  SE3d rest;
  Vector6d z;
  double cost;
};

/// Gauss-Newton steps over the angles, Log(Exp(-A eps) rest) = z - J_l^-1(z) A eps + ..., as long
/// as the predicted gain is worth a step and the predicted cost is below `least`.
template <int N>
void refine(const Eigen::Matrix<double, 6, N>& generators, const Matrix6d& information,
            double least, Equivalent& equivalent) {
  for (int step = 0; step < kMostSteps; ++step) {
    const auto jacobian = SE3d::left_jacobian_inverse_blocks(equivalent.z);
    Eigen::Matrix<double, 6, N> slope;
    for (int i = 0; i < N; ++i) slope.col(i) = jacobian.times(Vector6d(generators.col(i)));
    const Eigen::Matrix<double, 6, N> weighted = information.lazyProduct(slope);
    const Eigen::Matrix<double, N, N> normal = slope.transpose().lazyProduct(weighted);
    const Eigen::Matrix<double, N, 1> pull = weighted.transpose().lazyProduct(equivalent.z);
    const Eigen::Matrix<double, N, 1> eps = normal.inverse() * pull;
    const double gain = pull.dot(eps);
    if (!(gain > kSmallestGain * equivalent.cost && equivalent.cost - gain < least)) return;
    const SE3d turn = SE3d::exp(generators * eps);
    const Equivalent next(equivalent.motion * turn, turn.inverse() * equivalent.rest, information);
    if (!(next.cost < equivalent.cost)) return;
    equivalent = next;
  }
}

}  // namespace

SE3d SymmetryGroup::turned_to(const SE3d& error) const {
  if (axes_.empty()) return SE3d();
  const SymmetryAxis& axis = axes_.front();
  if (axes_.size() > 1) return about(axis.point, error.rotation());
  const Eigen::Quaterniond& q = error.rotation().quaternion();
  const double angle = 2.0 * std::atan2(q.vec().dot(axis.direction), q.w());
  return about(axis.point, SO3d::exp(angle * axis.direction));
}

/// The motion of the group with the least cost, of those that `refined` makes of the ones that
/// leave no rotation about the axes.
template <class Refine>
SE3d SymmetryGroup::best_motion(const SE3d& pose, const SE3d& reference,
                                const Matrix6d& information, const Refine& refined) const {
  if (!information.allFinite())
    throw InvalidInput("the information holds a value that is not finite");
  const SE3d error = pose.inverse() * reference;
  double least = std::numeric_limits<double>::infinity();
  SE3d best;
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const SE3d rest = inverses_[i] * error;
    const SE3d turn = turned_to(rest);
    Equivalent equivalent(elements_[i] * turn, turn.inverse() * rest, information);
    refined(least, equivalent);
    if (!(equivalent.cost < least)) continue;
    least = equivalent.cost;
    best = equivalent.motion;
  }
  return best;
}

SE3d SymmetryGroup::closest(const SE3d& pose, const SE3d& reference,
                            const Matrix6d& information) const {
  if (is_trivial()) return pose;
  return pose *
         best_motion(pose, reference, information, [&](double least, Equivalent& equivalent) {
           if (axes_.size() == 1)
             refine<1>(generators_.leftCols<1>(), information, least, equivalent);
           if (axes_.size() == 3) refine<3>(generators_, information, least, equivalent);
         });
}

SE3d SymmetryGroup::closest_observed(const SE3d& pose, const SE3d& reference,
                                     const Matrix6d& information) const {
  if (is_trivial()) return pose;
  return pose * best_motion(pose, reference, information, [](double, Equivalent&) {});
}

SE3d SymmetryGroup::undoing(const SO3d& rotation) const {
  if (turns_) {
    const Eigen::Quaterniond& q = rotation.quaternion();
    double angle = -2.0 * std::atan2(q.vec().dot(turns_->axis), q.w());
    angle = turns_->step_rad * std::round(angle / turns_->step_rad);
    return SE3d(SO3d::exp(angle * turns_->axis), Eigen::Vector3d::Zero());
  }
  // The first element is the identity.
  SE3d best = turned_to(SE3d(rotation, Eigen::Vector3d::Zero())).inverse();
  double least = (rotation * best.rotation()).angle();
  for (std::size_t i = 1; i < elements_.size(); ++i) {
    const SO3d turned = rotation * elements_[i].rotation();
    const SE3d undone = turned_to(SE3d(turned, Eigen::Vector3d::Zero())).inverse();
    const double angle = (turned * undone.rotation()).angle();
    if (!(angle < least)) continue;
    least = angle;
    best = elements_[i] * undone;
  }
  return best;
}

SE3d SymmetryGroup::nearest_rotation(const SE3d& pose, const SE3d& reference) const {
  if (is_trivial()) return pose;
  return pose * undoing(reference.rotation().inverse() * pose.rotation());
}

SE3d SymmetryGroup::reduced_error(const SE3d& error) const {
  if (is_trivial()) return error;
  return undoing(error.rotation()) * error;
}

Matrix6d SymmetryGroup::unobserved_covariance() const {
  const double variance = std::numbers::pi * std::numbers::pi / 3.0;
  return variance * generators_ * generators_.transpose();
}

Matrix6d SymmetryGroup::observed_projection() const {
  Matrix6d projection = Matrix6d::Identity();
  for (Eigen::Index k = 0; k < generators_.cols(); ++k)
    projection.leftCols<3>() -= generators_.col(k) * generators_.col(k).head<3>().transpose();
  return projection;
}

}  // namespace posemix
