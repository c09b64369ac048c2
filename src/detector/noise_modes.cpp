// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_modes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "detector/noise_rows.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"
#include "posemix/detector/noise_correlation.hpp"
#include "posemix/lie/mean.hpp"

namespace posemix {
namespace {

using internal::ResidualRows;

/// Number of detections, evenly spaced, that are tried as centres of a ball.
constexpr std::size_t kCentres = 1000;
constexpr int kMeanShifts = 20;
/// Least weight of clutter where the fit with modes begins.
constexpr double kLeastClutter = 1e-3;

double angle_between(const SO3d& a, const SO3d& b) { return (a.inverse() * b).log().norm(); }

/// Observations beyond the gate of the heaviest component whose rotation errs by more than the
/// radius.
std::vector<NoiseObservation> outliers_of(std::span<const NoiseObservation> observations,
                                          const DetectorNoise& noise, double radius) {
  const NoiseComponent& inlier = noise.components().front();
  const Matrix6d precision = inlier.covariance.inverse();
  std::vector<NoiseObservation> outliers;
  for (const NoiseObservation& each : observations) {
    const Vector6d n = detection_residual(each.truth * inlier.offset, each.detected, inlier.frame);
    const bool far = angle_between(each.truth.rotation(), each.detected.rotation()) > radius;
    if (far && n.dot(precision * n) > kInlierGate) outliers.push_back(each);
  }
  return outliers;
}

/// Indices of the errors whose rotations lie in a ball.
std::vector<std::size_t> members_of(const std::vector<SE3d>& errors, const SO3d& centre,
                                    double radius) {
  std::vector<std::size_t> members;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (angle_between(centre, errors[i].rotation()) < radius) members.push_back(i);
  }
  return members;
}

SO3d mean_rotation(const std::vector<SE3d>& errors, const std::vector<std::size_t>& members) {
  std::vector<SO3d> rotations;
  rotations.reserve(members.size());
  for (const std::size_t i : members) rotations.push_back(errors[i].rotation());
  const std::vector<double> weights(rotations.size(), 1.0);
  return weighted_mean<SO3d>(rotations, weights, {.max_iterations = 20}).mean;
}

/// The members of the fullest ball about an error, after mean shift.
std::vector<std::size_t> fullest_ball(const std::vector<SE3d>& errors, double radius) {
  const std::size_t centres = std::min(errors.size(), kCentres);
  std::vector<std::size_t> members;
  for (std::size_t j = 0; j < centres; ++j) {
    const SO3d& centre = errors[j * errors.size() / centres].rotation();
    auto held = members_of(errors, centre, radius);
    if (held.size() > members.size()) members = std::move(held);
  }
  for (int shift = 0; shift < kMeanShifts; ++shift) {
    auto held = members_of(errors, mean_rotation(errors, members), radius);
    if (held.size() <= members.size()) break;
    members = std::move(held);
  }
  return members;
}

SE3d centre_of(const std::vector<SE3d>& errors, const std::vector<std::size_t>& members) {
  Eigen::Vector3d middle;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(members.size());
    for (const std::size_t i : members) values.push_back(errors[i].translation()[axis]);
    middle[axis] = median(values);
  }
  return SE3d(mean_rotation(errors, members), middle);
}

/// One component per cluster; weights are shares of all `count` observations.
std::vector<NoiseComponent> clusters_of(std::vector<NoiseObservation> outliers, double count,
                                        const NoiseEmSettings& settings,
                                        const NoiseModeSettings& modes) {
  std::vector<NoiseComponent> clusters;
  while (clusters.size() < modes.most && !outliers.empty()) {
    std::vector<SE3d> errors;
    errors.reserve(outliers.size());
    for (const NoiseObservation& each : outliers)
      errors.push_back(each.truth.inverse() * each.detected);
    const auto members = fullest_ball(errors, radians(modes.radius_deg));
    const double share = static_cast<double>(members.size()) / count;
    if (share < modes.least_share) break;
    const SE3d offset = centre_of(errors, members);
    std::vector<NoiseObservation> held;
    held.reserve(members.size());
    for (const std::size_t i : members) held.push_back(outliers[i]);
    const ResidualRows rows(held, settings.frame, offset);
    const Eigen::ArrayXd ones = Eigen::ArrayXd::Ones(static_cast<Eigen::Index>(held.size()));
    const Matrix6d second = rows.second_moment(ones) / static_cast<double>(held.size());
    clusters.push_back({.weight = share,
                        .covariance = bounded_covariance(second, settings.em),
                        .frame = settings.frame,
                        .offset = offset});
    std::size_t index = 0;
    std::erase_if(outliers, [&](const NoiseObservation&) {
      return std::binary_search(members.begin(), members.end(), index++);
    });
  }
  return clusters;
}

