// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <limits>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/slam/association.hpp"

namespace posemix {
namespace {

constexpr Eigen::Index kNoRow = -1;

/// Rows are matched one after the other along the shortest augmenting path. Potentials u and v keep
/// every reduced cost c_ij - u_i - v_j at least zero, and at zero where matched (Kuhn; Jonker and
/// Volgenant).
class Matching {
 public:
  explicit Matching(const Eigen::MatrixXd& cost)
      : cost_(cost),
        u_(Eigen::VectorXd::Zero(cost.rows())),
        v_(Eigen::VectorXd::Zero(cost.cols())),
        row_of_(static_cast<std::size_t>(cost.cols()), kNoRow) {}

  void add(Eigen::Index row) {
    const auto columns = static_cast<std::size_t>(cost_.cols());
    constexpr double kFar = std::numeric_limits<double>::infinity();
    std::vector<double> distance(columns, kFar);
    std::vector<Eigen::Index> before(columns, kNoRow);
    std::vector<bool> is_done(columns, false);
    Eigen::Index at = kNoRow;  // column that the path ends with
    Eigen::Index from = row;
    double length = 0.0;
    do {
      Eigen::Index nearest = kNoRow;
      double least = kFar;
      for (Eigen::Index j = 0; j < cost_.cols(); ++j) {
        const auto k = static_cast<std::size_t>(j);
        if (is_done[k]) continue;
        const double through = length + cost_(from, j) - u_[from] - v_[j];
        if (through < distance[k]) {
          distance[k] = through;
          before[k] = at;
        }
        if (distance[k] < least) {
          least = distance[k];
          nearest = j;
        }
      }
      at = nearest;
      length = least;
      is_done[static_cast<std::size_t>(at)] = true;
      from = row_of_[static_cast<std::size_t>(at)];
    } while (from != kNoRow);
    move_potentials(row, length, distance, is_done, at);
    turn_over(row, before, at);
  }

  const std::vector<Eigen::Index>& row_of() const { return row_of_; }

 private:
  void move_potentials(Eigen::Index row, double length, const std::vector<double>& distance,
                       const std::vector<bool>& is_done, Eigen::Index last) {
    u_[row] += length;
    for (Eigen::Index j = 0; j < cost_.cols(); ++j) {
      const auto k = static_cast<std::size_t>(j);
      if (!is_done[k] || j == last) continue;
      u_[row_of_[k]] += length - distance[k];
      v_[j] -= length - distance[k];
    }
  }

  /// Every column of the path takes the row of the column before it, the first one the new row.
  void turn_over(Eigen::Index row, const std::vector<Eigen::Index>& before, Eigen::Index at) {
    while (at != kNoRow) {
      const Eigen::Index previous = before[static_cast<std::size_t>(at)];
      row_of_[static_cast<std::size_t>(at)] =
          previous == kNoRow ? row : row_of_[static_cast<std::size_t>(previous)];
      at = previous;
    }
  }

  const Eigen::MatrixXd& cost_;
  Eigen::VectorXd u_;
  Eigen::VectorXd v_;
  std::vector<Eigen::Index> row_of_;
};

}  // namespace

std::vector<Eigen::Index> least_cost_assignment(const Eigen::MatrixXd& cost) {
  if (cost.rows() > cost.cols() || !cost.allFinite()) {
    throw InvalidInput(
        fmt::format("assignment of {} rows to {} columns, expected finite costs and at least as "
                    "many columns as rows",
                    cost.rows(), cost.cols()));
  }
  Matching matching(cost);
  for (Eigen::Index row = 0; row < cost.rows(); ++row) matching.add(row);
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(cost.rows()));
  for (Eigen::Index j = 0; j < cost.cols(); ++j) {
    const Eigen::Index row = matching.row_of()[static_cast<std::size_t>(j)];
    if (row != kNoRow) columns[static_cast<std::size_t>(row)] = j;
  }
  return columns;
}

}  // namespace posemix
