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
/// "avx2", "avx512", "neon", or "auto". With "portable" results are the same on all x86-64 machines
/// that run the same program with the same C library. Its exp, log, sin and others have versions
/// with fused operations, which glibc chooses by the processor when a process starts: the program
/// posemix sees to it by starting itself again, other processes set GLIBC_TUNABLES;
/// docs/reproducibility.md.
namespace posemix {

/// What decides on the last bits of results in this process: the set in use, "avx512", "avx2",
/// "neon" or "portable". " with FMA" follows where the C library fuses and the set does not, and
/// " without FMA" where it is the other way round.
/// @throws InvalidInput when POSEMIX_SIMD is not one of its words, or names a set that this machine
/// lacks
std::string_view vector_instructions();

}  // namespace posemix
