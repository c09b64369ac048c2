// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Transposes of square tiles of doubles in registers. Included once for every set of vector
// instructions.
#if defined(POSEMIX_TRANSPOSE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_TRANSPOSE_INL
#undef POSEMIX_TRANSPOSE_INL
#else
#define POSEMIX_TRANSPOSE_INL
#endif

#include <cstddef>
#include <cstdint>

#include "base/vectors-inl.hpp"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

/// Transposes a tile of as many vectors as there are lanes.
template <std::size_t kN = kLanes>
HWY_INLINE void transpose([[maybe_unused]] V* rows) {
  [[maybe_unused]] const D d;
#if HWY_TARGET != HWY_SCALAR
  // Pairs of rows, within blocks of two.
  POSEMIX_UNROLL
  for (std::size_t i = 0; i < kN; i += 2) {
    const V lower = hn::InterleaveLower(d, rows[i], rows[i + 1]);
    rows[i + 1] = hn::InterleaveUpper(d, rows[i], rows[i + 1]);
    rows[i] = lower;
  }
#endif
#if HWY_MAX_BYTES > 16
  if constexpr (kN == 4) {
    POSEMIX_UNROLL
    for (std::size_t i = 0; i < 2; ++i) {
      const V lower = hn::ConcatLowerLower(d, rows[i + 2], rows[i]);
      rows[i + 2] = hn::ConcatUpperUpper(d, rows[i + 2], rows[i]);
      rows[i] = lower;
    }
  }
  if constexpr (kN == 8) {
    // Of every half, blocks 0 and 2 of one row with those of the row two below, and 1 and 3.
    V blocks[8];
    POSEMIX_UNROLL
    for (std::size_t half = 0; half < 8; half += 4) {
      for (std::size_t i = half; i < half + 2; ++i) {
        blocks[i] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(rows[i + 2]), rows[i]);
        blocks[i + 2] = hn::OddEvenBlocks(rows[i + 2], hn::SwapAdjacentBlocks(rows[i]));
      }
    }
    for (std::size_t i = 0; i < 4; ++i) {
      rows[i] = hn::ConcatLowerLower(d, blocks[i + 4], blocks[i]);
      rows[i + 4] = hn::ConcatUpperUpper(d, blocks[i + 4], blocks[i]);
    }
  }
#endif
}

/// Transposes both halves of half as many vectors as there are lanes; two vectors of two.
HWY_INLINE void transpose_part(V* rows) {
#if HWY_MAX_BYTES > 16
  if constexpr (kLanes == 8) {
    const D d;
    // Masks of the lanes that take the shuffled vector, so that a shuffle is one instruction.
    constexpr std::uint8_t kEven = 0x33;
    constexpr std::uint8_t kOdd = 0xcc;
    const auto even = hn::LoadMaskBits(d, &kEven);
    const auto odd = hn::LoadMaskBits(d, &kOdd);
    const V even_01 = hn::InterleaveLower(d, rows[0], rows[1]);
    const V odd_01 = hn::InterleaveUpper(d, rows[0], rows[1]);
    const V even_23 = hn::InterleaveLower(d, rows[2], rows[3]);
    const V odd_23 = hn::InterleaveUpper(d, rows[2], rows[3]);
    rows[0] = hn::IfThenElse(odd, hn::SwapAdjacentBlocks(even_23), even_01);
    rows[1] = hn::IfThenElse(odd, hn::SwapAdjacentBlocks(odd_23), odd_01);
    rows[2] = hn::IfThenElse(even, hn::SwapAdjacentBlocks(even_01), even_23);
    rows[3] = hn::IfThenElse(even, hn::SwapAdjacentBlocks(odd_01), odd_23);
    return;
  }
#endif
  transpose<2>(rows);
}

/// The strict upper triangle of a column-major matrix takes the values of the lower one.
HWY_INLINE void mirror_lower(double* m, std::size_t stride, std::size_t size) {
  const std::size_t whole = size / kLanes * kLanes;
  for (std::size_t j = 0; j < whole; j += kLanes) {
    // The tile on the diagonal.
    for (std::size_t c = j; c < j + kLanes; ++c) {
      for (std::size_t r = c + 1; r < j + kLanes; ++r) m[c + r * stride] = m[r + c * stride];
    }
    for (std::size_t i = j + kLanes; i < whole; i += kLanes) {
      V rows[kLanes];
      POSEMIX_UNROLL
      for (std::size_t c = 0; c < kLanes; ++c) rows[c] = hn::LoadU(D(), m + i + (j + c) * stride);
      transpose(rows);
      POSEMIX_UNROLL
      for (std::size_t r = 0; r < kLanes; ++r) hn::StoreU(rows[r], D(), m + j + (i + r) * stride);
    }
  }
  for (std::size_t r = whole; r < size; ++r) {
    for (std::size_t c = 0; c < r; ++c) m[c + r * stride] = m[r + c * stride];
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
