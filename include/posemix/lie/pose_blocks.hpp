// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include <Eigen/Core>

/// The parts of vectors and matrices over the tangent space of several poses, six coordinates each.
/// All functions but offset() return views; a view of an argument that is not const can be assigned
/// to.
namespace posemix {

inline constexpr Eigen::Index kPoseDof = 6;

/// Index of the first coordinate of a pose, or the size of the tangent space of that many poses.
inline constexpr Eigen::Index offset(std::size_t pose) {
  return kPoseDof * static_cast<Eigen::Index>(pose);
}

/// The six rows of a pose.
template <class Matrix>
auto rows(Matrix& matrix, std::size_t pose) {
  return matrix.template middleRows<kPoseDof>(offset(pose));
}

/// The six columns of a pose.
template <class Matrix>
auto columns(Matrix& matrix, std::size_t pose) {
  return matrix.template middleCols<kPoseDof>(offset(pose));
}

/// The 6x6 block in the rows of one pose and the columns of another.
template <class Matrix>
auto block(Matrix& matrix, std::size_t row, std::size_t column) {
  return matrix.template block<kPoseDof, kPoseDof>(offset(row), offset(column));
}

/// The six coordinates of a pose in a vector.
template <class Vector>
auto segment(Vector& vector, std::size_t pose) {
  return vector.template segment<kPoseDof>(offset(pose));
}

}  // namespace posemix
