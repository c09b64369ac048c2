// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>

#include "posemix/grasp/success_probability.hpp"

/// The probability of a tolerance box under ten projected Gaussians: quasi-Monte Carlo within the
/// box against counting samples, with the standard error of each.
namespace posemix {
namespace {

Mixture<ProjectedGaussian<SE3d>> ten_components() {
  std::vector<Component<ProjectedGaussian<SE3d>>> components;
  RandomStream stream(1);
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(9e-4), Eigen::Vector3d::Constant(9e-6);
  for (int k = 0; k < 10; ++k) {
    const Eigen::Vector3d turn(stream.normal(), stream.normal(), stream.normal());
    const Eigen::Vector3d shift(stream.normal(), stream.normal(), stream.normal());
    const SE3d mean(SO3d::exp(0.02 * turn), Eigen::Vector3d(0.001 * shift));
    components.push_back({0.0, ProjectedGaussian<SE3d>(mean, Matrix6d(variance.asDiagonal()))});
  }
  return Mixture<ProjectedGaussian<SE3d>>(std::move(components));
}

const ToleranceBox kBox{Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(0.005)};

void BM_SuccessProbability(benchmark::State& state) {
  const auto mixture = ten_components();
  RandomStream stream(2);
  const SuccessSettings settings{.points = static_cast<std::size_t>(state.range(0))};
  SuccessEstimate success{};
  for (auto _ : state) {
    success = success_probability(mixture, kBox, SE3d(), stream, settings);
  }
  state.counters["probability"] = success.probability;
  state.counters["error"] = success.error;
}
BENCHMARK(BM_SuccessProbability)->Arg(1 << 5)->Arg(1 << 9)->Unit(benchmark::kMicrosecond);

void BM_CountedSamples(benchmark::State& state) {
  const auto mixture = ten_components();
  RandomStream stream(3);
  double probability = 0.0;
  const int samples = 10000;
  for (auto _ : state) {
    int inside = 0;
    for (int i = 0; i < samples; ++i) {
      const SE3d x = mixture.sample(stream);
      const Eigen::Vector3d u = gnomonic::lift(SO3d(), x.rotation());
      const bool in = u.cwiseAbs().maxCoeff() <= std::tan(0.05) &&
                      x.translation().cwiseAbs().maxCoeff() <= 0.005;
      inside += in ? 1 : 0;
    }
    probability = static_cast<double>(inside) / samples;
  }
  state.counters["probability"] = probability;
  state.counters["error"] = std::sqrt(probability * (1.0 - probability) / samples);
}
BENCHMARK(BM_CountedSamples)->Unit(benchmark::kMicrosecond);

void BM_BestGrasp(benchmark::State& state) {
  const auto mixture = ten_components();
  RandomStream stream(4);
  for (auto _ : state) benchmark::DoNotOptimize(best_grasp(mixture, kBox, stream));
}
BENCHMARK(BM_BestGrasp)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace posemix
