// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <vector>

#include <benchmark/benchmark.h>

#include "posemix/base/random.hpp"
#include "posemix/lie/lie.hpp"

// A million elements at once into a newly allocated result, as in the Python package: the reference
// for bench/python/batch.py.
namespace posemix {
namespace {

constexpr std::size_t kMany = 1000000;

template <typename G>
std::vector<typename G::Tangent> many_tangents() {
  RandomStream random(7);
  std::vector<typename G::Tangent> result(kMany);
  for (auto& xi : result) {
    for (double& x : xi) x = random.normal();
  }
  return result;
}

template <typename G>
void ExpMany(benchmark::State& state) {
  const auto xis = many_tangents<G>();
  for (auto _ : state) {
    std::vector<G> result(kMany);
    for (std::size_t i = 0; i < kMany; ++i) result[i] = G::exp(xis[i]);
    benchmark::DoNotOptimize(result.data());
  }
}

template <typename G>
void LogMany(benchmark::State& state) {
  const auto xis = many_tangents<G>();
  std::vector<G> elements(kMany);
  for (std::size_t i = 0; i < kMany; ++i) elements[i] = G::exp(xis[i]);
  for (auto _ : state) {
    std::vector<typename G::Tangent> result(kMany);
    for (std::size_t i = 0; i < kMany; ++i) result[i] = elements[i].log();
    benchmark::DoNotOptimize(result.data());
  }
}

BENCHMARK(ExpMany<SO3d>)->Unit(benchmark::kMillisecond);
BENCHMARK(LogMany<SO3d>)->Unit(benchmark::kMillisecond);
BENCHMARK(ExpMany<SE3d>)->Unit(benchmark::kMillisecond);
BENCHMARK(LogMany<SE3d>)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace posemix
