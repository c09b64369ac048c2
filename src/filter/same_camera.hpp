// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/filter/multi_object_filter.hpp"

namespace posemix::internal {

/// Whether two observations are by the same camera of a rig.
bool is_same_camera(const ObservationSource& a, const ObservationSource& b);

}  // namespace posemix::internal
