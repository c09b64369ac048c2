// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/log_densities.hpp"

#include <limits>
#include <type_traits>

#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "em_draws.hpp"
#include "posemix/testing/expect.hpp"

/// Log densities of many elements at once; the reference is the Evaluator of one.
namespace posemix {
namespace {

using testing::Gaussian;
using testing::Projected;
using testing::random_covariance;
using testing::random_element;
using testing::random_mixture;
using testing::thrown_message;

/// Draws, what lies far from all components, the components' means, and their neighbours at angles
/// down to 3e-9.
template <class D>
std::vector<typename D::Group> points_of(const Mixture<D>& mixture, std::size_t count,
                                         RandomStream& stream) {
  using G = typename D::Group;
  std::vector<G> points;
  for (std::size_t i = 0; points.size() < count; ++i) {
    const G& mean = mixture[i % mixture.size()].density.mean();
    switch (i % 4) {
      case 0:
        points.push_back(mixture.sample(stream));
        break;
      case 1:
        points.push_back(random_element<G>(30.0, stream));
        break;
      case 2:
        points.push_back(mean);
        break;
      default:
        points.push_back(
            random_element<G>(std::pow(10.0, -9.0 * static_cast<double>(i % 40) / 40.0), stream) *
            mean);
    }
  }
  return points;
}

template <class D>
class LogDensities : public ::testing::Test {};
using DensitiesWithKernels = ::testing::Types<Gaussian<SO3d>, Gaussian<SE3d>, Projected<SO3d>,
                                              Projected<SE3d>, Gaussian<Rnd<1>>, Gaussian<Rnd<6>>,
                                              Gaussian<Rnd<7>>, Gaussian<Rnd<Eigen::Dynamic>>>;
TYPED_TEST_SUITE(LogDensities, DensitiesWithKernels);

TYPED_TEST(LogDensities, AreThoseOfTheEvaluators) {
  using D = TypeParam;
  using G = typename D::Group;
  RandomStream stream(31);
  const Mixture<D> mixture = random_mixture_of<D>(4, stream);
  const typename Mixture<D>::Evaluator evaluator(mixture);
  const typename D::Evaluator of_one(mixture[2].density);
  internal::by_every_instruction_set([&] {
    // None, one, less and more than a block.
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, kEmBlock - 1, kEmBlock, kEmBlock + 1, 2 * kEmBlock + 5}) {
      const std::vector<G> points = points_of(mixture, count, stream);
      const std::vector<double> logs = log_densities(mixture, std::span<const G>(points));
      const std::vector<double> one = log_densities(mixture[2].density, std::span<const G>(points));
      const std::vector<double> each = component_log_densities(mixture, std::span<const G>(points));
      ASSERT_EQ(logs.size(), count);
      ASSERT_EQ(one.size(), count);
      ASSERT_EQ(each.size(), 4 * count);
      for (std::size_t i = 0; i < count; ++i) {
        const double expected = evaluator.log_density(points[i]);
        ASSERT_NEAR(logs[i], expected, 1e-12 * (10.0 + std::abs(expected))) << i;
        const double expected_one = of_one.log_density(points[i]);
        ASSERT_NEAR(one[i], expected_one, 1e-12 * (10.0 + std::abs(expected_one))) << i;
        ASSERT_EQ(each[4 * i + 2], one[i]);
      }
    }
  });
}

TYPED_TEST(LogDensities, DependOnTheirElementAlone) {
  using D = TypeParam;
  using G = typename D::Group;
  RandomStream stream(32);
  const Mixture<D> mixture = random_mixture_of<D>(4, stream);
  const std::vector<G> points = points_of(mixture, 300, stream);
  const std::vector<double> all = log_densities(mixture, std::span<const G>(points));
  for (const std::size_t i : {std::size_t{0}, std::size_t{3}, std::size_t{258}, std::size_t{299}})
    EXPECT_EQ(log_densities(mixture, std::span<const G>(&points[i], 1))[0], all[i]);
}

