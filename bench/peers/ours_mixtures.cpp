// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Divergence, reduction, EM and log densities of mixtures.
#include <cmath>
#include <string>
#include <utility>

#include "ours.hpp"
#include "posemix/divergence/so3_quadrature.hpp"
#include "posemix/mixture/em.hpp"
#include "posemix/mixture/log_densities.hpp"
#include "posemix/reduction/reduce.hpp"

namespace posemix {
namespace {

using Space = Rnd<6>;
using VectorPeak = ConcentratedGaussian<Space>;

/// Weight, mean and covariance of every component.
template <class D>
std::vector<double> numbers_of(const Mixture<D>& mixture) {
  std::vector<double> numbers;
  for (const auto& part : mixture.components()) {
    numbers.push_back(std::exp(part.log_weight));
    append(numbers, part.density);
  }
  return numbers;
}

using Peaks = Mixture<ConcentratedGaussian<SE3d>>;

std::vector<Component<ConcentratedGaussian<SE3d>>> components(const bench::Jobs& jobs) {
  const auto weights = jobs.input("reduce_weights");
  const auto poses = poses_of(jobs.input("reduce_poses"));
  const auto covariances = matrices_of(jobs.input("reduce_covariances"));
  std::vector<Component<ConcentratedGaussian<SE3d>>> result;
  for (std::size_t i = 0; i < weights.size(); ++i)
    result.push_back({std::log(weights[i]), {poses[i], covariances[i]}});
  return result;
}

/// A thousand components to ten, pair after pair.
void reduction_jobs(bench::Jobs& jobs) {
  const Peaks mixture(components(jobs));
  const auto job = [&](const std::string& name, PairRule rule) {
    const ReductionSettings settings{.prune_below = 0.0, .max_components = 10, .pair = rule};
    const auto work = [&] { return reduce(mixture, settings).mixture; };
    jobs.run(
        name, 1, [&] { bench::keep(work()); }, [&] { return numbers_of(work()); });
  };
  job("reduce_runnalls", PairRule::runnalls);
  job("reduce_symmetric_kl", PairRule::symmetric_kl);
}

/// Log densities of a mixture at many elements, in one call, which factorises its components.
template <class D>
void density_job(bench::Jobs& jobs, const std::string& name, const Mixture<D>& mixture,
                 const std::vector<typename D::Group>& at) {
  std::vector<double> found;
  jobs.run(
      name, at.size(),
      [&] {
        found = log_densities(mixture, std::span<const typename D::Group>(at));
        bench::keep(found);
      },
      [&] { return found; });
}

void pose_density_job(bench::Jobs& jobs) {
  auto ten = components(jobs);
  ten.erase(ten.begin() + 10, ten.end());
  density_job(jobs, "log_density", Peaks(std::move(ten)), poses_of(jobs.input("reduce_others")));
}

using Peak = ConcentratedGaussian<SO3d>;

/// A mixture of two on SO(3) from log-means and covariances, and one Gaussian.
void kl_jobs(bench::Jobs& jobs) {
  for (const std::string name : {"kl_axisymmetric", "kl_general"}) {
    if (!jobs.wants(name)) continue;
    const auto means = jobs.input(name + "_means");
    const auto covariances = jobs.input(name + "_covariances");
    std::vector<Peak> peaks;
    for (std::size_t i = 0; i < 3; ++i) {
      peaks.emplace_back(SO3d::exp(Eigen::Vector3d(&means[3 * i])),
                         Eigen::Map<const RowMajor>(&covariances[9 * i], 3, 3));
    }
    const Mixture<Peak> p({{std::log(0.5), peaks[0]}, {std::log(0.5), peaks[1]}});
    jobs.run(
        name, 1, [&] { bench::keep(kl(p, peaks[2])); },
        [&] { return std::vector<double>{kl(p, peaks[2]).value}; });
  }
}

/// Seven components of equal weights with the given covariances.
Mixture<VectorPeak> vector_mixture(const std::vector<Vector6d>& means,
                                   const std::vector<Matrix6d>& covariances) {
  std::vector<Component<VectorPeak>> parts;
  for (std::size_t k = 0; k < means.size(); ++k)
    parts.push_back({0.0, VectorPeak(Space(means[k]), covariances[k])});
  return Mixture<VectorPeak>(std::move(parts));
}

/// Pairs of Gaussians on R^6: the product, and the merge by weights 0.3 and 0.7.
void pair_jobs(bench::Jobs& jobs) {
  const auto means = vectors_of(jobs.input("tangents"));
  const auto covariances = matrices_of(jobs.input("covariances"));
  std::vector<VectorPeak> peaks;
  for (std::size_t i = 0; i < means.size(); ++i)
    peaks.emplace_back(Space(means[i]), covariances[i]);
  std::vector<VectorPeak> found = peaks;
  const std::size_t last = peaks.size() - 1;
  each_job(jobs, "fuse_vectors", found,
           [&](std::size_t i) { return fuse(peaks[i], peaks[last - i]).density; });
  each_job(jobs, "merge_vectors", found, [&](std::size_t i) {
    const Component<VectorPeak> pair[] = {{std::log(0.3), peaks[i]},
                                          {std::log(0.7), peaks[last - i]}};
    return merge<Space>(pair).component.density;
  });
}

/// A Gaussian prior times a likelihood with two modes: their weights, means and covariances.
void hybrid_job(bench::Jobs& jobs) {
  const auto prior_covariance = matrices_of(jobs.input("hybrid_prior_covariance"));
  const Mixture<VectorPeak> prior(
      {{0.0, VectorPeak(Space(vectors_of(jobs.input("hybrid_prior"))[0]), prior_covariance[0])}});
  const Space measured(vectors_of(jobs.input("hybrid_measured"))[0]);
  const auto noise = matrices_of(jobs.input("hybrid_noise"));
  const Mixture<VectorPeak> likelihood({{std::log(0.7), VectorPeak(measured, noise[0])},
                                        {std::log(0.3), VectorPeak(measured, noise[1])}});
  const auto work = [&] { return fuse(prior, likelihood).density; };
  jobs.run(
      "hybrid", 1, [&] { bench::keep(work()); }, [&] { return numbers_of(work()); });
}

/// EM on vectors, five iterations from a start, an item is an iteration; and log densities.
void vector_jobs(bench::Jobs& jobs) {
  constexpr int kIterations = 5;
  std::vector<Space> samples;
  for (const Vector6d& x : vectors_of(jobs.input("em_samples"))) samples.emplace_back(x);
  const auto means = vectors_of(jobs.input("em_means"));
  const auto start = vector_mixture(means, {means.size(), Matrix6d(0.04 * Matrix6d::Identity())});
  const EmSettings settings{
      .components = start.size(), .max_iterations = kIterations, .tolerance = 0.0};
  RandomStream stream(1);
  const auto work = [&] {
    return fit_mixture<VectorPeak>(samples, {}, settings, stream, start).mixture;
  };
  jobs.run(
      "em", kIterations, [&] { bench::keep(work()); }, [&] { return numbers_of(work()); });
  density_job(jobs, "log_density_vectors",
              vector_mixture(means, matrices_of(jobs.input("em_covariances"))), samples);
}

}  // namespace

void mixture_jobs(bench::Jobs& jobs) {
  kl_jobs(jobs);
  reduction_jobs(jobs);
  pose_density_job(jobs);
  pair_jobs(jobs);
  hybrid_job(jobs);
  vector_jobs(jobs);
}

}  // namespace posemix
