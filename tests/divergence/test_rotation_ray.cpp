// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "divergence/rotation_ray.hpp"
#include "posemix/base/random.hpp"

/// The kernel along rays against its scalar reference.
namespace posemix::internal {
namespace {

using Peak = ConcentratedGaussian<SO3d>;

SO3d random_rotation(RandomStream& random) {
  return SO3d::from_quaternion(
      {random.normal(), random.normal(), random.normal(), random.normal()});
}

/// Peaks of which some are far narrower than others.
std::vector<RotationPeak> random_peaks(std::size_t count, RandomStream& random) {
  std::vector<Component<Peak>> components;
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Matrix3d root;
    for (double& x : root.reshaped()) x = random.normal();
    const double scale = std::pow(10.0, -2.0 * random.uniform());
    const Eigen::Matrix3d covariance =
        scale * scale * (root * root.transpose() + 0.1 * Eigen::Matrix3d::Identity());
    components.push_back({-random.uniform(), Peak(random_rotation(random), covariance)});
  }
  return rotation_peaks(Mixture<Peak>(components));
}

void expect_the_reference() {
  RandomStream random(5);
  for (const std::size_t count : {1U, 2U, 7U}) {
    const RotationPair pair{random_peaks(count, random), random_peaks(1 + count / 2, random)};
    RotationRay ray(pair);
    for (int k = 0; k < 50; ++k) {
      const Eigen::Vector3d direction =
          Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
      const bool at_a_mean = k % 2 == 0;
      ray.begin(at_a_mean ? pair.p[0].mean : random_rotation(random).quaternion(), direction);
      // Up to the cut locus, and to the centre itself.
      const double stretch = std::numbers::pi / 9.0 * (k % 5 == 0 ? 1.0 : random.uniform());
      RayBlock block;
      for (std::size_t i = 0; i < kRayPoints; ++i)
        block.rho[i] = 9.0 * static_cast<double>(i) / (kRayPoints - 1);
      ray.evaluate(stretch, block);
      for (std::size_t i = 0; i < kRayPoints; ++i) {
        const double rho = block.rho[i];
        const auto expected = ray.at(rho * stretch);
        EXPECT_NEAR(block.log_p[i], expected.p, 1e-13 * (1.0 + std::abs(expected.p)));
        EXPECT_NEAR(block.log_q[i], expected.q, 1e-13 * (1.0 + std::abs(expected.q)));
        const double mass = rho * rho * std::exp(-0.5 * rho * rho);
        EXPECT_NEAR(block.mass[i], mass, 1e-14 * mass);
      }
    }
  }
}

TEST(RotationRay, TheKernelIsItsScalarReferenceByAnyInstructions) {
  by_every_instruction_set(expect_the_reference);
}

}  // namespace
}  // namespace posemix::internal
