// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <ctime>
#include <map>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "posemix/mixture/em.hpp"

/// EM of seven components on SE(3) and R^6: one iteration (a pass over all samples and the M-step),
/// against a naive pass with functions of one sample at a time. The counter `ratio` is the naive
/// time over the time of EM in this run.
namespace posemix {
namespace {

constexpr std::size_t kComponents = 7;

template <class D>
Mixture<D> scattered_mixture(RandomStream& stream) {
  std::vector<Component<D>> parts;
  for (std::size_t k = 0; k < kComponents; ++k) {
    Eigen::VectorXd centre(6);
    stream.fill_normal(centre);
    parts.push_back({0.0, D(D::Group::exp(0.5 * centre), Matrix6d(0.04 * Matrix6d::Identity()))});
  }
  return Mixture<D>(std::move(parts));
}

template <class D>
struct Problem {
  Mixture<D> truth;
  std::vector<typename D::Group> samples;

  static const Problem& of(std::int64_t count) {
    static std::map<std::int64_t, Problem> problems;
    if (const auto found = problems.find(count); found != problems.end()) return found->second;
    RandomStream stream(1);
    Problem problem{scattered_mixture<D>(stream), {}};
    for (std::int64_t i = 0; i < count; ++i)
      problem.samples.push_back(problem.truth.sample(stream));
    return problems.emplace(count, std::move(problem)).first->second;
  }
};

template <LieGroup G>
Vector6d coordinates(const ConcentratedGaussian<G>& density, const G& sample) {
  return (sample * density.mean().inverse()).log();
}
Vector6d coordinates(const ProjectedGaussian<SE3d>& density, const SE3d& sample) {
  return density.coordinates(sample);
}

double seconds_of_processor() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

/// Processor time [s] for the shares and second moments of a tenth of the samples, one by one.
template <class D>
double naive_seconds(const Problem<D>& problem) {
  std::vector<typename D::Evaluator> evaluators;
  for (const auto& component : problem.truth.components()) {
    evaluators.emplace_back(component.density);
  }
  std::vector<Matrix6d> second(kComponents, Matrix6d::Zero());
  std::vector<double> terms(kComponents);
  const double begin = seconds_of_processor();
  for (std::size_t i = 0; i < problem.samples.size(); i += 10) {
    const typename D::Group& sample = problem.samples[i];
    for (std::size_t k = 0; k < kComponents; ++k) {
      terms[k] = problem.truth[k].log_weight + evaluators[k].log_density(sample);
    }
    const double total = log_sum_exp(terms);
    for (std::size_t k = 0; k < kComponents; ++k) {
      const Vector6d y = coordinates(problem.truth[k].density, sample);
      second[k] += std::exp(terms[k] - total) * y * y.transpose();
    }
  }
  benchmark::DoNotOptimize(second.data());
  return seconds_of_processor() - begin;
}

/// Processor time of an iteration: a tenth of the time that ten more of them take.
template <class D>
void bench_iteration(benchmark::State& state) {
  const Problem<D>& problem = Problem<D>::of(state.range(0));
  RandomStream stream(1);
  const auto run = [&](int iterations) {
    const EmSettings settings{
        .components = kComponents, .max_iterations = iterations, .tolerance = 0.0};
    const double begin = seconds_of_processor();
    const auto fit = fit_mixture<D>(problem.samples, {}, settings, stream, problem.truth);
    return std::pair(seconds_of_processor() - begin, static_cast<double>(fit.history.size()));
  };
  double iteration = 0.0;
  for (auto _ : state) {
    const auto [few_seconds, few] = run(1);
    const auto [many_seconds, many] = run(11);
    iteration = (many_seconds - few_seconds) / (many - few);
    state.SetIterationTime(iteration);
  }
  state.counters["ratio"] = 10.0 * naive_seconds(problem) / iteration;
}

BENCHMARK(bench_iteration<ConcentratedGaussian<SE3d>>)
    ->Name("em_concentrated_se3_7")
    ->Arg(100000)
    ->Arg(1000000)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(bench_iteration<ProjectedGaussian<SE3d>>)
    ->Name("em_projected_se3_7")
    ->Arg(100000)
    ->Arg(1000000)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(bench_iteration<ConcentratedGaussian<Rnd<6>>>)
    ->Name("em_r6_7")
    ->Arg(100000)
    ->Arg(1000000)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace posemix
