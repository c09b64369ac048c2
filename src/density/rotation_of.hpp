// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/lie/lie.hpp"

namespace posemix::internal {

/// The rotation of an element of either group.
inline const SO3d& rotation_of(const SO3d& element) { return element; }
inline const SO3d& rotation_of(const SE3d& element) { return element.rotation(); }

}  // namespace posemix::internal
