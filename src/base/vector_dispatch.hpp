// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "hwy/highway.h"

namespace posemix::internal {

/// Takes POSEMIX_SIMD into account, once, before the first inner loop is chosen.
/// @throws InvalidInput when its value is unknown, or the machine lacks what it names
void choose_vector_instructions();

}  // namespace posemix::internal

/// The version of an exported function for the vector instructions that are in use.
#define POSEMIX_DISPATCH(function) \
  (::posemix::internal::choose_vector_instructions(), HWY_DYNAMIC_DISPATCH(function))
