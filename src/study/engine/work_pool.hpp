// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "items.hpp"

namespace posemix {

/// Threads that work on items in the order in which they were submitted.
class WorkPool {
 public:
  using Work = std::function<std::string(std::size_t)>;

  /// @throws std::system_error when a thread cannot be started
  WorkPool(std::size_t threads, Work work);
  /// Drops items that have not begun and waits for the others.
  ~WorkPool();
  WorkPool(const WorkPool&) = delete;
  WorkPool& operator=(const WorkPool&) = delete;

  std::size_t threads() const { return threads_.size(); }
  void submit(std::span<const ItemRange> ranges);
  /// Drops items that have not begun.
  void cancel();
  /// The number of submitted items whose results have not been taken, those that failed among them.
  std::size_t outstanding() const;
  /// Whether every submitted item has begun, so that a thread may be waiting for more.
  bool runs_dry() const;
  /// Takes all results that are there. Waits before that, but at most for `patience`, until there
  /// are some and a thread may be waiting for more, or an item has failed.
  FinishedBatch take(std::chrono::milliseconds patience);

 private:
  void close();
  void run();
  void work_on(std::size_t item, FinishedBatch& batch) const;
  /// The next item, taken off the queue.
  std::size_t pop();

  Work work_;
  mutable std::mutex mutex_;
  std::condition_variable submitted_;
  std::condition_variable finished_;
  std::deque<ItemRange> queue_;
  FinishedBatch batch_;
  std::size_t queued_ = 0;   ///< items in the queue
  std::size_t running_ = 0;  ///< items that threads work on
  std::size_t ended_ = 0;    ///< items whose results, or errors, are in the batch
  bool closing_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace posemix
