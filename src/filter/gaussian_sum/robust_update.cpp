// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/robust_update.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

/// Noise components with covariances multiplied by lambda.
class MultipliedNoise {
 public:
  explicit MultipliedNoise(std::span<const NoiseComponent* const> noise)
      : given_(noise), lambdas_(noise.size(), 1.0) {
    multiplied_.reserve(noise.size());
    for (const NoiseComponent* component : noise)
      pointers_.push_back(&multiplied_.emplace_back(*component));
  }
  MultipliedNoise(const MultipliedNoise&) = delete;
  MultipliedNoise(MultipliedNoise&&) = delete;
  MultipliedNoise& operator=(const MultipliedNoise&) = delete;
  MultipliedNoise& operator=(MultipliedNoise&&) = delete;
  ~MultipliedNoise() = default;

  /// Sets one lambda. Returns the relative change of the weight 1 / lambda.
  double set(std::size_t j, double lambda) {
    const double change = std::abs(lambdas_[j] / lambda - 1.0);
    lambdas_[j] = lambda;
    multiplied_[j].covariance = lambda * given_[j]->covariance;
    return change;
  }

  std::span<const NoiseComponent* const> components() const { return pointers_; }

 private:
  std::span<const NoiseComponent* const> given_;
  std::vector<double> lambdas_;
  std::vector<NoiseComponent> multiplied_;
  std::vector<const NoiseComponent*> pointers_;
};

/// r^T R^-1 r for the residual r of a detection at a mean.
double squared_residual(const PoseStackd& mean, const Detection& detection,
                        const NoiseComponent& noise) {
  const Innovation one = innovation(mean, detection, noise);
  return Eigen::LLT<Matrix6d>(one.noise).matrixL().solve(one.residual).squaredNorm();
}

}  // namespace

UpdateResult cauchy_update(const Hypothesis& prior, std::span<const Detection> detections,
                           std::span<const NoiseComponent* const> noise, const NoiseUpdate& update,
                           const CauchySettings& settings) {
  if (!(settings.scale > 0.0))
    throw InvalidInput(
        fmt::format("cauchy scale is {}, expected a positive number", settings.scale));
  require(noise.size() == detections.size(),
          "cauchy update: not as many noise components as detections, expected one for each");
  require(static_cast<bool>(update), "cauchy update: there is no update to repeat");
  const auto lambda = [&](double squared) {
    return 1.0 + squared / (settings.scale * settings.scale);
  };
  MultipliedNoise multiplied(noise);
  for (std::size_t j = 0; j < detections.size(); ++j) {
    const double squared = squared_mahalanobis(prior, detections[j], *noise[j]);
    if (std::isfinite(squared)) multiplied.set(j, lambda(squared));
  }
  UpdateResult result = update(multiplied.components());
  for (int i = 0; i < settings.max_iterations && result.ok; ++i) {
    double change = 0.0;
    for (std::size_t j = 0; j < detections.size(); ++j) {
      const double squared = squared_residual(result.posterior.mean(), detections[j], *noise[j]);
      change = std::max(change, multiplied.set(j, lambda(squared)));
    }
    if (change <= settings.tolerance) break;
    result = update(multiplied.components());
  }
  return result;
}

}  // namespace posemix
