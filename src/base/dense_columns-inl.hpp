// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Six columns of a matrix product in registers, of which the kernels of dense matrices are made.
// Included once for every set of vector instructions.
#if defined(POSEMIX_DENSE_COLUMNS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_DENSE_COLUMNS_INL
#undef POSEMIX_DENSE_COLUMNS_INL
#else
#define POSEMIX_DENSE_COLUMNS_INL
#endif

#include <cstddef>

#include "base/vectors-inl.hpp"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

constexpr std::size_t kColumns = 6;

/// A matrix by rows and columns of any stride.
struct Strided {
  const double* data;
  std::size_t row;
  std::size_t column;
};

/// Whole vectors.
struct Whole {
  HWY_INLINE V load(const double* at) const { return hn::LoadU(D(), at); }
  HWY_INLINE void store(V v, double* at) const { hn::StoreU(v, D(), at); }
};
/// The first entries of a vector; the others are neither read nor written.
struct Part {
  hn::Mask<D> mask;
  HWY_INLINE explicit Part(std::size_t count) : mask(hn::FirstN(D(), count)) {}
  HWY_INLINE V load(const double* at) const {
    return kLanes == 2 ? load_first(at) : hn::MaskedLoad(mask, D(), at);
  }
  HWY_INLINE void store(V v, double* at) const {
    if (kLanes == 2) {
      *at = hn::GetLane(v);
    } else {
      hn::BlendedStore(v, mask, D(), at);
    }
  }
};

/// Six columns of C = P - A B^T, over kVectors vectors of rows of A, P and C, the last with `last`.
/// P may be C.
template <std::size_t kVectors, class Access>
HWY_INLINE void subtract_tile(const Access& last, const double* a, std::size_t stride_a,
                              const Strided& b, std::size_t depth, const double* p,
                              std::size_t stride_p, double* c, std::size_t stride_c) {
  const auto load = [&](const double* at, std::size_t v) HWY_ATTR {
    return v + 1 == kVectors ? last.load(at + v * kLanes) : hn::LoadU(D(), at + v * kLanes);
  };
  V sums[kVectors][kColumns];
  POSEMIX_UNROLL
  for (std::size_t v = 0; v < kVectors; ++v) {
    POSEMIX_UNROLL
    for (std::size_t j = 0; j < kColumns; ++j) sums[v][j] = load(p + j * stride_p, v);
  }
  for (std::size_t k = 0; k < depth; ++k) {
    V rows[kVectors];
    POSEMIX_UNROLL
    for (std::size_t v = 0; v < kVectors; ++v) rows[v] = load(a + k * stride_a, v);
    const double* const factors = b.data + k * b.column;
    POSEMIX_UNROLL
    for (std::size_t j = 0; j < kColumns; ++j) {
      const V factor = set(factors[j * b.row]);
      POSEMIX_UNROLL
      for (std::size_t v = 0; v < kVectors; ++v)
        sums[v][j] = hn::NegMulAdd(rows[v], factor, sums[v][j]);
    }
  }
  POSEMIX_UNROLL
  for (std::size_t v = 0; v < kVectors; ++v) {
    POSEMIX_UNROLL
    for (std::size_t j = 0; j < kColumns; ++j) {
      double* const at = c + j * stride_c + v * kLanes;
      v + 1 == kVectors ? last.store(sums[v][j], at) : hn::StoreU(sums[v][j], D(), at);
    }
  }
}

/// Vectors of rows of a tile: as many as there are registers for their sums.
constexpr std::size_t kTile = kLanes == 8 ? 3 : 2;

/// A tile of whole vectors but for the last one.
template <std::size_t kVectors>
HWY_INLINE void subtract_last_tile(std::size_t rows, const double* a, std::size_t stride_a,
                                   const Strided& b, std::size_t depth, const double* p,
                                   std::size_t stride_p, double* c, std::size_t stride_c) {
  const std::size_t last = rows - (kVectors - 1) * kLanes;
  if (last == kLanes) {
    subtract_tile<kVectors>(Whole(), a, stride_a, b, depth, p, stride_p, c, stride_c);
  } else {
    subtract_tile<kVectors>(Part(last), a, stride_a, b, depth, p, stride_p, c, stride_c);
  }
}

/// Six columns of C = P - A B^T with any number of rows. P may be C.
HWY_INLINE void subtract_columns(std::size_t rows, const double* a, std::size_t stride_a,
                                 const Strided& b, std::size_t depth, const double* p,
                                 std::size_t stride_p, double* c, std::size_t stride_c) {
  for (; rows > kTile * kLanes; rows -= kTile * kLanes) {
    subtract_tile<kTile>(Whole(), a, stride_a, b, depth, p, stride_p, c, stride_c);
    a += kTile * kLanes;
    p += kTile * kLanes;
    c += kTile * kLanes;
  }
  if (rows > 2 * kLanes) {
    subtract_last_tile<kTile>(rows, a, stride_a, b, depth, p, stride_p, c, stride_c);
  } else if (rows > kLanes) {
    subtract_last_tile<2>(rows, a, stride_a, b, depth, p, stride_p, c, stride_c);
  } else if (rows > 0) {
    subtract_last_tile<1>(rows, a, stride_a, b, depth, p, stride_p, c, stride_c);
  }
}

/// Six columns of C -= A B^T with any number of rows.
HWY_INLINE void subtract_columns(std::size_t rows, const double* a, std::size_t stride_a,
                                 const Strided& b, std::size_t depth, double* c,
                                 std::size_t stride_c) {
  subtract_columns(rows, a, stride_a, b, depth, c, stride_c, c, stride_c);
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
