// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <limits>
#include <type_traits>

#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "em_draws.hpp"
#include "posemix/mixture/em.hpp"
#include "posemix/testing/expect.hpp"

/// Compares the loops with vector instructions to the plain functions, sample by sample.
namespace posemix {
namespace {

using testing::Gaussian;
using testing::Projected;
using testing::random_element;
using testing::random_mixture;
using testing::thrown_message;

/// Poses about `centre` at angles from 3e-9 to pi and at metres, and the centre itself; one more
/// than fits a block and a vector.
std::vector<SE3d> poses_about(const SE3d& centre, RandomStream& stream) {
  std::vector<SE3d> poses;
  for (int i = 0; i < 300; ++i) {
    Vector6d xi;
    stream.fill_normal(xi);
    xi.head<3>() = std::pow(10.0, -9.0 * (i % 10) / 9.0) * xi.head<3>().normalized() * 3.14;
    poses.push_back(SE3d::exp(xi) * centre);
  }
  poses.push_back(centre);
  return poses;
}

Vector6d volume_gradient(const Vector6d& xi) {
  Vector6d gradient = Vector6d::Zero();
  for (Eigen::Index j = 0; j < 3; ++j) {
    const Vector6d step = 1e-6 * Vector6d::Unit(j);
    gradient[j] =
        (SE3d::log_abs_det_left_jacobian(xi + step) - SE3d::log_abs_det_left_jacobian(xi - step)) /
        2e-6;
  }
  return gradient;
}

TEST(EmKernels, OfConcentratedGaussiansAgreeWithTheGroup) {
  RandomStream stream(21);
  const auto density = random_mixture<SE3d>(1, 1.0, 0.8, stream)[0].density;
  const std::vector<SE3d> poses = poses_about(density.mean(), stream);
  const EmCoordinates samples{std::span<const SE3d>(poses)};
  const ConcentratedGaussian<SE3d>::Evaluator evaluator(density);
  const Matrix6d precision = density.covariance().inverse();
  const SE3d inverse = density.mean().inverse();
  const EmSettings settings;
  internal::EmGaussianWorker<SE3d> worker(density, settings);
  internal::EmGaussianMoments<SE3d> expected(6);
  for (const std::size_t begin : {std::size_t{0}, kEmBlock}) {
    const std::size_t count = std::min(kEmBlock, poses.size() - begin);
    EmRow log, shares;
    worker.log_density(samples, begin, count, log);
    for (std::size_t i = 0; i < count; ++i) {
      const SE3d& pose = poses[begin + i];
      const Vector6d xi = (pose * inverse).log();
      for (std::size_t j = 0; j < 6; ++j) {
        ASSERT_NEAR(worker.rows()[j][i], xi[static_cast<Eigen::Index>(j)], 1e-14 * (1 + xi.norm()));
      }
      const double direct = evaluator.log_density(pose);
      ASSERT_NEAR(log[i], direct, 1e-12 * (1.0 + std::abs(direct)));
      shares[i] = i % 3 == 0 ? 0.0 : stream.uniform();
      expected.weight += shares[i];
      expected.first += shares[i] * xi;
      expected.second += shares[i] * xi * xi.transpose();
      expected.gradient +=
          shares[i] *
          (SE3d::right_jacobian_inverse(xi).transpose() * (precision * xi) + volume_gradient(xi));
    }
    worker.accumulate(shares);
  }
  const auto moments = worker.moments();
  EXPECT_NEAR(moments.weight, expected.weight, 1e-12 * expected.weight);
  EXPECT_LT((moments.first - expected.first).norm(), 1e-11);
  EXPECT_LT((moments.second - expected.second).norm(), 1e-12 * expected.second.norm());
  EXPECT_LT((moments.gradient - expected.gradient).norm(), 1e-8 * expected.weight);
}

template <class N>
class EmKernelsOnVectors : public ::testing::Test {};
template <int N>
using Size = std::integral_constant<int, N>;
using Sizes =
    ::testing::Types<Size<1>, Size<2>, Size<3>, Size<4>, Size<5>, Size<6>, Size<7>, Size<11>>;
TYPED_TEST_SUITE(EmKernelsOnVectors, Sizes);

/// Compares with the worker of any group: one block and a part of another, whose size is no
/// multiple of a vector's, with a mean that is ten deviations from zero. Every sum has some 300
/// terms, each of which is rounded a few times: 1e-13 of the sum of absolute values.
template <LieGroup G>
void expect_worker_of_any_group(const Gaussian<G>& density, const std::vector<G>& elements,
                                RandomStream& stream) {
  const EmSettings settings;
  typename EmModel<Gaussian<G>>::Worker worker(density, settings);
  internal::EmAnyGroupWorker<G> reference(density, settings);
  const EmCoordinates samples{std::span<const G>(elements)};
  const EmSamples<G> plain{std::span<const G>(elements)};
  const Eigen::VectorXd sd = density.covariance().diagonal().cwiseSqrt();
  Eigen::VectorXd absolute = Eigen::VectorXd::Zero(sd.size());
  for (std::size_t begin = 0; begin < elements.size(); begin += kEmBlock) {
    const std::size_t count = std::min(kEmBlock, elements.size() - begin);
    EmRow log, expected, shares;
    worker.log_density(samples, begin, count, log);
    reference.log_density(plain, begin, count, expected);
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_NEAR(log[i], expected[i], 1e-13 * (10.0 + std::abs(expected[i])));
      shares[i] = i % 3 == 0 || (i > 64 && i < 96) ? 0.0 : stream.uniform();
      const Eigen::VectorXd y = (elements[begin + i] * density.mean().inverse()).log();
      absolute += shares[i] * y.cwiseAbs();
    }
    worker.accumulate(shares);
    reference.accumulate(shares);
  }
  const auto moments = worker.moments();
  const auto& sums = reference.moments();
  EXPECT_NEAR(worker.weight(), sums.weight, 1e-13 * sums.weight);
  EXPECT_EQ(moments.weight, worker.weight());
  const Eigen::VectorXd root = sums.second.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < sd.size(); ++i) {
    EXPECT_NEAR(moments.first[i], sums.first[i], 1e-13 * absolute[i]);
    for (Eigen::Index j = 0; j < sd.size(); ++j)
      EXPECT_NEAR(moments.second(i, j), sums.second(i, j), 1e-13 * root[i] * root[j]);
  }
  EXPECT_LT((moments.gradient - sums.gradient).norm(), 1e-11 * (1.0 + sums.gradient.norm()));
}

