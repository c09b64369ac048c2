// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "posemix/base/linear.hpp"

/// Decompositions of Eigen that are compiled once, in eigen_instances.cpp. The precompiled headers
/// of rooms and tests include this file: without it the compiler instantiates the same
/// factorisations in nearly every source, which takes up to two fifths of its time.

/// The type of a sum of two matrices, the argument of compute() in `(A + B).llt()`.
#define POSEMIX_EIGEN_SUM(M) \
  Eigen::CwiseBinaryOp<Eigen::internal::scalar_sum_op<double, double>, const M, const M>

// NOLINTBEGIN(bugprone-macro-parentheses): the arguments are types and a keyword.
#define POSEMIX_EIGEN_DECOMPOSITIONS(prefix, M)                                                \
  prefix template class Eigen::SelfAdjointEigenSolver<M>;                                      \
  prefix template Eigen::SelfAdjointEigenSolver<M>& Eigen::SelfAdjointEigenSolver<M>::compute( \
      const Eigen::EigenBase<M>&, int);                                                        \
  prefix template Eigen::LLT<M>& Eigen::LLT<M>::compute(const Eigen::EigenBase<M>&);           \
  prefix template Eigen::LLT<M>& Eigen::LLT<M>::compute(                                       \
      const Eigen::EigenBase<POSEMIX_EIGEN_SUM(M)>&)
// NOLINTEND(bugprone-macro-parentheses)

POSEMIX_EIGEN_DECOMPOSITIONS(extern, Eigen::Matrix3d);
POSEMIX_EIGEN_DECOMPOSITIONS(extern, posemix::Matrix6d);
POSEMIX_EIGEN_DECOMPOSITIONS(extern, Eigen::MatrixXd);

/// The kernel of matrix products of dynamic size.
#define POSEMIX_EIGEN_PRODUCT_KERNEL(prefix)                                                     \
  prefix template struct Eigen::internal::gebp_kernel<                                           \
      double, double, Eigen::Index,                                                              \
      Eigen::internal::blas_data_mapper<double, Eigen::Index, Eigen::ColMajor, Eigen::Unaligned, \
                                        1>,                                                      \
      Eigen::internal::gebp_traits<double, double>::mr,                                          \
      Eigen::internal::gebp_traits<double, double>::nr, false, false>

POSEMIX_EIGEN_PRODUCT_KERNEL(extern);
