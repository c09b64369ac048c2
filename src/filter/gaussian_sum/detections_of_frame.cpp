// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detections_of_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/precision.hpp"
#include "innovation_score.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/lie/pose_checks.hpp"
#include "scene_frame.hpp"

namespace posemix::internal {

double gate_threshold(double probability) {
  if (!(probability > 0.0 && probability <= 1.0)) {
    throw InvalidInput(
        fmt::format("gate probability is {}, expected a number in (0, 1]", probability));
  }
  if (probability == 1.0) return std::numeric_limits<double>::infinity();
  return chi_square_quantile(probability, 6);
}

void check_detections(std::span<const Detection> detections, std::size_t poses) {
  for (std::size_t i = 0; i < detections.size(); ++i) {
    const std::size_t object = detections[i].object;
    if (object == kCamera || object >= poses) {
      throw InvalidInput(
          fmt::format("detection of pose {}, expected an object in 1..{}", object, poses - 1));
    }
    check_pose(detections[i].camera_object, "detection");
    for (std::size_t j = 0; j < i; ++j) {
      if (detections[j].object == object) {
        throw InvalidInput(fmt::format("object at pose {} is detected twice in one frame", object));
      }
    }
  }
}

void check_precision(const Posterior& prior, std::size_t pose, const DetectorNoise& noise) {
  const char* name = pose == kCamera ? "the pose of the camera" : "the pose of the object";
  // An update is computed near the scene, and kept in the world: both have to hold the noise.
  const auto origin = scene_origin(prior);
  const WorldShift near(origin ? Eigen::Vector3d(-*origin) : Eigen::Vector3d::Zero());
  for (const auto& hypothesis : prior.components()) {
    const Matrix6d covariance = block(hypothesis.density.covariance(), pose, pose);
    for (const NoiseComponent& component : noise.components()) {
      require_precision(covariance, component.covariance, name);
      if (origin) require_precision(near(covariance), component.covariance, name);
    }
  }
}

std::size_t common_components(std::span<const Detection> detections) {
  const auto& first = detections.front().noise->components();
  for (const Detection& detection : detections) {
    if (detections.size() > 1 && detection.noise->clutter().weight > 0.0) {
      throw InvalidInput("joint use of noise components: a noise model has clutter component");
    }
    const auto& other = detection.noise->components();
    const bool same = std::equal(first.begin(), first.end(), other.begin(), other.end(),
                                 [](const NoiseComponent& a, const NoiseComponent& b) {
                                   return std::abs(a.weight - b.weight) < 1e-12;
                                 });
    if (!same) {
      throw InvalidInput(
          "joint use of noise components needs the same number of components with the same weights "
          "for every object");
    }
  }
  return first.size();
}

std::optional<double> nis_of(const Posterior& posterior, const Detection& detection) {
  const auto& hypotheses = posterior.components();
  const auto heaviest =
      std::max_element(hypotheses.begin(), hypotheses.end(),
                       [](const auto& a, const auto& b) { return a.log_weight < b.log_weight; });
  std::optional<double> nis;
  double most = -std::numeric_limits<double>::infinity();
  for (const NoiseComponent& noise : detection.noise->components()) {
    const InnovationScore score = innovation_score(heaviest->density, detection, noise);
    const double weighed = std::log(noise.weight) + score.log_likelihood;
    if (!(weighed > most)) continue;
    most = weighed;
    nis = score.squared;
  }
  return nis;
}

bool is_outlier(const Posterior& posterior, const Detection& detection, double threshold) {
  for (const auto& hypothesis : posterior.components()) {
    for (const NoiseComponent& noise : detection.noise->components()) {
      if (squared_mahalanobis(hypothesis.density, detection, noise) <= threshold) return false;
    }
  }
  return true;
}

}  // namespace posemix::internal
