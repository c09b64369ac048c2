// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em.hpp"

#include <Eigen/Eigenvalues>

namespace posemix {
namespace internal {

void check_em_settings(const EmSettings& settings, Eigen::Index dof) {
  const auto check = [](bool good, const char* name, auto value, const char* expected) {
    if (!good) throw InvalidInput(fmt::format("EM: {} is {}, expected {}", name, value, expected));
  };
  check(settings.components > 0, "components", settings.components, "one or more");
  check(settings.max_iterations > 0, "max_iterations", settings.max_iterations, "one or more");
  check(settings.restarts > 0, "restarts", settings.restarts, "one or more");
  check(settings.tolerance >= 0.0, "tolerance", settings.tolerance, "zero or more");
  check(settings.min_sd > 0.0 && std::isfinite(settings.min_sd), "min_sd", settings.min_sd,
        "a finite number above zero");
  check(settings.max_sd >= settings.min_sd, "max_sd", settings.max_sd, "at least min_sd");
  const Eigen::VectorXd& unit = settings.unit;
  if (unit.size() == 0) return;
  check(unit.size() == dof, "size of unit", unit.size(), "the degrees of freedom");
  check(unit.allFinite() && unit.minCoeff() > 0.0, "smallest unit", unit.minCoeff(),
        "finite numbers above zero");
}

std::size_t needed_samples(std::size_t components, Eigen::Index dof, const EmSettings& settings) {
  return components * (settings.diagonal ? 2 : static_cast<std::size_t>(dof) + 1);
}

double checked_em_weights(std::span<const double> weights, std::size_t samples,
                          std::size_t needed) {
  if (weights.size() != samples) {
    throw InvalidInput(fmt::format("EM: {} weights for {} samples", weights.size(), samples));
  }
  double total = 0.0;
  std::size_t positive = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    if (!(weights[i] >= 0.0) || !std::isfinite(weights[i])) {
      throw InvalidInput(
          fmt::format("EM: weight {} is {}, expected a finite number >= 0", i, weights[i]));
    }
    total += weights[i];
    if (weights[i] > 0.0) ++positive;
  }
  if (positive < needed) {
    throw InvalidInput(fmt::format(
        "EM: {} samples of positive weight, expected at least {} for so many components", positive,
        needed));
  }
  require(std::isfinite(total), "EM: the sum of the weights is not finite");
  return total;
}

}  // namespace internal

Eigen::MatrixXd bounded_covariance(const Eigen::MatrixXd& second_moment,
                                   const EmSettings& settings) {
  const Eigen::Index n = second_moment.rows();
  require(n > 0 && second_moment.cols() == n, "EM: the second moment is not square");
  internal::check_em_settings(settings, n);
  const Eigen::VectorXd unit = settings.unit.size() == 0 ? Eigen::VectorXd::Ones(n) : settings.unit;
  const double lowest = settings.min_sd * settings.min_sd;
  const double highest = settings.max_sd * settings.max_sd;
  if (settings.diagonal) {
    const Eigen::ArrayXd variance = second_moment.diagonal().array() / unit.array().square();
    const Eigen::VectorXd bounded =
        variance.cwiseMax(lowest).cwiseMin(highest) * unit.array().square();
    return bounded.asDiagonal();
  }
  const Eigen::VectorXd inverse_unit = unit.cwiseInverse();
  const Eigen::MatrixXd scaled =
      inverse_unit.asDiagonal() * second_moment * inverse_unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const Eigen::VectorXd& values = eigen.eigenvalues();
  if (values[0] >= lowest && values[n - 1] <= highest) return second_moment;
  const Eigen::MatrixXd vectors = unit.asDiagonal() * eigen.eigenvectors();
  const Eigen::VectorXd bounded = values.cwiseMax(lowest).cwiseMin(highest);
  Eigen::MatrixXd result = vectors * bounded.asDiagonal() * vectors.transpose();
  symmetrize(result);
  return result;
}

template EmResult<ConcentratedGaussian<SO3d>> fit_mixture(
    std::span<const SO3d>, std::span<const double>, const EmSettings&, RandomStream&,
    const std::optional<Mixture<ConcentratedGaussian<SO3d>>>&);
template EmResult<ConcentratedGaussian<SE3d>> fit_mixture(
    std::span<const SE3d>, std::span<const double>, const EmSettings&, RandomStream&,
    const std::optional<Mixture<ConcentratedGaussian<SE3d>>>&);
template EmResult<ProjectedGaussian<SO3d>> fit_mixture(
    std::span<const SO3d>, std::span<const double>, const EmSettings&, RandomStream&,
    const std::optional<Mixture<ProjectedGaussian<SO3d>>>&);
template EmResult<ProjectedGaussian<SE3d>> fit_mixture(
    std::span<const SE3d>, std::span<const double>, const EmSettings&, RandomStream&,
    const std::optional<Mixture<ProjectedGaussian<SE3d>>>&);

}  // namespace posemix
