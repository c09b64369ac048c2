// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <cmath>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/reduction/merge.hpp"
#include "posemix/testing/rotation_quadrature.hpp"

/// The merge rules on SO(3) against numbers that were computed by other programs.
namespace posemix {
namespace {

using Density = ConcentratedGaussian<SO3d>;
using Part = Component<Density>;

const Eigen::Vector3d kAxis = Eigen::Vector3d(1, -1, 1).normalized();

/// Weight, deviation per axis (degrees) and angle about kAxis (degrees).
Part part(double weight, double deviation, double angle) {
  const double s = radians(deviation);
  return {std::log(weight),
          {SO3d::exp(radians(angle) * kAxis), s * s * Eigen::Matrix3d::Identity()}};
}

/// Standard deviation across kAxis, in degrees.
double across(const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d u = kAxis.unitOrthogonal();
  return degrees(std::sqrt(u.dot(covariance * u)));
}

Density merged_rotations(const std::array<Part, 2>& parts, MergeRule rule) {
  return merge<SO3d>(parts, {.rule = rule}).component.density;
}

// Weights 0.5 and 0.4, N(Id, 5 deg^2 I) and 10 deg at an angle of 60 or 5 deg about any axis. The
// values were computed by an independent prototype (without this library); by hand, across the axis
// a component moved by an angle a gains the factor (a/2 / sin(a/2))^2 in variance.
TEST(MergeRotations, DeviationsAcrossTheAxisAtSixtyDegrees) {
  const std::array parts{part(0.5, 5.0, 0.0), part(0.4, 10.0, 60.0)};
  EXPECT_NEAR(across(merged_rotations(parts, MergeRule::midway).covariance()), 7.737, 6e-4);
  EXPECT_NEAR(across(merged_rotations(parts, MergeRule::tangent_of_larger).covariance()), 7.843,
              6e-4);
  EXPECT_NEAR(across(merged_rotations(parts, MergeRule::moment_matched).covariance()), 7.738, 6e-4);
  const auto tangent = tangent_moments<SO3d>(parts, parts[0].density.mean());
  EXPECT_NEAR(across(tangent.covariance), 7.914, 6e-4);  // not back-projected
}

TEST(MergeRotations, DeviationsAcrossTheAxisAtFiveDegrees) {
  const std::array parts{part(0.5, 5.0, 0.0), part(0.4, 10.0, 5.0)};
  EXPECT_NEAR(across(merged_rotations(parts, MergeRule::midway).covariance()), 7.6383, 6e-5);
  EXPECT_NEAR(across(merged_rotations(parts, MergeRule::tangent_of_larger).covariance()), 7.6390,
              6e-5);
  const auto tangent = tangent_moments<SO3d>(parts, parts[0].density.mean());
  EXPECT_NEAR(across(tangent.covariance), 7.6395, 6e-5);
}

TEST(MergeRotations, ByHandAcrossTheAxis) {
  const std::array parts{part(0.5, 5.0, 0.0), part(0.4, 10.0, 60.0)};
  const auto gain = [](double angle) {
    const double half = radians(angle) / 2.0;
    return std::pow(half / std::sin(half), 2);
  };
  const double w_2 = 4.0 / 9.0;
  const double midway =
      (1.0 - w_2) * 25.0 * gain(60.0 * w_2) + w_2 * 100.0 * gain(60.0 * (1.0 - w_2));
  const double larger = ((1.0 - w_2) * 25.0 + w_2 * 100.0 * gain(60.0)) / gain(60.0 * w_2);
  EXPECT_NEAR(across(merged_rotations(parts, MergeRule::midway).covariance()), std::sqrt(midway),
              1e-10);
  EXPECT_NEAR(across(merged_rotations(parts, MergeRule::tangent_of_larger).covariance()),
              std::sqrt(larger), 1e-10);
  // Along the axis nothing is curved: eq. 8 of the midway-merge paper.
  const double along = (1.0 - w_2) * 25.0 + w_2 * 100.0 + w_2 * (1.0 - w_2) * 3600.0;
  for (const MergeRule rule : {MergeRule::midway, MergeRule::tangent_of_larger}) {
    EXPECT_NEAR(degrees(degrees(kAxis.dot(merged_rotations(parts, rule).covariance() * kAxis))),
                along, 1e-8);
    EXPECT_TRUE(merged_rotations(parts, rule)
                    .mean()
                    .is_approx(SO3d::exp(radians(60.0 * w_2) * kAxis), 1e-13));
  }
}

/// The experiment of the midway-merge paper, section V (eq. 23-25): equal weights, 5 deg at the
/// identity and 10 deg at Exp([phi, -phi, phi]), phi in degrees. KLD and ISD with the Haar measure,
/// computed by an independent program with a two-dimensional Gauss-Legendre rule in the radius and
/// the angle to the symmetry axis (doubling its grid changes the KLD by less than 1e-13). `first`
/// and `second` are the differences of tangent_of_larger from midway, anchored at either component:
/// equal weights tie, the first is taken.
struct Reference {
  double phi;
  double kl_midway;
  double kl_first;
  double kl_second;
  double isd_midway;
  double isd_first;
  double isd_second;
};

/// In the name of the test, in place of its bytes with their addresses.
void PrintTo(const Reference& row, std::ostream* out) { *out << row.phi << " deg"; }

class SectionFive : public ::testing::TestWithParam<Reference> {
 protected:
  static Part narrow() { return part(0.5, 5.0, 0.0); }
  static Part wide() { return part(0.5, 10.0, GetParam().phi * std::sqrt(3.0)); }

