// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/samples.hpp"

#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "em_draws.hpp"

/// Many draws at once; the reference is as many calls of `sample`, whose moments are tested.
namespace posemix {
namespace {

using testing::Gaussian;
using testing::Projected;
using testing::random_covariance;
using testing::random_element;

/// Whether `found` are the draws of `density` by a stream, which they leave where these do.
template <class D>
void expect_draws(const std::vector<typename D::Group>& found, RandomStream& after,
                  const auto& density, std::size_t count, std::uint64_t seed) {
  RandomStream stream(seed);
  ASSERT_EQ(found.size(), count);
  for (std::size_t i = 0; i < count; ++i)
    ASSERT_TRUE(found[i].is_approx(density.sample(stream), 1e-12)) << i;
  EXPECT_EQ(after(), stream());
}

template <class D>
class Samples : public ::testing::Test {};
using Sampled = ::testing::Types<Gaussian<SO3d>, Gaussian<SE3d>, Gaussian<Rnd<6>>,
                                 Gaussian<Rnd<Eigen::Dynamic>>, Projected<SO3d>, Projected<SE3d>>;
TYPED_TEST_SUITE(Samples, Sampled);

TYPED_TEST(Samples, AreThoseOfAsManyCalls) {
  RandomStream made(41);
  const Mixture<TypeParam> mixture = random_mixture_of<TypeParam>(3, made);
  internal::by_every_instruction_set([&] {
    // None, one, and less and more than a block.
    for (const std::size_t count : {0, 1, 255, 256, 257, 600}) {
      RandomStream stream(count);
      const auto found = samples(mixture, count, stream);
      expect_draws<TypeParam>(found, stream, mixture, count, count);
      const TypeParam& one = mixture[1].density;
      RandomStream of_one(count);
      const auto found_of_one = samples(one, count, of_one);
      expect_draws<TypeParam>(found_of_one, of_one, one, count, count);
    }
  });
}

TEST(SamplesOfStacks, AreThoseOfAsManyCalls) {
  RandomStream made(42);
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(12, 12);
  const ConcentratedGaussian<PoseStackd> density(
      PoseStackd({testing::random_element<SE3d>(1.0, made), SE3d()}),
      0.01 * (root * root.transpose() + Eigen::MatrixXd::Identity(12, 12)));
  RandomStream stream(7);
  const auto found = samples(density, 20, stream);
  expect_draws<ConcentratedGaussian<PoseStackd>>(found, stream, density, 20, 7);
}

TEST(SamplesOfMixtures, NeverComeFromAComponentWithoutWeight) {
  const double none = -std::numeric_limits<double>::infinity();
  const Matrix6d narrow = 1e-12 * Matrix6d::Identity();
  const SE3d far(SO3d(), {100.0, 0.0, 0.0});
  const Mixture<Gaussian<SE3d>> mixture(
      {{none, Gaussian<SE3d>(far, narrow)}, {0.0, Gaussian<SE3d>(SE3d(), narrow)}});
  RandomStream stream(3);
  for (const SE3d& pose : samples(mixture, 1000, stream))
    ASSERT_LT(pose.translation().norm(), 1e-4);
}

}  // namespace
}  // namespace posemix
