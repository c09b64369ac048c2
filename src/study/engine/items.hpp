// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

/// Parts of a study on their way between ranks, threads and journal.
namespace posemix {

/// Items one after the other.
struct ItemRange {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// An item and its result.
struct FinishedItem {
  std::size_t item = 0;
  std::string text;
};

/// What threads have finished since they were asked last.
struct FinishedBatch {
  std::vector<FinishedItem> items;
  double seconds = 0.0;           ///< that they took, summed over the threads
  std::exception_ptr error = {};  ///< the first that ended an item

  void add(FinishedBatch&& later) {
    std::move(later.items.begin(), later.items.end(), std::back_inserter(items));
    seconds += later.seconds;
    if (!error) error = later.error;
  }
};

}  // namespace posemix
