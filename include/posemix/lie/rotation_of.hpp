// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/lie/se3.hpp"
#include "posemix/lie/so3.hpp"

namespace posemix {

/// The rotation of an element of SO(3) or SE(3).
inline const SO3d& rotation_of(const SO3d& element) { return element; }
inline const SO3d& rotation_of(const SE3d& element) { return element.rotation(); }

}  // namespace posemix
