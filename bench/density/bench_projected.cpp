// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <benchmark/benchmark.h>

#include "posemix/density/operations.hpp"
#include "posemix/density/projected_moments.hpp"
#include "posemix/density/projected_operations.hpp"

/// Projected Gaussians on SE(3): the normaliser against Monte Carlo integration with few samples,
/// and the operations against those of concentrated Gaussians.
namespace posemix {
namespace {

Matrix6d covariance(double rotation, double translation) {
  Matrix6d p = Matrix6d::Zero();
  p.diagonal().head<3>().setConstant(rotation * rotation);
  p.diagonal().tail<3>().setConstant(translation * translation);
  p(0, 4) = p(4, 0) = 0.3 * rotation * translation;
  p(1, 2) = p(2, 1) = 0.2 * rotation * rotation;
  return p;
}

template <class D>
D at(double angle) {
  return D(SE3d(SO3d::exp({angle, 0.1, -0.2}), {0.1, 0.2, 0.6}), covariance(0.08, 0.01));
}

using Projected = ProjectedGaussian<SE3d>;
using Concentrated = ConcentratedGaussian<SE3d>;

void BM_Normalizer(benchmark::State& state) {
  const Eigen::Matrix3d s = covariance(0.2, 0.01).topLeftCorner<3, 3>();
  Eigen::Vector3d mean(state.range(0) != 0 ? 0.1 : 0.0, 0.0, 0.0);
  for (auto _ : state) {
    benchmark::DoNotOptimize(mean);
    benchmark::DoNotOptimize(projected_log_normalizer(mean, s));
  }
}
BENCHMARK(BM_Normalizer)->Arg(0)->Arg(1);

/// The method of the MPG paper: 1000 samples, accurate to two digits.
void BM_NormalizerByMonteCarlo(benchmark::State& state) {
  const Eigen::Matrix3d l = covariance(0.2, 0.01).topLeftCorner<3, 3>().llt().matrixL();
  RandomStream stream(1);
  for (auto _ : state) {
    double sum = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector3d z(stream.normal(), stream.normal(), stream.normal());
      const double v = 1.0 / (1.0 + (l * z).squaredNorm());
      sum += v * v;
    }
    benchmark::DoNotOptimize(sum);
  }
}
BENCHMARK(BM_NormalizerByMonteCarlo);

template <class D>
void BM_Fuse(benchmark::State& state) {
  const D p = at<D>(0.0), q = at<D>(0.2);
  for (auto _ : state) benchmark::DoNotOptimize(fuse(p, q));
}
BENCHMARK(BM_Fuse<Projected>);
BENCHMARK(BM_Fuse<Concentrated>);

template <class D>
void BM_LogDensity(benchmark::State& state) {
  const typename D::Evaluator evaluator(at<D>(0.0));
  const SE3d pose = at<D>(0.1).mean();
  for (auto _ : state) benchmark::DoNotOptimize(evaluator.log_density(pose));
}
BENCHMARK(BM_LogDensity<Projected>);
BENCHMARK(BM_LogDensity<Concentrated>);

template <class D>
void BM_Sample(benchmark::State& state) {
  const D density = at<D>(0.0);
  RandomStream stream(1);
  for (auto _ : state) benchmark::DoNotOptimize(density.sample(stream));
}
BENCHMARK(BM_Sample<Projected>);
BENCHMARK(BM_Sample<Concentrated>);

void BM_Compose(benchmark::State& state) {
  const auto p = at<Projected>(0.0), q = at<Projected>(0.2);
  const auto rule = static_cast<CompositionRule>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(compose(p, q, rule));
}
BENCHMARK(BM_Compose)
    ->Arg(static_cast<int>(CompositionRule::cubature))
    ->Arg(static_cast<int>(CompositionRule::third_degree_cubature))
    ->Arg(static_cast<int>(CompositionRule::jacobian));

void BM_ComposeConcentrated(benchmark::State& state) {
  const auto p = at<Concentrated>(0.0), q = at<Concentrated>(0.2);
  for (auto _ : state) benchmark::DoNotOptimize(compose(p, q));
}
BENCHMARK(BM_ComposeConcentrated);

}  // namespace
}  // namespace posemix
