// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// The cost of leading a study per work item, with and without a journal. The items only return a
// text as long as that of a Monte-Carlo item. The inverse of the cost is the rate of items at which
// rank 0 saturates.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>

#include <unistd.h>

#include "study/engine/run_study.hpp"

namespace {

posemix::Study empty_study(std::size_t items) {
  return {"empty", "{}", items, [](std::size_t) { return std::string(300, 'x'); },
          [](std::span<const std::string>) { return posemix::StudyReport{}; }};
}

void run(posemix::Ranks& ranks, std::size_t items, const std::filesystem::path& journal) {
  const auto done = posemix::run_study(ranks, [items] { return empty_study(items); },
                                       {.threads = 1, .journal = journal});
  if (!journal.empty()) std::filesystem::remove(journal);
  benchmark::DoNotOptimize(&done);
}

posemix::Ranks& the_ranks() {
  static posemix::Ranks ranks;
  return ranks;
}

constexpr std::size_t kItems = 20000;

void without_journal(benchmark::State& state) {
  for (auto _ : state) run(the_ranks(), kItems, {});
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kItems));
}

void with_journal(benchmark::State& state) {
  const auto journal = std::filesystem::temp_directory_path() /
                       ("posemix-bench-" + std::to_string(getpid()) + ".journal");
  for (auto _ : state) run(the_ranks(), kItems, journal);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kItems));
}

BENCHMARK(without_journal)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(with_journal)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