TYPED_TEST(EmKernelsOnVectors, AgreeWithTheWorkerOfAnyGroup) {
  constexpr int kN = TypeParam::value;
  RandomStream stream(24);
  const auto density = random_mixture<Rnd<kN>>(1, 10.0, 1.0, stream)[0].density;
  const Gaussian<Rnd<Eigen::Dynamic>> same{
      Rnd<Eigen::Dynamic>(Eigen::VectorXd(density.mean().value())),
      Eigen::MatrixXd(density.covariance())};
  std::vector<Rnd<kN>> samples;
  std::vector<Rnd<Eigen::Dynamic>> of_any_size;
  for (int i = 0; i < 301; ++i) {
    samples.push_back(density.sample(stream));
    of_any_size.emplace_back(Eigen::VectorXd(samples.back().value()));
  }
  internal::by_every_instruction_set([&] {
    expect_worker_of_any_group(density, samples, stream);
    expect_worker_of_any_group(same, of_any_size, stream);
  });
}

TEST(EmKernels, RefuseVectorsOfSeveralDimensions) {
  const std::vector<Rnd<Eigen::Dynamic>> samples{Rnd<Eigen::Dynamic>(Eigen::VectorXd::Zero(2)),
                                                 Rnd<Eigen::Dynamic>(Eigen::VectorXd::Zero(3))};
  EXPECT_EQ(thrown_message([&] { EmCoordinates{std::span(samples)}; }),
            "EM: sample 1 has 3 dimensions, the first 2");
}

TEST(EmKernels, SharesAreThoseOfTheExponentials) {
  RandomStream stream(22);
  EmRow weights;
  std::vector<EmRow> terms(3);
  for (std::size_t i = 0; i < kEmBlock; ++i) {
    weights[i] = stream.uniform();
    for (EmRow& row : terms) row[i] = 30.0 * stream.normal() - 500.0;
  }
  terms[1][7] = -std::numeric_limits<double>::infinity();
  const std::vector<EmRow> logs = terms;
  const double log_likelihood = internal::shares_from_log_terms(weights, kEmBlock, terms);
  double expected = 0.0;
  for (std::size_t i = 0; i < kEmBlock; ++i) {
    const double total = log_sum_exp(std::vector<double>{logs[0][i], logs[1][i], logs[2][i]});
    expected += weights[i] * total;
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_NEAR(terms[k][i], weights[i] * std::exp(logs[k][i] - total), 1e-13);
    }
  }
  EXPECT_NEAR(log_likelihood, expected, 1e-13 * std::abs(expected));
}

TEST(EmKernels, NoComponentWithDensityMeansNoShares) {
  EmRow weights;
  weights[0] = 1.0;
  std::vector<EmRow> terms(2);
  terms[0][0] = terms[1][0] = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(internal::shares_from_log_terms(weights, 1, terms),
            -std::numeric_limits<double>::infinity());
  EXPECT_EQ(terms[0][0], 0.0);
  EXPECT_EQ(terms[1][0], 0.0);
}

TEST(EmKernels, DoNotDependOnTheInstructions) {
  RandomStream stream(23);
  const auto density = random_mixture<SE3d>(1, 1.0, 0.8, stream)[0].density;
  const Projected<SE3d> projected(density.mean(), density.covariance());
  const std::vector<SE3d> poses = poses_about(random_element<SE3d>(0.5, stream), stream);
  const EmCoordinates samples{std::span<const SE3d>(poses)};
  const EmSettings settings;
  std::vector<EmRow> first;
  internal::by_every_instruction_set([&] {
    std::vector<EmRow> rows(3);
    internal::EmGaussianWorker<SE3d>(density, settings).log_density(samples, 0, kEmBlock, rows[0]);
    EmModel<Projected<SE3d>>::Worker(projected, settings)
        .log_density(samples, 0, kEmBlock, rows[1]);
    const double sum = internal::shares_from_log_terms(rows[0], kEmBlock, {&rows[1], 1});
    rows[2][0] = sum;
    if (first.empty()) first = rows;
    for (std::size_t j = 0; j < rows.size(); ++j) {
      for (std::size_t i = 0; i < kEmBlock; ++i) {
        ASSERT_NEAR(rows[j][i], first[j][i], 1e-11 * (1.0 + std::abs(first[j][i])));
      }
    }
  });
}

}  // namespace
}  // namespace posemix
