// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include "dense_divergence.hpp"
#include "dense_filter.hpp"
#include "dense_fusion.hpp"
#include "dense_mixture.hpp"
#include "jobs.hpp"

/// The jobs by plain Eigen, for any type of number.
namespace dense {

template <class S>
void merge_jobs(bench::Jobs& jobs) {
  for (const int n : {12, 36, 66, 126}) {
    const std::string name = "merge_" + std::to_string(n);
    if (!jobs.wants(name)) continue;
    const auto pair = hypotheses<S>(jobs, name);
    jobs.run(
        name, 1, [&] { bench::keep(merged(pair[0], pair[1])); },
        [&] { return numbers_of(merged(pair[0], pair[1])); });
  }
}

template <class S>
void frame_job(bench::Jobs& jobs) {
  if (!jobs.wants("frame")) return;
  const Frame<S> frame(jobs);
  jobs.run(
      "frame", 1, [&] { bench::keep(frame_of(frame)); },
      [&] { return numbers_of(frame_of(frame)); });
}

/// Runs `one` for each of as many items as `found` has.
template <class Found, class One>
void each_job(bench::Jobs& jobs, const std::string& name, std::vector<Found>& found,
              const One& one) {
  bench::run_each(jobs, name, found, one, [](const auto& values) { return flat(values); });
}

template <class S>
void lie_jobs(bench::Jobs& jobs) {
  const auto xi = vectors_of<S>(jobs.input("tangents"));
  const auto poses = poses_of<S>(jobs.input("poses"));
  const std::size_t last = poses.size() - 1;
  std::vector<Pose<S>> moved(poses.size());
  std::vector<Vector6<S>> logs(poses.size());
  std::vector<Matrix6<S>> jacobians(poses.size());
  std::vector<Matrix3<S>> turned(poses.size());
  std::vector<Vector3<S>> turns(poses.size());
  each_job(jobs, "so3_exp", turned,
           [&](std::size_t i) { return exp_rotation<S>(xi[i].template head<3>()); });
  each_job(jobs, "so3_log", turns, [&](std::size_t i) { return log_rotation(poses[i].r); });
  each_job(jobs, "se3_exp", moved, [&](std::size_t i) { return exp(xi[i]); });
  each_job(jobs, "se3_log", logs, [&](std::size_t i) { return log(poses[i]); });
  each_job(jobs, "se3_left_jacobian_inverse", jacobians,
           [&](std::size_t i) { return left_jacobian_inverse(xi[i]); });
  each_job(jobs, "se3_compose", moved, [&](std::size_t i) { return poses[i] * poses[last - i]; });
}

template <class S>
void uncertain_jobs(bench::Jobs& jobs) {
  const auto poses = poses_of<S>(jobs.input("poses"));
  const auto others = poses_of<S>(jobs.input("other_poses"));
  const auto p = matrices_of<S>(jobs.input("covariances"));
  const std::size_t last = poses.size() - 1;
  std::vector<UncertainPose<S>> found(poses.size());
  each_job(jobs, "compose_covariances", found, [&](std::size_t i) {
    const Matrix6<S> ad = adjoint(poses[i]);
    return UncertainPose<S>{poses[i] * poses[last - i], p[i] + ad * p[last - i] * ad.transpose()};
  });
  found.resize(128);
  each_job(jobs, "fuse", found, [&](std::size_t i) {
    return fused(UncertainPose<S>{poses[i], p[i]}, UncertainPose<S>{others[i], p[last - i]});
  });
}

template <class S>
void reduction_jobs(bench::Jobs& jobs) {
  if (!jobs.wants("reduce_runnalls") && !jobs.wants("reduce_symmetric_kl")) return;
  const auto mixture = hypotheses<S>(jobs, "reduce");
  const auto job = [&](const std::string& name, const auto& cost) {
    std::vector<Hypothesis<S>> found;
    jobs.run(
        name, 1, [&] { found = reduced(mixture, 10, cost); }, [&] { return numbers_of(found); });
  };
  job("reduce_runnalls", Runnalls());
  job("reduce_symmetric_kl", SymmetricKl());
}

/// Ten components at many poses.
template <class S>
void density_job(bench::Jobs& jobs) {
  if (!jobs.wants("log_density")) return;
  auto mixture = hypotheses<S>(jobs, "reduce");
  mixture.resize(10);
  const auto at = poses_of<S>(jobs.input("reduce_others"));
  std::vector<double> found;
  jobs.run(
      "log_density", at.size(), [&] { found = log_densities(mixture, at); }, [&] { return found; });
}

template <class S>
void pair_jobs(bench::Jobs& jobs) {
  const auto means = vectors_of<S>(jobs.input("tangents"));
  const auto covariances = matrices_of<S>(jobs.input("covariances"));
  std::vector<VectorPeak<S>> peaks;
  for (std::size_t i = 0; i < means.size(); ++i) peaks.push_back({means[i], covariances[i]});
  const std::size_t last = peaks.size() - 1;
  std::vector<VectorPeak<S>> found(peaks.size());
  each_job(jobs, "fuse_vectors", found,
           [&](std::size_t i) { return fused(peaks[i], peaks[last - i]); });
  each_job(jobs, "merge_vectors", found,
           [&](std::size_t i) { return merged(peaks[i], peaks[last - i], S(0.3), S(1) - S(0.3)); });
}

/// A Gaussian prior and a measurement with two modes of noise.
template <class S>
void hybrid_job(bench::Jobs& jobs) {
  const VectorPeak<S> prior{vectors_of<S>(jobs.input("hybrid_prior"))[0],
                            matrices_of<S>(jobs.input("hybrid_prior_covariance"))[0]};
  const auto measured = vectors_of<S>(jobs.input("hybrid_measured"))[0];
  const auto noise = matrices_of<S>(jobs.input("hybrid_noise"));
  const S weights[] = {S(0.7), S(0.3)};
  std::vector<VectorPeak<S>> modes(2);
  std::vector<S> shares(2);
  jobs.run(
      "hybrid", 1,
      [&] {
        using std::exp;
        for (std::size_t k = 0; k < 2; ++k) {
          modes[k] = fused(prior, VectorPeak<S>{measured, noise[k]}, &shares[k]);
          shares[k] = weights[k] * exp(shares[k]);
        }
        const S sum = shares[0] + shares[1];
        for (S& share : shares) share /= sum;
      },
      [&] {
        std::vector<double> numbers;
        for (std::size_t k = 0; k < 2; ++k) {
          numbers.push_back(static_cast<double>(shares[k]));
          append(numbers, modes[k]);
        }
        return numbers;
      });
}

/// EM from equal weights and covariances, and log densities on R^6.
template <class S>
void vector_jobs(bench::Jobs& jobs) {
  if (!jobs.wants("em") && !jobs.wants("log_density_vectors")) return;
  constexpr int kIterations = 5;
  const auto numbers = jobs.input("em_samples");
  const Samples<S> samples = Eigen::Map<const Samples<double>>(
                                 numbers.data(), 6, static_cast<Eigen::Index>(numbers.size() / 6))
                                 .template cast<S>();
  const auto means = vectors_of<S>(jobs.input("em_means"));
  const std::vector<S> weights(means.size(), S(1) / S(means.size()));
  const VectorMixture<S> start{
      weights, means, {means.size(), Matrix6<S>(S(0.04) * Matrix6<S>::Identity())}};
  VectorMixture<S> fit;
  jobs.run(
      "em", kIterations,
      [&] {
        fit = start;
        for (int i = 0; i < kIterations; ++i) fit = em_iteration(fit, samples);
      },
      [&] { return numbers_of(fit); });
  const VectorMixture<S> given{weights, means, matrices_of<S>(jobs.input("em_covariances"))};
  std::vector<double> found;
  jobs.run(
      "log_density_vectors", static_cast<std::size_t>(samples.cols()),
      [&] { found = log_densities(given, samples); }, [&] { return found; });
}

}  // namespace dense
