// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "base/dense_kernels.hpp"

#include <array>
#include <cmath>

#include "base/vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dense_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "base/dense_columns-inl.hpp"
#include "base/transpose-inl.hpp"
#include "base/vector_dispatch.hpp"
#include "base/vectors-inl.hpp"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

void subtract_product(double* c, std::size_t stride_c, const double* a, std::size_t stride_a,
                      const double* b, std::size_t stride_b, std::size_t rows, std::size_t columns,
                      std::size_t depth) {
  for (std::size_t j = 0; j < columns; j += kColumns)
    subtract_columns(rows, a, stride_a, {b + j, 1, stride_b}, depth, c + j * stride_c, stride_c);
}

/// The lower triangle of C = P - A B^T, and some entries above it. P may be C.
void subtract_lower_product(const double* p, std::size_t stride_p, const double* a,
                            std::size_t stride_a, const double* b, std::size_t stride_b,
                            std::size_t size, std::size_t depth, double* c, std::size_t stride_c) {
  for (std::size_t j = 0; j < size; j += kColumns) {
    subtract_columns(size - j, a + j, stride_a, {b + j, 1, stride_b}, depth, p + j + j * stride_p,
                     stride_p, c + j + j * stride_c, stride_c);
  }
}

/// The factor of a block of six, in its place, and the reciprocals of its diagonal. One column
/// waits for a division of the one before, not for its root.
HWY_INLINE bool factor_block(double* s, std::size_t stride,
                             std::array<double, kColumns>& reciprocals) {
  POSEMIX_UNROLL
  for (std::size_t j = 0; j < kColumns; ++j) {
    double* const column = s + j * stride;
    const double pivot = column[j];
    if (!(pivot > 0.0)) return false;
    const double inverse = 1.0 / pivot;
    for (std::size_t k = j + 1; k < kColumns; ++k) {
      const double factor = column[k] * inverse;
      for (std::size_t i = k; i < kColumns; ++i) s[i + k * stride] -= column[i] * factor;
    }
    const double root = std::sqrt(pivot);
    reciprocals[j] = 1.0 / root;
    column[j] = root;
    for (std::size_t i = j + 1; i < kColumns; ++i) column[i] *= reciprocals[j];
  }
  return true;
}

/// A block of six of L and the reciprocals of its diagonal.
struct Triangle {
  const double* l;
  std::size_t stride;
  std::array<double, kColumns> reciprocals;

  HWY_INLINE V at(std::size_t row, std::size_t column) const {
    return hn::Set(D(), l[row + column * stride]);
  }
};

HWY_INLINE Triangle triangle_of(const double* l, std::size_t stride) {
  Triangle result{l, stride, {}};
  POSEMIX_UNROLL
  for (std::size_t j = 0; j < kColumns; ++j) result.reciprocals[j] = 1.0 / l[j + j * stride];
  return result;
}

/// Calls tile(access, row) for all vectors of rows.
template <class Tile>
HWY_INLINE void for_rows(std::size_t rows, const Tile& tile) {
  std::size_t row = 0;
  for (; row + kLanes <= rows; row += kLanes) tile(Whole(), row);
  if (row < rows) tile(Part(rows - row), row);
}

/// Six columns of X L^-T for a block of L.
HWY_INLINE void solve_block_transposed(const Triangle& l, std::size_t rows, double* x,
                                       std::size_t stride) {
  for_rows(rows, [&](const auto& access, std::size_t row) HWY_ATTR {
    V columns[kColumns];
    POSEMIX_UNROLL
    for (std::size_t j = 0; j < kColumns; ++j) {
      columns[j] = access.load(x + row + j * stride);
      for (std::size_t k = 0; k < j; ++k)
        columns[j] = hn::NegMulAdd(columns[k], l.at(j, k), columns[j]);
      columns[j] = hn::Mul(columns[j], hn::Set(D(), l.reciprocals[j]));
      access.store(columns[j], x + row + j * stride);
    }
  });
}

/// Six columns of X L^-1 for a block of L.
HWY_INLINE void solve_block(const Triangle& l, std::size_t rows, double* x, std::size_t stride) {
  for_rows(rows, [&](const auto& access, std::size_t row) HWY_ATTR {
    V columns[kColumns];
    POSEMIX_UNROLL
    for (std::size_t done = 0; done < kColumns; ++done) {
      const std::size_t j = kColumns - 1 - done;
      columns[j] = access.load(x + row + j * stride);
      for (std::size_t k = j + 1; k < kColumns; ++k)
        columns[j] = hn::NegMulAdd(columns[k], l.at(k, j), columns[j]);
      columns[j] = hn::Mul(columns[j], hn::Set(D(), l.reciprocals[j]));
      access.store(columns[j], x + row + j * stride);
    }
  });
}

bool factor(double* s, std::size_t stride, std::size_t size) {
  for (std::size_t j = 0; j < size; j += kColumns) {
    double* const panel = s + j + j * stride;
    subtract_columns(size - j, s + j, stride, {s + j, 1, stride}, j, panel, stride);
    Triangle block{panel, stride, {}};
    if (!factor_block(panel, stride, block.reciprocals)) return false;
    solve_block_transposed(block, size - j - kColumns, panel + kColumns, stride);
  }
  return true;
}

void solve_transposed(const double* l, std::size_t stride_l, std::size_t size, double* x,
                      std::size_t stride, std::size_t rows) {
  for (std::size_t j = 0; j < size; j += kColumns) {
    double* const columns = x + j * stride;
    subtract_columns(rows, x, stride, {l + j, 1, stride_l}, j, columns, stride);
    solve_block_transposed(triangle_of(l + j + j * stride_l, stride_l), rows, columns, stride);
  }
}

