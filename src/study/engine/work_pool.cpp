// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "work_pool.hpp"

#include <utility>

namespace posemix {

WorkPool::WorkPool(std::size_t threads, Work work) : work_(std::move(work)) {
  for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
}

WorkPool::~WorkPool() {
  {
    const std::lock_guard lock(mutex_);
    queue_.clear();
    closing_ = true;
  }
  submitted_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkPool::submit(std::size_t item) {
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back(item);
  }
  submitted_.notify_one();
}

void WorkPool::cancel() {
  const std::lock_guard lock(mutex_);
  queue_.clear();
}

std::size_t WorkPool::outstanding() const {
  const std::lock_guard lock(mutex_);
  return queue_.size() + running_ + results_.size();
}

std::vector<WorkResult> WorkPool::take(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  finished_.wait_for(lock, patience, [this] { return !results_.empty(); });
  return std::exchange(results_, {});
}

void WorkPool::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    submitted_.wait(lock, [this] { return closing_ || !queue_.empty(); });
    if (queue_.empty()) return;
    WorkResult result{queue_.front(), {}, {}};
    queue_.pop_front();
    ++running_;
    lock.unlock();
    try {
      result.text = work_(result.item);
    } catch (...) {
      result.error = std::current_exception();
    }
    lock.lock();
    --running_;
    results_.push_back(std::move(result));
    finished_.notify_one();
  }
}

}  // namespace posemix
