// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cmath>

#include "posemix/base/linear.hpp"

namespace posemix::internal {

/// The Cholesky factor of a 6x6 covariance S = L L^T, of which the lower triangle is read. Like
/// Eigen::LLT<Matrix6d>, with loops of a length known at compile time, which Eigen leaves to its
/// kernels for any size. A direction in which rounding leaves no variance is taken as known: it
/// adds nothing to what is whitened or solved.
class Cholesky6 {
 public:
  explicit Cholesky6(const Matrix6d& s) {
    for (Eigen::Index j = 0; j < 6; ++j) {
      double pivot = s(j, j);
      for (Eigen::Index k = 0; k < j; ++k) pivot -= l_(j, k) * l_(j, k);
      const bool positive = pivot > 0.0;
      ok_ = ok_ && positive;
      l_(j, j) = positive ? std::sqrt(pivot) : 0.0;
      reciprocals_[j] = positive ? 1.0 / l_(j, j) : 0.0;
      for (Eigen::Index i = j + 1; i < 6; ++i) {
        double sum = s(i, j);
        for (Eigen::Index k = 0; k < j; ++k) sum -= l_(i, k) * l_(j, k);
        l_(i, j) = sum * reciprocals_[j];
      }
    }
  }

  /// Whether S is positive definite.
  bool ok() const { return ok_; }

  /// L.
  const Matrix6d& factor() const { return l_; }

  double log_det() const { return 2.0 * std::log(l_.diagonal().prod()); }

  /// L^-1 z.
  Vector6d whitened(const Vector6d& z) const {
    Vector6d x;
    for (Eigen::Index j = 0; j < 6; ++j) {
      double sum = z[j];
      for (Eigen::Index k = 0; k < j; ++k) sum -= l_(j, k) * x[k];
      x[j] = sum * reciprocals_[j];
    }
    return x;
  }

  /// X L^-T for X of six columns.
  template <class Derived>
  typename Derived::PlainObject whitened_rows(const Eigen::MatrixBase<Derived>& given) const {
    typename Derived::PlainObject x = given;
    for (Eigen::Index j = 0; j < 6; ++j) {
      for (Eigen::Index k = 0; k < j; ++k) x.col(j) -= x.col(k) * l_(j, k);
      x.col(j) *= reciprocals_[j];
    }
    return x;
  }

  /// X S^-1 for X of six columns.
  template <class Derived>
  typename Derived::PlainObject solved_rows(const Eigen::MatrixBase<Derived>& given) const {
    return after_whitening(whitened_rows(given));
  }

  /// X L^-1 for X of six columns.
  template <class Derived>
  typename Derived::PlainObject after_whitening(const Eigen::MatrixBase<Derived>& whitened) const {
    typename Derived::PlainObject x = whitened;
    for (Eigen::Index j = 5; j >= 0; --j) {
      for (Eigen::Index k = j + 1; k < 6; ++k) x.col(j) -= x.col(k) * l_(k, j);
      x.col(j) *= reciprocals_[j];
    }
    return x;
  }

  /// S^-1 z.
  Vector6d solved(const Vector6d& z) const { return solved_rows(z.transpose()).transpose(); }

 private:
  Matrix6d l_ = Matrix6d::Zero();
  std::array<double, 6> reciprocals_;
  bool ok_ = true;
};

}  // namespace posemix::internal
