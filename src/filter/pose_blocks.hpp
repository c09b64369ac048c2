// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "posemix/base/linear.hpp"
#include "posemix/lie/twist_matrix.hpp"

/// Products with the covariance of a pose stack, 6x6 block by block. Dim is 6 where one detection
/// is processed, so that every block has a size known at compile time, and Eigen::Dynamic for
/// several at once. In the room `filter` only.
namespace posemix::internal {

inline constexpr Eigen::Index kPoseDof = 6;

inline Eigen::Index offset(std::size_t pose) { return kPoseDof * static_cast<Eigen::Index>(pose); }

template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;
template <int Dim>
using Square = Eigen::Matrix<double, Dim, Dim>;
/// Six rows per pose of the stack, one column per coordinate that is observed.
template <int Dim>
using Tall = Eigen::Matrix<double, Eigen::Dynamic, Dim>;

/// The six rows, six columns, or the square block of poses.
template <class Matrix>
auto rows(Matrix& matrix, std::size_t pose) {
  return matrix.template middleRows<kPoseDof>(offset(pose));
}
template <class Matrix>
auto columns(Matrix& matrix, std::size_t pose) {
  return matrix.template middleCols<kPoseDof>(offset(pose));
}
template <class Matrix>
auto block(Matrix& matrix, std::size_t row, std::size_t column) {
  return matrix.template block<kPoseDof, kPoseDof>(offset(row), offset(column));
}

/// The coordinates of one pose.
template <class Vector>
auto segment(Vector& vector, std::size_t pose) {
  return vector.template segment<kPoseDof>(offset(pose));
}

/// p -= a b^T for a p that is and stays symmetric: what is above the diagonal is computed, the rest
/// mirrored.
template <int Dim>
void subtract_symmetric_product(Eigen::MatrixXd& p, const Tall<Dim>& a, const Tall<Dim>& b) {
  if constexpr (Dim == Eigen::Dynamic) {
    p.triangularView<Eigen::Upper>() -= a * b.transpose();
    p.triangularView<Eigen::StrictlyLower>() = p.transpose();
  } else {
    const auto poses = static_cast<std::size_t>(p.rows() / kPoseDof);
    for (std::size_t j = 0; j < poses; ++j) {
      const Matrix6d b_j = rows(b, j);
      for (std::size_t i = 0; i <= j; ++i) {
        const Matrix6d a_i = rows(a, i);
        Matrix6d difference = block(p, i, j);
        difference.noalias() -= a_i * b_j.transpose();
        if (i == j) difference = mirror_upper(difference);
        block(p, i, j) = difference;
        if (i != j) block(p, j, i) = difference.transpose();
      }
    }
  }
}

/// c S^-1 for the Cholesky factor L of S: c L^-T column by column, then that times L^-1.
template <int Dim>
Tall<Dim> times_inverse(const Tall<Dim>& c, const Eigen::LLT<Square<Dim>>& s) {
  if constexpr (Dim == Eigen::Dynamic) {
    return s.solve(c.transpose()).transpose();
  } else {
    const Matrix6d& l = s.matrixLLT();
    const Vector6d reciprocal = l.diagonal().cwiseInverse();
    Tall<Dim> result(c.rows(), Dim);
    for (std::size_t pose = 0; pose < static_cast<std::size_t>(c.rows() / kPoseDof); ++pose) {
      Matrix6d x = rows(c, pose);
      for (Eigen::Index j = 0; j < Dim; ++j) {
        for (Eigen::Index k = 0; k < j; ++k) x.col(j) -= x.col(k) * l(j, k);
        x.col(j) *= reciprocal(j);
      }
      for (Eigen::Index j = Dim - 1; j >= 0; --j) {
        for (Eigen::Index k = j + 1; k < Dim; ++k) x.col(j) -= x.col(k) * l(k, j);
        x.col(j) *= reciprocal(j);
      }
      rows(result, pose) = x;
    }
    return result;
  }
}

}  // namespace posemix::internal
