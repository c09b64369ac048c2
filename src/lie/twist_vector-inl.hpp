// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Symmetric and triangular 6x6 matrices, at most eight at a time, one per lane. Included once for
// every set of vector instructions.
#if defined(POSEMIX_TWIST_VECTOR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_TWIST_VECTOR_INL
#undef POSEMIX_TWIST_VECTOR_INL
#else
#define POSEMIX_TWIST_VECTOR_INL
#endif

#include <cstddef>

#include "base/vector_targets.hpp"
#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"
#include "lie/pose_vector-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

/// Position of entry (row, column), row >= column, of a lower triangle by columns.
constexpr std::size_t lower_index(std::size_t row, std::size_t column) {
  return 6 * column - column * (column + 1) / 2 + row;
}

/// The lower triangle of symmetric matrices, by columns.
struct Symmetric {
  V m[21];

  HWY_INLINE V at(std::size_t row, std::size_t column) const {
    return row >= column ? m[lower_index(row, column)] : m[lower_index(column, row)];
  }
};

/// Triangular matrices, by columns, and the reciprocals of their diagonal.
struct Lower {
  V m[21];
  V reciprocals[6];
};

/// w v v^T.
HWY_INLINE Symmetric outer_product(V w, const Tangents& v) {
  const V x[] = {v.phi.x, v.phi.y, v.phi.z, v.rho.x, v.rho.y, v.rho.z};
  Symmetric result;
  POSEMIX_UNROLL
  for (std::size_t c = 0; c < 6; ++c) {
    const V scaled = hn::Mul(w, x[c]);
    POSEMIX_UNROLL
    for (std::size_t r = 0; r < 6; ++r) {
      if (r >= c) result.m[lower_index(r, c)] = hn::Mul(scaled, x[r]);
    }
  }
  return result;
}

/// sum += w P.
HWY_INLINE void add_scaled(V w, const Symmetric& p, Symmetric& sum) {
  POSEMIX_UNROLL
  for (std::size_t k = 0; k < 21; ++k) sum.m[k] = hn::MulAdd(w, p.m[k], sum.m[k]);
}

/// Entry (row, column) of [a 0; b a].
HWY_INLINE V entry(const TwistMatrices& j, std::size_t row, std::size_t column) {
  return row < 3 ? j.a.m[3 * column + row]
                 : (column < 3 ? j.b.m[3 * column + row - 3] : j.a.m[3 * (column - 3) + row - 3]);
}

/// J P J^T.
HWY_INLINE Symmetric congruence(const TwistMatrices& j, const Symmetric& p) {
  Symmetric result;
  POSEMIX_UNROLL
  for (std::size_t c = 0; c < 6; ++c) {
    // Column c of P J^T.
    V column[6];
    POSEMIX_UNROLL
    for (std::size_t r = 0; r < 6; ++r) {
      V sum = hn::Mul(p.at(r, 0), entry(j, c, 0));
      POSEMIX_UNROLL
      for (std::size_t k = 1; k < 6; ++k) {
        if (c >= 3 || k < 3) sum = hn::MulAdd(p.at(r, k), entry(j, c, k), sum);
      }
      column[r] = sum;
    }
    POSEMIX_UNROLL
    for (std::size_t r = 0; r < 6; ++r) {
      if (r < c) continue;
      V sum = hn::Mul(entry(j, r, 0), column[0]);
      POSEMIX_UNROLL
      for (std::size_t k = 1; k < 6; ++k) {
        if (r >= 3 || k < 3) sum = hn::MulAdd(entry(j, r, k), column[k], sum);
      }
      result.m[lower_index(r, c)] = sum;
    }
  }
  return result;
}

/// L with S = L L^T; entries that are not numbers where S is not positive definite.
HWY_INLINE Lower cholesky(const Symmetric& s) {
  Lower l;
  POSEMIX_UNROLL
  for (std::size_t c = 0; c < 6; ++c) {
    POSEMIX_UNROLL
    for (std::size_t r = 0; r < 6; ++r) {
      if (r < c) continue;
      V sum = s.m[lower_index(r, c)];
      POSEMIX_UNROLL
      for (std::size_t k = 0; k < 6; ++k) {
        if (k < c) sum = hn::NegMulAdd(l.m[lower_index(r, k)], l.m[lower_index(c, k)], sum);
      }
      if (r == c) {
        l.m[lower_index(c, c)] = hn::Sqrt(sum);
        l.reciprocals[c] = hn::Div(set(1.0), l.m[lower_index(c, c)]);
      } else {
        l.m[lower_index(r, c)] = hn::Mul(sum, l.reciprocals[c]);
      }
    }
  }
  return l;
}

/// log |L L^T|. The product of six entries does not overflow between 1e-50 and 1e50.
HWY_INLINE V log_det(const Lower& l) {
  V product = l.m[0];
  POSEMIX_UNROLL
  for (std::size_t c = 1; c < 6; ++c) product = hn::Mul(product, l.m[lower_index(c, c)]);
  return hn::Mul(set(2.0), hn::Log(D(), product));
}

/// L^-1 v.
HWY_INLINE Tangents solved(const Lower& l, const Tangents& v) {
  const V given[] = {v.phi.x, v.phi.y, v.phi.z, v.rho.x, v.rho.y, v.rho.z};
  V x[6];
  POSEMIX_UNROLL
  for (std::size_t r = 0; r < 6; ++r) {
    V sum = given[r];
    POSEMIX_UNROLL
    for (std::size_t k = 0; k < 6; ++k) {
      if (k < r) sum = hn::NegMulAdd(l.m[lower_index(r, k)], x[k], sum);
    }
    x[r] = hn::Mul(sum, l.reciprocals[r]);
  }
  return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
}

/// L^-1 M for two triangular matrices, which is triangular; its reciprocals are not set.
HWY_INLINE Symmetric solved(const Lower& l, const Lower& m) {
  Symmetric x;
  POSEMIX_UNROLL
  for (std::size_t c = 0; c < 6; ++c) {
    POSEMIX_UNROLL
    for (std::size_t r = 0; r < 6; ++r) {
      if (r < c) continue;
      V sum = m.m[lower_index(r, c)];
      POSEMIX_UNROLL
      for (std::size_t k = 0; k < 6; ++k) {
        if (k >= c && k < r)
          sum = hn::NegMulAdd(l.m[lower_index(r, k)], x.m[lower_index(k, c)], sum);
      }
      x.m[lower_index(r, c)] = hn::Mul(sum, l.reciprocals[r]);
    }
  }
  return x;
}

HWY_INLINE V squared_norm(const Tangents& v) {
  return hn::Add(dot(v.phi, v.phi), dot(v.rho, v.rho));
}

/// The sum of the squares of a triangular matrix.
HWY_INLINE V squared_norm(const Symmetric& lower) {
  V sum = hn::Mul(lower.m[0], lower.m[0]);
  POSEMIX_UNROLL
  for (std::size_t k = 1; k < 21; ++k) sum = hn::MulAdd(lower.m[k], lower.m[k], sum);
  return sum;
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
