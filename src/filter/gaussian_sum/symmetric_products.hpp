// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "base/dense_kernels.hpp"
#include "posemix/base/linear.hpp"
#include "posemix/lie/pose_blocks.hpp"

/// Matrices over the poses of a stack and the observed coordinates. Dim is 6 for one detection, so
/// that small matrices have a size known at compile time, and Eigen::Dynamic for several.
namespace posemix::internal {

template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;
template <int Dim>
using Square = Eigen::Matrix<double, Dim, Dim>;
/// Six rows per pose of the stack, and one column per observed coordinate.
template <int Dim>
using Tall = Eigen::Matrix<double, Eigen::Dynamic, Dim>;

/// c S^-1 from the Cholesky factor of S.
template <int Dim>
Tall<Dim> times_inverse(const Tall<Dim>& c, const Eigen::LLT<Square<Dim>>& s) {
  Tall<Dim> result = c;
  solve_from_right(s.matrixLLT(), result);
  return result;
}

}  // namespace posemix::internal
