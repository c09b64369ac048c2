// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/default_noise.hpp"

#include "posemix/base/units.hpp"

namespace posemix {

DetectorNoise default_detector_noise() {
  const Eigen::Vector3d rotation = Eigen::Vector3d(7.5, 7.5, 2.0) * kRadPerDeg;
  const Eigen::Vector3d translation(0.007, 0.007, 0.045);
  constexpr double kCommonRange = 11.8;
  constexpr double kWider = 2.7;
  NoiseComponent inlier{.weight = 0.65,
                        .covariance = pose_covariance(rotation, translation),
                        .frame = NoiseFrame::ray};
  inlier.update_covariance =
      pose_covariance(rotation, translation.cwiseProduct(Eigen::Vector3d(1.0, 1.0, kCommonRange)));
  NoiseComponent wide = inlier;
  wide.weight = 0.12;
  wide.covariance *= kWider * kWider;
  *wide.update_covariance *= kWider * kWider;
  return DetectorNoise({inlier, wide}, {.weight = 0.23, .volume_m3 = 1.0});
}

}  // namespace posemix
