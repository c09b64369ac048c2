// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include <Eigen/Core>

/// Square matrices that a thread keeps for the next frame of a filter. The heap gives memory of
/// their size back to the system, which clears its pages anew for the next frame.
namespace posemix::internal {

/// A matrix of undefined values.
Eigen::MatrixXd kept_matrix(Eigen::Index size);
Eigen::MatrixXd kept_copy(const Eigen::MatrixXd& square);

/// Takes in a matrix that is not used any more. What a thread keeps is bounded by kMostKeptBytes;
/// a matrix beyond that is freed.
void keep(Eigen::MatrixXd matrix);

inline constexpr std::size_t kMostKeptBytes = std::size_t{8} << 20;

}  // namespace posemix::internal
