// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "em_draws.hpp"
#include "posemix/mixture/em.hpp"

/// EM finds the same end more slowly where a term of its second derivative is wrong: what is tested
/// is how much nearer one step comes.
namespace posemix {
namespace {

using testing::draws;
using testing::Projected;

template <RotationOrPose G>
Projected<G> one_step(const Projected<G>& density, const std::vector<G>& samples) {
  const EmSettings settings;
  typename EmModel<Projected<G>>::Worker worker(density, settings);
  const EmCoordinates coordinates{std::span<const G>(samples)};
  EmRow row;
  for (std::size_t begin = 0; begin < samples.size(); begin += kEmBlock) {
    const std::size_t count = std::min(kEmBlock, samples.size() - begin);
    worker.log_density(coordinates, begin, count, row);
    // Entries behind the last sample are none.
    for (std::size_t i = 0; i < kEmBlock; ++i) row[i] = i < count ? 1.0 : 0.0;
    worker.accumulate(row);
  }
  return worker.update(1.0);
}

template <RotationOrPose G>
Projected<G> converged(Projected<G> density, const std::vector<G>& samples) {
  for (int i = 0; i < 100; ++i) density = one_step(density, samples);
  return density;
}

/// The part of an error of the tangent point about each axis that one step of EM leaves.
template <RotationOrPose G>
Eigen::Vector3d left_by_one_step(const Projected<G>& truth, std::size_t count, std::uint64_t seed) {
  RandomStream stream(seed);
  const auto samples = draws(Mixture<Projected<G>>({{0.0, truth}}), count, stream);
  const Projected<G> best = converged(truth, samples);
  Eigen::Vector3d left;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d error = 1e-4 * Eigen::Vector3d::Unit(axis);
    const Projected<G> start(gnomonic::project(best.tangent_point(), error), best.tangent_mean(),
                             best.covariance());
    const Projected<G> after = one_step(start, samples);
    left[axis] = gnomonic::lift(best.tangent_point(), after.tangent_point()).norm() / error.norm();
  }
  return left;
}

/// Bounds are one and a half times what was measured, which other random numbers change by a fifth.
TEST(ProjectedEmStep, ComesNearOnRotations) {
  const SO3d mode = SO3d::exp({0.3, -0.2, 0.5});
  const auto left = [&](const Eigen::Vector3d& sd, std::uint64_t seed) {
    const Eigen::Matrix3d covariance = sd.cwiseAbs2().asDiagonal();
    return left_by_one_step(Projected<SO3d>(mode, covariance), 20000, seed);
  };
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    EXPECT_TRUE((left({0.01, 0.02, 0.03}, seed).array() < 0.0045).all());
    const Eigen::Array3d of_wide = left({0.5, 0.3, 0.4}, seed).array();
    EXPECT_TRUE((of_wide < Eigen::Array3d(0.03, 0.011, 0.075)).all()) << of_wide.transpose();
  }
}

/// Translations that follow the rotation tell of the tangent point, too.
TEST(ProjectedEmStep, ComesNearOnPosesWithALever) {
  Eigen::Matrix3d lever;
  lever << 0.2, -0.4, 0.1, 0.0, 0.3, -0.2, 0.5, 0.1, 0.3;
  const auto left = [&](double sd_u, double sd_t, std::uint64_t seed) {
    const Eigen::Matrix3d uu = (sd_u * Eigen::Vector3d(1.0, 0.6, 0.8)).cwiseAbs2().asDiagonal();
    Matrix6d covariance;
    covariance << uu, uu * lever.transpose(), lever * uu,
        lever * uu * lever.transpose() + sd_t * sd_t * Eigen::Matrix3d::Identity();
    const SE3d mode(SO3d::exp({0.3, -0.2, 0.5}), Eigen::Vector3d(0.1, 0.2, 0.3));
    return left_by_one_step(Projected<SE3d>(mode, covariance), 20000, seed);
  };
  for (std::uint64_t seed = 11; seed < 14; ++seed) {
    const Eigen::Array3d of_narrow = left(0.1, 0.02, seed).array();
    EXPECT_TRUE((of_narrow < Eigen::Array3d(0.1, 0.02, 0.06)).all()) << of_narrow.transpose();
    const Eigen::Array3d of_wide = left(0.2, 0.1, seed).array();
    EXPECT_TRUE((of_wide < Eigen::Array3d(0.04, 0.009, 0.04)).all()) << of_wide.transpose();
  }
}

/// Axes of the covariance between those of the coordinates: the gradient has every one of its
/// terms.
TEST(ProjectedEmStep, EndsWhereTheTangentPointIsMostLikely) {
  RandomStream stream(5);
  Eigen::Matrix3d covariance;
  covariance << 0.2, 0.08, -0.05, 0.08, 0.1, 0.03, -0.05, 0.03, 0.15;
  const SO3d mode = SO3d::exp({0.3, -0.2, 0.5});
  const auto samples =
      draws(Mixture<Projected<SO3d>>({{0.0, Projected<SO3d>(mode, covariance)}}), 500, stream);
  const Projected<SO3d> best = converged(Projected<SO3d>(mode, covariance), samples);
  const auto likelihood = [&](const Eigen::Vector3d& d) {
    const SO3d moved = gnomonic::project(best.tangent_point(), d);
    const Projected<SO3d> density(moved, Eigen::Vector3d::Zero(), best.covariance());
    double sum = 0.0;
    for (const SO3d& sample : samples) sum += density.log_density(sample);
    return sum;
  };
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kStep = 1e-4;
    const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(axis);
    // The information about an angle is some thousands: a gradient of 0.1 is 3e-5 rad.
    EXPECT_NEAR((likelihood(d) - likelihood(-d)) / (2.0 * kStep), 0.0, 0.1);
  }
}

}  // namespace
}  // namespace posemix
