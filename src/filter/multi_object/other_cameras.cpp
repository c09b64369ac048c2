// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "other_cameras.hpp"

#include <Eigen/Cholesky>

namespace posemix::internal {
namespace {

/// Covariance of [e; b].
Matrix12d pair_of(const Matrix6d& error, const Matrix6d& slow_and_error, const Matrix6d& slow) {
  Matrix12d pair;
  pair << error, slow_and_error.transpose(), slow_and_error, slow;
  return pair;
}

/// The regression of b_k on [e; b], whose covariance is `given`, and what is left. Moments that are
/// none of a Gaussian, by rounding or as the velocity of the body is left out of them, tell nothing
/// of b_k but its own.
void regress(OtherCamera& other, const OtherMoments& moments, const Matrix12d& given) {
  constexpr double kRounding = 1e-9;
  const Eigen::LLT<Matrix12d> factor(given);
  other.given = factor.solve(moments.with_given.transpose()).transpose();
  other.covariance = moments.own - other.given * moments.with_given.transpose();
  symmetrize(other.covariance);
  const Matrix6d regular = other.covariance + kRounding * moments.own;
  if (factor.info() == Eigen::Success && Cholesky6(regular).ok()) return;
  other.given.setZero();
  other.covariance = moments.own;
  symmetrize(other.covariance);
}

}  // namespace

bool is_same_camera(const ObservationSource& a, const ObservationSource& b) {
  if (a.camera || b.camera) return a.camera == b.camera;
  const Eigen::Vector4d turn = a.body_camera.rotation().quaternion().coeffs();
  const Eigen::Vector4d other = b.body_camera.rotation().quaternion().coeffs();
  return (turn == other || turn == -other) &&
         a.body_camera.translation() == b.body_camera.translation();
}

void OtherCamera::follow(const SE3d& body_now, const SE3d& object, const Vector6d& mean_of_seeing) {
  // A correction of the world turns body and object alike.
  const SE3d turn(body_now.rotation() * body.rotation().inverse(), Eigen::Vector3d::Zero());
  given.leftCols<6>() = (given.leftCols<6>() * turn.inverse().adjoint()).eval();
  const SE3d place(SO3d(), object.translation());
  const SE3d by = object * (body_now * body_object).inverse();
  mean += on_error() * (place.inverse() * by * place).log();
  mean += on_seeing() * (mean_of_seeing - seeing);
  body = body_now;
  body_object = body_now.inverse() * object;
  seeing = mean_of_seeing;
}

Matrix6d SeenByRig::errors(const Eigen::MatrixXd& by_a, const Eigen::MatrixXd& by_b) const {
  const auto of_object = cross_.topRows<6>();
  const Matrix6d apart = pose_.covariance.topLeftCorner<6, 6>() - by_a * of_object.transpose() -
                         of_object * by_b.transpose() + by_a * rig_ * by_b.transpose();
  return to_place_ * apart * to_place_.transpose();
}

Matrix6d SeenByRig::slow_and_error(const Eigen::MatrixXd& by) const {
  const Matrix6d apart =
      pose_.covariance.bottomLeftCorner<6, 6>() - cross_.bottomRows<6>() * by.transpose();
  return apart * to_place_.transpose();
}

Eigen::MatrixXd SeenByRig::own(const ObservationSource& a) const {
  Eigen::MatrixXd by = joint_.seen_by(a);
  by.leftCols<6>().setZero();
  return by;
}

Matrix6d SeenByRig::errors(const ObservationSource& a, const ObservationSource& b) const {
  return errors(joint_.seen_by(a), joint_.seen_by(b));
}

Matrix6d SeenByRig::error_and_own(const ObservationSource& a) const {
  return errors(joint_.seen_by(a), own(a));
}

Matrix6d SeenByRig::slow_and_error(const ObservationSource& a) const {
  return slow_and_error(joint_.seen_by(a));
}

Matrix6d SeenByRig::slow_and_own(const ObservationSource& a) const {
  return slow_and_error(own(a));
}

OtherCamera other_camera(const ObservationSource& source, double correlation,
                         const Matrix6d& stationary) {
  OtherCamera other{.source = source, .covariance = (1.0 - correlation * correlation) * stationary};
  other.given.rightCols<6>() = correlation * Matrix6d::Identity();
  return other;
}

OtherMoments moments_before(const OtherCamera& other, const SeenByRig& before, bool released) {
  const ObservationSource& source = other.source;
  const Matrix6d error = before.errors(source, source);
  const Matrix6d with_slow = before.slow_and_error(source);
  const Matrix6d slow = before.slow();
  const Matrix6d error_after = released ? before.error_and_own(source) : error;
  const Matrix6d slow_after = released ? before.slow_and_own(source) : with_slow;
  OtherMoments moments;
  moments.own =
      other.given * pair_of(error, with_slow, slow) * other.given.transpose() + other.covariance;
  moments.with_given << other.on_error() * error_after + other.on_seeing() * slow_after,
      other.on_error() * with_slow.transpose() + other.on_seeing() * slow;
  return moments;
}

void decay(OtherCamera& other, const OtherMoments& before, const SeenByRig& after, double a,
           double correlation, const Matrix6d& stationary) {
  const double kept = a * a;
  const Matrix6d fresh = (1.0 - kept) * stationary;
  OtherMoments moments;
  moments.own = kept * before.own + fresh;
  moments.with_given << a * before.with_given.leftCols<6>(),
      kept * before.with_given.rightCols<6>() + correlation * fresh;
  regress(other, moments,
          pair_of(after.errors(other.source, other.source), a * after.slow_and_error(other.source),
                  kept * after.slow() + fresh));
  other.mean *= a;
  other.seeing *= a;
}

void decay(OtherCamera& other, double a, const Matrix6d& stationary) {
  other.mean *= a;
  other.seeing *= a;
  other.given.leftCols<6>() *= a;
  other.covariance = a * a * other.covariance + (1.0 - a * a) * stationary;
}

bool is_known(const OtherCamera& other, const SeenByRig& seen, const Matrix6d& stationary) {
  constexpr double kMostVariance = 4.0;  // times that of a slow error of which nothing is known
  const Matrix6d own = other.given *
                           pair_of(seen.errors(other.source, other.source),
                                   seen.slow_and_error(other.source), seen.slow()) *
                           other.given.transpose() +
                       other.covariance;
  const Cholesky6 factor(stationary);
  return factor.ok() && factor.solved_rows(own).diagonal().maxCoeff() < kMostVariance &&
         factor.whitened(other.mean).squaredNorm() < 6.0 * kMostVariance * kMostVariance;
}

void take_turns(std::vector<OtherCamera>& others, const OtherCamera& next,
                const ObservationSource& last, const SeenByRig& before) {
  const Matrix6d slow = before.slow();
  const Matrix6d with_next_error = before.slow_and_error(next.source);
  // Of the slow error of `next`, its own covariance, and that with b and the error of a camera.
  const Matrix6d own = next.given *
                           pair_of(before.errors(next.source, next.source), with_next_error, slow) *
                           next.given.transpose() +
                       next.covariance;
  const Matrix6d with_slow =
      next.on_error() * with_next_error.transpose() + next.on_seeing() * slow;
  const auto with_error = [&](const ObservationSource& of) -> Matrix6d {
    return next.on_error() * before.errors(next.source, of) +
           next.on_seeing() * before.slow_and_error(of);
  };
  // b given the error of a camera and the slow error of `next`.
  const auto given_next = [&](const ObservationSource& of) {
    OtherCamera left{.source = last, .mean = next.seeing};
    OtherMoments moments{slow, {}};
    moments.with_given << before.slow_and_error(of), with_slow.transpose();
    regress(left, moments, pair_of(before.errors(of, of), with_error(of), own));
    left.body = next.body;
    left.body_object = next.body_object;
    left.seeing = next.mean;
    return left;
  };
  for (OtherCamera& other : others) {
    const OtherCamera left = given_next(other.source);
    const Matrix6d on_seeing = other.on_seeing();
    other.given.rightCols<6>().setZero();
    other.given += on_seeing * left.given;
    other.covariance += on_seeing * left.covariance * on_seeing.transpose();
    symmetrize(other.covariance);
    other.seeing = next.mean;
  }
  others.push_back(given_next(last));
}

void rescale(OtherCamera& other, const Vector6d& factor, const Matrix6d& slow_map) {
  // e <- e + A (1 - f) (b - b0), b <- f b.
  const Matrix6d moved = slow_map * (Vector6d::Ones() - factor).asDiagonal();
  other.mean = other.mean.cwiseProduct(factor).eval();
  other.seeing = other.seeing.cwiseProduct(factor).eval();
  other.given.rightCols<6>() -= other.on_error() * moved;
  other.given = (factor.asDiagonal() * other.given).eval();
  other.given.rightCols<6>() =
      (other.given.rightCols<6>() * factor.cwiseInverse().asDiagonal()).eval();
  other.covariance = (factor.asDiagonal() * other.covariance * factor.asDiagonal()).eval();
}

}  // namespace posemix::internal
