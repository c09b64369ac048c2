// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>

#include <gtest/gtest.h>

#include "base/vector_targets.hpp"
//
#include "base/vector_dispatch.hpp"

namespace posemix::internal {

/// Runs a test by every set of vector instructions that this machine has, the portable one too.
template <class Test>
void by_every_instruction_set(const Test& test) {
  choose_vector_instructions();
  const std::int64_t supported = hwy::SupportedTargets();
  for (const std::int64_t target : {HWY_EMU128, HWY_AVX2, HWY_AVX3, HWY_NEON}) {
    if (target != HWY_EMU128 && (supported & target) == 0) continue;
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::GetChosenTarget().Update(target);
    test();
  }
  hwy::GetChosenTarget().Update(supported);
}

}  // namespace posemix::internal
