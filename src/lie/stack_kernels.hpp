// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "posemix/lie/twist_matrix.hpp"

/// Congruences of the covariances of stacks of poses, with the widest vector instructions of the
/// machine. PoseStack's templates are the reference.
namespace posemix::internal {

/// weight B P B^T with B block-diagonal, of which `blocks` has the blocks, one for every pose. Of P
/// the 6x6 blocks on and above the diagonal are read.
struct Congruence {
  const TwistMatrix<double>* blocks;
  const Eigen::MatrixXd* p;
  double weight;
};

/// Numbers of a 6x6 block whose columns are filled up to vectors of eight.
inline constexpr std::size_t kMostPadded = 48;

/// A sum of congruences and of D D^T, with scratch of kMostPadded numbers for every block.
struct CongruenceSum {
  const Congruence* parts;
  std::size_t count;
  std::size_t poses;
  const double* d;
  std::size_t deviations;
  double* scratch;
};

/// sum <- the sum of the congruences, of stacks of equal size, and of D D^T; exactly symmetric.
/// `sum` has the size of the covariances, D as many rows and any number of columns.
void sum_congruences(std::span<const Congruence> parts, const Eigen::MatrixXd& d,
                     Eigen::MatrixXd& sum);

}  // namespace posemix::internal
