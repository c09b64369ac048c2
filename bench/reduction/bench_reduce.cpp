// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <benchmark/benchmark.h>

#include "posemix/base/random.hpp"
#include "posemix/reduction/reduce.hpp"

// Reduction of many components on SE(3) to ten, pair after pair.
namespace posemix {
namespace {

/// Components about ten places.
template <class Density>
Mixture<Density> random_mixture(std::size_t count) {
  RandomStream stream(4, count);
  std::vector<SE3d> places;
  const auto draw = [&](double rotation, double translation) {
    Vector6d xi;
    for (double& x : xi) x = stream.normal();
    xi.head<3>() *= rotation;
    xi.tail<3>() *= translation;
    return xi;
  };
  for (int i = 0; i < 10; ++i) places.push_back(SE3d::exp(draw(0.8, 1.0)));
  std::vector<Component<Density>> components;
  for (std::size_t i = 0; i < count; ++i) {
    Matrix6d root;
    for (double& x : root.reshaped()) x = 0.03 * stream.normal();
    const SE3d mean = SE3d::exp(draw(0.2, 0.2)) * places[i % places.size()];
    components.push_back(
        {stream.normal(), Density(mean, root * root.transpose() + 1e-4 * Matrix6d::Identity())});
  }
  return Mixture<Density>(std::move(components));
}

template <class Density, PairRule kRule>
void reduce_to_ten(benchmark::State& state) {
  const Mixture<Density> mixture =
      random_mixture<Density>(static_cast<std::size_t>(state.range(0)));
  ReductionSettings settings{.prune_below = 0.0, .max_components = 10, .pair = kRule};
  for (auto _ : state) benchmark::DoNotOptimize(reduce(mixture, settings));
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("components")->Arg(100)->Arg(1000)->Unit(benchmark::kMillisecond);
}

using Concentrated = ConcentratedGaussian<SE3d>;
using Projected = ProjectedGaussian<SE3d>;
BENCHMARK(reduce_to_ten<Concentrated, PairRule::runnalls>)->Name("reduce_runnalls")->Apply(sizes);
BENCHMARK(reduce_to_ten<Concentrated, PairRule::symmetric_kl>)
    ->Name("reduce_symmetric_kl")
    ->Apply(sizes);
BENCHMARK(reduce_to_ten<Concentrated, PairRule::most_distant>)
    ->Name("reduce_most_distant")
    ->Apply(sizes);
BENCHMARK(reduce_to_ten<Projected, PairRule::runnalls>)
    ->Name("reduce_projected_runnalls")
    ->Apply(sizes);
BENCHMARK(reduce_to_ten<Projected, PairRule::symmetric_kl>)
    ->Name("reduce_projected_symmetric_kl")
    ->Apply(sizes);

}  // namespace
}  // namespace posemix
