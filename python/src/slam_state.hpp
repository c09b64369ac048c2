// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <nanobind/nanobind.h>

#include "posemix/slam/object_slam.hpp"
#include "posemix/slam/stamped_slam.hpp"

namespace posemix::python {

/// Saving and loading (docs/state.md): methods of both classes of live object SLAM.
void bind_state_of(nanobind::class_<ObjectSlam>& slam);
void bind_state_of(nanobind::class_<StampedSlam>& slam);

}  // namespace posemix::python
