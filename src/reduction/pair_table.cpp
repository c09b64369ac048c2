// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/reduction/pair_table.hpp"

#include <algorithm>
#include <numeric>

namespace posemix::internal {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

}  // namespace

PairTable::PairTable(std::size_t size)
    : count_(size), costs_(size * (size + 1) / 2, kNone), least_(size), slots_(size) {
  std::iota(slots_.begin(), slots_.end(), std::size_t{0});
}

void PairTable::search(std::size_t slot) {
  Least least;
  for (std::size_t other = 0; other < slot; ++other) {
    if (row(slot)[other] < least.cost) least = {row(slot)[other], other};
  }
  least_[slot] = least;
}

void PairTable::set_before(std::size_t i, const double* costs) {
  const std::size_t slot = slots_[i];
  for (std::size_t k = 0; k < i; ++k) row(slot)[slots_[k]] = costs[slots_[k]];
  search(slot);
}

void PairTable::set_all(std::size_t i, const double* costs) {
  set_before(i, costs);
  const std::size_t slot = slots_[i];
  for (std::size_t k = i + 1; k < slots_.size(); ++k) {
    const std::size_t later = slots_[k];
    const double cost = costs[later];
    row(later)[slot] = cost;
    Least& least = least_[later];
    if (least.with == slot) {
      search(later);
    } else if (cost < least.cost || (cost == least.cost && slot < least.with)) {
      least = {cost, slot};
    }
  }
}

bool PairTable::erase(std::size_t i) {
  const std::size_t slot = slots_[i];
  slots_.erase(slots_.begin() + static_cast<std::ptrdiff_t>(i));
  for (std::size_t k = i; k < slots_.size(); ++k) {
    row(slots_[k])[slot] = kNone;
    if (least_[slots_[k]].with == slot) search(slots_[k]);
  }
  if (2 * slots_.size() > count_) return false;
  renumber();
  return true;
}

void PairTable::renumber() {
  for (std::size_t i = 1; i < slots_.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) row(i)[k] = row(slots_[i])[slots_[k]];
  }
  count_ = slots_.size();
  std::iota(slots_.begin(), slots_.end(), std::size_t{0});
  for (std::size_t slot = 0; slot < count_; ++slot) search(slot);
}

std::pair<std::size_t, std::size_t> PairTable::least() const {
  double cost = kNone;
  std::size_t row = 1;
  std::size_t column = 0;
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    const Least& one = least_[slots_[k]];
    if (one.cost < cost || (one.cost == cost && one.cost < kNone && one.with < slots_[column])) {
      cost = one.cost;
      row = k;
      column = static_cast<std::size_t>(std::lower_bound(slots_.begin(), slots_.end(), one.with) -
                                        slots_.begin());
    }
  }
  return {column, row};
}

}  // namespace posemix::internal
