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

/// All groups of the room `lie`, with names for double precision.
namespace posemix {

using SO3d = SO3<double>;
using SE3d = SE3<double>;
using PoseStackd = PoseStack<double>;
template <int N>
using Rnd = Rn<N, double>;

// NOLINTBEGIN(bugprone-macro-parentheses): types and keywords take none
#define POSEMIX_LIE(prefix, G)                                                                   \
  prefix template G interpolate(const G&, const G&, const double&);                              \
  prefix template MeanResult<G> weighted_mean(std::span<const G>, std::span<const double>,       \
                                              const MeanSettings&);                              \
  prefix template MeanResult<G> weighted_mean(const std::vector<G>&, const std::vector<double>&, \
                                              const MeanSettings&)
// NOLINTEND(bugprone-macro-parentheses)
POSEMIX_LIE(extern, SO3d);
POSEMIX_LIE(extern, SE3d);
POSEMIX_LIE(extern, PoseStackd);
POSEMIX_LIE(extern, Rnd<3>);

}  // namespace posemix
