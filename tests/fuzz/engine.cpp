// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cstddef>
#include <cstdint>

#include "target.hpp"

/// The one target of the program, for libFuzzer. What it throws ends the program, which libFuzzer
/// reports.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  posemix::fuzzing::targets().front().feed({reinterpret_cast<const char*>(data), size});
  return 0;
}
