// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/detector/observation.hpp"

namespace posemix::internal {

/// An order of the observations of one stamp that does not depend on when they came: by detector,
/// camera, object and class, then by their numbers.
bool comes_before(const Observation& a, const Observation& b);

/// The observation with its components in an order of their own, the heaviest first.
Observation with_ordered_components(Observation observation);

}  // namespace posemix::internal