TEST(LogDensitiesOfMixtures, LeaveOutComponentsWithoutWeight) {
  const Gaussian<SO3d> peak(SO3d(), 0.01 * Eigen::Matrix3d::Identity());
  const Gaussian<SO3d> other(SO3d::exp({1.0, 0.0, 0.0}), 0.01 * Eigen::Matrix3d::Identity());
  const double none = -std::numeric_limits<double>::infinity();
  const Mixture<Gaussian<SO3d>> mixture({{0.0, peak}, {none, other}});
  const std::vector<SO3d> at{other.mean(), peak.mean()};
  const std::vector<double> logs = log_densities(mixture, std::span<const SO3d>(at));
  EXPECT_NEAR(logs[0], peak.log_density(at[0]), 1e-10);
  EXPECT_NEAR(logs[1], peak.log_density(at[1]), 1e-12);
  EXPECT_NEAR(component_log_densities(mixture, std::span<const SO3d>(at))[1],
              other.log_density(at[0]), 1e-12);
}

TEST(LogDensitiesOfMixtures, AreMinusInfinityWhereAProjectedGaussianHasNoCoordinates) {
  const Projected<SO3d> peak(SO3d(), 0.01 * Eigen::Matrix3d::Identity());
  const auto half_turn = SO3d::from_quaternion(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0));
  const std::vector<SO3d> points{half_turn, SO3d()};
  const std::vector<double> logs =
      log_densities(Mixture<Projected<SO3d>>({{0.0, peak}}), std::span<const SO3d>(points));
  EXPECT_EQ(logs[0], -std::numeric_limits<double>::infinity());
  EXPECT_NEAR(logs[1], peak.log_density(SO3d()), 1e-12);
}

TEST(LogDensitiesOfMixtures, OfAHalfTurnAreThoseOfEitherQuaternion) {
  RandomStream stream(33);
  internal::by_every_instruction_set([&] {
    const auto density = random_mixture<SE3d>(1, 0.0, 0.5, stream)[0].density;
    std::vector<SE3d> points;
    for (int k = 0; k < 40; ++k) {
      // Axes with and without zeros, and both signs of them.
      Eigen::Vector3d axis(k % 2 == 0 ? stream.normal() : 0.0, k % 3 == 0 ? stream.normal() : 0.0,
                           stream.normal());
      axis.normalize();
      const double sign = k % 4 < 2 ? 1.0 : -1.0;
      points.emplace_back(SO3d::from_quaternion(Eigen::Quaterniond(
                              0.0, sign * axis.x(), sign * axis.y(), sign * axis.z())),
                          Eigen::Vector3d(1.0, 2.0, 3.0));
    }
    const ConcentratedGaussian<SE3d> centred(SE3d(), density.covariance());
    const ConcentratedGaussian<SE3d>::Evaluator evaluator(centred);
    const std::vector<double> logs = log_densities(centred, std::span<const SE3d>(points));
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_NEAR(logs[i], evaluator.log_density(points[i]), 1e-11 * std::abs(logs[i])) << i;
  });
}

TEST(LogDensitiesOfMixtures, OfWhatIsNoNumberAreNone) {
  const Gaussian<Rnd<2>> peak(Rnd<2>(), Eigen::Matrix2d::Identity());
  const Mixture<Gaussian<Rnd<2>>> mixture({{0.0, peak}, {0.0, peak}});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Rnd<2>> points(9);
  points[4] = Rnd<2>(Eigen::Vector2d(nan, 0.0));
  internal::by_every_instruction_set([&] {
    const std::vector<double> logs = log_densities(mixture, std::span<const Rnd<2>>(points));
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(std::isnan(logs[i]), i == 4) << i;
  });
}

TEST(LogDensitiesOfMixtures, RefuseVectorsOfAnotherDimension) {
  using Any = Rnd<Eigen::Dynamic>;
  const Gaussian<Any> peak(Any(Eigen::VectorXd::Zero(2)), Eigen::MatrixXd::Identity(2, 2));
  const std::vector<Any> points{Any(Eigen::VectorXd::Zero(2)), Any(Eigen::VectorXd::Zero(3))};
  const std::string expected = "element 1 has 3 degrees of freedom, the density has 2";
  EXPECT_EQ(thrown_message([&] { log_densities(peak, std::span<const Any>(points)); }), expected);
  const Mixture<Gaussian<Any>> mixture({{0.0, peak}});
  EXPECT_EQ(thrown_message([&] { log_densities(mixture, std::span<const Any>(points)); }),
            expected);
  std::vector<double> room(1);
  EXPECT_EQ(thrown_message(
                [&] { BatchEvaluator(mixture).log_densities(std::span<const Any>(points), room); }),
            "log_densities: room for 1 results of 2 elements");
  EXPECT_EQ(thrown_message([&] { component_log_densities(mixture, std::span<const Any>(points)); }),
            expected);
}

}  // namespace
}  // namespace posemix