void solve(const double* l, std::size_t stride_l, std::size_t size, double* x, std::size_t stride,
           std::size_t rows) {
  for (std::size_t j = size; j > 0;) {
    const std::size_t after = j;
    j -= kColumns;
    double* const columns = x + j * stride;
    subtract_columns(rows, x + after * stride, stride, {l + after + j * stride_l, stride_l, 1},
                     size - after, columns, stride);
    solve_block(triangle_of(l + j + j * stride_l, stride_l), rows, columns, stride);
  }
}

void subtract(const double* a, std::size_t stride_a, const double* b, std::size_t stride_b,
              std::size_t rows, std::size_t columns, double* c, std::size_t stride_c) {
  for (std::size_t j = 0; j < columns; ++j) {
    for_rows(rows, [&](const auto& access, std::size_t row) HWY_ATTR {
      const V difference =
          hn::Sub(access.load(a + row + j * stride_a), access.load(b + row + j * stride_b));
      access.store(difference, c + row + j * stride_c);
    });
  }
}

void times_vector(const double* a, std::size_t stride, std::size_t rows, std::size_t columns,
                  const double* x, double* y) {
  for_rows(rows, [&](const auto& access, std::size_t row) HWY_ATTR {
    V even = hn::Zero(D());
    V odd = even;
    for (std::size_t k = 0; k + 1 < columns; k += 2) {
      even = hn::MulAdd(access.load(a + row + k * stride), set(x[k]), even);
      odd = hn::MulAdd(access.load(a + row + (k + 1) * stride), set(x[k + 1]), odd);
    }
    if (columns % 2 == 1) {
      even = hn::MulAdd(access.load(a + row + (columns - 1) * stride), set(x[columns - 1]), even);
    }
    access.store(hn::Add(even, odd), y + row);
  });
}

void mirror(double* m, std::size_t stride, std::size_t size) { mirror_lower(m, stride, size); }

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace posemix::internal {

HWY_EXPORT(subtract_product);
HWY_EXPORT(subtract_lower_product);
HWY_EXPORT(factor);
HWY_EXPORT(solve_transposed);
HWY_EXPORT(solve);
HWY_EXPORT(subtract);
HWY_EXPORT(times_vector);
HWY_EXPORT(mirror);

namespace {

std::size_t count(Eigen::Index n) { return static_cast<std::size_t>(n); }
template <class Matrix>
std::size_t stride(const Matrix& m) {
  return count(m.outerStride());
}

}  // namespace

void subtract_product(MatrixRef c, ConstMatrixRef a, ConstMatrixRef b) {
  POSEMIX_DISPATCH(subtract_product)
  (c.data(), stride(c), a.data(), stride(a), b.data(), stride(b), count(c.rows()), count(c.cols()),
   count(a.cols()));
}

void subtract_lower_product(MatrixRef p, ConstMatrixRef a, ConstMatrixRef b) {
  POSEMIX_DISPATCH(subtract_lower_product)
  (p.data(), stride(p), a.data(), stride(a), b.data(), stride(b), count(p.rows()), count(a.cols()),
   p.data(), stride(p));
}

void subtract_symmetric_product(MatrixRef p, ConstMatrixRef a, ConstMatrixRef b) {
  // An entry (i, j) above the diagonal has row i of a and row j of b; below it is entry (j, i).
  subtract_lower_product(p, b, a);
  mirror_lower_in_place(p);
}

void set_symmetric_difference(MatrixRef result, ConstMatrixRef p, ConstMatrixRef a,
                              ConstMatrixRef b) {
  POSEMIX_DISPATCH(subtract_lower_product)
  (p.data(), stride(p), b.data(), stride(b), a.data(), stride(a), count(p.rows()), count(a.cols()),
   result.data(), stride(result));
  mirror_lower_in_place(result);
}

bool factor_in_place(MatrixRef s) {
  return POSEMIX_DISPATCH(factor)(s.data(), stride(s), count(s.rows()));
}

void solve_transposed_from_right(ConstMatrixRef l, MatrixRef x) {
  POSEMIX_DISPATCH(solve_transposed)
  (l.data(), stride(l), count(l.rows()), x.data(), stride(x), count(x.rows()));
}

void solve_after_transposed(ConstMatrixRef l, MatrixRef x) {
  POSEMIX_DISPATCH(solve)
  (l.data(), stride(l), count(l.rows()), x.data(), stride(x), count(x.rows()));
}

void solve_from_right(ConstMatrixRef l, MatrixRef x) {
  solve_transposed_from_right(l, x);
  solve_after_transposed(l, x);
}

void set_difference(MatrixRef c, ConstMatrixRef a, ConstMatrixRef b) {
  POSEMIX_DISPATCH(subtract)
  (a.data(), stride(a), b.data(), stride(b), count(a.rows()), count(a.cols()), c.data(), stride(c));
}

void set_product(Eigen::VectorXd& y, ConstMatrixRef a, const Eigen::Ref<const Eigen::VectorXd>& x) {
  y.resize(a.rows());
  POSEMIX_DISPATCH(times_vector)
  (a.data(), stride(a), count(a.rows()), count(a.cols()), x.data(), y.data());
}

double log_det_of_factor(ConstMatrixRef l) {
  double sum = 0.0;
  // Products of six entries do not overflow between 1e-50 and 1e50.
  for (Eigen::Index j = 0; j < l.rows(); j += 6) sum += std::log(l.diagonal().segment<6>(j).prod());
  return 2.0 * sum;
}

void mirror_lower_in_place(MatrixRef m) {
  POSEMIX_DISPATCH(mirror)(m.data(), stride(m), count(m.rows()));
}

}  // namespace posemix::internal
#endif
