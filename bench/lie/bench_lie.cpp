// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <cstddef>

#include <benchmark/benchmark.h>
#include <Eigen/Core>
#include <Eigen/LU>
#include <unsupported/Eigen/MatrixFunctions>

#include "posemix/base/random.hpp"
#include "posemix/lie/lie.hpp"

// The closed forms beside general dense matrix functions (Eigen's exponential and logarithm, the
// inverse of the power series of J_l) on the same data in the same run.
namespace posemix {
namespace {

constexpr std::size_t kCount = 256;

/// Tangent vectors with rotations of about half a radian and translations of about a metre.
template <typename G>
std::array<typename G::Tangent, kCount> tangents() {
  RandomStream random(7);
  std::array<typename G::Tangent, kCount> result;
  for (auto& xi : result) {
    for (double& x : xi) x = random.normal();
    xi.template head<3>() *= 0.3;
  }
  return result;
}

template <typename G>
std::array<G, kCount> elements() {
  std::array<G, kCount> result;
  const auto xis = tangents<G>();
  for (std::size_t i = 0; i < kCount; ++i) result[i] = G::exp(xis[i]);
  return result;
}

/// Times `function` on each of `data` in turn.
template <typename Data, typename Function>
void run(benchmark::State& state, const Data& data, const Function& function) {
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(function(data[i]));
    i = (i + 1) % kCount;
  }
}

template <typename G>
void Exp(benchmark::State& state) {
  run(state, tangents<G>(), [](const auto& xi) { return G::exp(xi); });
}

template <typename G>
void ExpDense(benchmark::State& state) {
  run(state, tangents<G>(), [](const auto& xi) -> typename G::Matrix { return G::hat(xi).exp(); });
}

template <typename G>
void Log(benchmark::State& state) {
  run(state, elements<G>(), [](const G& x) { return x.log(); });
}

template <typename G>
void LogDense(benchmark::State& state) {
  std::array<typename G::Matrix, kCount> matrices;
  const auto xs = elements<G>();
  for (std::size_t i = 0; i < kCount; ++i) matrices[i] = xs[i].matrix();
  run(state, matrices, [](const auto& m) -> typename G::Matrix { return m.log(); });
}

template <typename G>
void LeftJacobianInverse(benchmark::State& state) {
  run(state, tangents<G>(), [](const auto& xi) { return G::left_jacobian_inverse(xi); });
}

/// The inverse of sum ad^n / (n+1)! by LU, to double precision.
template <typename G>
void LeftJacobianInverseDense(benchmark::State& state) {
  run(state, tangents<G>(), [](const auto& xi) -> typename G::TangentMatrix {
    const typename G::TangentMatrix ad = G::ad(xi);
    typename G::TangentMatrix term = G::TangentMatrix::Identity();
    typename G::TangentMatrix sum = term;
    for (int n = 1; n < 24; ++n) {
      term = (term * ad / (n + 1)).eval();
      sum += term;
    }
    return sum.inverse();
  });
}

template <typename G>
void Compose(benchmark::State& state) {
  const G y = elements<G>()[kCount / 2];
  run(state, elements<G>(), [&y](const G& x) { return x * y; });
}

template <typename G>
void ComposeDense(benchmark::State& state) {
  std::array<typename G::Matrix, kCount> matrices;
  const auto xs = elements<G>();
  for (std::size_t i = 0; i < kCount; ++i) matrices[i] = xs[i].matrix();
  const typename G::Matrix y = matrices[kCount / 2];
  run(state, matrices, [&y](const auto& x) -> typename G::Matrix { return x * y; });
}

BENCHMARK(Exp<SO3d>);
BENCHMARK(ExpDense<SO3d>);
BENCHMARK(Exp<SE3d>);
BENCHMARK(ExpDense<SE3d>);
BENCHMARK(Log<SO3d>);
BENCHMARK(LogDense<SO3d>);
BENCHMARK(Log<SE3d>);
BENCHMARK(LogDense<SE3d>);
BENCHMARK(LeftJacobianInverse<SO3d>);
BENCHMARK(LeftJacobianInverseDense<SO3d>);
BENCHMARK(LeftJacobianInverse<SE3d>);
BENCHMARK(LeftJacobianInverseDense<SE3d>);
BENCHMARK(Compose<SO3d>);
BENCHMARK(ComposeDense<SO3d>);
BENCHMARK(Compose<SE3d>);
BENCHMARK(ComposeDense<SE3d>);

}  // namespace
}  // namespace posemix
