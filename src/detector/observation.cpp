// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/observation.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "observation_ranges.hpp"
#include "posemix/base/error.hpp"
#include "posemix/lie/pose_checks.hpp"

namespace posemix {
namespace {

/// Symmetric up to rounding in files, relative to the largest entry.
constexpr double kAsymmetry = 1e-6;
/// Weights in files are rounded.
constexpr double kWeightSum = 1e-3;

void check_covariance(const Matrix6d& covariance) {
  check_variances(covariance, "covariance");
  const double largest = covariance.cwiseAbs().maxCoeff();
  if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() > kAsymmetry * largest)
    throw InvalidInput("covariance is not symmetric");
  Matrix6d symmetric = covariance;
  symmetrize(symmetric);
  if (Eigen::LLT<Matrix6d>(symmetric).info() != Eigen::Success)
    throw InvalidInput("covariance is not positive definite");
}

void check_component(const ObservationComponent& component) {
  check_pose(component.pose, "pose");
  if (!(component.weight >= 0.0) || std::isinf(component.weight))
    throw InvalidInput(fmt::format("weight is {}, expected zero or more", component.weight));
  if (component.covariance) check_covariance(*component.covariance);
}

}  // namespace

Observation observation_of(const SE3d& camera_object) {
  Observation observation;
  observation.components.push_back({.pose = camera_object});
  return observation;
}

std::size_t best_component(const Observation& observation) {
  const auto& components = observation.components;
  if (components.empty())
    throw InvalidInput("the observation has no components, expected at least one");
  const auto best =
      std::max_element(components.begin(), components.end(),
                       [](const auto& a, const auto& b) { return a.weight < b.weight; });
  return static_cast<std::size_t>(best - components.begin());
}

void validate(const Observation& observation) {
  if (observation.components.empty())
    throw InvalidInput("the observation has no components, expected at least one");
  double total = 0.0;
  for (std::size_t k = 0; k < observation.components.size(); ++k) {
    try {
      check_component(observation.components[k]);
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("components[{}].{}", k, error.what()));
    }
    total += observation.components[k].weight;
  }
  if (!(std::abs(total - 1.0) <= kWeightSum)) {
    throw InvalidInput(
        fmt::format("the weights of the components sum to {:.6g}, expected one", total));
  }
  if (observation.clutter &&
      !(*observation.clutter > 0.0 && *observation.clutter <= internal::kMostClutter)) {
    throw InvalidInput(
        fmt::format("clutter is {}, expected a probability above 0 and at most 1 - 1e-9 (leave out "
                    "a sighting that is of no object)",
                    *observation.clutter));
  }
  kStamp.check(observation.stamp_s, "stamp_s");
  if (observation.score && !std::isfinite(*observation.score))
    throw InvalidInput(fmt::format("score is {}, expected a finite number", *observation.score));
}

}  // namespace posemix
