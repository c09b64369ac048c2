// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Where to grasp an object whose pose is a mixture.
//
//   X     in SE(3), T_world_mug
//   p(X)  = a N(X; M, P) + (1 - a) N(X; M D, P): two peaks that are less than a tolerance apart
//   D     a displacement of 8 mm along x
//   B     the box of poses that the gripper tolerates, about the identity: 10 deg, 1 cm
//   m     in SE(3), T_world_grasp: where the gripper expects the mug
//   s(m)  = P(X in {m Y: Y in B}): the probability of success
//
// The best m is not the heaviest peak M, but between the two peaks.
#include <cstdio>

#include <posemix/base/random.hpp>
#include <posemix/base/units.hpp>
#include <posemix/grasp/success_probability.hpp>

using namespace posemix;
using Gaussian = ConcentratedGaussian<SE3d>;

int main() {
  const double a = 0.6;
  Vector6d sd;  // rotation, then translation
  sd << Eigen::Vector3d::Constant(radians(3.0)), Eigen::Vector3d::Constant(0.004);
  const Matrix6d P = sd.cwiseAbs2().asDiagonal();
  const SE3d M;
  const SE3d D(SO3d(), {0.008, 0.0, 0.0});
  const double weights[] = {a, 1.0 - a};
  const auto p = Mixture<Gaussian>::from_weights(weights, {Gaussian(M, P), Gaussian(M * D, P)});
  const ToleranceBox B{.rotation = Eigen::Vector3d::Constant(radians(10.0)),
                       .translation = Eigen::Vector3d::Constant(0.01)};

  RandomStream random(1);
  const SuccessEstimate at_peak = success_probability(p, B, M, random);
  const BestGrasp best = best_grasp(p, B, random);
  const double x = best.pose.translation().x();
  std::printf("at the heaviest peak: s = %.4f +- %.4f\n", at_peak.probability, at_peak.error);
  std::printf("best, %.1f mm along x: s = %.4f +- %.4f\n", 1e3 * x, best.success.probability,
              best.success.error);

  const bool good = best.success.probability > at_peak.probability + 0.02 && 0.001 < x && x < 0.007;
  std::puts(good ? "good" : "not good: expected a better place between the peaks");
  return good ? 0 : 1;
}
