// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <cstddef>
#include <numbers>

#include <benchmark/benchmark.h>

#include "posemix/base/units.hpp"
#include "posemix/divergence/monte_carlo.hpp"
#include "posemix/divergence/paper_grid.hpp"
#include "posemix/divergence/so3_quadrature.hpp"
#include "posemix/divergence/wasserstein.hpp"

/// A divergence by the adaptive quadrature, and by the plain sum over a grid of 3 degrees in the
/// ball; a counter has their relative difference. Compare the lines of one run.
namespace posemix {
namespace {

using Peak = ConcentratedGaussian<SO3d>;
using Peaks = Mixture<Peak>;

struct Pair {
  Peaks p;
  Peak q;
};

/// The example of section V of the midway-merge paper at 30 deg per axis, which has an axis of
/// symmetry.
Pair axisymmetric() {
  const auto covariance = [](double degrees) -> Eigen::Matrix3d {
    return radians(degrees) * radians(degrees) * Eigen::Matrix3d::Identity();
  };
  const SO3d other = SO3d::exp(radians(30.0) * Eigen::Vector3d(1, -1, 1));
  const Peaks p({{std::log(0.5), Peak(SO3d(), covariance(5.0))},
                 {std::log(0.5), Peak(other, covariance(10.0))}});
  const SO3d centre = interpolate(SO3d(), other, 0.5);
  return {p, back_project(tangent_moments<SO3d>(p.components(), centre))};
}

/// The example with the same means and correlated covariances.
Pair anisotropic() {
  Pair pair = axisymmetric();
  Eigen::Matrix3d shape;
  shape << 1.0, 0.4, -0.2, 0.4, 0.6, 0.1, -0.2, 0.1, 1.3;
  std::vector<Component<Peak>> parts;
  for (const auto& c : pair.p.components()) {
    parts.push_back({c.log_weight, {c.density.mean(), c.density.covariance()(0, 0) * shape}});
  }
  const SO3d centre = pair.q.mean();
  return {Peaks(parts), back_project(tangent_moments<SO3d>(parts, centre))};
}

struct GridSums {
  double kl = 0.0;
  double isd = 0.0;
};

/// Euler's method in the ball with the exact logarithm.
GridSums ball_grid(const Pair& pair, double step) {
  const Peaks::Evaluator log_p(pair.p);
  const Peak::Evaluator log_q(pair.q);
  const int reach = static_cast<int>(std::numbers::pi / step);
  GridSums sum;
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      for (int k = -reach; k <= reach; ++k) {
        const Eigen::Vector3d xi = step * Eigen::Vector3d(i, j, k);
        if (xi.squaredNorm() > std::numbers::pi * std::numbers::pi) continue;
        const SO3d x = SO3d::exp(xi) * pair.q.mean();
        const double volume = std::exp(SO3d::log_abs_det_left_jacobian(xi));
        const double at_p = log_p.log_density(x);
        const double at_q = log_q.log_density(x);
        sum.kl += volume * std::exp(at_p) * (at_p - at_q);
        sum.isd += volume * std::pow(std::exp(at_p) - std::exp(at_q), 2);
      }
    }
  }
  const double cell = step * step * step;
  return {sum.kl * cell, sum.isd * cell};
}

template <Pair kPair()>
void bench_grid(benchmark::State& state) {
  const Pair pair = kPair();
  GridSums sums;
  for (auto _ : state) benchmark::DoNotOptimize(sums = ball_grid(pair, radians(3.0)));
  state.counters["kl_difference"] = sums.kl / kl(pair.p, pair.q).value - 1.0;
  state.counters["isd_difference"] = sums.isd / isd(pair.p, pair.q).value - 1.0;
}

using Divergence = DivergenceEstimate(const RotationDensity&, const RotationDensity&,
                                      const RotationQuadratureSettings&);

template <Pair kPair(), Divergence kDivergence>
void bench_quadrature(benchmark::State& state) {
  const Pair pair = kPair();
  DivergenceEstimate estimate{};
  for (auto _ : state) benchmark::DoNotOptimize(estimate = kDivergence(pair.p, pair.q, {}));
  const double exact = kDivergence(pair.p, pair.q, {.relative_tolerance = 1e-9}).value;
  state.counters["evaluations"] = static_cast<double>(estimate.evaluations);
  state.counters["relative_error"] = std::abs(estimate.value / exact - 1.0);
  state.counters["estimated"] = estimate.error / estimate.value;
}

void bench_paper_grid(benchmark::State& state) {
  const Pair pair = axisymmetric();
  PaperGridDivergence grid{};
  for (auto _ : state) {
    benchmark::DoNotOptimize(grid = paper_grid_divergence(pair.p, pair.q, radians(3.0)));
  }
  state.counters["relative_error"] = std::abs(grid.kl / kl(pair.p, pair.q).value - 1.0);
}

void bench_poses(benchmark::State& state) {
  using Poses = Mixture<ConcentratedGaussian<SE3d>>;
  Vector6d step;
  step << 0.2, -0.1, 0.3, 0.1, 0.2, -0.3;
  const ConcentratedGaussian<SE3d> a(SE3d(), 0.01 * Matrix6d::Identity());
  const ConcentratedGaussian<SE3d> b(SE3d::exp(step), 0.02 * Matrix6d::Identity());
  const Poses p({{std::log(0.6), a}, {std::log(0.4), b}});
  const Poses q({{0.0, back_project(tangent_moments<SE3d>(p.components(), a.mean()))}});
  RandomStream stream(1);
  DivergenceEstimate estimate{};
  for (auto _ : state) benchmark::DoNotOptimize(estimate = kl_monte_carlo(p, q, stream));
  state.counters["evaluations"] = static_cast<double>(estimate.evaluations);
  state.counters["estimated"] = estimate.error / estimate.value;
}

void bench_wasserstein(benchmark::State& state) {
  const Pair pair = anisotropic();
  const Peaks q({{0.0, pair.q}});
  for (auto _ : state) benchmark::DoNotOptimize(mixture_wasserstein(pair.p, q));
}

void in_milliseconds(benchmark::internal::Benchmark* benchmark) {
  benchmark->Unit(benchmark::kMillisecond);
}

BENCHMARK(bench_grid<axisymmetric>)->Name("ball_grid_3deg/axisymmetric")->Apply(in_milliseconds);
BENCHMARK(bench_quadrature<axisymmetric, kl>)->Name("kl/axisymmetric")->Apply(in_milliseconds);
BENCHMARK(bench_quadrature<axisymmetric, isd>)->Name("isd/axisymmetric")->Apply(in_milliseconds);
BENCHMARK(bench_grid<anisotropic>)->Name("ball_grid_3deg/anisotropic")->Apply(in_milliseconds);
BENCHMARK(bench_quadrature<anisotropic, kl>)->Name("kl/anisotropic")->Apply(in_milliseconds);
BENCHMARK(bench_quadrature<anisotropic, isd>)->Name("isd/anisotropic")->Apply(in_milliseconds);
BENCHMARK(bench_quadrature<anisotropic, symmetric_kl>)
    ->Name("symmetric_kl/anisotropic")
    ->Apply(in_milliseconds);
BENCHMARK(bench_paper_grid)->Name("paper_grid_3deg")->Apply(in_milliseconds);
BENCHMARK(bench_poses)->Name("kl_monte_carlo/se3_65536")->Apply(in_milliseconds);
BENCHMARK(bench_wasserstein)->Name("mixture_wasserstein/2_to_1")->Apply(in_milliseconds);

}  // namespace
}  // namespace posemix
