// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>

/// Products and factors of the small dense matrices of filters, with the widest vector instructions
/// of the machine. All sizes but those that are summed over are multiples of six, the coordinates
/// of a pose; a matrix that is solved for may have any number of rows. Sums run over vectors of
/// rows, so that no sum is over lanes.
namespace posemix::internal {

using MatrixRef = Eigen::Ref<Eigen::MatrixXd>;
using ConstMatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

/// c -= a b^T.
void subtract_product(MatrixRef c, ConstMatrixRef a, ConstMatrixRef b);

/// The lower triangle of p -= a b^T. The entries above it are left, but for those of the 6x6 blocks
/// on the diagonal.
void subtract_lower_product(MatrixRef p, ConstMatrixRef a, ConstMatrixRef b);

/// p -= a b^T for a symmetric p and product: the entries on and above the diagonal are computed,
/// and mirrored.
void subtract_symmetric_product(MatrixRef p, ConstMatrixRef a, ConstMatrixRef b);

/// The same into another matrix, result = p - a b^T.
void set_symmetric_difference(MatrixRef result, ConstMatrixRef p, ConstMatrixRef a,
                              ConstMatrixRef b);

/// The Cholesky factor L of a symmetric S = L L^T, of which the lower triangle is read, in its
/// place. False, and the lower triangle is lost, when S is not positive definite.
[[nodiscard]] bool factor_in_place(MatrixRef s);

/// x <- x L^-T.
void solve_transposed_from_right(ConstMatrixRef l, MatrixRef x);
/// x <- x L^-1.
void solve_after_transposed(ConstMatrixRef l, MatrixRef x);
/// x <- x S^-1 = x L^-T L^-1.
void solve_from_right(ConstMatrixRef l, MatrixRef x);

/// c = a - b, of any size.
void set_difference(MatrixRef c, ConstMatrixRef a, ConstMatrixRef b);

/// y = a x.
void set_product(Eigen::VectorXd& y, ConstMatrixRef a, const Eigen::Ref<const Eigen::VectorXd>& x);

/// log det S of its factor L.
double log_det_of_factor(ConstMatrixRef l);

/// The strict upper triangle takes the values of the lower one.
void mirror_lower_in_place(MatrixRef m);

}  // namespace posemix::internal
