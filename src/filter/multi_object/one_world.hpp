// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "multi_object_state.hpp"

/// States that differ in where the world is and in nothing that is seen (docs/many-objects.md,
/// "Global hypotheses").
namespace posemix::internal {

/// Whether two states differ by a shift of the world alone, between which no detection decides.
/// Objects with a prior, and a camera that was given, are known in the world.
bool are_one_but_for_the_world(const MultiObjectState& a, const MultiObjectState& b);

/// Whether the cameras agree in the world.
bool are_at_one_place(const MultiObjectState& a, const MultiObjectState& b);

}  // namespace posemix::internal
