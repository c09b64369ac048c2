// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "ball_centre.hpp"

namespace posemix::internal {

/// The width of the narrowest feature of an integrand in the ball of a radius about a centre, both
/// in standard deviations of its peak; zero if the integrand is not smooth in the whole ball.
double narrowest_feature(const RotationPair& pair, const Integrand& integrand,
                         const BallCentre& centre, double radius);

}  // namespace posemix::internal
