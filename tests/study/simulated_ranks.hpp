// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <functional>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "study/engine/schedule.hpp"

namespace posemix::testing {

/// A study over many ranks of one thread each, in simulated time: when ranks finish items, when
/// they send results (as `follow` does), and when rank 0, which handles one message after the
/// other, has answered. A message takes a millisecond, the time between two looks for messages.
class SimulatedRanks {
 public:
  /// What rank 0 does on a message.
  struct Answer {
    std::vector<ItemRange> ranges;
    double seconds = 0.0;  ///< that it takes
  };
  /// Rank 0 on a message of a rank, with results and the seconds that they took; without results
  /// for the first message of a rank.
  using Handle =
      std::function<Answer(std::size_t rank, std::span<const std::size_t> items, double seconds)>;

  struct Run {
    double seconds = 0.0;           ///< until the last result is with rank 0
    double busy_seconds = 0.0;      ///< of rank 0
    std::size_t messages = 0;       ///< that rank 0 has received
    std::vector<std::size_t> done;  ///< how often each item has been done
  };

  SimulatedRanks(std::size_t ranks, std::size_t items, std::function<double(std::size_t)> duration,
                 Handle handle)
      : duration_(std::move(duration)), handle_(std::move(handle)), ranks_(ranks) {
    run_.done.resize(items);
  }

  Run run() {
    for (std::size_t rank = 0; rank < ranks_.size(); ++rank)
      events_.push({kLatency, rank, [this, rank] { arrive(rank, {}, 0.0); }, order_++});
    while (!events_.empty()) {
      const Event event = events_.top();
      events_.pop();
      now_ = event.time;
      event.happen();
    }
    return run_;
  }

 private:
  static constexpr double kLatency = 1e-3;

  struct Event {
    double time;
    std::size_t rank;
    std::function<void()> happen;
    std::size_t order;
    bool operator<(const Event& other) const {
      return std::pair(time, order) > std::pair(other.time, other.order);
    }
  };

  struct Rank {
    std::deque<ItemRange> queue;
    std::vector<std::size_t> held;
    double held_seconds = 0.0;
    double next_message = 0.0;
    bool works = false;
  };

  void at(double time, std::size_t rank, std::function<void()> happen) {
    events_.push({time, rank, std::move(happen), order_++});
  }

  void begin_item(std::size_t rank) {
    Rank& its = ranks_[rank];
    its.works = !its.queue.empty();
    if (!its.works) return;
    ItemRange& front = its.queue.front();
    const std::size_t item = front.first++;
    if (--front.count == 0) its.queue.pop_front();
    const double duration = duration_(item);
    at(now_ + duration, rank, [this, rank, item, duration] { end_item(rank, item, duration); });
  }

  void end_item(std::size_t rank, std::size_t item, double duration) {
    Rank& its = ranks_[rank];
    its.held.push_back(item);
    its.held_seconds += duration;
    begin_item(rank);
    if (!its.queue.empty() && now_ < its.next_message) return;
    const std::chrono::duration<double> wait = time_between_messages(ranks_.size());
    its.next_message = now_ + wait.count();
    at(now_ + kLatency, rank,
       [this, rank, items = std::exchange(its.held, {}),
        seconds = std::exchange(its.held_seconds, 0.0)] { arrive(rank, items, seconds); });
  }

  void arrive(std::size_t rank, std::span<const std::size_t> items, double seconds) {
    for (const std::size_t item : items) ++run_.done[item];
    Answer answer = handle_(rank, items, seconds);
    ++run_.messages;
    run_.busy_seconds += answer.seconds;
    free_ = std::max(free_, now_) + answer.seconds;
    if (!items.empty()) run_.seconds = free_;
    if (answer.ranges.empty()) return;
    at(free_ + kLatency, rank, [this, rank, ranges = std::move(answer.ranges)] {
      Rank& its = ranks_[rank];
      its.queue.insert(its.queue.end(), ranges.begin(), ranges.end());
      if (!its.works) begin_item(rank);
    });
  }

  std::function<double(std::size_t)> duration_;
  Handle handle_;
  std::vector<Rank> ranks_;
  std::priority_queue<Event> events_;
  std::size_t order_ = 0;
  double now_ = 0.0;
  double free_ = 0.0;  ///< when rank 0 has answered all messages so far
  Run run_;
};

}  // namespace posemix::testing
