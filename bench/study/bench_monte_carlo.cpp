// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// One run of the Monte-Carlo study by method, 1000 detections, against the single-Gaussian filter
// of the same run.
#include <benchmark/benchmark.h>

#include "study/monte_carlo/study.hpp"

namespace {

void one_run(benchmark::State& state, const char* method) {
  posemix::MonteCarloStudySettings settings;
  settings.methods = {method};
  for (auto _ : state) {
    benchmark::DoNotOptimize(posemix::run_monte_carlo(settings, 4.0, 0));
  }
}

BENCHMARK_CAPTURE(one_run, riekf, "riekf")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(one_run, midway, "midway")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(one_run, tangent_of_larger, "tangent_of_larger")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(one_run, iterated, "iterated")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(one_run, moment_matched, "moment_matched")->Unit(benchmark::kMillisecond);

}  // namespace
