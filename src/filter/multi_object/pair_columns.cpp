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

/// A variance given everything before, relative to the largest one, below which a covariance is
/// nearly singular: the factor has lost digits then, and poses that rounding takes anywhere are
/// caught by RegularFactor.
constexpr double kLeastVariance = 1e-8;

/// The factor by which (I + Phi N)^-1 may be larger than the identity, and lose digits.
constexpr double kMostAmplified = 1e4;

PairWorkspace& workspace() {
  static thread_local PairWorkspace kept;
  return kept;
}

}  // namespace

template <int Own>
PairUpdate<Own>::PairUpdate(const MatrixXd& covariance, Index object, const Explanation& leading,
                            const GainFactors& gain)
    : work_(workspace()), object_(object), gain_(gain) {
  Eigen::Matrix<double, Own, 6> h;
  h.template topRows<6>().setIdentity();
  for (const Innovation& one : leading.innovations) {
    if (!(one.weight > 0.0)) continue;
    if constexpr (Own > 6) h.template bottomRows<6>() = one.slow_map.transpose();
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
  if constexpr (Own > 6) f.rightCols<6>() = covariance.middleCols<6>(object + 6);
  mean_ = product(seen(), gain_.camera * moved_);
  mean_.segment<Own>(object) = seen().template middleRows<Own>(object) * moved_;
  if constexpr (Own > 6) mean_.segment<6>(object + 6) *= gain_.slow;
}

template <int Own>
typename PairUpdate<Own>::Square PairUpdate<Own>::change(double row_gain,
                                                         double column_gain) const {
  const double both = row_gain * column_gain;
  return both * spread_ - (row_gain + column_gain - both) * reduction_;
}

template <int Own>
typename PairUpdate<Own>::Square PairUpdate<Own>::object_change() const {
  const Square own = seen().template middleRows<Own>(object_);
  Square result;
  result.template topRows<6>() = own.template topRows<6>().lazyProduct(change(1.0, gain_.camera));
  if constexpr (Own > 6) {
    result.template bottomRows<6>() =
        own.template bottomRows<6>().lazyProduct(change(gain_.slow, gain_.camera));
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
void PairUpdate<Own>::set_object(const Wide& l, const Square& own, MatrixXd& covariance) {
  // The columns F L^T.
  MatrixXd& rows = work_.rows;
  rows.setZero(covariance.rows(), Own);
  subtract_product(rows, work_.columns, Wide(-l));
  rows.middleRows<Own>(object_) = 0.5 * (own + own.transpose());
  covariance.middleCols<Own>(object_) = rows;
  covariance.middleRows<Own>(object_) = rows.transpose();
}

template <int Own>
void PairUpdate<Own>::take_leading(MatrixXd& covariance) {
  const Square own = object_covariance(covariance);
  // The rows of the object are [I I 0; 0 0 I] F^T before, and change by N.
  Wide l = Wide::Zero();
  l.template topLeftCorner<6, 6>().setIdentity();
  l.template rightCols<Own>() = Square::Identity() + object_change();
  MatrixXd& weighted = work_.weighted;
  weighted.setZero(covariance.rows(), Own);
  subtract_product(weighted, seen(), change(gain_.camera, gain_.camera));
  subtract_lower_product(covariance, seen(), weighted);
  mirror_lower_in_place(covariance);
  set_object(l, own, covariance);
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
  const double largest = covariance.diagonal().maxCoeff();
  if (!factor_in_place(ordered)) return false;
  const double least = ordered.diagonal().minCoeff();
  if (!(least * least > kLeastVariance * largest)) return false;
  const Square l = ordered.bottomRightCorner<Own, Own>().template triangularView<Eigen::Lower>();
  own = l.lazyProduct(l.transpose());
  return true;
}

template <int Own>
bool PairUpdate<Own>::take_mixture(double weight, const Vector6d& camera_mean,
                                   const Matrix6d& camera, MatrixXd& covariance) {
  Square given;
  if (!given_the_rest(covariance, given)) return false;
  const MatrixXd& f = work_.columns;
  const double g = gain_.camera;
  const Square n_gg = change(g, g);
  // Phi = F_s^T B_ss^-1 F_s, eq. (28).
  All phi;
  phi.template topRows<6>() = f.topRows<6>();
  phi.template bottomRows<Own>() = f.middleRows<Own>(object_);
  phi.template middleRows<6>(6) -= f.topRows<6>();
  phi.template bottomRightCorner<Own, Own>() -= given;
  // The object's regression under the leading hypothesis, C F_s^T B_ss^-1 with C = [[I; 0] C_y],
  // eq. (29).
  const Square phi_yn = phi.template bottomRightCorner<Own, Own>().lazyProduct(n_gg);
  const Square inverse = Eigen::PartialPivLU<Square>(Square::Identity() + phi_yn).inverse();
  if (!(inverse.cwiseAbs().maxCoeff() < kMostAmplified)) return false;
  Square direct = Square::Identity() + object_change();
  direct.template topRows<6>() -= phi.template topRightCorner<6, Own>().lazyProduct(n_gg);
  const Square c_y = direct.lazyProduct(inverse);
  // Everything but the object: B_ss + F_s Q F_s^T, eq. (27).
  const Cholesky6 prior(f.topLeftCorner<6, 6>());
  Eigen::Matrix<double, kAll, 1> apart;
  apart.template head<6>() = prior.solved(camera_mean);
  apart.template tail<Own>() = -g * moved_;
  All q = weight * (1.0 - weight) * (apart * apart.transpose());
  const Matrix6d solved = prior.solved_rows(Matrix6d(camera - f.topLeftCorner<6, 6>()));
  q.template topLeftCorner<6, 6>() += weight * prior.solved_rows(Matrix6d(solved.transpose()));
  q.template bottomRightCorner<Own, Own>() += (1.0 - weight) * n_gg;
  // The moments of the mixture, eq. (30).
  Wide c_phi = c_y.lazyProduct(phi.template bottomRows<Own>());
  c_phi.template topRows<6>() += phi.template topRows<6>();
  const Wide c_phi_q = c_phi.lazyProduct(q);
  Wide difference = c_phi_q;
  difference.template rightCols<Own>() -= c_phi.template rightCols<Own>().lazyProduct(n_gg);
  const Square own = object_covariance(covariance) + difference.lazyProduct(c_phi.transpose());
  Wide l = c_phi_q;
  l.template topLeftCorner<6, 6>() += Matrix6d::Identity();
  l.template rightCols<Own>() += c_y;
  const Eigen::Matrix<double, kAll, 1> shift = weight * apart;
  const Seen own_mean = mean_.segment<Own>(object_) + c_phi * shift;
  mean_ += product(f, shift);
  mean_.segment<Own>(object_) = own_mean;
  MatrixXd& weighted = work_.weighted;
  weighted.setZero(covariance.rows(), kAll);
  subtract_product(weighted, f, q);
  subtract_lower_product(covariance, f, weighted);
  mirror_lower_in_place(covariance);
  set_object(l, own, covariance);
  return true;
}

template <int Own>
Matrix6d PairUpdate<Own>::camera_reduction() const {
  const Eigen::Matrix<double, 6, Own> d = seen().template topRows<6>();
  return d.lazyProduct(reduction_).eval().lazyProduct(d.transpose());
}

template <int Own>
Eigen::Matrix<double, Eigen::Dynamic, 6> PairUpdate<Own>::reduction_with_camera() const {
  const Eigen::Matrix<double, Own, 6> with_camera =
      reduction_.lazyProduct(seen().template topRows<6>().transpose());
  return seen() * with_camera;
}

template class PairUpdate<6>;
template class PairUpdate<12>;

}  // namespace posemix::internal
