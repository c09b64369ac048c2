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

template <std::size_t kFields>
HWY_INLINE void load_fields(const double* rows, std::size_t stride, V* fields) {
  POSEMIX_UNROLL
  for (std::size_t first = 0; first < kFields; first += kLanes) {
    const std::size_t part = std::min(kLanes, kFields - first);
    V tile[kLanes];
    POSEMIX_UNROLL
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double* const row = rows + lane * stride + first;
      tile[lane] =
          part == kLanes ? hn::LoadU(D(), row) : hn::MaskedLoad(hn::FirstN(D(), part), D(), row);
    }
    transpose(tile);
    POSEMIX_UNROLL
    for (std::size_t k = 0; k < part; ++k) fields[first + k] = tile[k];
  }
}

/// Of the first `lanes` rows.
template <std::size_t kFields>
HWY_INLINE void store_fields(const V* fields, double* rows, std::size_t stride,
                             std::size_t lanes = kLanes) {
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
