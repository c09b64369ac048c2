// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Values of groups, densities and mixtures.
#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "containers.hpp"
#include "public_headers.hpp"
#include "samples_of_types.hpp"

namespace posemix::arguments {

/// Rotations: with half a turn, and of a detection that is missing (NaN).
template <>
struct Samples<SO3d> {
  static std::size_t count() { return 4; }
  static SO3d make(std::size_t i) {
    const std::array<Eigen::Vector3d, 4> values{
        Eigen::Vector3d(0.1, -0.2, 0.3), Eigen::Vector3d::Zero(),
        Eigen::Vector3d(0, 0, std::numbers::pi), Eigen::Vector3d::Constant(kNaN)};
    return SO3d::exp(values[i]);
  }
};

template <>
struct Samples<SE3d> {
  static std::size_t count() { return 8; }
  static SE3d make(std::size_t i) {
    const std::array<Eigen::Vector3d, 8> positions{
        Eigen::Vector3d(0.1, 0.05, 0.8),  Eigen::Vector3d::Zero(),      Eigen::Vector3d(kNaN, 0, 1),
        Eigen::Vector3d(0, kInfinity, 1), Eigen::Vector3d(0, 0, 1e300), Eigen::Vector3d(0, 0, 1e9),
        Eigen::Vector3d(0.1, 0.05, 0.8),  Eigen::Vector3d(0, 0, 1)};
    return SE3d(i < 6 ? fine<SO3d>() : Samples<SO3d>::make(i - 4), positions[i]);
  }
};

template <int N>
struct Samples<Rn<N, double>> {
  using Vector = Eigen::Matrix<double, N, 1>;
  static std::size_t count() { return Samples<Vector>::count(); }
  static Rn<N, double> make(std::size_t i) { return Rn<N, double>(Samples<Vector>::make(i)); }
};

template <>
struct Samples<Eigen::Quaterniond> {
  static std::size_t count() { return 4; }
  static Eigen::Quaterniond make(std::size_t i) {
    const std::array<Eigen::Quaterniond, 4> values{
        Eigen::Quaterniond::Identity(), Eigen::Quaterniond(0, 0, 0, 0),
        Eigen::Quaterniond(kNaN, 0, 0, 1), Eigen::Quaterniond(1e300, 0, 1e300, 0)};
    return values[i];
  }
};

/// Two poses, so that tangent vectors of twelve numbers fit.
template <>
struct Samples<PoseStackd> {
  static std::size_t count() { return 4; }
  static PoseStackd make(std::size_t i) {
    const SE3d pose = fine<SE3d>();
    const std::array<std::vector<SE3d>, 4> values{std::vector{pose, pose}, std::vector<SE3d>{},
                                                  std::vector{pose},
                                                  std::vector{pose, Samples<SE3d>::make(2)}};
    return PoseStackd(values[i]);
  }
};

template <>
struct Samples<TwistMatrix<double>> {
  static std::size_t count() { return 2; }
  static TwistMatrix<double> make(std::size_t i) {
    return {Eigen::Matrix3d::Constant(i == 0 ? 0.1 : kNaN), Eigen::Matrix3d::Identity()};
  }
};

/// A density of positive definite covariance, from sharp to wide; of stacks also with one pose.
template <class G>
struct Samples<ConcentratedGaussian<G>> {
  static std::size_t count() { return 5; }
  static ConcentratedGaussian<G> make(std::size_t i) {
    G mean = fine<G>();
    if constexpr (std::same_as<G, PoseStackd>) {
      if (i == 4) mean = PoseStackd(std::vector{fine<SE3d>()});
    }
    const std::array variances{1e-4, 1e-24, 1e6, 1e300, 1e-4};
    return {mean, G::TangentMatrix::Identity(mean.dof(), mean.dof()) * variances[i]};
  }
};

template <class G>
struct Samples<ProjectedGaussian<G>> {
  static std::size_t count() { return 4; }
  static ProjectedGaussian<G> make(std::size_t i) {
    const std::array variances{1e-3, 1e-24, 1e6, 1e300};
    return {fine<G>(), G::TangentMatrix::Identity() * variances[i]};
  }
};

template <class D>
struct Samples<Component<D>> {
  static std::size_t count() { return Samples<D>::count() + Samples<double>::count() - 1; }
  static Component<D> make(std::size_t i) {
    const std::size_t densities = Samples<D>::count();
    return i < densities ? Component<D>{-0.7, Samples<D>::make(i)}
                         : Component<D>{Samples<double>::make(i - densities + 1), fine<D>()};
  }
};

template <class D>
struct Samples<Mixture<D>> {
  static std::size_t count() { return Samples<D>::count(); }
  static Mixture<D> make(std::size_t i) {
    if constexpr (std::same_as<D, ConcentratedGaussian<PoseStackd>>) {
      if (i == 4) return Mixture<D>({{0.0, Samples<D>::make(4)}});
    }
    return Mixture<D>({{std::log(0.25), fine<D>()}, {std::log(0.75), Samples<D>::make(i)}});
  }
};

inline RandomStream good(Type<RandomStream>) { return RandomStream(1); }

inline Stopwatch good(Type<Stopwatch>) { return {}; }

template <class D>
PairSelector<D> good(Type<PairSelector<D>>) {
  return PairSelector<D>(fine<std::vector<Component<D>>>(), PairRule::runnalls,
                         DistanceMetric::mahalanobis);
}

inline RotationDensity good(Type<RotationDensity>) {
  return RotationDensity(fine<ConcentratedGaussian<SO3d>>());
}

inline gnomonic::ChartChange good(Type<gnomonic::ChartChange>) {
  return {fine<SO3d>(), Samples<SO3d>::make(1)};
}

template <class D>
BatchEvaluator<D> good(Type<BatchEvaluator<D>>) {
  return BatchEvaluator<D>(fine<Mixture<D>>());
}

template <class G>
struct Samples<TangentGaussian<G>> {
  static std::size_t count() { return 1 + Samples<typename G::Tangent>::count(); }
  static TangentGaussian<G> make(std::size_t i) {
    const G anchor = fine<G>();
    return {anchor,
            i == 0 ? fine<typename G::Tangent>() : Samples<typename G::Tangent>::make(i - 1),
            0.01 * G::TangentMatrix::Identity(anchor.dof(), anchor.dof())};
  }
};

}  // namespace posemix::arguments
