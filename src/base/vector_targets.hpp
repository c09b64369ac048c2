// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// The sets of vector instructions that the inner loops are compiled for besides the baseline: two
/// widths of x86-64, and none whose vectors cannot be members of a class. Included before Highway.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)

/// Unrolls the loop that follows, so that arrays of vectors are registers.
#if defined(__clang__)
#define POSEMIX_UNROLL _Pragma("clang loop unroll(full)")
#else
#define POSEMIX_UNROLL _Pragma("GCC unroll 64")
#endif
