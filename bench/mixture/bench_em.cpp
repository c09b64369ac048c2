// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <vector>

#include <benchmark/benchmark.h>

#include "posemix/mixture/em.hpp"

/// EM of seven components on SE(3). The counter `per_iteration` is the time of one iteration.
namespace posemix {
namespace {

using Density = ConcentratedGaussian<SE3d>;

Mixture<Density> scattered_mixture(std::size_t components, RandomStream& stream) {
  std::vector<Component<Density>> parts;
  for (std::size_t k = 0; k < components; ++k) {
    Eigen::VectorXd centre(6);
    stream.fill_normal(centre);
    parts.push_back({0.0, Density(SE3d::exp(0.5 * centre), Matrix6d(0.04 * Matrix6d::Identity()))});
  }
  return Mixture<Density>(std::move(parts));
}

void bench_iterations(benchmark::State& state) {
  RandomStream stream(1);
  const Mixture<Density> truth = scattered_mixture(7, stream);
  std::vector<SE3d> samples;
  for (std::int64_t i = 0; i < state.range(0); ++i) samples.push_back(truth.sample(stream));
  const EmSettings settings{.components = 7, .max_iterations = 5, .tolerance = 0.0};
  double passes = 0.0;
  for (auto _ : state) {
    const auto fit = fit_mixture<Density>(samples, {}, settings, stream, truth);
    passes += static_cast<double>(fit.history.size());
  }
  state.counters["per_iteration"] =
      benchmark::Counter(passes, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(bench_iterations)
    ->Name("em_se3_7_components")
    ->Arg(100000)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace posemix
