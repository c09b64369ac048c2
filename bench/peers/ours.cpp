// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// The library on the numbers that the programs of its peers read, too.
#include "ours.hpp"

namespace posemix {
namespace {

void lie_jobs(bench::Jobs& jobs) {
  const auto xi = vectors_of(jobs.input("tangents"));
  const std::size_t count = xi.size();
  const auto poses = poses_of(jobs.input("poses"));
  std::vector<SO3d> turned(count);
  std::vector<Eigen::Vector3d> turns(count);
  std::vector<SE3d> moved(count);
  std::vector<Vector6d> logs(count);
  std::vector<Matrix6d> jacobians(count);
  each_job(jobs, "so3_exp", turned, [&](std::size_t i) { return SO3d::exp(xi[i].head<3>()); });
  each_job(jobs, "so3_log", turns, [&](std::size_t i) { return poses[i].rotation().log(); });
  each_job(jobs, "se3_exp", moved, [&](std::size_t i) { return SE3d::exp(xi[i]); });
  each_job(jobs, "se3_log", logs, [&](std::size_t i) { return poses[i].log(); });
  each_job(jobs, "se3_left_jacobian_inverse", jacobians,
           [&](std::size_t i) { return SE3d::left_jacobian_inverse(xi[i]); });
  each_job(jobs, "se3_compose", moved,
           [&](std::size_t i) { return poses[i] * poses[count - 1 - i]; });
}

/// So many are enough for packages that take milliseconds.
constexpr std::size_t kFused = 128;

void uncertain_jobs(bench::Jobs& jobs) {
  const auto poses = poses_of(jobs.input("poses"));
  const auto others = poses_of(jobs.input("other_poses"));
  const auto covariances = matrices_of(jobs.input("covariances"));
  const std::size_t count = poses.size();
  std::vector<ConcentratedGaussian<SE3d>> densities;
  std::vector<ConcentratedGaussian<SE3d>> near;
  for (std::size_t i = 0; i < count; ++i) {
    densities.emplace_back(poses[i], covariances[i]);
    near.emplace_back(others[i], covariances[count - 1 - i]);
  }
  std::vector<ConcentratedGaussian<SE3d>> found = densities;
  each_job(jobs, "compose_covariances", found,
           [&](std::size_t i) { return compose(densities[i], densities[count - 1 - i]); });
  found.resize(kFused, found.front());
  each_job(jobs, "fuse", found, [&](std::size_t i) { return fuse(densities[i], near[i]).density; });
}

}  // namespace
}  // namespace posemix

int main(int count, char** arguments) {
  return bench::jobs_main(count, arguments, [](bench::Jobs& jobs) {
    posemix::filter_jobs(jobs);
    posemix::lie_jobs(jobs);
    posemix::uncertain_jobs(jobs);
    posemix::mixture_jobs(jobs);
  });
}
