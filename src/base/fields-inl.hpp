// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Rows of an array of structures, as many as there are lanes, to one vector per field and back.
// Included once for every set of vector instructions.
#if defined(POSEMIX_FIELDS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_FIELDS_INL
#undef POSEMIX_FIELDS_INL
#else
#define POSEMIX_FIELDS_INL
#endif

#include <algorithm>
#include <cstddef>

#include "base/transpose-inl.hpp"
#include "base/vectors-inl.hpp"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

/// Rows are transposed in parts of half a vector: a vector has a part of one row and that of the
/// row half of the lanes later, which loads and stores put together and apart.
constexpr std::size_t kPart = kLanes > 2 ? kLanes / 2 : kLanes;

/// The first field of part `k`. The last part overlaps the one before where fields do not fill it.
template <std::size_t kFields>
constexpr std::size_t part_begin(std::size_t k) {
  return kFields < kPart ? 0 : std::min(k * kPart, kFields - kPart);
}
template <std::size_t kFields>
constexpr std::size_t kFieldParts = (kFields + kPart - 1) / kPart;

/// A part of a row and that of the row kPart later, or of one row where vectors have no halves.
template <std::size_t kFields>
HWY_INLINE V load_part(const double* row, [[maybe_unused]] std::size_t stride) {
#if HWY_MAX_BYTES > 16
  if constexpr (kPart < kLanes) {
    const hn::Half<D> half;
    if constexpr (kFields < kPart) {
      const auto mask = hn::FirstN(half, kFields);
      return hn::Combine(D(), hn::MaskedLoad(mask, half, row + kPart * stride),
                         hn::MaskedLoad(mask, half, row));
    } else {
      return hn::Combine(D(), hn::LoadU(half, row + kPart * stride), hn::LoadU(half, row));
    }
  }
#endif
  if constexpr (kFields < kPart) return load_first(row);
  return hn::LoadU(D(), row);
}

/// The first of 2 or 4 lanes, without a mask: an extraction that is stored by one touches what is
/// masked, and faults where that is no memory.
template <std::size_t kFields, class Part>
HWY_INLINE void store_first(Part, hn::VFromD<Part> part, double* row) {
#if HWY_MAX_BYTES > 16
  if constexpr (kFields > 1) {
    const hn::Half<Part> half;
    hn::StoreU(hn::LowerHalf(half, part), half, row);
    if constexpr (kFields == 3) row[2] = hn::GetLane(hn::UpperHalf(half, part));
    return;
  }
#endif
  row[0] = hn::GetLane(part);
}

template <std::size_t kFields>
HWY_INLINE void store_part(V part, double* row, [[maybe_unused]] std::size_t stride) {
#if HWY_MAX_BYTES > 16
  if constexpr (kPart < kLanes) {
    const hn::Half<D> half;
    const auto lower = hn::LowerHalf(half, part);
    const auto upper = hn::UpperHalf(half, part);
    if constexpr (kFields < kPart) {
      store_first<kFields>(half, lower, row);
      store_first<kFields>(half, upper, row + kPart * stride);
    } else {
      hn::StoreU(lower, half, row);
      hn::StoreU(upper, half, row + kPart * stride);
    }
    return;
  }
#endif
  if constexpr (kFields < kPart) {
    store_first<kFields>(D(), part, row);
  } else {
    hn::StoreU(part, D(), row);
  }
}

/// Of as many rows as there are lanes.
template <std::size_t kFields>
HWY_INLINE void load_fields(const double* rows, std::size_t stride, V* fields) {
  POSEMIX_UNROLL
  for (std::size_t k = 0; k < kFieldParts<kFields>; ++k) {
    const std::size_t first = part_begin<kFields>(k);
    V tile[kPart];
    POSEMIX_UNROLL
    for (std::size_t row = 0; row < kPart; ++row)
      tile[row] = load_part<kFields>(rows + row * stride + first, stride);
    transpose_part(tile);
    constexpr std::size_t kUsed = std::min(kPart, kFields);
    POSEMIX_UNROLL
    for (std::size_t j = 0; j < kUsed; ++j) fields[first + j] = tile[j];
  }
}

