// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "posemix/base/linear.hpp"
#include "posemix/lie/pose_blocks.hpp"

/// Products with the covariance of a pose stack, 6x6 block by block. Dim is 6 for one detection, so
/// that every block has a size known at compile time, and Eigen::Dynamic for several.
namespace posemix::internal {

template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;
template <int Dim>
using Square = Eigen::Matrix<double, Dim, Dim>;
/// Six rows per pose of the stack, and one column per observed coordinate.
template <int Dim>
using Tall = Eigen::Matrix<double, Eigen::Dynamic, Dim>;

/// p -= a b^T where p is symmetric and stays so: the entries above the diagonal are computed and
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

/// c S^-1 from the Cholesky factor L of S: first c L^-T column by column, then its product with
/// L^-1.
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
