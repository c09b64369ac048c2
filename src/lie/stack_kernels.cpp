// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "lie/stack_kernels.hpp"

#include <algorithm>
#include <vector>

#include "base/vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stack_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "base/fields-inl.hpp"
#include "base/vector_dispatch.hpp"
#include "base/vectors-inl.hpp"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

constexpr std::size_t kDof = 6;
/// Vectors over six columns.
constexpr std::size_t kParts = (kDof + kLanes - 1) / kLanes;
constexpr std::size_t kRow = kParts * kLanes;
/// Numbers of a 6x6 block whose columns are filled up to whole vectors.
constexpr std::size_t kPadded = kDof * kRow;
static_assert(kPadded <= kMostPadded);

/// A block [a 0; b a] times a weight as a dense one, by padded columns.
HWY_INLINE void pad(const TwistMatrix<double>& block, double weight, double* dense) {
  std::fill_n(dense, kPadded, 0.0);
  POSEMIX_UNROLL
  for (std::size_t k = 0; k < 3; ++k) {
    double* const left = dense + k * kRow;
    double* const right = dense + (3 + k) * kRow;
    POSEMIX_UNROLL
    for (std::size_t row = 0; row < 3; ++row) {
      left[row] = right[3 + row] = weight * block.a.data()[3 * k + row];
      left[3 + row] = weight * block.b.data()[3 * k + row];
    }
  }
}

/// A 6x6 block by rows.
struct Block {
  V rows[kDof][kParts];
};

/// P B^T for two blocks; a column of B, which is padded, is a vector over the columns of the
/// product.
HWY_INLINE Block right_product(const double* p, std::size_t stride, const double* b) {
  Block product;
  POSEMIX_UNROLL
  for (std::size_t part = 0; part < kParts; ++part) {
    // The first three rows of the last three columns of B are zero.
    const std::size_t columns = (part + 1) * kLanes <= 3 ? 3 : kDof;
    POSEMIX_UNROLL
    for (std::size_t k = 0; k < columns; ++k) {
      const V column = hn::Load(D(), b + k * kRow + part * kLanes);
      const double* const values = p + k * stride;
      POSEMIX_UNROLL
      for (std::size_t row = 0; row < kDof; ++row) {
        const V value = set(values[row]);
        V& sum = product.rows[row][part];
        sum = k == 0 ? hn::Mul(value, column) : hn::MulAdd(value, column, sum);
      }
    }
  }
  return product;
}

/// sum += B Q.
HWY_INLINE void add_left_product(const TwistMatrix<double>& block, const Block& q, Block& sum) {
  const double* const a = block.a.data();
  const double* const b = block.b.data();
  POSEMIX_UNROLL
  for (std::size_t part = 0; part < kParts; ++part) {
    POSEMIX_UNROLL
    for (std::size_t k = 0; k < 3; ++k) {
      POSEMIX_UNROLL
      for (std::size_t r = 0; r < 3; ++r) {
        const V a_rk = set(a[3 * k + r]);
        V& upper = sum.rows[r][part];
        V& lower = sum.rows[3 + r][part];
        upper = hn::MulAdd(a_rk, q.rows[k][part], upper);
        lower = hn::MulAdd(a_rk, q.rows[3 + k][part], lower);
        lower = hn::MulAdd(set(b[3 * k + r]), q.rows[k][part], lower);
      }
    }
  }
}

/// sum += B_i P B_j^T, of which `right` is B_j, padded. A call for every block, because compilers
/// otherwise keep the addresses of all its entries.
HWY_NOINLINE void add_block(const double* p, std::size_t stride, const TwistMatrix<double>& left,
                            const double* right, Block& sum) {
  const Block q = right_product(p, stride, right);
  Block total = sum;
  add_left_product(left, q, total);
  sum = total;
}

/// Writes a block of the sum, and its transpose. Rows of the sum are columns in memory.
HWY_NOINLINE void write(const Block& block, std::size_t row, std::size_t column, double* sum,
                        std::size_t stride) {
  POSEMIX_UNROLL
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t count = std::min(kLanes, kDof - part * kLanes);
    V rows[kDof];
    POSEMIX_UNROLL
    for (std::size_t r = 0; r < kDof; ++r) {
      rows[r] = block.rows[r][part];
      double* const at = sum + (row + r) * stride + column + part * kLanes;
      if (count == kLanes) {
        hn::StoreU(rows[r], D(), at);
      } else {
        hn::BlendedStore(rows[r], hn::FirstN(D(), count), D(), at);
      }
    }
    if (row != column)
      store_fields<kDof>(rows, sum + (column + part * kLanes) * stride + row, stride, count);
  }
}

/// Of a 6x6 block on the diagonal the strict lower triangle takes the values of the upper one.
HWY_INLINE void mirror_block(double* block, std::size_t stride) {
  POSEMIX_UNROLL
  for (std::size_t c = 0; c < kDof; ++c) {
    for (std::size_t r = c + 1; r < kDof; ++r) block[r + c * stride] = block[c + r * stride];
  }
}

void sum_congruences(const CongruenceSum& of, double* sum) {
  const std::size_t n = kDof * of.poses;
  for (std::size_t k = 0; k < of.count; ++k) {
    for (std::size_t j = 0; j < of.poses; ++j)
      pad(of.parts[k].blocks[j], of.parts[k].weight, of.scratch + (k * of.poses + j) * kPadded);
  }
  for (std::size_t i = 0; i < of.poses; ++i) {
    const double* const d_i = of.d + kDof * i;
    for (std::size_t j = i; j < of.poses; ++j) {
      const double* const d_j = of.d + kDof * j;
      Block block;
      POSEMIX_UNROLL
      for (std::size_t part = 0; part < kParts; ++part) {
        POSEMIX_UNROLL
        for (auto& row : block.rows) row[part] = hn::Zero(D());
        const auto mask = hn::FirstN(D(), std::min(kLanes, kDof - part * kLanes));
        for (std::size_t k = 0; k < of.deviations; ++k) {
          const V row = hn::MaskedLoad(mask, D(), d_j + k * n + part * kLanes);
          POSEMIX_UNROLL
          for (std::size_t r = 0; r < kDof; ++r)
            block.rows[r][part] = hn::MulAdd(set(d_i[k * n + r]), row, block.rows[r][part]);
        }
      }
      for (std::size_t k = 0; k < of.count; ++k) {
        add_block(of.parts[k].p->data() + kDof * (j * n + i), n, of.parts[k].blocks[i],
                  of.scratch + (k * of.poses + j) * kPadded, block);
      }
      write(block, kDof * i, kDof * j, sum, n);
    }
    mirror_block(sum + kDof * i * (n + 1), n);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace posemix::internal {

HWY_EXPORT(sum_congruences);

namespace {

/// Memory that a thread keeps, of at least so many numbers, aligned for vectors.
double* kept(std::size_t size) {
  struct alignas(64) Line {
    double numbers[8];
  };
  static thread_local std::vector<Line> lines;
  if (8 * lines.size() < size) lines.resize(size / 8 + 1);
  return lines.data()->numbers;
}

}  // namespace

void sum_congruences(std::span<const Congruence> parts, const Eigen::MatrixXd& d,
                     Eigen::MatrixXd& sum) {
  const auto poses = static_cast<std::size_t>(sum.rows()) / 6;
  const CongruenceSum of{parts.data(),
                         parts.size(),
                         poses,
                         d.data(),
                         static_cast<std::size_t>(d.cols()),
                         kept(parts.size() * poses * kMostPadded)};
  POSEMIX_DISPATCH(sum_congruences)(of, sum.data());
}

}  // namespace posemix::internal
#endif
