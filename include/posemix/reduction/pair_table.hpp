// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "posemix/mixture/mixture.hpp"

namespace posemix {

enum class PairRule;
enum class DistanceMetric;

}  // namespace posemix

namespace posemix::internal {

/// The costs of all pairs of a list that shrinks, and the least of every row, so that the next pair
/// is found without looking at all of them. A member has a *slot* that does not change while others
/// are erased; members keep their order. Slots are renumbered when half of them are empty.
class PairTable {
 public:
  PairTable() = default;
  /// Without costs, which set() gives row by row.
  explicit PairTable(std::size_t size);

  std::size_t size() const { return slots_.size(); }
  /// The slot of every member, in rising order.
  const std::vector<std::size_t>& slots() const { return slots_; }
  /// Number of slots, the empty ones included.
  std::size_t slot_count() const { return count_; }

  /// Sets the costs of the pairs of member `i` with those before it, by the slot of the other.
  void set_before(std::size_t i, const double* costs);
  /// Sets the costs of the pairs of member `i` with all others, by the slot of the other.
  void set_all(std::size_t i, const double* costs);
  /// Erases a member. True when slots were renumbered: every member then has its place as its slot.
  bool erase(std::size_t i);

  /// The pair of least cost; among equal ones that which is first in order of a, then b. The first
  /// two where no cost is a number below infinity.
  std::pair<std::size_t, std::size_t> least() const;

 private:
  /// The least cost of a row, and the slot of the other.
  struct Least {
    double cost = std::numeric_limits<double>::infinity();
    std::size_t with = 0;
  };

  /// The costs of a row with all slots before it.
  double* row(std::size_t slot) { return &costs_[slot * (slot - 1) / 2]; }
  void search(std::size_t slot);
  void renumber();

  std::size_t count_ = 0;
  std::vector<double> costs_;  ///< by slots, the larger one first; infinite where one is empty
  std::vector<Least> least_;   ///< by slot, over the slots before it
  std::vector<std::size_t> slots_;
};

/// The numbers of Gaussians on SE(3) by slots, from which the costs of many pairs are computed at
/// once by vector instructions.
class ComponentColumns {
 public:
  /// Numbers beyond the last one that whole vectors may touch.
  static constexpr std::size_t kRoom = 8;

  ComponentColumns() = default;
  explicit ComponentColumns(std::size_t slots);

  void set(std::size_t slot, const Component<ConcentratedGaussian<SE3d>>& component);
  /// The slots given, in rising order, become the first ones.
  void renumber(const std::vector<std::size_t>& slots);
  /// The costs of pairs of a slot with the first `count` ones. `costs` has room for kRoom more.
  void costs(PairRule rule, DistanceMetric metric, std::size_t slot, std::size_t count,
             double* costs) const;

 private:
  std::size_t stride_ = 0;
  std::vector<double> numbers_;  ///< field by field
};

}  // namespace posemix::internal
