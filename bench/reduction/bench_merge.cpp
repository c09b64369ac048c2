// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <cmath>
#include <cstddef>

#include <benchmark/benchmark.h>

#include "posemix/base/random.hpp"
#include "posemix/reduction/merge.hpp"

/// One merge of two components over n poses: the rules of this library, which work pose by pose,
/// and the midway merge with dense matrices as the authors of the paper wrote it. Compare the lines
/// of one run; machines and their load differ.
namespace posemix {
namespace {

using Density = ConcentratedGaussian<PoseStackd>;
using Pair = std::array<Component<Density>, 2>;

PoseStackd::TangentMatrix random_covariance(Eigen::Index n, RandomStream& stream) {
  Eigen::VectorXd entries(n * n);
  stream.fill_normal(entries);
  const Eigen::MatrixXd root = 0.05 * entries.reshaped(n, n);
  PoseStackd::TangentMatrix covariance = root * root.transpose() / static_cast<double>(n);
  covariance.diagonal().array() += 1e-4;
  symmetrize(covariance);
  return covariance;
}

/// Two components about 0.4 rad and 0.4 m apart per pose.
Pair random_pair(std::size_t poses) {
  RandomStream stream(1, poses);
  const auto n = static_cast<Eigen::Index>(6 * poses);
  Eigen::VectorXd centre(n);
  Eigen::VectorXd step(n);
  stream.fill_normal(centre);
  stream.fill_normal(step);
  const PoseStackd mean = PoseStackd::exp(centre);
  const PoseStackd other = PoseStackd::exp(0.25 * step) * mean;
  return {{{std::log(0.7), Density(mean, random_covariance(n, stream))},
           {std::log(0.3), Density(other, random_covariance(n, stream))}}};
}

/// Midway-merge paper, eq. 12-19, with dense block-diagonal Jacobians and dense products.
Density dense_midway(const Pair& pair) {
  const double w_1 = std::exp(pair[0].log_weight);
  const double w_2 = std::exp(pair[1].log_weight);
  const double share_2 = w_2 / (w_1 + w_2);
  const PoseStackd& x_1 = pair[0].density.mean();
  const Eigen::VectorXd dx = (pair[1].density.mean() * x_1.inverse()).log();
  const Eigen::MatrixXd j_1 = PoseStackd::left_jacobian_inverse(-share_2 * dx);
  const Eigen::MatrixXd j_2 = PoseStackd::left_jacobian_inverse((1.0 - share_2) * dx);
  const Eigen::MatrixXd p_1 = j_1 * pair[0].density.covariance() * j_1.transpose();
  const Eigen::MatrixXd p_2 = j_2 * pair[1].density.covariance() * j_2.transpose();
  Eigen::MatrixXd covariance =
      (1.0 - share_2) * p_1 + share_2 * p_2 + (1.0 - share_2) * share_2 * dx * dx.transpose();
  return Density::trusted(PoseStackd::exp(share_2 * dx) * x_1, std::move(covariance));
}

void bench_dense(benchmark::State& state) {
  const Pair pair = random_pair(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(dense_midway(pair));
  const Density ours = merge<PoseStackd>(pair).component.density;
  const Eigen::MatrixXd difference = dense_midway(pair).covariance() - ours.covariance();
  state.counters["largest_difference"] = difference.cwiseAbs().maxCoeff();
}

template <MergeRule kRule>
void bench_rule(benchmark::State& state) {
  const Pair pair = random_pair(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(merge<PoseStackd>(pair, {.rule = kRule}));
}

void numbers_of_poses(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("poses")->Arg(2)->Arg(6)->Arg(11)->Arg(21)->Unit(benchmark::kMicrosecond);
}

BENCHMARK(bench_dense)->Name("midway_dense")->Apply(numbers_of_poses);
BENCHMARK(bench_rule<MergeRule::midway>)->Name("midway")->Apply(numbers_of_poses);
BENCHMARK(bench_rule<MergeRule::tangent_of_larger>)
    ->Name("tangent_of_larger")
    ->Apply(numbers_of_poses);
BENCHMARK(bench_rule<MergeRule::moment_matched>)->Name("moment_matched")->Apply(numbers_of_poses);

}  // namespace
}  // namespace posemix
