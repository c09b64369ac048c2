// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "oracle.hpp"

#include <limits>

#include <Eigen/LU>

namespace posemix::oracle {
namespace {

Matrix hat(const Vector& xi) {
  if (xi.size() == 3) return cross(xi);
  Matrix m = Matrix::Zero(4, 4);
  m.topLeftCorner(3, 3) = cross(xi.head(3));
  m.topRightCorner(3, 1) = xi.tail(3);
  return m;
}

Matrix ad(const Vector& xi) {
  if (xi.size() == 3) return cross(xi);
  Matrix m = Matrix::Zero(6, 6);
  m.topLeftCorner(3, 3) = m.bottomRightCorner(3, 3) = cross(xi.head(3));
  m.bottomLeftCorner(3, 3) = cross(xi.tail(3));
  return m;
}

/// sum m^n / (n + shift)! until the terms vanish.
Matrix power_series(const Matrix& m, int shift) {
  const Real negligible =
      std::numeric_limits<Real>::epsilon() * std::numeric_limits<Real>::epsilon();
  Matrix term = Matrix::Identity(m.rows(), m.cols());
  Matrix sum = term;
  for (int n = 1; n < 1000; ++n) {
    term = product(term, m) / Real(n + shift);
    sum += term;
    if (term.cwiseAbs().maxCoeff() <= negligible) break;
  }
  return sum;
}

}  // namespace

Matrix cross(const Vector& v) {
  Matrix m = Matrix::Zero(3, 3);
  m(2, 1) = v(0), m(1, 2) = -v(0);
  m(0, 2) = v(1), m(2, 0) = -v(1);
  m(1, 0) = v(2), m(0, 1) = -v(2);
  return m;
}

Matrix product(const Matrix& a, const Matrix& b) { return a.lazyProduct(b); }

Matrix exp(const Vector& xi) {
  int halvings = 0;
  for (Real size = xi.head(3).norm(); size > Real(1); size /= Real(2)) ++halvings;
  Matrix m = power_series(hat(xi) / pow(Real(2), halvings), 0);
  for (int i = 0; i < halvings; ++i) m = product(m, m);
  return m;
}

Matrix left_jacobian(const Vector& xi) { return power_series(ad(xi), 1); }

Matrix inverse(const Matrix& m) { return m.fullPivLu().inverse(); }

Real log_abs_det(const Matrix& m) { return log(Real(abs(Real(m.fullPivLu().determinant())))); }

Matrix rotation(const Vector& q) {
  const Real norm = q.norm();
  const Matrix v = cross(Vector(q.head(3)) / norm);
  return Matrix::Identity(3, 3) + Real(2) * (q(3) / norm) * v + Real(2) * product(v, v);
}

Vector log(const Vector& q) {
  Vector v = q.head(3);
  const Real length = v.norm();
  if (length == Real(0)) return v;
  const Real first = v(0) != Real(0) ? v(0) : (v(1) != Real(0) ? v(1) : v(2));
  if (q(3) < Real(0) || (q(3) == Real(0) && first < Real(0))) v = -v;
  return v * (Real(2) * atan2(length, Real(abs(q(3)))) / length);
}

Vector log(const Vector& q, const Vector& t) {
  Vector xi(6);
  xi.head(3) = log(q);
  xi.tail(3) = left_jacobian(xi.head(3)).fullPivLu().solve(t);
  return xi;
}

}  // namespace posemix::oracle
