// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <cmath>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/divergence/so3_quadrature.hpp"
#include "posemix/reduction/merge.hpp"

/// The experiment of the midway-merge paper, section V (eq. 23-25), with the library's merge rules
/// and its quadrature, against numbers of an independent program.
namespace posemix {
namespace {

using Density = ConcentratedGaussian<SO3d>;
using Part = Component<Density>;

/// phi in degrees; divergences of the midway merge and by how much those of the tangent-of-larger
/// merge are larger, anchored at the first and at the second component.
struct Row {
  double phi;
  double kl, kl_first, kl_second;
  double isd, isd_first, isd_second;
};

Part part(double deviation, double angle) {
  const double s = radians(deviation);
  return {
      std::log(0.5),
      {SO3d::exp(radians(angle) * Eigen::Vector3d(1, -1, 1)), s * s * Eigen::Matrix3d::Identity()}};
}

Density merged(const std::array<Part, 2>& parts, MergeRule rule) {
  return merge<SO3d>(parts, {.rule = rule}).component.density;
}

/// In the name of the test, in place of its bytes with their addresses.
void PrintTo(const Row& row, std::ostream* out) { *out << row.phi << " deg"; }

class SectionFiveDivergences : public ::testing::TestWithParam<Row> {};

TEST_P(SectionFiveDivergences, DivergencesAreThoseOfTheReference) {
  const Row& row = GetParam();
  const Part narrow = part(5.0, 0.0);
  const Part wide = part(10.0, row.phi);
  const Mixture<Density> before({narrow, wide});
  const Density midway = merged({narrow, wide}, MergeRule::midway);
  const Density first = merged({narrow, wide}, MergeRule::tangent_of_larger);
  const Density second = merged({wide, narrow}, MergeRule::tangent_of_larger);

  const RotationQuadratureSettings settings{.relative_tolerance = 1e-9};
  const DivergenceEstimate kl_midway = kl(before, midway, settings);
  EXPECT_TRUE(kl_midway.converged);
  EXPECT_NEAR(kl_midway.value, row.kl, 6e-9);
  EXPECT_NEAR((kl(before, first, settings).value - kl_midway.value) / row.kl_first, 1.0, 4e-3);
  EXPECT_NEAR((kl(before, second, settings).value - kl_midway.value) / row.kl_second, 1.0, 4e-3);

  const DivergenceEstimate isd_midway = isd(before, midway);
  EXPECT_TRUE(isd_midway.converged);
  EXPECT_NEAR(isd_midway.value, row.isd, 6e-5);
  EXPECT_NEAR((isd(before, first).value - isd_midway.value) / row.isd_first, 1.0, 4e-3);
  EXPECT_NEAR((isd(before, second).value - isd_midway.value) / row.isd_second, 1.0, 4e-3);
}

INSTANTIATE_TEST_SUITE_P(
    Angles, SectionFiveDivergences,
    ::testing::Values(Row{5, 0.14636029, 1.64e-7, 1.63e-7, 2.8578, 1.81e-3, -1.81e-3},
                      Row{10, 0.24758524, 2.63e-6, 2.59e-6, 3.9783, 4.33e-3, -4.29e-3},
                      Row{15, 0.37745845, 1.344e-5, 1.307e-5, 4.9613, 6.03e-3, -5.87e-3},
                      Row{20, 0.54121480, 4.30e-5, 4.10e-5, 5.8951, 7.34e-3, -6.97e-3},
                      Row{25, 0.71344138, 1.065e-4, 9.93e-5, 6.6057, 8.63e-3, -7.92e-3},
                      Row{30, 0.87336600, 2.249e-4, 2.037e-4, 7.1003, 1.005e-2, -8.84e-3},
                      Row{35, 1.01547454, 4.255e-4, 3.723e-4, 7.4516, 1.168e-2, -9.75e-3},
                      Row{40, 1.14136899, 7.435e-4, 6.250e-4, 7.7118, 1.356e-2, -1.068e-2},
                      Row{45, 1.25388507, 1.223e-3, 9.82e-4, 7.9116, 1.574e-2, -1.160e-2},
                      Row{50, 1.35544388, 1.921e-3, 1.464e-3, 8.0695, 1.825e-2, -1.253e-2},
                      Row{55, 1.44791930, 2.905e-3, 2.088e-3, 8.1973, 2.115e-2, -1.345e-2},
                      Row{60, 1.53276029, 4.260e-3, 2.868e-3, 8.3027, 2.447e-2, -1.436e-2}),
    [](const auto& parameter) {
      return "Phi" + std::to_string(static_cast<int>(parameter.param.phi));
    });

}  // namespace
}  // namespace posemix
