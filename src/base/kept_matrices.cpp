// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "base/kept_matrices.hpp"

#include <utility>
#include <vector>

namespace posemix::internal {
namespace {

/// Below this the heap is as fast.
constexpr std::size_t kLeastBytes = 4096;

std::size_t bytes_of(const Eigen::MatrixXd& matrix) {
  return sizeof(double) * static_cast<std::size_t>(matrix.size());
}

/// Matrices of one thread, all of the size of the last one: a filter has one size.
struct Kept {
  std::vector<Eigen::MatrixXd> matrices;
  std::size_t bytes = 0;

  void clear() {
    matrices.clear();
    bytes = 0;
  }
};

Kept& of_this_thread() {
  static thread_local Kept kept;
  return kept;
}

}  // namespace

Eigen::MatrixXd kept_matrix(Eigen::Index size) {
  Kept& kept = of_this_thread();
  if (kept.matrices.empty() || kept.matrices.back().rows() != size)
    return Eigen::MatrixXd(size, size);
  Eigen::MatrixXd matrix = std::move(kept.matrices.back());
  kept.matrices.pop_back();
  kept.bytes -= bytes_of(matrix);
  return matrix;
}

Eigen::MatrixXd kept_copy(const Eigen::MatrixXd& square) {
  Eigen::MatrixXd copy = kept_matrix(square.rows());
  copy = square;
  return copy;
}

void keep(Eigen::MatrixXd matrix) {
  const std::size_t bytes = bytes_of(matrix);
  if (bytes < kLeastBytes || matrix.rows() != matrix.cols()) return;
  Kept& kept = of_this_thread();
  if (!kept.matrices.empty() && kept.matrices.back().rows() != matrix.rows()) kept.clear();
  if (kept.bytes + bytes > kMostKeptBytes) return;
  kept.matrices.push_back(std::move(matrix));
  kept.bytes += bytes;
}

}  // namespace posemix::internal
