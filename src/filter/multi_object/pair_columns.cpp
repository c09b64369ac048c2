// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "pair_columns.hpp"

#include <algorithm>

#include <Eigen/LU>

#include "base/cholesky6.hpp"
#include "base/dense_kernels.hpp"

namespace posemix::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// The part of a variance that is left given everything before, below which a covariance is nearly
/// singular: the factor has lost digits then, and poses that rounding takes anywhere are caught by
/// RegularFactor.
constexpr double kLeastPivot = 1e-8;

/// The factor by which (I + Phi N)^-1 may be larger than the identity, and lose digits.
constexpr double kMostAmplified = 1e4;

const Innovation& heaviest(const KeptVector<Innovation>& innovations) {
  return *std::max_element(innovations.begin(), innovations.end(),
                           [](const auto& a, const auto& b) { return a.weight < b.weight; });
}

template <int Own>
PairWorkspace& workspace() {
  static thread_local PairWorkspace kept;
  return kept;
}

}  // namespace

template <int Own>
PairUpdate<Own>::PairUpdate(const MatrixXd& covariance, Index object, const Explanation& leading,
                            const GainFactors& gain)
    : work_(workspace<Own>()),
      object_(object),
      gain_(gain),
      main_(heaviest(leading.innovations)),
      whitening_(main_.covariance) {
  if (!whitening_.ok()) return;
  // h_c in whitened coordinates, [L_0^T; (A_c - A_0)^T].
  Eigen::Matrix<double, Own, 6> h;
  h.template topRows<6>() = whitening_.factor().transpose();
  for (const Innovation& one : leading.innovations) {
    if (!(one.weight > 0.0)) continue;
    if constexpr (Own > 6) h.template bottomRows<6>() = (one.slow_map - main_.slow_map).transpose();
    const Cholesky6 s(one.covariance);
    const Eigen::Matrix<double, Own, 6> white = s.whitened_rows(h);
    const Seen u = white * s.whitened(one.residual);
    moved_ += one.weight * u;
    reduction_ += one.weight * white.lazyProduct(white.transpose());
    spread_ += one.weight * (u * u.transpose());
  }
  spread_ -= moved_ * moved_.transpose();

  MatrixXd& f = work_.columns;
  f.resize(covariance.rows(), kAll);
  f.leftCols<6>() = covariance.leftCols<6>();
  set_difference(f.middleCols<6>(6), covariance.middleCols<6>(object), covariance.leftCols<6>());
  if constexpr (Own > 6) {
    f.rightCols<6>() = covariance.middleCols<6>(object + 6);
    const Matrix6d less = -main_.slow_map;
    subtract_product(f.middleCols<6>(6), f.rightCols<6>(), less);
  }
  solve_transposed_from_right(whitening_.factor(), f.middleCols<6>(6));
  Eigen::VectorXd& mean = work_.mean;
  const Seen moved = gain_.camera * moved_;
  set_product(mean, seen(), moved);
  mean.segment<Own>(object) = seen().template middleRows<Own>(object) * moved_;
  if constexpr (Own > 6) mean.segment<6>(object + 6) *= gain_.slow;
}

template <int Own>
typename PairUpdate<Own>::Wide PairUpdate<Own>::whitened(const Wide& rows) const {
  Wide result = rows;
  Eigen::Matrix<double, 6, kAll> detected = rows.template topRows<6>();
  if constexpr (Own > 6) detected += main_.slow_map.lazyProduct(rows.template bottomRows<6>());
  result.template topRows<6>() = whitening_.whitened_rows(detected.transpose().eval()).transpose();
  return result;
}

template <int Own>
typename PairUpdate<Own>::Square PairUpdate<Own>::in_whitened_columns(const Square& m) const {
  Square result = m;
  Eigen::Matrix<double, Own, 6> detected = m.template leftCols<6>();
  if constexpr (Own > 6)
    detected += m.template rightCols<6>().lazyProduct(main_.slow_map.transpose());
  result.template leftCols<6>() = whitening_.whitened_rows(detected);
  return result;
}

