// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

#include "posemix/density/projected_gaussian.hpp"
#include "posemix/mixture/mixture.hpp"
#include "posemix/testing/density_draw.hpp"

/// Random mixtures and draws from them, for tests of EM.
namespace posemix::testing {

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

template <class G>
using Projected = ProjectedGaussian<G>;

template <class G>
typename G::TangentMatrix random_covariance(double spread, RandomStream& stream) {
  using Matrix = typename G::TangentMatrix;
  Eigen::VectorXd entries(G::Dof * G::Dof);
  stream.fill_normal(entries);
  const Matrix root = entries.reshaped(G::Dof, G::Dof);
  Matrix covariance =
      spread * spread * (root * root.transpose() / G::Dof + 0.1 * Matrix::Identity());
  symmetrize(covariance);
  return covariance;
}

template <class G>
Mixture<Projected<G>> random_projected(std::size_t count, double reach, double spread,
                                       RandomStream& stream) {
  std::vector<Component<Projected<G>>> components;
  for (std::size_t k = 0; k < count; ++k) {
    components.push_back(
        {std::log(0.5 + stream.uniform()),
         Projected<G>(random_element<G>(reach, stream), random_covariance<G>(spread, stream))});
  }
  return Mixture<Projected<G>>(std::move(components));
}

/// A mixture of either kind of density.
template <class D>
Mixture<D> random_mixture_of(std::size_t count, RandomStream& stream) {
  using G = typename D::Group;
  if constexpr (std::is_same_v<D, Gaussian<G>>) {
    return random_mixture<G>(count, 1.0, 0.5, stream);
  } else {
    return random_projected<G>(count, 1.0, 0.5, stream);
  }
}

/// A random mixture of densities of the kind D.
template <class D>
Mixture<D> random_mixture_of(std::size_t count, double reach, double spread, RandomStream& stream) {
  using G = typename D::Group;
  if constexpr (std::is_same_v<D, Gaussian<G>>) {
    return random_mixture<G>(count, reach, spread, stream);
  } else {
    return random_projected<G>(count, reach, spread, stream);
  }
}

/// Three components well apart. Those of projected Gaussians have smaller deviations of rotation,
/// for |u| is half the angle.
template <class D>
Mixture<D> three_poses() {
  const auto component = [](double weight, const Vector6d& mean, const Vector6d& sd) {
    return Component<D>{std::log(weight),
                        D(SE3d::exp(mean), Matrix6d(sd.cwiseAbs2().asDiagonal()))};
  };
  Vector6d a, b, c, narrow, wide;
  a << 0.1, 0.2, -0.1, 0.5, 0, 1;
  b << -0.9, 0.4, 1.6, 0.1, 0.6, 1;
  c << 1.2, -1.4, 0.3, -0.4, 0.2, 0.7;
  narrow << 0.1, 0.05, 0.2, 0.02, 0.03, 0.05;
  wide << 0.4, 0.3, 0.5, 0.2, 0.1, 0.2;
  if (std::is_same_v<D, Projected<SE3d>>) {
    narrow.head<3>() << 0.05, 0.03, 0.1;
    wide.head<3>() << 0.25, 0.15, 0.3;
  }
  return Mixture<D>(
      {component(0.5, a, narrow), component(0.3, b, wide), component(0.2, c, narrow)});
}

template <class D>
double log_likelihood(const Mixture<D>& mixture, const std::vector<typename D::Group>& samples) {
  const typename Mixture<D>::Evaluator evaluator(mixture);
  double sum = 0.0;
  for (const auto& sample : samples) sum += evaluator.log_density(sample);
  return sum;
}

inline double worst_fall(const std::vector<double>& history) {
  double fall = 0.0;
  for (std::size_t i = 1; i < history.size(); ++i) {
    fall = std::max(fall, history[i - 1] - history[i]);
  }
  return fall;
}

}  // namespace posemix::testing
