// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "base/kept_memory.hpp"

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

/// A matrix in kept memory, for what is needed a while. Its entries are zero at first.
template <int Columns = Eigen::Dynamic>
class KeptMatrix {
 public:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Columns>;

  explicit KeptMatrix(Eigen::Index rows = 0, Eigen::Index columns = Columns)
      : rows_(rows), columns_(columns), values_(static_cast<std::size_t>(rows * columns), 0.0) {}

  Eigen::Map<Matrix> get() { return {values_.data(), rows_, columns_}; }
  Eigen::Map<const Matrix> get() const { return {values_.data(), rows_, columns_}; }

 private:
  Eigen::Index rows_;
  Eigen::Index columns_;
  KeptVector<double> values_;
};

}  // namespace posemix::internal
