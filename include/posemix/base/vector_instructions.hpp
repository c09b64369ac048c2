// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string_view>

/// The inner loops are compiled for several sets of vector instructions, and the program uses the
/// widest that the machine has. Sums are in another order and are rounded less often where vectors
/// are wider and multiply-adds are fused, so results differ in their last bits from set to set.
/// With one set they are the same to the last bit for any number of threads and ranks.
///
/// The environment variable POSEMIX_SIMD chooses one: "portable" (two lanes, no fused operation),
/// "avx2", "avx512", or "auto". With "portable" results are the same on all x86-64 machines that
/// run the same program; for functions of the C library, which has several versions of its own, see
/// docs/reproducibility.md.
namespace posemix {

/// The set in use: "avx512", "avx2", "neon" or "portable".
/// @throws InvalidInput when POSEMIX_SIMD is not one of its words, or names a set that this machine
/// lacks
std::string_view vector_instructions();

}  // namespace posemix
