// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "smooth_ball.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/SVD>

namespace posemix::internal {
namespace {

/// A ball that reaches so far is not smooth: beyond pi its points would count twice.
constexpr double kLargestAngle = 3.0;
/// A peak does not matter if it is so many of its standard deviations away.
constexpr double kFarAway = 12.0;

/// Whether a ball may reach the cut locus of a peak at an offset from its centre.
///
/// On the cut locus tan(t/2) cos(b) = cot(angle/2), with b the angle between xi and the offset or
/// its opposite. In the ball |xi| cos(b) is at most `towards`, and tan(t/2) / t at most `bend`.
bool reaches_cut_locus(const Eigen::Matrix3d& root, double radius, const Eigen::Vector3d& offset) {
  const double largest = radius * root.colwise().norm().maxCoeff();
  if (largest > kLargestAngle) return true;
  const double angle = offset.norm();
  if (angle == 0.0) return false;
  const double bend = std::tan(0.5 * largest) / largest;
  const double towards = radius * (root.transpose() * offset).norm() / angle;
  return bend * towards * std::tan(0.5 * angle) >= 1.0;
}

}  // namespace

double narrowest_feature(const RotationPair& pair, const Integrand& integrand,
                         const BallCentre& centre, double radius) {
  double narrowest = std::numeric_limits<double>::infinity();
  const Eigen::Matrix3d whiten = centre.root.inverse();
  for (const auto* side : {&pair.p, &pair.q}) {
    // The log density of one peak is smooth, however narrow it is.
    const bool is_plain = integrand.factor == log_ratio && side->size() == 1;
    for (const RotationPeak& peak : *side) {
      const Eigen::Quaterniond step = peak.mean * centre.peak->mean.conjugate();
      const Eigen::Vector3d offset = SO3d::from_quaternion(step).log();
      if (reaches_cut_locus(centre.root, radius, offset)) return 0.0;
      const Eigen::Matrix3d spread = whiten * SO3d::left_jacobian_inverse(offset) * peak.root;
      const Eigen::Vector3d widths = spread.jacobiSvd().singularValues();
      const bool matters = (whiten * offset).norm() < radius + kFarAway * widths[0];
      if (matters && !is_plain) narrowest = std::min(narrowest, widths[2]);
    }
  }
  return narrowest;
}

}  // namespace posemix::internal
