// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cstdio>
#include <numbers>

#include <posemix/mixture/operations.hpp>
#include <posemix/reduction/reduce.hpp>

int main() {
  using Pose = posemix::ConcentratedGaussian<posemix::SE3d>;
  const posemix::Matrix6d covariance = 1e-3 * posemix::Matrix6d::Identity();
  const posemix::SE3d seen(posemix::SO3d(),
                           {0.0, 0.0, 0.8});  // a detector's answer, T_camera_mug ...
  const posemix::SO3d flip = posemix::SO3d::exp({0.0, 0.0, std::numbers::pi});
  const posemix::SE3d flipped(flip,
                              seen.translation());  // ... which is turned by 180 degrees at times
  const double weights[] = {0.7, 0.3};
  const auto mug = posemix::Mixture<Pose>::from_weights(
      weights, {Pose(seen, covariance), Pose(flipped, covariance)});
  const auto twice = posemix::fuse(mug, mug).density;  // two independent looks: four peaks
  posemix::ReductionSettings settings;
  settings.max_components = 2;
  settings.pair = posemix::PairRule::symmetric_kl;
  const auto reduced = posemix::reduce(twice, settings);
  std::printf("upright with probability %.3f\n", reduced.mixture.weight(0));
}
