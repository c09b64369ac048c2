// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em.hpp"

#include <limits>
#include <numeric>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::relative_difference;
using testing::tested_dof;
using testing::thrown_message;

template <LieGroup G>
using Gaussian = ConcentratedGaussian<G>;

template <LieGroup G>
G random_element(double reach, RandomStream& stream) {
  Eigen::VectorXd xi(tested_dof<G>());
  stream.fill_normal(xi);
  return G::exp(typename G::Tangent(reach * xi));
}

/// Draws from `count` components scattered by `reach`, each with random correlated spread.
template <LieGroup G>
Mixture<Gaussian<G>> random_mixture(std::size_t count, double reach, double spread,
                                    RandomStream& stream) {
  const Eigen::Index n = tested_dof<G>();
  std::vector<Component<Gaussian<G>>> components;
  for (std::size_t k = 0; k < count; ++k) {
    Eigen::VectorXd entries(n * n);
    stream.fill_normal(entries);
    const Eigen::MatrixXd root = entries.reshaped(n, n);
    typename G::TangentMatrix covariance =
        spread * spread *
        (root * root.transpose() / static_cast<double>(n) + 0.2 * Eigen::MatrixXd::Identity(n, n));
    symmetrize(covariance);
    components.push_back({std::log(0.5 + stream.uniform()),
                          Gaussian<G>(random_element<G>(reach, stream), covariance)});
  }
  return Mixture<Gaussian<G>>(std::move(components));
}

template <class D>
std::vector<typename D::Group> draws(const Mixture<D>& mixture, std::size_t count,
                                     RandomStream& stream) {
  std::vector<typename D::Group> samples;
  for (std::size_t i = 0; i < count; ++i) samples.push_back(mixture.sample(stream));
  return samples;
}

template <class D>
double log_likelihood(const Mixture<D>& mixture, const std::vector<typename D::Group>& samples) {
  const typename Mixture<D>::Evaluator evaluator(mixture);
  double sum = 0.0;
  for (const auto& sample : samples) sum += evaluator.log_density(sample);
  return sum;
}

double worst_fall(const std::vector<double>& history) {
  double fall = 0.0;
  for (std::size_t i = 1; i < history.size(); ++i) {
    fall = std::max(fall, history[i - 1] - history[i]);
  }
  return fall;
}

template <class G>
class EmOn : public ::testing::Test {};
using Groups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(EmOn, Groups);

TYPED_TEST(EmOn, NeverLowersTheLogLikelihood) {
  using D = Gaussian<TypeParam>;
  double fall = 0.0;
  std::size_t iterations = 0;
  for (std::uint64_t seed = 0; seed < (TypeParam::Dof == Eigen::Dynamic ? 8 : 24); ++seed) {
    RandomStream stream(7, seed);
    const double reach = seed % 3 == 0 ? 2.0 : 0.6;
    const double spread = seed % 2 == 0 ? 0.9 : 0.3;
    const auto samples = draws(random_mixture<TypeParam>(3, reach, spread, stream), 150, stream);
    const EmSettings settings{.components = 1 + seed % 4,
                              .max_iterations = 60,
                              .tolerance = 0.0,
                              .restarts = 2,
                              .fixed_means = seed % 8 == 7,
                              .diagonal = seed % 5 == 4,
                              .min_sd = 1e-3,
                              .max_sd = seed % 6 == 5 ? 0.7 : 1e3};
    const auto fit = fit_mixture<D>(samples, {}, settings, stream);
    fall = std::max(fall, worst_fall(fit.history));
    iterations += fit.history.size();
    EXPECT_NEAR(fit.log_likelihood, log_likelihood(fit.mixture, samples),
                1e-9 * std::abs(fit.log_likelihood) + 1e-9);
    EXPECT_EQ(fit.log_likelihood, fit.history.back());
  }
  EXPECT_LE(fall, 1e-9);
  EXPECT_GT(iterations, 150U);
}

/// The log-likelihood of the mixture with component k moved and its spread changed.
template <LieGroup G>
double perturbed_log_likelihood(const Mixture<Gaussian<G>>& mixture, std::size_t k,
                                const typename G::Tangent& move,
                                const typename G::TangentMatrix& change,
                                const std::vector<G>& samples) {
  std::vector<Component<Gaussian<G>>> components = mixture.components();
  Gaussian<G>& density = components[k].density;
  density = Gaussian<G>(G::exp(move) * density.mean(),
                        typename G::TangentMatrix(density.covariance() + change));
  return log_likelihood(Mixture<Gaussian<G>>(std::move(components)), samples);
}

