// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <functional>

/// Functions of many rotations or poses whose numbers lie in rows, as in arrays of other libraries:
/// what posemix/lie/batch.hpp does for the library's types.
namespace posemix::internal {

/// Numbers in rows, `stride` apart; with a stride of zero one row is used for all. A tangent vector
/// has three or six in a row, a quaternion x y z w, the blocks a and b of [a 0; b a] eighteen, by
/// columns, and a covariance 36.
struct ConstRows {
  const double* data;
  std::size_t stride;

  ConstRows from(std::size_t row) const { return {data + row * stride, stride}; }
};
struct MutableRows {
  double* data;
  std::size_t stride;

  MutableRows from(std::size_t row) const { return {data + row * stride, stride}; }
};

/// Poses: x y z w of the first quaternion, the first translation, and the stride of both.
struct ConstPoseRows {
  const double* rotation;
  const double* translation;
  std::size_t stride;

  ConstPoseRows from(std::size_t row) const {
    return {rotation + row * stride, translation + row * stride, stride};
  }
};
struct MutablePoseRows {
  double* rotation;
  double* translation;
  std::size_t stride;

  MutablePoseRows from(std::size_t row) const {
    return {rotation + row * stride, translation + row * stride, stride};
  }
};

/// Square matrices without gaps, by columns or by rows.
struct MutableMatrices {
  double* data;
  std::size_t stride;
  bool by_rows;

  MutableMatrices from(std::size_t row) const { return {data + row * stride, stride, by_rows}; }
};

// Functions of `count` rotations.
void so3_exp_of(ConstRows phi, MutableRows rotations, std::size_t count);
void so3_log_of(ConstRows rotations, MutableRows phi, std::size_t count);
void so3_left_jacobian_of(ConstRows phi, MutableMatrices result, std::size_t count);
void so3_left_jacobian_inverse_of(ConstRows phi, MutableMatrices result, std::size_t count);
void so3_product_of(ConstRows x, ConstRows y, MutableRows result, std::size_t count);
void so3_inverse_of(ConstRows x, MutableRows result, std::size_t count);

// Functions of `count` poses.
void exp_of(ConstRows xi, MutablePoseRows poses, std::size_t count);
void log_of(ConstPoseRows poses, MutableRows xi, std::size_t count);
void left_jacobian_of(ConstRows xi, MutableMatrices result, std::size_t count);
void left_jacobian_inverse_of(ConstRows xi, MutableMatrices result, std::size_t count);
void left_jacobian_blocks_of(ConstRows xi, MutableRows blocks, std::size_t count);
void left_jacobian_inverse_blocks_of(ConstRows xi, MutableRows blocks, std::size_t count);
void product_of(ConstPoseRows x, ConstPoseRows y, MutablePoseRows result, std::size_t count);
void inverse_of(ConstPoseRows x, MutablePoseRows result, std::size_t count);

/// Ad(X) P Ad(X)^T; exactly symmetric.
void adjoint_congruence_of(ConstPoseRows poses, ConstRows covariances, MutableRows result,
                           std::size_t count);

/// Poses with covariances of their left perturbations.
struct ConstDensities {
  ConstPoseRows mean;
  ConstRows covariance;

  ConstDensities from(std::size_t row) const { return {mean.from(row), covariance.from(row)}; }
};
struct MutableDensities {
  MutablePoseRows mean;
  MutableRows covariance;

  MutableDensities from(std::size_t row) const { return {mean.from(row), covariance.from(row)}; }
};
void density_product_of(ConstDensities x, ConstDensities y, MutableDensities result,
                        std::size_t count);
/// X^-1 Y.
void density_between_of(ConstDensities x, ConstDensities y, MutableDensities result,
                        std::size_t count);
void density_inverse_of(ConstDensities x, MutableDensities result, std::size_t count);

/// Calls part(first, count) for the parts of `count` rows on `threads` threads, 0 for one per core.
void for_parts(std::size_t count, std::size_t threads,
               const std::function<void(std::size_t, std::size_t)>& part);

/// One of the functions above on several threads.
template <class Function, class... Rows>
void by_parts(Function function, std::size_t count, std::size_t threads, const Rows&... rows) {
  for_parts(count, threads,
            [&](std::size_t first, std::size_t part) { function(rows.from(first)..., part); });
}

}  // namespace posemix::internal
