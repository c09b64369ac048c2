// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "schedule.hpp"

#include <algorithm>
#include <cmath>

namespace posemix {
namespace {

constexpr std::chrono::microseconds kTimePerMessage{100};
constexpr std::chrono::microseconds kShortestTime{1000};
constexpr std::chrono::microseconds kTimeOfMessage{10};
/// So many items, and two of each thread, tell the time that others will take.
constexpr double kEnough = 32.0;
/// An item takes some time, whatever a clock says [s].
constexpr double kShortestItem = 1e-8;
/// Ranks look for messages once in a millisecond, so that an answer takes up to two; as much again
/// in reserve.
constexpr std::chrono::microseconds kAnswer{4000};

double seconds_of(std::chrono::microseconds time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

std::chrono::microseconds time_between_messages(std::size_t ranks) {
  return std::max(kShortestTime, kTimePerMessage * static_cast<std::int64_t>(ranks));
}

Schedule::Schedule(const std::vector<bool>& finished, std::size_t ranks)
    : threads_(ranks),
      round_(seconds_of(kTimeOfMessage * static_cast<std::int64_t>(ranks))),
      horizon_(seconds_of(2 * time_between_messages(ranks) + kAnswer)),
      ranks_(ranks) {
  for (std::size_t item = 0; item < finished.size(); ++item) {
    if (finished[item]) continue;
    const bool goes_on = item > 0 && !finished[item - 1];
    if (goes_on) {
      ++waiting_.back().count;
    } else {
      waiting_.push_back({item, 1});
    }
    ++count_waiting_;
  }
}

void Schedule::join(std::size_t rank, std::size_t threads) {
  ranks_[rank].threads = threads;
  threads_ += threads - 1;
}

double Schedule::items_in(double seconds) const {
  if (finished_ < kEnough) return 0.0;
  return seconds * finished_ / std::max(seconds_, kShortestItem * finished_);
}

std::size_t Schedule::wanted(const Rank& rank) const {
  const auto threads = static_cast<double>(rank.threads);
  // Where fewer wait than there are threads, none lies behind another.
  const std::size_t one_more = count_waiting_ > threads_ ? 1 : 0;
  const auto in_all = [&](double per_thread) {
    return rank.threads + std::max(one_more, static_cast<std::size_t>(threads * per_thread));
  };
  const double share = static_cast<double>(count_waiting_) / static_cast<double>(threads_);
  const auto half = static_cast<std::size_t>(threads * share / 2.0);
  return std::max(in_all(items_in(round_)), std::min(in_all(items_in(horizon_)), half));
}

std::vector<ItemRange> Schedule::next(std::size_t rank) {
  Rank& its = ranks_[rank];
  if (its.threads == 0) return {};
  const std::size_t most = wanted(its);
  if (its.items > std::max(its.threads, most / 2)) return {};
  std::vector<ItemRange> ranges = take(most - its.items);
  for (const ItemRange& range : ranges) its.items += range.count;
  return ranges;
}

void Schedule::finished(std::size_t rank, std::size_t items, double seconds) {
  ranks_[rank].items -= items;
  const auto count = static_cast<double>(items);
  const double kept = std::max(0.0, 1.0 - count / (kEnough + 2.0 * static_cast<double>(threads_)));
  seconds_ = kept * seconds_ + seconds;
  finished_ = kept * finished_ + count;
}

std::vector<ItemRange> Schedule::take(std::size_t count) {
  std::vector<ItemRange> ranges;
  while (count > 0 && !waiting_.empty()) {
    ItemRange& front = waiting_.front();
    const std::size_t taken = std::min(count, front.count);
    ranges.push_back({front.first, taken});
    front.first += taken;
    front.count -= taken;
    if (front.count == 0) waiting_.pop_front();
    count -= taken;
    count_waiting_ -= taken;
  }
  return ranges;
}

}  // namespace posemix