/// At the end the slope of the likelihood is zero in every mean and covariance: the M-step is that
/// of maximum likelihood, volume factor included. (Without it slopes of up to 0.3 are left here.)
TYPED_TEST(EmOn, EndsWhereTheLikelihoodIsStationary) {
  using G = TypeParam;
  RandomStream stream(11);
  const Mixture<Gaussian<G>> truth = random_mixture<G>(2, 0.7, 0.5, stream);
  const auto samples = draws(truth, 400, stream);
  const EmSettings settings{.components = 2, .max_iterations = 4000, .tolerance = 0.0};
  const auto fit = fit_mixture<Gaussian<G>>(samples, {}, settings, stream, std::optional(truth));
  ASSERT_EQ(fit.status, EmStatus::converged);
  const Eigen::Index n = tested_dof<G>();
  const typename G::TangentMatrix none = G::TangentMatrix::Zero(n, n);
  constexpr double kStep = 1e-5;
  for (std::size_t k = 0; k < 2; ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const typename G::Tangent move = kStep * G::Tangent::Unit(n, i);
      const double slope = (perturbed_log_likelihood<G>(fit.mixture, k, move, none, samples) -
                            perturbed_log_likelihood<G>(fit.mixture, k, -move, none, samples)) /
                           (2.0 * kStep);
      EXPECT_NEAR(slope, 0.0, 2e-2) << "mean " << k << " along " << i;
      const double scale = fit.mixture[k].density.covariance()(i, i);
      typename G::TangentMatrix change = none;
      change(i, i) = kStep * scale;
      const typename G::Tangent still = 0.0 * move;
      const double growth = (perturbed_log_likelihood<G>(fit.mixture, k, still, change, samples) -
                             perturbed_log_likelihood<G>(fit.mixture, k, still, -change, samples)) /
                            (2.0 * kStep);
      EXPECT_NEAR(growth, 0.0, 2e-2) << "variance " << k << " along " << i;
    }
  }
}

/// The blocks of poses, which are computed coordinate by coordinate, against the group's own
/// functions; angles up to pi, down to zero, and translations of metres.
TEST(EmSamples, OfPosesAgreeWithTheGroup) {
  RandomStream stream(21);
  std::vector<SE3d> poses;
  const SE3d centre = random_element<SE3d>(1.0, stream);
  for (int i = 0; i < 300; ++i) {
    Vector6d xi;
    stream.fill_normal(xi);
    xi.head<3>() = std::pow(10.0, -9.0 * (i % 10) / 9.0) * xi.head<3>().normalized() * 3.14;
    poses.push_back(SE3d::exp(xi) * centre);
  }
  poses.push_back(centre);
  const EmSamples<SE3d> samples(poses);
  for (const std::size_t begin : {std::size_t{0}, std::size_t{256}}) {
    const std::size_t count = std::min<std::size_t>(256, poses.size() - begin);
    const auto columns = static_cast<Eigen::Index>(count);
    EmSamples<SE3d>::Block block;
    samples.log(begin, count, centre.inverse(), block);
    TangentRows<SE3d> y(6, columns);
    Eigen::ArrayXd shares(columns);
    Vector6d expected = Vector6d::Zero();
    for (Eigen::Index i = 0; i < columns; ++i) {
      const Vector6d xi = (poses[begin + static_cast<std::size_t>(i)] * centre.inverse()).log();
      ASSERT_LT((block.xi().col(i) - xi).norm(), 2e-14 * (1.0 + xi.norm())) << xi.transpose();
      ASSERT_NEAR(block.log_volume[i], SE3d::log_abs_det_left_jacobian(xi), 1e-14);
      y.col(i) = Vector6d::Random();
      shares[i] = stream.uniform();
      Vector6d volume = Vector6d::Zero();
      for (Eigen::Index j = 0; j < 3; ++j) {
        const Vector6d step = 1e-6 * Vector6d::Unit(j);
        volume[j] = (SE3d::log_abs_det_left_jacobian(xi + step) -
                     SE3d::log_abs_det_left_jacobian(xi - step)) /
                    2e-6;
      }
      expected += shares[i] * (SE3d::right_jacobian_inverse(xi).transpose() * y.col(i) + volume);
    }
    Vector6d gradient = Vector6d::Zero();
    EmSamples<SE3d>::add_gradient(block, y, shares, gradient);
    EXPECT_LT((gradient - expected).norm(), 1e-7 * static_cast<double>(count));
  }
}

TEST(Em, OfOneComponentOnVectorsIsMeanAndCovariance) {
  RandomStream stream(3);
  const auto samples = draws(random_mixture<Rnd<3>>(3, 2.0, 1.0, stream), 200, stream);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& sample : samples) mean += sample.value() / 200.0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& sample : samples) {
    covariance += (sample.value() - mean) * (sample.value() - mean).transpose() / 200.0;
  }
  const auto fit = fit_mixture<Gaussian<Rnd<3>>>(samples, {}, {}, stream);
  EXPECT_EQ(fit.status, EmStatus::converged);
  EXPECT_LT((fit.mixture[0].density.mean().value() - mean).norm(), 1e-12);
  EXPECT_LT(relative_difference(fit.mixture[0].density.covariance(), covariance), 1e-12);
  EXPECT_EQ(fit.parameters, 9U);
  EXPECT_NEAR(fit.bic, 9.0 * std::log(200.0) - 2.0 * fit.log_likelihood, 1e-9);
}

