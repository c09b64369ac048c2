// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <vector>

#include "items.hpp"

namespace posemix {

/// The time between two messages of a rank with results, so that rank 0 has no more than ten
/// thousand messages a second to read, however many ranks there are.
std::chrono::microseconds time_between_messages(std::size_t ranks);

/// Which items a rank gets next, and how many (guided self-scheduling, Polychronopoulos and Kuck
/// 1987, with a limit in time).
///
/// A rank is given the items that it needs until its next message and the answer to it, by the mean
/// time of the last items of all ranks. So items that take long are handed out one by one, and
/// short ones in chunks. A chunk is at most half of the rank's share of what waits, so that chunks
/// become small at the end: as many as it has threads, one more while there are enough, and where
/// there are thousands of ranks, what it works on while rank 0 answers all others.
///
/// Invariants: items are handed out in order and each once; the schedule decides on who works on an
/// item, and nothing else.
class Schedule {
 public:
  /// All items of a study but those that are finished, for so many ranks.
  Schedule(const std::vector<bool>& finished, std::size_t ranks);

  /// A rank is there, with its threads.
  void join(std::size_t rank, std::size_t threads);
  /// What a rank is to get now; often nothing.
  std::vector<ItemRange> next(std::size_t rank);
  /// A rank has finished so many items, in so many seconds summed over its threads.
  void finished(std::size_t rank, std::size_t items, double seconds);

 private:
  struct Rank {
    std::size_t threads = 0;  ///< 0 until it joins
    std::size_t items = 0;    ///< handed out and not finished
  };

  /// The number of items that keep a thread busy for so long; none while nothing is known of them.
  double items_in(double seconds) const;
  std::size_t wanted(const Rank& rank) const;
  std::vector<ItemRange> take(std::size_t count);

  std::deque<ItemRange> waiting_;
  std::size_t count_waiting_ = 0;
  std::size_t threads_ = 0;  ///< of all ranks, each of which has one at least
  double round_;             ///< seconds that rank 0 needs at least for a message of every rank
  double horizon_;           ///< seconds until the next message of a rank and the answer
  double seconds_ = 0.0;     ///< that the last items took
  double finished_ = 0.0;    ///< their number
  std::vector<Rank> ranks_;
};

}  // namespace posemix
