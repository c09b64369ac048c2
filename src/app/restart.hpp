// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

namespace posemix {

/// With POSEMIX_SIMD=portable the results of the program depend on no processor, those of the C
/// library neither: where glibc has chosen its functions with fused multiply-adds, the process
/// starts itself again, with its own command line, and an environment that hides them from glibc
/// (docs/reproducibility.md). Called before threads and MPI are there.
/// @throws UsageError when POSEMIX_SIMD is unknown, the machine lacks what it names, or the process
/// cannot be started again
void restart_where_portable();

}  // namespace posemix
