// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/divergence/paper_grid.hpp"
#include "posemix/mixture/tangent_moments.hpp"

namespace posemix {
namespace {

using Peak = ConcentratedGaussian<SO3d>;
using Peaks = Mixture<Peak>;

Peak peak(double deviation, double angle) {
  const double s = radians(deviation);
  return {SO3d::exp(radians(angle) * Eigen::Vector3d(1, -1, 1)),
          s * s * Eigen::Matrix3d::Identity()};
}

/// The paper's method in an independent program: relative error of the KLD, the difference of
/// tangent-of-larger (first component) from midway, and the mass.
struct Row {
  double phi;
  double kl_error;
  double kl_first;
  double mass;
  double kl_unit, first_unit, mass_unit;  ///< units of the last given digit
};

/// In the name of the test, in place of its bytes with their addresses.
void PrintTo(const Row& row, std::ostream* out) { *out << row.phi << " deg"; }

class PaperGrid : public ::testing::TestWithParam<Row> {};

TEST_P(PaperGrid, HasTheErrorsOfTheReference) {
  const Row& row = GetParam();
  const Peaks p({{std::log(0.5), peak(5.0, 0.0)}, {std::log(0.5), peak(10.0, row.phi)}});
  const auto merged_at = [&](double t) {
    const SO3d anchor = interpolate(p[0].density.mean(), p[1].density.mean(), t);
    return back_project(tangent_moments<SO3d>(p.components(), anchor));
  };
  const Peak midway = merged_at(0.5);
  const Peak first = merged_at(0.0);
  const PaperGridDivergence grid = paper_grid_divergence(p, midway, radians(3.0));
  const double exact = kl(p, midway).value;
  EXPECT_NEAR(std::abs(grid.kl / exact - 1.0), row.kl_error, 0.6 * row.kl_unit);
  EXPECT_NEAR(grid.mass, row.mass, 0.6 * row.mass_unit);
  const double difference = paper_grid_divergence(p, first, radians(3.0)).kl - grid.kl;
  EXPECT_NEAR(difference, row.kl_first, 0.6 * row.first_unit);
  EXPECT_EQ(grid.evaluations, 121U * 121U * 121U);
}

INSTANTIATE_TEST_SUITE_P(Angles, PaperGrid,
                         ::testing::Values(Row{15, 1.4e-3, 1.76e-5, 0.99963, 1e-4, 1e-7, 1e-5},
                                           Row{30, 9.0e-3, 4.04e-4, 0.9957, 1e-4, 1e-6, 1e-4},
                                           Row{60, 5.2e-2, 9.62e-3, 0.963, 1e-3, 1e-5, 1e-3}),
                         [](const auto& parameter) {
                           return "Phi" + std::to_string(static_cast<int>(parameter.param.phi));
                         });

TEST(PaperGrid, IsRightForConcentratedNeighbours) {
  // The series is exact for one common mean, and its terms are small for near ones.
  const Peak p = peak(8.0, 0.0);
  const Peak q(SO3d::exp({0.05, 0.02, 0.0}), peak(10.0, 0.0).covariance());
  const PaperGridDivergence grid = paper_grid_divergence(p, q, radians(3.0));
  EXPECT_NEAR(grid.mass, 1.0, 1e-12);
  EXPECT_NEAR(grid.kl, kl(p, q).value, 1e-5 * grid.kl);
  EXPECT_NEAR(grid.isd, isd(p, q).value, 1e-4 * grid.isd);
}

TEST(PaperGrid, RejectsAStepOutsideTheCube) {
  const Peak p = peak(5.0, 0.0);
  EXPECT_THROW(paper_grid_divergence(p, p, 0.0), InvalidInput);
  EXPECT_THROW(paper_grid_divergence(p, p, 4.0), InvalidInput);
}

}  // namespace
}  // namespace posemix
