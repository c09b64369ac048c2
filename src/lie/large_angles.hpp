// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/lie/small_angle.hpp"

/// The coefficients of vector functions for one angle, by small_angle.hpp: for those that are too
/// large for the polynomials of vectors, and for what is not a number.
namespace posemix::internal {

/// cos and sinc of half the angle.
inline void half_angle_coefficients(double u, double* values) {
  const auto half = small_angle::cosine_and_sinc(u / 4.0);
  values[0] = half.cosine;
  values[1] = half.sinc;
}

/// A, B and C, and with slopes those of B and C.
inline void jacobian_coefficients(double u, double* values) {
  const auto c = small_angle::jacobian_coefficients(u);
  values[0] = c.a;
  values[1] = c.b;
  values[2] = c.c;
}
inline void jacobian_coefficients_and_slopes(double u, double* values) {
  jacobian_coefficients(u, values);
  const auto slopes =
      small_angle::jacobian_coefficient_slopes(u, {values[0], values[1], values[2]});
  values[3] = slopes.b;
  values[4] = slopes.c;
}

/// (theta/2) cot(theta/2) and D, and with slopes both of theirs.
inline void inverse_jacobian_coefficients(double u, double* values) {
  const auto c = small_angle::inverse_jacobian_coefficients(u);
  values[0] = c.half_cot;
  values[1] = c.d;
}
inline void inverse_jacobian_coefficients_and_slopes(double u, double* values) {
  inverse_jacobian_coefficients(u, values);
  const auto slopes = small_angle::inverse_jacobian_coefficient_slopes(u, {values[0], values[1]});
  values[2] = slopes.half_cot;
  values[3] = slopes.d;
}

}  // namespace posemix::internal