  /// D(p || q) and the integral of (p - q)^2 for the merge of the parts in this order.
  static std::pair<double, double> divergences(const std::array<Part, 2>& parts, MergeRule rule) {
    const Mixture<Density>::Evaluator log_p(Mixture<Density>({parts[0], parts[1]}));
    const Density::Evaluator log_q(merged_rotations(parts, rule));
    const testing::BallRule quadrature{
        .radial_panels = 6, .polar_panels = 4, .azimuths = 1, .axis = kAxis};
    double kl = 0.0;
    double isd = 0.0;
    quadrature.for_each(narrow().density.mean(), [&](const SO3d& x, double weight) {
      const double log_density = log_p.log_density(x);
      const double p = std::exp(log_density);
      const double q = std::exp(log_q.log_density(x));
      kl += weight * p * (log_density - log_q.log_density(x));
      isd += weight * (p - q) * (p - q);
    });
    return {kl, isd};
  }
};

TEST_P(SectionFive, DivergencesAgreeWithTheReference) {
  const Reference& expected = GetParam();
  const auto [kl, isd] = divergences({narrow(), wide()}, MergeRule::midway);
  const auto [kl_first, isd_first] = divergences({narrow(), wide()}, MergeRule::tangent_of_larger);
  const auto [kl_second, isd_second] =
      divergences({wide(), narrow()}, MergeRule::tangent_of_larger);
  EXPECT_NEAR(kl, expected.kl_midway, 2e-8);
  EXPECT_NEAR((kl_first - kl) / expected.kl_first, 1.0, 4e-3);
  EXPECT_NEAR((kl_second - kl) / expected.kl_second, 1.0, 4e-3);
  EXPECT_NEAR(isd, expected.isd_midway, 1e-4);
  EXPECT_NEAR((isd_first - isd) / expected.isd_first, 1.0, 4e-3);
  EXPECT_NEAR((isd_second - isd) / expected.isd_second, 1.0, 4e-3);
}

INSTANTIATE_TEST_SUITE_P(
    Angles, SectionFive,
    ::testing::Values(Reference{5, 0.14636029, 1.64e-7, 1.63e-7, 2.8578, 1.81e-3, -1.81e-3},
                      Reference{15, 0.37745845, 1.344e-5, 1.307e-5, 4.9613, 6.03e-3, -5.87e-3},
                      Reference{30, 0.87336600, 2.249e-4, 2.037e-4, 7.1003, 1.005e-2, -8.84e-3},
                      Reference{45, 1.25388507, 1.223e-3, 9.82e-4, 7.9116, 1.574e-2, -1.160e-2},
                      Reference{60, 1.53276029, 4.260e-3, 2.868e-3, 8.3027, 2.447e-2, -1.436e-2}),
    [](const auto& parameter) {
      return "Phi" + std::to_string(static_cast<int>(parameter.param.phi));
    });

TEST(SectionFiveDeviations, AcrossTheAxisAtSixtyDegreesPerAxis) {
  // The same program: 8.18 deg by midway, 8.58 and 7.88 anchored at the first and second component.
  const Part first = part(0.5, 5.0, 0.0);
  const Part second = part(0.5, 10.0, 60.0 * std::sqrt(3.0));
  EXPECT_NEAR(across(merged_rotations({first, second}, MergeRule::midway).covariance()), 8.18,
              6e-3);
  EXPECT_NEAR(across(merged_rotations({first, second}, MergeRule::tangent_of_larger).covariance()),
              8.58, 6e-3);
  EXPECT_NEAR(across(merged_rotations({second, first}, MergeRule::tangent_of_larger).covariance()),
              7.88, 6e-3);
}

}  // namespace
}  // namespace posemix