Mixture<Gaussian<SE3d>> three_poses() {
  const auto component = [](double weight, const Vector6d& mean, const Vector6d& sd) {
    return Component<Gaussian<SE3d>>{
        std::log(weight), Gaussian<SE3d>(SE3d::exp(mean), Matrix6d(sd.cwiseAbs2().asDiagonal()))};
  };
  Vector6d a, b, c, narrow, wide;
  a << 0.1, 0.2, -0.1, 0.5, 0, 1;
  b << -0.9, 0.4, 1.6, 0.1, 0.6, 1;
  c << 1.2, -1.4, 0.3, -0.4, 0.2, 0.7;
  narrow << 0.1, 0.05, 0.2, 0.02, 0.03, 0.05;
  wide << 0.4, 0.3, 0.5, 0.2, 0.1, 0.2;
  return Mixture<Gaussian<SE3d>>(
      {component(0.5, a, narrow), component(0.3, b, wide), component(0.2, c, narrow)});
}

TEST(Em, RecoversAMixtureOfPoses) {
  RandomStream stream(5);
  const Mixture<Gaussian<SE3d>> truth = three_poses();
  constexpr double kCount = 8000;
  const auto samples = draws(truth, static_cast<std::size_t>(kCount), stream);
  const EmSettings settings{.components = 3, .restarts = 4};
  const auto fit = fit_mixture<Gaussian<SE3d>>(samples, {}, settings, stream);
  EXPECT_EQ(fit.status, EmStatus::converged);
  EXPECT_EQ(fit.starts, 4);
  for (const auto& component : truth.components()) {
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      const auto gap = [&](std::size_t j) {
        return (fit.mixture[j].density.mean() * component.density.mean().inverse()).log().norm();
      };
      if (gap(i) < gap(k)) k = i;
    }
    const double share = std::exp(component.log_weight);
    EXPECT_NEAR(fit.mixture.weight(k), share, 4.0 * std::sqrt(share * (1 - share) / kCount));
    const Vector6d sd = component.density.covariance().diagonal().cwiseSqrt();
    const Vector6d found = fit.mixture[k].density.covariance().diagonal().cwiseSqrt();
    const Vector6d gap = (fit.mixture[k].density.mean() * component.density.mean().inverse()).log();
    for (Eigen::Index i = 0; i < 6; ++i) {
      EXPECT_NEAR(found[i], sd[i], 4.0 * sd[i] / std::sqrt(2.0 * share * kCount));
      EXPECT_NEAR(gap[i], 0.0, 4.0 * sd[i] / std::sqrt(share * kCount));
    }
  }
}

TEST(Em, PicksTheNumberOfComponentsByBic) {
  RandomStream stream(6);
  const auto samples = draws(three_poses(), 1500, stream);
  const EmSettings settings{.components = 4, .restarts = 2};
  const auto selection = fit_mixture_by_bic<Gaussian<SE3d>>(samples, {}, settings, stream);
  ASSERT_EQ(selection.fits.size(), 4U);
  EXPECT_EQ(selection.best, 2U);
}

TEST(Em, AWeightCountsSamples) {
  RandomStream stream(8);
  const auto samples = draws(three_poses(), 300, stream);
  std::vector<double> weights(samples.size());
  std::vector<SE3d> repeated;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    weights[i] = static_cast<double>(i % 3);
    repeated.insert(repeated.end(), i % 3, samples[i]);
  }
  const EmSettings settings{.components = 3, .max_iterations = 20, .tolerance = 0.0};
  const auto a =
      fit_mixture<Gaussian<SE3d>>(samples, weights, settings, stream, std::optional(three_poses()));
  const auto b =
      fit_mixture<Gaussian<SE3d>>(repeated, {}, settings, stream, std::optional(three_poses()));
  EXPECT_NEAR(a.log_likelihood, b.log_likelihood, 1e-8);
  EXPECT_NEAR(a.bic, b.bic, 1e-8);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(a.mixture[k].density.mean().is_approx(b.mixture[k].density.mean(), 1e-9));
  }
}

