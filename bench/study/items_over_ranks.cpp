// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// usage: [mpirun -n N] items_over_ranks ITEMS MICROSECONDS [THREADS]
// A study of so many items that keep a thread busy for so long, over all ranks: what leading them
// costs. Rank 0 prints the time, the items per second, and the processor time of its leading
// thread.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <thread>

#include "study/engine/run_study.hpp"

namespace {

using Clock = std::chrono::steady_clock;

posemix::Study sleeping_study(std::size_t items, std::chrono::microseconds duration) {
  const auto work = [duration](std::size_t) {
    std::this_thread::sleep_for(duration);
    return std::string(300, 'x');  // as long as an item of `study monte-carlo`
  };
  return {"sleeping", "{}", items, work,
          [](std::span<const std::string>) { return posemix::StudyReport{}; }};
}

double processor_seconds_of_thread() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("usage: items_over_ranks ITEMS MICROSECONDS [THREADS]\n", stderr);
    return 2;
  }
  const auto items = static_cast<std::size_t>(std::atoll(argv[1]));
  const std::chrono::microseconds duration(std::atoll(argv[2]));
  const std::size_t threads = argc > 3 ? static_cast<std::size_t>(std::atoll(argv[3])) : 1;
  posemix::Ranks ranks;
  const auto begin = Clock::now();
  const double before = processor_seconds_of_thread();
  const auto run = posemix::run_study(ranks, [&] { return sleeping_study(items, duration); },
                                      {.threads = threads});
  if (!run) return 0;
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  const double led = processor_seconds_of_thread() - before;
  const auto count = static_cast<double>(items);
  std::printf("%d ranks: %.3f s, %.0f items per second, %.2f us of the leading thread per item\n",
              ranks.size(), seconds, count / seconds, 1e6 * led / count);
  return 0;
}
