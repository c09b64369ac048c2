// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "work_pool.hpp"

#include <utility>

namespace posemix {

WorkPool::WorkPool(std::size_t threads, Work work) : work_(std::move(work)) {
  try {
    for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
  } catch (...) {
    close();
    throw;
  }
}

WorkPool::~WorkPool() { close(); }

void WorkPool::close() {
  cancel();
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  submitted_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkPool::submit(std::span<const ItemRange> ranges) {
  std::size_t count = 0;
  {
    const std::lock_guard lock(mutex_);
    for (const ItemRange& range : ranges) {
      if (range.count == 0) continue;
      queue_.push_back(range);
      count += range.count;
    }
    queued_ += count;
  }
  if (count == 1) {
    submitted_.notify_one();
  } else {
    submitted_.notify_all();
  }
}

void WorkPool::cancel() {
  const std::lock_guard lock(mutex_);
  queue_.clear();
  queued_ = 0;
}

std::size_t WorkPool::outstanding() const {
  const std::lock_guard lock(mutex_);
  return queued_ + running_ + ended_;
}

bool WorkPool::runs_dry() const {
  const std::lock_guard lock(mutex_);
  return queued_ == 0;
}

FinishedBatch WorkPool::take(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  finished_.wait_for(lock, patience,
                     [this] { return batch_.error || (ended_ > 0 && queued_ == 0); });
  ended_ = 0;
  return std::exchange(batch_, {});
}

std::size_t WorkPool::pop() {
  ItemRange& front = queue_.front();
  const std::size_t item = front.first++;
  if (--front.count == 0) queue_.pop_front();
  --queued_;
  ++running_;
  return item;
}

void WorkPool::work_on(std::size_t item, FinishedBatch& batch) const {
  const auto begin = std::chrono::steady_clock::now();
  try {
    batch.items.push_back({item, work_(item)});
  } catch (...) {
    batch.error = std::current_exception();
  }
  batch.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void WorkPool::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    submitted_.wait(lock, [this] { return closing_ || queued_ > 0; });
    if (queued_ == 0) return;
    const std::size_t item = pop();
    lock.unlock();
    FinishedBatch its;
    work_on(item, its);
    lock.lock();
    --running_;
    ++ended_;
    batch_.add(std::move(its));
    if (batch_.error || queued_ == 0) finished_.notify_one();
  }
}

}  // namespace posemix
