// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <numbers>

/// The functions of small_angle.hpp as polynomials in the squared angle u, valid on [0, 16). They
/// are Chebyshev interpolants of so high a degree that what is left is rounding, computed to 60
/// digits and written in powers of u.
namespace posemix::internal {

/// Squared angle [rad^2] below which the polynomials hold.
inline constexpr double kLargestSquaredAngle = 16.0;

/// cos(theta/2) and sin(theta/2) / (theta/2).
inline constexpr std::array<double, 10> kCosineOfHalf = {1.0,
                                                         -0.125,
                                                         0.002604166666666665,
                                                         -2.1701388888885552e-05,
                                                         9.68812003946833e-08,
                                                         -2.6911444485762414e-10,
                                                         5.096863253113489e-13,
                                                         -7.001055079831433e-16,
                                                         7.2846882837779645e-19,
                                                         -5.682343527279611e-22};
inline constexpr std::array<double, 10> kSincOfHalf = {1.0,
                                                       -0.041666666666666664,
                                                       0.0005208333333333332,
                                                       -3.1001984126982535e-06,
                                                       1.0764577821767144e-08,
                                                       -2.4464949562236293e-11,
                                                       3.9206644040883015e-14,
                                                       -4.6673950898344204e-17,
                                                       4.2860209664029146e-20,
                                                       -3.0042786513556816e-23};

/// C, and the slopes of B and C in u.
inline constexpr std::array<double, 12> kSecondOrder = {
    0.16666666666666666,     -0.008333333333333333,  0.00019841269841269828,
    -2.7557319223984177e-06, 2.5052108385338283e-08, -1.6059043833138607e-10,
    7.647163648643761e-13,   -2.81145601685147e-15,  8.220512269129423e-18,
    -1.9564850830408144e-20, 3.834265532862913e-23,  -5.621496525641328e-26};
inline constexpr std::array<double, 11> kFirstOrderSlope = {
    -0.041666666666666664,   0.0027777777777777744, -7.440476190475358e-05, 1.1022927689513127e-06,
    -1.0438378489866815e-08, 6.88244723976273e-11,  -3.345631964763448e-13, 1.2495111318781948e-15,
    -3.697365614339368e-18,  8.806299359543372e-21, -1.5289860317458174e-23};
inline constexpr std::array<double, 11> kSecondOrderSlope = {
    -0.008333333333333333,   0.0003968253968253967,  -8.267195767195456e-06, 1.0020843354146342e-07,
    -8.029521916891499e-10,  4.588298194692851e-12,  -1.968019268515797e-14, 6.576413284609959e-17,
    -1.7608482281812343e-19, 3.8344347504510523e-22, -6.18382261941773e-25};

/// What the nearest pole, at (2 pi)^2, leaves of D = 2 / ((2 pi)^2 - u) + ..., and of its slope.
inline constexpr double kPole = 4.0 * std::numbers::pi * std::numbers::pi;
inline constexpr std::array<double, 10> kInverseRest = {
    0.03267274151216444,    0.00010564110705340528, 5.637370281677524e-07, 3.3571420221390086e-09,
    2.0742834410872774e-11, 1.3001370048315257e-13, 8.183655713971856e-16, 5.286190196458124e-18,
    2.7394975291234297e-20, 3.514066903752053e-22};
inline constexpr std::array<double, 10> kInverseSlopeRest = {
    0.00010564110705334664, 1.1274740565796322e-06, 1.0071425771204216e-08, 8.297149859430894e-11,
    6.500212957706744e-13,  4.9182790300295784e-15, 3.6170521097164316e-17, 2.6991250883702273e-19,
    1.4777572908507852e-21, 2.3471059197167986e-23};

}  // namespace posemix::internal
