// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace posemix {

/// A finished work item: its text, or the error that ended it.
struct WorkResult {
  std::size_t item;
  std::string text;
  std::exception_ptr error;
};

/// Threads that work on items in the order in which they were submitted.
class WorkPool {
 public:
  using Work = std::function<std::string(std::size_t)>;

  WorkPool(std::size_t threads, Work work);
  /// Drops items that have not begun and waits for the others.
  ~WorkPool();
  WorkPool(const WorkPool&) = delete;
  WorkPool& operator=(const WorkPool&) = delete;

  std::size_t threads() const { return threads_.size(); }
  void submit(std::size_t item);
  /// Drops items that have not begun.
  void cancel();
  /// The number of submitted items whose results have not been taken.
  std::size_t outstanding() const;
  /// Takes all available results; waits for one, but at most for `patience`.
  std::vector<WorkResult> take(std::chrono::milliseconds patience);

 private:
  void run();

  Work work_;
  mutable std::mutex mutex_;
  std::condition_variable submitted_;
  std::condition_variable finished_;
  std::deque<std::size_t> queue_;
  std::vector<WorkResult> results_;
  std::size_t running_ = 0;
  bool closing_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace posemix
