// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "posemix/base/random.hpp"
#include "posemix/reduction/merge.hpp"

/// The merge of two stacks of poses by vector instructions. Oracle: the equations of both papers in
/// long double, with dense Jacobians.
namespace posemix {
namespace {

using Stackl = PoseStack<long double>;
using Vectorl = Stackl::Tangent;
using Matrixl = Stackl::TangentMatrix;
using StackDensity = ConcentratedGaussian<PoseStackd>;
using StackPair = std::array<Component<StackDensity>, 2>;

Stackl exact(const PoseStackd& stack) {
  Stackl result;
  for (const SE3d& pose : stack)
    result.push_back({pose.rotation().cast<long double>(), pose.translation().cast<long double>()});
  return result;
}

StackPair random_pair(std::size_t poses, double apart, std::uint64_t seed) {
  RandomStream stream(3, seed);
  const auto n = static_cast<Eigen::Index>(6 * poses);
  const auto draw = [&](double scale) {
    Eigen::VectorXd xi(n);
    stream.fill_normal(xi);
    return Eigen::VectorXd(scale * xi);
  };
  const auto covariance = [&] {
    Eigen::VectorXd entries(n * n);
    stream.fill_normal(entries);
    const Eigen::MatrixXd root = 0.1 * entries.reshaped(n, n);
    return Eigen::MatrixXd(root * root.transpose() + 1e-3 * Eigen::MatrixXd::Identity(n, n));
  };
  const PoseStackd mean = PoseStackd::exp(draw(0.6));
  return {{{std::log(0.3), StackDensity(mean, covariance())},
           {std::log(0.5), StackDensity(PoseStackd::exp(draw(apart)) * mean, covariance())}}};
}

struct Moments {
  Stackl mean;
  Matrixl covariance;
};

Matrixl moved(const Matrixl& j, const StackDensity& density) {
  return j * density.covariance().cast<long double>() * j.transpose();
}

/// Midway-merge paper, eq. 12 to 18.
Moments midway(const StackPair& pair) {
  const long double w_2 = 0.5L / 0.8L;
  const Stackl x_1 = exact(pair[0].density.mean());
  const Vectorl dx = (exact(pair[1].density.mean()) * x_1.inverse()).log();
  const Matrixl p_1 = moved(Stackl::left_jacobian_inverse(-w_2 * dx), pair[0].density);
  const Matrixl p_2 = moved(Stackl::left_jacobian_inverse((1.0L - w_2) * dx), pair[1].density);
  return {Stackl::exp(w_2 * dx) * x_1,
          (1.0L - w_2) * p_1 + w_2 * p_2 + (1.0L - w_2) * w_2 * dx * dx.transpose()};
}

/// Cesic et al. 2017: in the tangent space of the second component, which has the larger weight.
Moments tangent_of_larger(const StackPair& pair) {
  const long double w_1 = 0.3L / 0.8L;
  const Stackl x_2 = exact(pair[1].density.mean());
  const Vectorl d = (exact(pair[0].density.mean()) * x_2.inverse()).log();
  const Matrixl p = w_1 * moved(Stackl::left_jacobian_inverse(d), pair[0].density) +
                    (1.0L - w_1) * pair[1].density.covariance().cast<long double>() +
                    w_1 * (1.0L - w_1) * d * d.transpose();
  const Matrixl j = Stackl::left_jacobian(w_1 * d);
  return {Stackl::exp(w_1 * d) * x_2, j * p * j.transpose()};
}

void expect(const StackPair& pair, MergeRule rule, const Moments& expected) {
  const auto merged = merge<PoseStackd>(pair, {.rule = rule}).component;
  EXPECT_NEAR(merged.log_weight, std::log(0.8), 1e-15);
  EXPECT_TRUE(exact(merged.density.mean()).is_approx(expected.mean, 1e-14L));
  const Matrixl difference = merged.density.covariance().cast<long double>() - expected.covariance;
  EXPECT_LT(static_cast<double>(difference.cwiseAbs().maxCoeff() /
                                expected.covariance.cwiseAbs().maxCoeff()),
            1e-13);
  EXPECT_EQ(merged.density.covariance(), merged.density.covariance().transpose());
}

TEST(StackMerge, BothRulesByEveryInstructionSet) {
  internal::by_every_instruction_set([] {
    for (const std::size_t poses : {1u, 2u, 4u, 6u, 9u}) {
      for (const double apart : {1e-9, 0.1, 0.7}) {
        SCOPED_TRACE(fmt::format("{} poses, {} apart", poses, apart));
        const StackPair pair = random_pair(poses, apart, poses);
        expect(pair, MergeRule::midway, midway(pair));
        expect(pair, MergeRule::tangent_of_larger, tangent_of_larger(pair));
      }
    }
  });
}

TEST(StackMerge, AWeightThatTheOthersDifferenceFromOneLosesCounts) {
  const Eigen::MatrixXd covariance = 1e-14 * Eigen::MatrixXd::Identity(12, 12);
  Eigen::VectorXd apart = Eigen::VectorXd::Zero(12);
  apart[3] = 3.0;
  const double log_small = -37.0;  // 8.5e-17, half of the last digit of one
  const Component<StackDensity> large{0.0, StackDensity(PoseStackd(2), covariance)};
  const Component<StackDensity> small{log_small, StackDensity(PoseStackd::exp(apart), covariance)};
  // Translations alone: w_1 P + w_2 P + w_1 w_2 d^2.
  const double expected = 1e-14 + std::exp(log_small) * 9.0;
  for (const MergeRule rule : {MergeRule::midway, MergeRule::tangent_of_larger}) {
    for (const StackPair& pair : {StackPair{large, small}, StackPair{small, large}}) {
      const auto merged = merge<PoseStackd>(pair, {.rule = rule}).component;
      EXPECT_NEAR(merged.density.covariance()(3, 3), expected, 1e-13 * expected);
    }
  }
}

TEST(StackMerge, StacksOfNoPosesAndOfDifferentSizes) {
  const Component<StackDensity> none{0.0,
                                     StackDensity::trusted(PoseStackd(), Eigen::MatrixXd(0, 0))};
  const std::array nothing{none, none};
  EXPECT_EQ(merge<PoseStackd>(nothing).component.density.mean().size(), 0u);
  const StackPair pair = random_pair(2, 0.1, 1);
  const std::array different{pair[0], random_pair(3, 0.1, 1)[1]};
  EXPECT_THROW(merge<PoseStackd>(different), InvalidInput);
}

}  // namespace
}  // namespace posemix
