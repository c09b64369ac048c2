// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <benchmark/benchmark.h>

#include "posemix/base/random.hpp"

namespace {

void uniform(benchmark::State& state) {
  posemix::RandomStream random(1);
  for (auto _ : state) benchmark::DoNotOptimize(random.uniform());
}
BENCHMARK(uniform);

void normal(benchmark::State& state) {
  posemix::RandomStream random(1);
  for (auto _ : state) benchmark::DoNotOptimize(random.normal());
}
BENCHMARK(normal);

}  // namespace
