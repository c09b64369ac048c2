// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>

#include "posemix/lie/concept.hpp"
#include "posemix/lie/interpolate.hpp"
#include "posemix/lie/mean.hpp"
#include "posemix/lie/pose_stack.hpp"
#include "posemix/lie/rn.hpp"
#include "posemix/lie/se3.hpp"
#include "posemix/lie/so3.hpp"

/// All of the room `lie`, with the double-precision names.
namespace posemix {

using SO3d = SO3<double>;
using SE3d = SE3<double>;
using PoseStackd = PoseStack<double>;
template <int N>
using Rnd = Rn<N, double>;

}  // namespace posemix