template <int Own>
typename PairUpdate<Own>::Square PairUpdate<Own>::change(double row_gain,
                                                         double column_gain) const {
  const double both = row_gain * column_gain;
  return both * spread_ - (row_gain + column_gain - both) * reduction_;
}

template <int Own>
typename PairUpdate<Own>::Square PairUpdate<Own>::object_change(const Square& less) const {
  const Square own = seen().template middleRows<Own>(object_);
  Square result;
  result.template topRows<6>() =
      own.template topRows<6>().lazyProduct(Square(change(1.0, gain_.camera) - less));
  if constexpr (Own > 6) {
    result.template bottomRows<6>() =
        own.template bottomRows<6>().lazyProduct(Square(change(gain_.slow, gain_.camera) - less));
  }
  return result;
}

template <int Own>
typename PairUpdate<Own>::Square PairUpdate<Own>::object_covariance(
    const MatrixXd& covariance) const {
  const Square rows = seen().template middleRows<Own>(object_);
  Square own = covariance.block<Own, Own>(object_, object_);
  const double gains[] = {1.0, gain_.slow};
  for (Index i = 0; i < Own; i += 6) {
    for (Index k = 0; k < Own; k += 6) {
      const Eigen::Matrix<double, 6, Own> left =
          rows.template middleRows<6>(i).lazyProduct(change(gains[i / 6], gains[k / 6]));
      own.template block<6, 6>(i, k) +=
          left.lazyProduct(rows.template middleRows<6>(k).transpose());
    }
  }
  return own;
}

template <int Own>
void PairUpdate<Own>::change_covariance(const ConstMatrixRef& columns,
                                        const ConstMatrixRef& weighted,
                                        const ConstMatrixRef& object, const Square& own,
                                        MatrixXd& covariance) {
  MatrixXd& changed = work_.object;
  changed = covariance.middleCols<Own>(object_);
  subtract_product(changed, columns, object);
  changed.middleRows<Own>(object_) = 0.5 * (own + own.transpose());
  subtract_lower_product(covariance, columns, weighted);
  mirror_lower_in_place(covariance);
  covariance.middleCols<Own>(object_) = changed;
  covariance.middleRows<Own>(object_) = changed.transpose();
}

template <int Own>
void PairUpdate<Own>::take_leading(MatrixXd& covariance) {
  const Square own = object_covariance(covariance);
  work_.weighted.resize(covariance.rows(), kAll);
  auto weighted = work_.weighted.template leftCols<Own>();
  weighted.setZero();
  subtract_product(weighted, seen(), change(gain_.camera, gain_.camera));
  const Square object = -object_change(Square::Zero());
  change_covariance(seen(), weighted, object, own, covariance);
}

template <int Own>
bool PairUpdate<Own>::given_the_rest(const MatrixXd& covariance, Square& own) {
  const Index n = covariance.rows();
  const Index rest = n - object_ - Own;
  MatrixXd& ordered = work_.ordered;
  ordered.resize(n, n);
  // The lower triangle, column by column, with the object behind all else.
  const auto copy_column = [&](Index from, Index to) {
    const double* const column = covariance.data() + from * n;
    double* const target = ordered.data() + to * n;
    std::copy_n(column, object_, target);
    std::copy_n(column + object_ + Own, rest, target + object_);
    std::copy_n(column + object_, Own, target + n - Own);
  };
  for (Index k = 0; k < object_; ++k) copy_column(k, k);
  for (Index k = 0; k < rest; ++k) copy_column(object_ + Own + k, object_ + k);
  for (Index k = 0; k < Own; ++k) copy_column(object_ + k, n - Own + k);
  Eigen::VectorXd& variances = work_.variances;
  variances = ordered.diagonal();
  if (!factor_in_place(ordered)) return false;
  const double least =
      ordered.diagonal().array().square().cwiseQuotient(variances.array()).minCoeff();
  if (!(least > kLeastPivot)) return false;
  const Square l = ordered.bottomRightCorner<Own, Own>().template triangularView<Eigen::Lower>();
  own = l.lazyProduct(l.transpose());
  return true;
}

