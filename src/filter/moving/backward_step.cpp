// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "backward_step.hpp"

#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

namespace posemix::internal {
namespace {

/// Directions whose variance is below this part of those of the coordinates are known.
constexpr double kLeastVariance = 1e-12;

/// The inverse of a root L of a covariance P = L L^T, r x 18, where r is the rank of P: rows of
/// zeros, as those of a twist that there is not, are left out.
Eigen::MatrixXd inverse_root(const Matrix18d& p) {
  const Vector18d sds = p.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Vector18d scale = (sds.array() > 0.0).select(sds.cwiseInverse(), 0.0);
  const Matrix18d correlation = scale.asDiagonal() * p * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix18d> eigen(correlation);
  Eigen::Index known = 0;
  while (known < 18 && !(eigen.eigenvalues()[known] > kLeastVariance)) ++known;
  const Eigen::Index rank = 18 - known;
  return eigen.eigenvalues().tail(rank).cwiseSqrt().cwiseInverse().asDiagonal() *
         eigen.eigenvectors().rightCols(rank).transpose() * scale.asDiagonal();
}

/// Moves the mean, and takes `reduction` from the covariance, by Joseph's form with the factors
/// `gain`: as GaussianUpdate.
void correct(PlacedObject& object, const Vector18d& shift, const Matrix18d& reduction,
             const Vector18d& gain) {
  for (Eigen::Index k = 0; k < 18; ++k) {
    object.covariance.col(k).array() -=
        (gain.array() + gain[k] - gain.array() * gain[k]) * reduction.col(k).array();
  }
  const Vector18d moved = gain.cwiseProduct(shift);
  object.move(moved);
  // The covariance is of perturbations of the mean before: the inverse of
  // PlacedObject::transported.
  const Matrix6d jacobian = SE3d::left_jacobian(moved.head<6>());
  object.covariance.topRows<6>() = (jacobian * object.covariance.topRows<6>()).eval();
  object.covariance.leftCols<6>() = (object.covariance.leftCols<6>() * jacobian.transpose()).eval();
  symmetrize(object.covariance);
}

}  // namespace

PlacedObject smoothed_before(const PlacedObject& before, const Matrix18d& f,
                             const PlacedObject& predicted, const PlacedObject& smoothed,
                             const Vector18d& gain) {
  const Eigen::MatrixXd root = inverse_root(predicted.covariance);
  const Matrix18d g = before.covariance * f.transpose() * (root.transpose() * root);
  const Vector18d apart = smoothed.from(predicted);
  const Matrix18d change = predicted.covariance - smoothed.transported(apart.head<6>());
  PlacedObject result = before;
  correct(result, g * apart, g * change * g.transpose(), gain);
  return result;
}

LaterEvidence::LaterEvidence(const PlacedObject& without, const PlacedObject& with)
    : without_(without) {
  const Eigen::MatrixXd root = inverse_root(without.covariance);
  if (root.rows() == 0) return;  // all is known, and nothing later tells more
  const Vector18d apart = with.from(without);
  Eigen::MatrixXd ratio = root * with.transported(apart.head<6>()) * root.transpose();
  symmetrize(ratio);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(ratio);
  constexpr double kLeastRatio = 1e-12;
  const Eigen::VectorXd variance = eigen.eigenvalues().cwiseMax(kLeastRatio);
  to_y_ = eigen.eigenvectors().transpose() * root;
  // Evidence of the information Pi moves a mean by a variance of 1 - 1 / (1 + Pi). What is beyond,
  // and what became wider, is no Gaussian evidence, as after an update by a mixture.
  constexpr double kMostDeviations = 3.0;
  const Eigen::ArrayXd narrower = variance.cwiseMin(1.0);
  const Eigen::ArrayXd most = kMostDeviations * (1.0 - narrower).sqrt();
  const Eigen::ArrayXd moved = (to_y_ * apart).array();
  const Eigen::ArrayXd told = moved.min(most).max(-most);
  pi_ = 1.0 / narrower - 1.0;
  eta_ = told / narrower;
  rest_ = moved - told;
  widening_ = (variance.array() - 1.0).cwiseMax(0.0);
}

LaterEvidence::Result LaterEvidence::applied_to(const PlacedObject& source,
                                                const PlacedObject& converted, const Matrix18d& f,
                                                const Vector18d& gain) const {
  if (pi_.size() == 0) return {source, 0.0};
  const Vector18d apart = converted.from(without_);
  const Eigen::VectorXd mean = to_y_ * apart;
  const Eigen::MatrixXd v = to_y_ * converted.transported(apart.head<6>()) * to_y_.transpose();
  Matrix18d to_tangent = f;
  to_tangent.topRows<6>() = SE3d::left_jacobian_inverse(apart.head<6>()) * f.topRows<6>();
  const Eigen::MatrixXd cross = source.covariance * to_tangent.transpose() * to_y_.transpose();

  // (I + Pi V)^-1 = I - R (I + R V R)^-1 R V with R = Pi^(1/2)
  const Eigen::VectorXd r = pi_.cwiseSqrt();
  Eigen::MatrixXd a = r.asDiagonal() * v * r.asDiagonal();
  a.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> factor(a);
  Eigen::MatrixXd information = factor.solve(Eigen::MatrixXd(r.asDiagonal()));
  information = (r.asDiagonal() * information).eval();
  const Eigen::VectorXd g = eta_ - pi_.cwiseProduct(mean);
  // What is no Gaussian evidence moves a source of the same width, V = I, by as much.
  Eigen::MatrixXd wider = v;
  wider.diagonal().array() += 1.0;
  const Eigen::MatrixXd rigid =
      2.0 * Eigen::LLT<Eigen::MatrixXd>(wider).solve(cross.transpose()).transpose();

  Result result{source, 0.0};
  correct(
      result.object, cross * (g - information * (v * g)) + rigid * rest_,
      cross * information * cross.transpose() - rigid * widening_.asDiagonal() * rigid.transpose(),
      gain);
  result.log_likelihood = eta_.dot(mean) - 0.5 * mean.dot(pi_.cwiseProduct(mean)) +
                          0.5 * g.dot(v * (g - information * (v * g))) - 0.5 * log_det(factor);
  return result;
}

}  // namespace posemix::internal
