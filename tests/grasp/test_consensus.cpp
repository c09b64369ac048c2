// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/grasp/consensus.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::thrown_message;

ErrorMixture isotropic(double rotation_sd, double translation_sd) {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(rotation_sd * rotation_sd),
      Eigen::Vector3d::Constant(translation_sd * translation_sd);
  std::vector<Component<ErrorMixture::Gaussian>> components;
  components.push_back({0.0, {Rnd<6>(Vector6d::Zero()), Matrix6d(variance.asDiagonal())}});
  return ErrorMixture(Mixture<ErrorMixture::Gaussian>(std::move(components)));
}

SE3d shifted(double x) { return SE3d(SO3d(), {x, 0.0, 1.0}); }

/// n equal Gaussians to the power b multiply to one at their mean with the variance by n b.
TEST(Consensus, OfGaussiansIsTheirProduct) {
  const ErrorMixture errors = isotropic(radians(2.0), 5e-3);
  const std::vector<SE3d> estimates{shifted(0.0), shifted(6e-3), shifted(3e-3)};
  for (const double correlation : {0.0, 0.5, 1.0}) {
    std::vector<ConsensusMember> members;
    for (const SE3d& estimate : estimates) members.push_back({estimate, &errors});
    RandomStream stream(1);
    const PoseConsensus consensus =
        fuse_estimates(members, {.draws_per_member = 20000, .correlation = correlation}, stream);
    const double variance = 25e-6 * (1.0 + 2.0 * correlation) / 3.0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double square = 0.0;
    for (std::size_t i = 0; i < consensus.truths.size(); ++i) {
      const double weight = consensus.weights[static_cast<Eigen::Index>(i)];
      mean += weight * consensus.truths[i].translation();
      square += weight * std::pow(consensus.truths[i].translation().x() - 3e-3, 2);
    }
    EXPECT_NEAR(mean.x(), 3e-3, 1e-4);
    EXPECT_NEAR(square / variance, 1.0, 0.05) << correlation;
    EXPECT_NEAR(consensus.weights.sum(), 1.0, 1e-12);
    EXPECT_GT(consensus.effective_draws(), 1000.0);
    EXPECT_LE(consensus.effective_draws(), 60000.0 * (1.0 + 1e-12));
  }
}

/// P(|N(0, sd)| < w) = erf(w / (sd sqrt 2)) along one axis.
TEST(Consensus, SuccessInAHardBox) {
  const ErrorMixture errors = isotropic(radians(2.0), 5e-3);
  const std::vector<ConsensusMember> members{{shifted(0.0), &errors}};
  RandomStream stream(2);
  const PoseConsensus consensus = fuse_estimates(members, {.draws_per_member = 40000}, stream);
  ToleranceRegion box;
  box.half_width[3] = 4e-3;
  ToleranceRegion wider = box;
  wider.half_width[3] = 8e-3;
  const double narrow = std::erf(0.8 / std::sqrt(2.0));
  const double wide = std::erf(1.6 / std::sqrt(2.0));
  const std::vector<ToleranceRegion> both{box, wider};
  EXPECT_NEAR(success_probability(consensus, shifted(0.0), std::span(both).first(1)), narrow, 0.01);
  EXPECT_NEAR(success_probability(consensus, shifted(0.0), both), 0.5 * (narrow + wide), 0.01);
  EXPECT_NEAR(success_probability(consensus.resampled(20000), shifted(0.0), both),
              0.5 * (narrow + wide), 0.015);
  EXPECT_EQ(consensus.resampled(77).truths.size(), 77U);
}

TEST(Consensus, ResamplingKeepsShares) {
  const PoseConsensus two{{shifted(0.0), shifted(1.0)}, Eigen::Vector2d(0.3, 0.7)};
  const PoseConsensus many = two.resampled(10);
  double sum = 0.0;
  for (const SE3d& truth : many.truths) sum += truth.translation().x();
  EXPECT_EQ(sum, 7.0);
  EXPECT_NEAR(many.weights[3], 0.1, 1e-15);
}

TEST(Consensus, IsTheSameForTheSameStream) {
  const ErrorMixture errors = isotropic(0.1, 0.01);
  const std::vector<ConsensusMember> members{{shifted(0.0), &errors}, {shifted(0.01), &errors}};
  RandomStream first(3);
  RandomStream second(3);
  EXPECT_EQ(fuse_estimates(members, {}, first).weights,
            fuse_estimates(members, {}, second).weights);
}

TEST(Consensus, RefusesBadInput) {
  const ErrorMixture errors = isotropic(0.1, 0.01);
  const std::vector<ConsensusMember> members{{shifted(0.0), &errors}};
  RandomStream stream(4);
  EXPECT_EQ(thrown_message([&] { fuse_estimates({}, {}, stream); }),
            "a consensus needs at least one estimate");
  EXPECT_EQ(thrown_message([&] { fuse_estimates(members, {.correlation = 1.5}, stream); }),
            "correlation of estimates outside [0, 1]");
  EXPECT_EQ(thrown_message([&] { fuse_estimates(members, {.draws_per_member = 0}, stream); }),
            "a consensus needs at least one draw per estimate");
  const PoseConsensus consensus = fuse_estimates(members, {}, stream);
  EXPECT_EQ(thrown_message([&] { success_probability(consensus, shifted(0.0), {}); }),
            "probability of success without a region");
}

}  // namespace
}  // namespace posemix
