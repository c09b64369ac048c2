// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/batch.hpp"

#include <vector>

#include <benchmark/benchmark.h>

#include "posemix/base/random.hpp"

// Batches beside loops over the functions of SO3 and SE3, on one thread: 1,000 items, which stay in
// the cache, and a million into newly allocated results, as in the Python package, for which these
// are the reference (bench/python/batch.py). `per_item` is the time of one in seconds.
namespace posemix {
namespace {

constexpr std::size_t kMany = 1000000;

template <typename G>
std::vector<typename G::Tangent> tangents(std::size_t count) {
  RandomStream random(7);
  std::vector<typename G::Tangent> result(count);
  for (auto& xi : result) {
    for (double& x : xi) x = random.normal();
  }
  return result;
}

template <typename G>
std::vector<G> elements(std::size_t count) {
  std::vector<G> result;
  for (const auto& xi : tangents<G>(count)) result.push_back(G::exp(xi));
  return result;
}

std::vector<Matrix6d> covariances(std::size_t count) {
  std::vector<Matrix6d> result;
  for (const Vector6d& xi : tangents<SE3d>(count))
    result.push_back(Matrix6d::Identity() + xi * xi.transpose());
  return result;
}

/// Times fill(result), where results are new for every run if there are many.
template <typename Item, typename Fill>
void run(benchmark::State& state, const Fill& fill) {
  const auto count = static_cast<std::size_t>(state.range(0));
  std::vector<Item> kept(count < kMany ? count : 0);
  for (auto _ : state) {
    if (count < kMany) {
      fill(kept);
      benchmark::DoNotOptimize(kept.data());
    } else {
      std::vector<Item> result(count);
      fill(result);
      benchmark::DoNotOptimize(result.data());
    }
    benchmark::ClobberMemory();
  }
  state.counters["per_item"] =
      benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate |
                                                         benchmark::Counter::kInvert);
}

std::size_t count_of(const benchmark::State& state) {
  return static_cast<std::size_t>(state.range(0));
}

template <typename G>
void ExpLoop(benchmark::State& state) {
  const auto xi = tangents<G>(count_of(state));
  run<G>(state, [&](auto& result) {
    for (std::size_t i = 0; i < xi.size(); ++i) result[i] = G::exp(xi[i]);
  });
}
template <typename G>
void ExpBatch(benchmark::State& state) {
  const auto xi = tangents<G>(count_of(state));
  run<G>(state, [&](auto& result) { batch::exp(xi, result); });
}

template <typename G>
void LogLoop(benchmark::State& state) {
  const auto x = elements<G>(count_of(state));
  run<typename G::Tangent>(state, [&](auto& result) {
    for (std::size_t i = 0; i < x.size(); ++i) result[i] = x[i].log();
  });
}
template <typename G>
void LogBatch(benchmark::State& state) {
  const auto x = elements<G>(count_of(state));
  run<typename G::Tangent>(state, [&](auto& result) { batch::log(x, result); });
}

template <typename G>
void LeftJacobianInverseLoop(benchmark::State& state) {
  const auto xi = tangents<G>(count_of(state));
  run<typename G::TangentMatrix>(state, [&](auto& result) {
    for (std::size_t i = 0; i < xi.size(); ++i) result[i] = G::left_jacobian_inverse(xi[i]);
  });
}
template <typename G>
void LeftJacobianInverseBatch(benchmark::State& state) {
  const auto xi = tangents<G>(count_of(state));
  run<typename G::TangentMatrix>(state,
                                 [&](auto& result) { batch::left_jacobian_inverse(xi, result); });
}
void LeftJacobianInverseBlocksBatch(benchmark::State& state) {
  const auto xi = tangents<SE3d>(count_of(state));
  run<TwistMatrix<double>>(state, [&](auto& result) { batch::left_jacobian_inverse(xi, result); });
}
template <typename G>
void LeftJacobianBatch(benchmark::State& state) {
  const auto xi = tangents<G>(count_of(state));
  run<typename G::TangentMatrix>(state, [&](auto& result) { batch::left_jacobian(xi, result); });
}

template <typename G>
void ComposeLoop(benchmark::State& state) {
  const auto x = elements<G>(count_of(state));
  run<G>(state, [&](auto& result) {
    for (std::size_t i = 0; i < x.size(); ++i) result[i] = x[i] * x[x.size() - 1 - i];
  });
}
template <typename G>
void ComposeBatch(benchmark::State& state) {
  const auto x = elements<G>(count_of(state));
  const std::vector<G> y(x.rbegin(), x.rend());
  run<G>(state, [&](auto& result) { batch::compose(x, y, result); });
}

void ComposeCovariancesLoop(benchmark::State& state) {
  const auto x = elements<SE3d>(count_of(state));
  const auto p = covariances(x.size());
  std::vector<SE3d> products(x.size());
  run<Matrix6d>(state, [&](auto& result) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      products[i] = x[i] * x[x.size() - 1 - i];
      result[i] = p[i] + x[i].adjoint_congruence(p[x.size() - 1 - i]);
    }
  });
}
void ComposeCovariancesBatch(benchmark::State& state) {
  const auto x = elements<SE3d>(count_of(state));
  const auto p = covariances(x.size());
  const std::vector<SE3d> y(x.rbegin(), x.rend());
  const std::vector<Matrix6d> q(p.rbegin(), p.rend());
  std::vector<SE3d> products(x.size());
  run<Matrix6d>(state, [&](auto& result) { batch::compose({x, p}, {y, q}, {products, result}); });
}

#define POSEMIX_BENCH(name) BENCHMARK(name)->Arg(1000)->Arg(kMany)->Unit(benchmark::kMicrosecond)

POSEMIX_BENCH(ExpLoop<SO3d>);
POSEMIX_BENCH(ExpBatch<SO3d>);
POSEMIX_BENCH(LogLoop<SO3d>);
POSEMIX_BENCH(LogBatch<SO3d>);
POSEMIX_BENCH(LeftJacobianInverseLoop<SO3d>);
POSEMIX_BENCH(LeftJacobianInverseBatch<SO3d>);
POSEMIX_BENCH(LeftJacobianBatch<SO3d>);
POSEMIX_BENCH(ComposeLoop<SO3d>);
POSEMIX_BENCH(ComposeBatch<SO3d>);
POSEMIX_BENCH(ExpLoop<SE3d>);
POSEMIX_BENCH(ExpBatch<SE3d>);
POSEMIX_BENCH(LogLoop<SE3d>);
POSEMIX_BENCH(LogBatch<SE3d>);
POSEMIX_BENCH(LeftJacobianInverseLoop<SE3d>);
POSEMIX_BENCH(LeftJacobianInverseBatch<SE3d>);
POSEMIX_BENCH(LeftJacobianInverseBlocksBatch);
POSEMIX_BENCH(LeftJacobianBatch<SE3d>);
POSEMIX_BENCH(ComposeLoop<SE3d>);
POSEMIX_BENCH(ComposeBatch<SE3d>);
POSEMIX_BENCH(ComposeCovariancesLoop);
POSEMIX_BENCH(ComposeCovariancesBatch);

}  // namespace
}  // namespace posemix