#if HWY_MAX_BYTES > 32
/// The first two blocks of a vector are written to two rows, and the others to the two that follow.
HWY_INLINE void store_blocks_of_two(V blocks, double* row, std::size_t stride) {
  const hn::Half<D> half;
  const hn::Half<hn::Half<D>> block;
  const auto lower = hn::LowerHalf(half, blocks);
  const auto upper = hn::UpperHalf(half, blocks);
  hn::StoreU(hn::LowerHalf(block, lower), block, row);
  hn::StoreU(hn::UpperHalf(block, lower), block, row + stride);
  hn::StoreU(hn::LowerHalf(block, upper), block, row + 2 * stride);
  hn::StoreU(hn::UpperHalf(block, upper), block, row + 3 * stride);
}
#endif

template <std::size_t kFields>
HWY_INLINE void store_fields(const V* fields, double* rows, std::size_t stride) {
  std::size_t parts = kFieldParts<kFields>;
#if HWY_MAX_BYTES > 32
  if constexpr (kLanes == 8 && kFields % kPart == 2) {
    const V* const two = fields + kFields - 2;
    double* const row = rows + kFields - 2;
    store_blocks_of_two(hn::InterleaveLower(D(), two[0], two[1]), row, 2 * stride);
    store_blocks_of_two(hn::InterleaveUpper(D(), two[0], two[1]), row + stride, 2 * stride);
    --parts;
  }
#endif
  POSEMIX_UNROLL
  for (std::size_t k = 0; k < parts; ++k) {
    const std::size_t first = part_begin<kFields>(k);
    V tile[kPart];
    POSEMIX_UNROLL
    for (std::size_t j = 0; j < kPart; ++j) tile[j] = fields[first + std::min(j, kFields - 1)];
    transpose_part(tile);
    POSEMIX_UNROLL
    for (std::size_t row = 0; row < kPart; ++row)
      store_part<kFields>(tile[row], rows + row * stride + first, stride);
  }
}

/// Of the first `lanes` rows.
template <std::size_t kFields>
HWY_INLINE void store_fields(const V* fields, double* rows, std::size_t stride, std::size_t lanes) {
  if (lanes == kLanes) {
    store_fields<kFields>(fields, rows, stride);
    return;
  }
  POSEMIX_UNROLL
  for (std::size_t first = 0; first < kFields; first += kLanes) {
    const std::size_t part = std::min(kLanes, kFields - first);
    V tile[kLanes];
    POSEMIX_UNROLL
    for (std::size_t k = 0; k < kLanes; ++k) tile[k] = fields[first + std::min(k, part - 1)];
    transpose(tile);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      double* const row = rows + lane * stride + first;
      if (part == kLanes) {
        hn::StoreU(tile[lane], D(), row);
      } else {
        hn::BlendedStore(tile[lane], hn::FirstN(D(), part), D(), row);
      }
    }
  }
}

/// Rows that are read: `count` of them, `stride` numbers apart. Lanes beyond the last row repeat
/// it.
template <std::size_t kFields>
struct InputRows {
  const double* data;
  std::size_t stride;
  std::size_t count;

  HWY_INLINE void load(std::size_t row, V* fields) const {
    if (row + kLanes <= count) {
      load_fields<kFields>(data + row * stride, stride, fields);
      return;
    }
    double copy[kLanes * kFields];
    POSEMIX_UNROLL
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      std::copy_n(data + std::min(row + lane, count - 1) * stride, kFields, copy + lane * kFields);
    load_fields<kFields>(copy, kFields, fields);
  }
};

/// Rows that are written.
template <std::size_t kFields>
struct OutputRows {
  double* data;
  std::size_t stride;
  std::size_t count;

  HWY_INLINE void store(const V* fields, std::size_t row) const {
    store_fields<kFields>(fields, data + row * stride, stride, std::min(kLanes, count - row));
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
