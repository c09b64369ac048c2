// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/engine/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/base/random.hpp"
#include "simulated_ranks.hpp"
#include "study/engine/messages.hpp"

namespace posemix {
namespace {

using testing::SimulatedRanks;

/// What rank 0 needs for a message, and for an item in it. items_over_ranks measures 1 to 4 us an
/// item, messages included; the journal is the rest.
constexpr double kSecondsPerMessage = 10e-6;
constexpr double kSecondsPerItem = 8e-6;

std::vector<std::size_t> items_of(std::span<const ItemRange> ranges) {
  std::vector<std::size_t> items;
  for (const ItemRange& range : ranges) {
    for (std::size_t i = 0; i < range.count; ++i) items.push_back(range.first + i);
  }
  return items;
}

/// A study of ranks with one thread each under a Schedule.
SimulatedRanks::Run run_simulated(std::size_t ranks, std::size_t items,
                                  std::function<double(std::size_t)> duration) {
  Schedule schedule(std::vector<bool>(items, false), ranks);
  std::vector<bool> joined(ranks, false);
  const auto handle = [&](std::size_t rank, std::span<const std::size_t> finished, double seconds) {
    if (!joined[rank]) schedule.join(rank, 1);
    joined[rank] = true;
    schedule.finished(rank, finished.size(), seconds);
    return SimulatedRanks::Answer{
        schedule.next(rank),
        kSecondsPerMessage + kSecondsPerItem * static_cast<double>(finished.size())};
  };
  return SimulatedRanks(ranks, items, std::move(duration), handle).run();
}

void expect_each_once(const SimulatedRanks::Run& run) {
  EXPECT_TRUE(std::all_of(run.done.begin(), run.done.end(), [](auto n) { return n == 1; }));
}

TEST(Schedule, HandsOutEveryItemOnceAndInOrderButThoseThatAreFinished) {
  constexpr std::size_t kItems = 5000;
  constexpr std::size_t kRanks = 7;
  RandomStream stream(1);
  std::vector<bool> finished(kItems);
  for (std::size_t i = 0; i < kItems; ++i) finished[i] = stream.uniform() < 0.3;
  Schedule schedule(finished, kRanks);
  for (std::size_t rank = 0; rank < kRanks; ++rank) schedule.join(rank, 1 + rank % 3);
  std::vector<std::size_t> order;
  std::vector<std::size_t> held(kRanks, 0);
  std::size_t in_vain = 0;
  while (in_vain < 100 * kRanks) {
    const auto rank = static_cast<std::size_t>(stream.uniform() * kRanks);
    const std::vector<std::size_t> got = items_of(schedule.next(rank));
    order.insert(order.end(), got.begin(), got.end());
    held[rank] += got.size();
    const auto done =
        static_cast<std::size_t>(stream.uniform() * static_cast<double>(held[rank] + 1));
    schedule.finished(rank, done, 1e-3 * static_cast<double>(done));
    held[rank] -= done;
    in_vain = got.empty() && done == 0 ? in_vain + 1 : 0;
  }
  std::vector<std::size_t> expected;
  for (std::size_t i = 0; i < kItems; ++i) {
    if (!finished[i]) expected.push_back(i);
  }
  EXPECT_EQ(order, expected);
}

TEST(Schedule, GivesNothingToARankThatHasNotJoined) {
  Schedule schedule(std::vector<bool>(10, false), 2);
  EXPECT_TRUE(schedule.next(1).empty());
  schedule.join(1, 1);
  EXPECT_FALSE(schedule.next(1).empty());
}

TEST(Schedule, LongItemsAreHandedOutOneByOneAndOneMoreForEveryRank) {
  Schedule schedule(std::vector<bool>(1000, false), 2);
  schedule.join(0, 1);
  schedule.join(1, 4);
  for (int round = 0; round < 50; ++round) {
    EXPECT_EQ(items_of(schedule.next(0)).size(), round == 0 ? 2U : 1U);
    EXPECT_EQ(items_of(schedule.next(1)).size(), round == 0 ? 5U : 1U);
    schedule.finished(0, 1, 60.0);
    schedule.finished(1, 1, 60.0);
  }
}

TEST(Schedule, NoItemLiesBehindAnotherWhereThereAreNoMoreItemsThanThreads) {
  constexpr std::size_t kRanks = 10'000;
  const auto run = run_simulated(kRanks, kRanks, [](std::size_t) { return 60.0; });
  expect_each_once(run);
  // All at the same time, after the first message of every rank.
  EXPECT_LT(run.seconds, 60.0 + 2.0 * kRanks * (kSecondsPerMessage + kSecondsPerItem));
}

TEST(Schedule, ShortItemsAreHandedOutInChunksThatEndSmall) {
  constexpr std::size_t kItems = 100'000;
  Schedule schedule(std::vector<bool>(kItems, false), 2);
  schedule.join(0, 1);
  schedule.join(1, 1);
  std::size_t largest = 0;
  std::size_t last = 0;
  for (std::size_t rank = 0;; rank = 1 - rank) {
    const std::size_t count = items_of(schedule.next(rank)).size();
    if (count == 0) break;
    largest = std::max(largest, count);
    last = count;
    schedule.finished(rank, count, 10e-6 * static_cast<double>(count));
  }
  EXPECT_GT(largest, 100U) << "a millisecond between messages is 100 items of 10 us";
  EXPECT_LE(last, 3U) << "one, and what it works on while rank 0 answers both";
}

TEST(Schedule, TenThousandRanksAreKeptBusyByALeaderThatIsNot) {
  constexpr std::size_t kRanks = 10'000;
  constexpr std::size_t kItems = 1'000'000;
  constexpr double kDuration = 0.2;
  const auto run = run_simulated(kRanks, kItems, [](std::size_t) { return kDuration; });
  expect_each_once(run);
  // Fifty thousand items a second, of which a message each would take rank 0 0.9 of its time.
  const double least = kDuration * kItems / kRanks;
  EXPECT_LT(run.seconds, 1.05 * least);
  EXPECT_LT(run.busy_seconds, 0.6 * run.seconds);
}

TEST(Schedule, ManyRanksSendNoMoreMessagesThanTheLeaderCanRead) {
  for (const std::size_t ranks : {10U, 100U, 1000U, 10'000U}) {
    SCOPED_TRACE(ranks);
    const double duration = static_cast<double>(ranks) / 50e3;  // 50,000 items a second
    const auto run = run_simulated(ranks, 500'000, [&](std::size_t) { return duration; });
    expect_each_once(run);
    // Ten thousand a second, and those of ranks that run dry: at the start, where nothing is known
    // of items, and at the end.
    EXPECT_LT(static_cast<double>(run.messages),
              10e3 * run.seconds + 20.0 * static_cast<double>(ranks));
  }
}

TEST(Schedule, ItemsOfUnequalLengthEndTogether) {
  constexpr std::size_t kRanks = 1000;
  constexpr std::size_t kItems = 100'000;
  RandomStream stream(3);
  std::vector<double> durations(kItems);
  // Within a factor of a hundred, and the longest ones last.
  for (double& duration : durations) duration = 0.02 * std::pow(100.0, stream.uniform());
  std::sort(durations.begin(), durations.end());
  const double least = std::accumulate(durations.begin(), durations.end(), 0.0) / kRanks;
  const auto run = run_simulated(kRanks, kItems, [&](std::size_t item) { return durations[item]; });
  expect_each_once(run);
  // A list in any order is at most the longest item worse than the best schedule (Graham 1966); a
  // rank may hold one more behind it.
  EXPECT_LT(run.seconds, least + 2.0 * durations.back() + 0.5);
}

TEST(RankMessages, HaveItemsAndResultsOfAnyText) {
  const std::vector<ItemRange> ranges{{3, 4}, {std::size_t{1} << 40, 1}};
  const auto found = ranges_in(ranges_message(ranges));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(items_of(std::span(found).first(1)), (std::vector<std::size_t>{3, 4, 5, 6}));
  EXPECT_EQ(found[1].first, std::size_t{1} << 40);
  const std::vector<FinishedItem> items{{7, ""}, {8, std::string("a\0b\n", 4)}, {9, "{}"}};
  const FinishedBatch batch = results_in(results_message(items, 0.1));
  EXPECT_EQ(batch.seconds, 0.1);
  ASSERT_EQ(batch.items.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(batch.items[i].item, items[i].item);
    EXPECT_EQ(batch.items[i].text, items[i].text);
  }
}

TEST(RankMessages, AreRefusedWhenTheyAreCutOff) {
  const std::vector<FinishedItem> items{{7, "result"}};
  const std::string whole = results_message(items, 0.1);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    if (length == sizeof(double)) continue;  // a message of no items
    EXPECT_THROW(results_in(whole.substr(0, length)), std::runtime_error) << length;
  }
  EXPECT_THROW(ranges_in("1234567"), std::runtime_error);
}

}  // namespace
}  // namespace posemix