bool is_mode(const NoiseComponent& component) { return component.offset.log().norm() > 0.0; }

/// The mode of one component of a model, from the component's share in every observation.
NoiseMode describe(std::span<const NoiseObservation> observations, const DetectorNoise& noise,
                   const NoiseComponent& component, const NoiseModeSettings& settings) {
  const ResidualRows rows(observations, component.frame, component.offset);
  const Eigen::ArrayXd shares =
      (rows.log_density(component.covariance) + std::log(component.weight) -
       noise_log_density(noise, observations))
          .exp();
  std::map<std::size_t, double> by_recording;
  for (std::size_t i = 0; i < observations.size(); ++i)
    by_recording[observations[i].recording] += shares[static_cast<Eigen::Index>(i)];
  double sum = 0.0;
  double squares = 0.0;
  for (const auto& [recording, weight] : by_recording) {
    sum += weight;
    squares += weight * weight;
  }
  NoiseMode mode{
      .offset = component.offset,
      .weight = component.weight,
      .recordings = squares > 0.0 ? sum * sum / squares : 0.0,
      .rotation_sd_deg = degrees(std::sqrt(component.covariance.diagonal().head<3>().maxCoeff())),
      .accepted = false};
  mode.accepted = mode.weight >= settings.least_share &&
                  mode.recordings >= settings.least_recordings &&
                  mode.rotation_sd_deg <= settings.radius_deg &&
                  degrees(component.offset.rotation().log().norm()) >= settings.radius_deg;
  return mode;
}

/// Leaves out the least heavy mode that is not accepted, if there is one.
std::optional<DetectorNoise> without_worst(std::span<const NoiseObservation> observations,
                                           const DetectorNoise& noise,
                                           const NoiseModeSettings& settings,
                                           std::vector<NoiseMode>& refused) {
  std::vector<NoiseComponent> components = noise.components();
  for (auto it = components.rbegin(); it != components.rend(); ++it) {
    if (!is_mode(*it)) continue;
    const NoiseMode mode = describe(observations, noise, *it, settings);
    if (mode.accepted) continue;
    refused.push_back(mode);
    Clutter clutter = noise.clutter();
    clutter.weight += it->weight;
    components.erase(std::next(it).base());
    return DetectorNoise(std::move(components), clutter);
  }
  return std::nullopt;
}

}  // namespace

NoiseModesFit add_noise_modes(std::span<const NoiseObservation> observations, const NoiseEmFit& fit,
                              const NoiseEmSettings& settings, const NoiseModeSettings& modes) {
  require(settings.clutter, "noise model: modes need clutter");
  const auto clusters = clusters_of(outliers_of(observations, fit.noise, radians(modes.radius_deg)),
                                    static_cast<double>(observations.size()), settings, modes);
  NoiseModesFit result{fit, {}};
  if (clusters.empty()) return result;
  // Most of the clusters' observations were explained by clutter so far.
  std::vector<NoiseComponent> components = fit.noise.components();
  Clutter clutter = fit.noise.clutter();
  const double least = std::max(0.1 * clutter.weight, kLeastClutter);
  for (const NoiseComponent& cluster : clusters) {
    components.push_back(cluster);
    clutter.weight = std::max(clutter.weight - cluster.weight, least);
  }
  std::optional<DetectorNoise> next = DetectorNoise(std::move(components), clutter);
  while (next) {
    result.fit = refine_noise(observations, *next, settings);
    next = without_worst(observations, result.fit.noise, modes, result.modes);
  }
  for (const NoiseComponent& component : result.fit.noise.components()) {
    if (is_mode(component))
      result.modes.push_back(describe(observations, result.fit.noise, component, modes));
  }
  std::stable_sort(result.modes.begin(), result.modes.end(),
                   [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return result;
}

}  // namespace posemix
