// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// The vectors of all inner loops: doubles, at most eight. Included once for every set of vector
// instructions.
#if defined(POSEMIX_VECTORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_VECTORS_INL
#undef POSEMIX_VECTORS_INL
#else
#define POSEMIX_VECTORS_INL
#endif

#include <cstddef>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
constexpr std::size_t kLanes = hn::MaxLanes(D());

HWY_INLINE V set(double value) { return hn::Set(D(), value); }

/// A number in the first lane, and zeros: a masked load of vectors of two lanes reads both.
HWY_INLINE V load_first(const double* at) { return hn::InsertLane(hn::Zero(D()), 0, *at); }

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