TEST(Em, TellsConcentricComponentsApart) {
  RandomStream stream(9);
  const SE3d centre;
  const Matrix6d narrow = 0.01 * Matrix6d::Identity();
  Matrix6d wide = narrow;
  wide(2, 2) = 1.0;
  const std::vector<double> shares{0.6, 0.4};
  const auto truth = Mixture<Gaussian<SE3d>>::from_weights(
      shares, {Gaussian<SE3d>(centre, narrow), Gaussian<SE3d>(centre, wide)});
  const auto samples = draws(truth, 5000, stream);
  const EmSettings settings{.components = 2, .restarts = 3, .fixed_means = true, .diagonal = true};
  const auto fit = fit_mixture<Gaussian<SE3d>>(samples, {}, settings, stream);
  const std::size_t sharp = fit.mixture[0].density.covariance()(2, 2) < 0.1 ? 0 : 1;
  EXPECT_NEAR(fit.mixture.weight(sharp), 0.6, 0.04);
  EXPECT_NEAR(fit.mixture[sharp].density.covariance()(2, 2), 0.01, 1.5e-3);
  EXPECT_NEAR(fit.mixture[1 - sharp].density.covariance()(2, 2), 1.0, 0.1);
  EXPECT_TRUE(fit.mixture[sharp].density.mean().is_approx(centre, 0.0));
  EXPECT_TRUE(fit.mixture[sharp].density.covariance().isDiagonal(0.0));
  EXPECT_EQ(fit.parameters, 13U);
}

TEST(Em, KeepsCovariancesWithinTheirBounds) {
  RandomStream stream(10);
  const auto samples = draws(three_poses(), 500, stream);
  Eigen::VectorXd unit(6);
  unit << 1, 1, 1, 0.1, 0.1, 0.1;
  for (const bool diagonal : {false, true}) {
    const EmSettings settings{.components = 2,
                              .restarts = 2,
                              .diagonal = diagonal,
                              .unit = unit,
                              .min_sd = 0.3,
                              .max_sd = 0.6};
    const auto fit = fit_mixture<Gaussian<SE3d>>(samples, {}, settings, stream);
    for (const auto& component : fit.mixture.components()) {
      const Eigen::MatrixXd scaled = unit.cwiseInverse().asDiagonal() *
                                     component.density.covariance() *
                                     unit.cwiseInverse().asDiagonal();
      const Eigen::VectorXd values = scaled.selfadjointView<Eigen::Lower>().eigenvalues();
      EXPECT_GE(values.minCoeff(), 0.09 * (1.0 - 1e-12));
      EXPECT_LE(values.maxCoeff(), 0.36 * (1.0 + 1e-12));
    }
  }
}

TEST(Em, SaysThatAComponentCollapsed) {
  RandomStream stream(12);
  auto samples = draws(three_poses(), 200, stream);
  const std::vector<SE3d> same(20, SE3d::exp(Vector6d::Constant(-1.5)));
  samples.insert(samples.end(), same.begin(), same.end());
  std::vector<Component<Gaussian<SE3d>>> start = three_poses().components();
  start.push_back({0.0, Gaussian<SE3d>(same.front(), Matrix6d(1e-4 * Matrix6d::Identity()))});
  const auto fit =
      fit_mixture<Gaussian<SE3d>>(samples, {}, {.components = 4, .min_sd = 1e-4}, stream,
                                  std::optional(Mixture<Gaussian<SE3d>>(std::move(start))));
  EXPECT_EQ(fit.status, EmStatus::degenerate);
}

TEST(Em, RefusesBadInput) {
  RandomStream stream(13);
  auto samples = draws(three_poses(), 30, stream);
  const auto message = [&](const std::vector<SE3d>& s, const std::vector<double>& w,
                           const EmSettings& settings) {
    return thrown_message([&] { fit_mixture<Gaussian<SE3d>>(s, w, settings, stream); });
  };
  EXPECT_EQ(message({}, {}, {}), "EM: there are no samples");
  EXPECT_EQ(message(samples, {1.0}, {}), "EM: 1 weights for 30 samples");
  std::vector<double> weights(30, 1.0);
  weights[4] = -1.0;
  EXPECT_EQ(message(samples, weights, {}), "EM: weight 4 is -1, expected a finite number >= 0");
  EXPECT_EQ(message(samples, {}, {.components = 5}),
            "EM: 30 samples of positive weight, expected at least 35 for so many components");
  EXPECT_EQ(message(samples, {}, {.components = 0}), "EM: components is 0, expected one or more");
  EXPECT_EQ(message(samples, {}, {.min_sd = 0.0}),
            "EM: min_sd is 0, expected a finite number above zero");
  EXPECT_EQ(message(samples, {}, {.unit = Eigen::VectorXd::Ones(3)}),
            "EM: size of unit is 3, expected the degrees of freedom");
  samples[7] = SE3d(SO3d(), Eigen::Vector3d(0, std::numeric_limits<double>::quiet_NaN(), 0));
  EXPECT_EQ(message(samples, {}, {}),
            "EM: sample 7 is not finite, or not of 6 degrees of freedom as the first");
}

}  // namespace
}  // namespace posemix