template <int Own>
typename PairUpdate<Own>::All PairUpdate<Own>::weighting(
    double weight, const Eigen::Matrix<double, kAll, 1>& apart, const Cholesky6& prior,
    const Matrix6d& camera_change, const Square& n_gg) const {
  All q = weight * (1.0 - weight) * (apart * apart.transpose());
  const Matrix6d whitened_once = prior.whitened_rows(camera_change);
  q.template topLeftCorner<6, 6>() +=
      weight * prior.whitened_rows(Matrix6d(whitened_once.transpose()));
  q.template bottomRightCorner<Own, Own>() += (1.0 - weight) * n_gg;
  return q;
}

/// The moments of the mixture, eq. (30).
template <int Own>
void PairUpdate<Own>::take_moments(const Eigen::Matrix<double, kAll, 1>& shift, const All& q,
                                   const Wide& c_phi, const Square& c_y, MatrixXd& covariance) {
  const MatrixXd& f = work_.columns;
  Wide l = c_phi.lazyProduct(q);
  Wide difference = l;
  difference.template rightCols<Own>() -=
      c_phi.template rightCols<Own>().lazyProduct(change(gain_.camera, gain_.camera));
  const Square own = object_covariance(covariance) + difference.lazyProduct(c_phi.transpose());
  l.template rightCols<Own>() += c_y;
  Eigen::VectorXd& mean = work_.mean;
  const Seen own_mean = mean.segment<Own>(object_) + c_phi * shift;
  set_product(work_.moved, f, shift);
  mean += work_.moved;
  mean.segment<Own>(object_) = own_mean;
  MatrixXd& weighted = work_.weighted;
  weighted.setZero(covariance.rows(), kAll);
  subtract_product(weighted, f, q);
  const Wide object = -l;
  change_covariance(f, weighted, object, own, covariance);
}

template <int Own>
bool PairUpdate<Own>::take_mixture(double weight, const Vector6d& camera_mean,
                                   const Matrix6d& camera, MatrixXd& covariance) {
  const Matrix6d before = covariance.topLeftCorner<6, 6>();
  const Cholesky6 prior(before);
  Square given;
  if (!prior.ok() || !given_the_rest(covariance, given)) return false;
  MatrixXd& f = work_.columns;
  solve_transposed_from_right(prior.factor(), f.leftCols<6>());
  const double g = gain_.camera;
  const Square n_gg = change(g, g);
  // Rows of the object in F, of everything but what is its own, and those of y in Phi, eq. (28).
  const Square given_in_columns = in_whitened_columns(given);
  Wide known = f.middleRows<Own>(object_);
  known.template rightCols<Own>() -= given_in_columns;
  Wide phi_y = known;
  phi_y.template topRows<6>() -= f.topRows<6>();
  phi_y = whitened(phi_y);
  const Square phi_n = phi_y.template rightCols<Own>().lazyProduct(n_gg);
  const Square inverse = Eigen::PartialPivLU<Square>(Square::Identity() + phi_n).inverse();
  if (!(inverse.cwiseAbs().maxCoeff() < kMostAmplified)) return false;
  // The object's regression under the leading hypothesis, C - E, eq. (29).
  const Square direct = object_change(n_gg) + given_in_columns.lazyProduct(n_gg);
  const Square c_y = direct.lazyProduct(inverse);
  Eigen::Matrix<double, kAll, 1> apart;
  apart.template head<6>() = prior.whitened(camera_mean);
  apart.template tail<Own>() = -g * moved_;
  const All q = weighting(weight, apart, prior, camera - before, n_gg);
  take_moments(weight * apart, q, known + c_y.lazyProduct(phi_y), c_y, covariance);
  return true;
}

template <int Own>
Matrix6d PairUpdate<Own>::camera_reduction() const {
  const Eigen::Matrix<double, 6, Own> d = seen().template topRows<6>();
  return d.lazyProduct(reduction_).eval().lazyProduct(d.transpose());
}

template <int Own>
void PairUpdate<Own>::set_reduction_with_camera(MatrixRef rows) const {
  const Eigen::Matrix<double, Own, 6> with_camera =
      reduction_.lazyProduct(seen().template topRows<6>().transpose());
  rows.noalias() = seen() * with_camera;
}

template class PairUpdate<6>;
template class PairUpdate<12>;

}  // namespace posemix::internal
