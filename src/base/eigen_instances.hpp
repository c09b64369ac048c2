// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "posemix/base/linear.hpp"

/// Decompositions of Eigen that are compiled once, in eigen_instances.cpp. This header is part of
/// the precompiled ones of rooms and tests: the compiler would otherwise instantiate the same
/// factorisations in nearly every source, which is up to two fifths of its time.

/// A sum of two matrices, as `(A + B).llt()` hands it on.
#define POSEMIX_EIGEN_SUM(M) \
  Eigen::CwiseBinaryOp<Eigen::internal::scalar_sum_op<double, double>, const M, const M>

#define POSEMIX_EIGEN_DECOMPOSITIONS(prefix, M)                                                \
  prefix template class Eigen::SelfAdjointEigenSolver<M>;                                      \
  prefix template Eigen::SelfAdjointEigenSolver<M>& Eigen::SelfAdjointEigenSolver<M>::compute( \
      const Eigen::EigenBase<M>&, int);                                                        \
  prefix template Eigen::LLT<M>& Eigen::LLT<M>::compute(const Eigen::EigenBase<M>&);           \
  prefix template Eigen::LLT<M>& Eigen::LLT<M>::compute(                                       \
      const Eigen::EigenBase<POSEMIX_EIGEN_SUM(M)>&)

POSEMIX_EIGEN_DECOMPOSITIONS(extern, Eigen::Matrix3d);
POSEMIX_EIGEN_DECOMPOSITIONS(extern, posemix::Matrix6d);
POSEMIX_EIGEN_DECOMPOSITIONS(extern, Eigen::MatrixXd);

/// The kernel of products of dynamic matrices.
#define POSEMIX_EIGEN_PRODUCT_KERNEL(prefix)                                                     \
  prefix template struct Eigen::internal::gebp_kernel<                                           \
      double, double, Eigen::Index,                                                              \
      Eigen::internal::blas_data_mapper<double, Eigen::Index, Eigen::ColMajor, Eigen::Unaligned, \
                                        1>,                                                      \
      Eigen::internal::gebp_traits<double, double>::mr,                                          \
      Eigen::internal::gebp_traits<double, double>::nr, false, false>

POSEMIX_EIGEN_PRODUCT_KERNEL(extern);
