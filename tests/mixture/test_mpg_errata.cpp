// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/density/projected_moments.hpp"
#include "posemix/mixture/projected_operations.hpp"

// Statements of the MPG paper that do not hold; docs/mpg.md lists all.
namespace posemix {
namespace {

using Eigen::Matrix3d;
using Rotation = ProjectedGaussian<SO3d>;

Rotation isotropic(const Eigen::Vector3d& at, double degrees_of_rotation) {
  const double u = 0.5 * radians(degrees_of_rotation);
  return {SO3d::exp(at), Matrix3d(u * u * Matrix3d::Identity())};
}

TEST(MpgErrata, MixtureOfEquation18IntegratesToOneOverN) {
  const double weights[] = {0.5, 0.3, 0.2};
  const auto mixture = Mixture<Rotation>::from_weights(
      weights, {isotropic({0.2, 0.0, 0.0}, 30.0), isotropic({0.0, 1.0, 0.0}, 40.0),
                isotropic({0.0, 0.0, 2.0}, 25.0)});
  const Mixture<Rotation>::Evaluator evaluator(mixture);
  RandomStream stream(1);
  double integral = 0.0;
  const int samples = 100000;
  for (int i = 0; i < samples; ++i) {
    Eigen::Vector4d q;
    for (double& entry : q) entry = stream.normal();
    const SO3d uniform = SO3d::from_quaternion(Eigen::Quaterniond(q));
    integral += std::exp(evaluator.log_density(uniform)) / samples;
  }
  integral *= 8.0 * std::numbers::pi * std::numbers::pi;
  EXPECT_NEAR(integral, 1.0, 0.03);
  const double equation_18 = integral / static_cast<double>(mixture.size());
  EXPECT_NEAR(equation_18, 1.0 / 3.0, 0.01);
}

TEST(MpgErrata, MomentsAsCovarianceAreTooNarrow) {
  // Oracle: numpy prototype of the paper's fit, 27.6 degrees in place of 30 for an isotropic
  // rotation spread; exactly, the second moment under the distribution of eq. 11.
  const Rotation density = isotropic(Eigen::Vector3d::Zero(), 30.0);
  const ProjectedMoments moments = projected_moments(Eigen::Vector3d::Zero(), density.covariance());
  const double papers = 2.0 * degrees(std::sqrt(moments.second_moment(0, 0)));
  EXPECT_NEAR(papers, 27.6, 0.5);
  const auto likely = with_moments<SO3d>(SO3d(), Eigen::Vector3d::Zero(), moments.second_moment);
  EXPECT_NEAR(2.0 * degrees(std::sqrt(likely.covariance()(0, 0))), 30.0, 1e-9);
}

}  // namespace
}  // namespace posemix
