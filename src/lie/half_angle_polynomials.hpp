// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Functions of the angle t of a rotation as polynomials in z = 2 c - 1, c = cos(t/2) in [0, 1].
///
/// Both are analytic for c > -1, so their Chebyshev series on [0, 1] converge like 5.83^-n: degree
/// 20 is exact to 2e-16 (computed to 60 digits and written in powers of z). c is a component of the
/// quaternion, so no angle, root or division is needed.
namespace posemix::internal {

inline constexpr int kAngleDegree = 20;

/// (t/2) / sin(t/2).
inline constexpr double kHalfAngleOverSine[kAngleDegree + 1] = {
    1.2091995761561452,     -0.2636001412812842,     0.06973319205204692,   -0.019837146922537297,
    0.00586162897495759,    -0.0017729284598458914,  0.0005447739881301811, -0.0001693099599106564,
    5.307370323056482e-05,  -1.6749075082645974e-05, 5.314287188091921e-06, -1.693862205113952e-06,
    5.418581985727714e-07,  -1.7342788123244604e-07, 5.575738842888287e-08, -1.855750185293783e-08,
    6.0331600097782334e-09, -1.495978611795642e-09,  4.681011903625551e-10, -3.5522082207382583e-10,
    1.1890151456850346e-10};

/// log |det J_l| of SE(3), 4 log(sin(t/2) / (t/2)).
inline constexpr double kLogVolume[kAngleDegree + 1] = {
    -0.7598345336287238,     0.8719822483538345,    -0.13563141230922246,    0.02914730831606765,
    -0.007137510194536447,   0.0018760927797036777, -0.000515547120462939,   0.0001460579916856102,
    -4.230852640513579e-05,  1.246426156082347e-05, -3.7211164148503265e-06, 1.1229766608636821e-06,
    -3.4188503825991174e-07, 1.046541356000191e-07, -3.227923407446881e-08,  1.0274083573518819e-08,
    -3.2196779386340606e-09, 8.030760171481089e-10, -2.444855417388932e-10,  1.6810137807092309e-10,
    -5.4708287321684205e-11};

}  // namespace posemix::internal
