// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <utility>

#include "moving_object_state.hpp"

/// What is reported of the posterior.
namespace posemix::internal {

Matrix6d MovingObjectState::reported_covariance(const PlacedObject& object, std::size_t model,
                                                const Matrix6d& added) const {
  Matrix6d covariance = object.pose_covariance() + added;
  if (const KnownFrame* frame = frame_of(model)) covariance += frame->covariance;
  Matrix6d local = sensor().symmetries.unobserved_covariance();
  if (const auto common = detector_.common_covariance()) local += *common;
  covariance += object.pose.adjoint_congruence(local);
  symmetrize(covariance);
  return covariance;
}

MovingObjectState::Components MovingObjectState::components_here(const Matrix6d& added) const {
  Components result;
  for (const MovingHypothesis& hypothesis : hypotheses_) {
    const Eigen::ArrayXd weights = hypothesis.weights.by_model();
    for (std::size_t k = 0; k < model_count(); ++k) {
      const double weight = weights[static_cast<Eigen::Index>(k)];
      if (!(weight > 0.0)) continue;
      const PlacedObject& object = hypothesis.objects[k];
      result.push_back({std::log(weight), ConcentratedGaussian<SE3d>::trusted(
                                              object.pose, reported_covariance(object, k, added))});
    }
  }
  return result;
}

MovingObjectState::Components MovingObjectState::components() const {
  Components result = components_here(constant_);
  for (auto& component : result) component.density = to_world()(component.density);
  return result;
}

namespace {

ConcentratedGaussian<SE3d> seen_from(const KnownFrame& camera, const SE3d& pose,
                                     const Matrix6d& covariance) {
  const SE3d to_camera = camera.pose.inverse();
  return ConcentratedGaussian<SE3d>::trusted(to_camera * pose,
                                             to_camera.adjoint_congruence(covariance));
}

}  // namespace

MovingObjectState::Components MovingObjectState::relative_components(
    const KnownFrame& camera) const {
  const KnownFrame here = moved(camera, to_scene());
  Components result = components_here(here.covariance);
  for (auto& component : result) {
    const ConcentratedGaussian<SE3d>& world = component.density;
    component.density = seen_from(here, world.mean(), world.covariance());
  }
  return result;
}

/// What is reported of one Gaussian, with the twist along the world's axes.
PlacedObject MovingObjectState::reported(const PlacedObject& object, std::size_t model,
                                         const Matrix6d& added) const {
  PlacedObject result{.pose = object.pose};
  const WorldTwist moving = world_twist(object, models_.models[model]);
  result.twist = moving.mean;
  result.covariance.topLeftCorner<6, 6>() = reported_covariance(object, model, added);
  result.covariance.block<6, 6>(kTwistRow, kTwistRow) = moving.covariance;
  return result;
}

PlacedObject MovingObjectState::reported(const MovingHypothesis& hypothesis,
                                         const Matrix6d& added) const {
  const Eigen::ArrayXd weights = hypothesis.weights.by_model();
  const double total = weights.sum();
  std::vector<PlacedObject> objects;
  objects.reserve(model_count());
  for (std::size_t k = 0; k < model_count(); ++k)
    objects.push_back(reported(hypothesis.objects[k], k, added));
  std::vector<WeightedObject> parts;
  for (std::size_t k = 0; k < model_count(); ++k) {
    const double part = weights[static_cast<Eigen::Index>(k)] / total;
    if (part > 0.0) parts.push_back({part, &objects[k]});
  }
  return mixed(parts);
}

ConcentratedGaussian<SE3d> MovingObjectState::relative(const KnownFrame& camera) const {
  const KnownFrame here = moved(camera, to_scene());
  const PlacedObject object = reported(*leader(), here.covariance);
  return seen_from(here, object.pose, object.pose_covariance());
}

ConcentratedGaussian<SE3d> MovingObjectState::predicted_detection(const KnownFrame& given) const {
  const KnownFrame camera = moved(given, to_scene());
  const MovingHypothesis& hypothesis = *leader();
  const Eigen::ArrayXd weights = hypothesis.weights.by_model();
  std::vector<PlacedObject> seen;
  for (std::size_t k = 0; k < model_count(); ++k) {
    const DetectionState state = hypothesis.objects[k].seen_from(camera_for(camera, k));
    const Matrix6d a = slow_error_map(state, sensor().noise.components().front(), sensor());
    // xi_O - xi_C + A b.
    Eigen::Matrix<double, 6, 18> h;
    h << -Matrix6d::Identity(), Matrix6d::Identity(), a;
    PlacedObject& one = seen.emplace_back();
    one.pose = SE3d::exp(Vector6d(a * state.slow)) * state.object;
    one.covariance.topLeftCorner<6, 6>() = h * state.covariance * h.transpose();
  }
  std::vector<WeightedObject> parts;
  for (std::size_t k = 0; k < model_count(); ++k) {
    if (const double part = weights[static_cast<Eigen::Index>(k)]; part > 0.0)
      parts.push_back({part, &seen[k]});
  }
  const PlacedObject object = mixed(parts);
  return seen_from(camera, object.pose, object.pose_covariance());
}

MovingObjectEstimate MovingObjectState::estimate() const {
  MovingObjectEstimate result{.time_s = time_s_.value_or(0.0),
                              .hypotheses = {},
                              .lost_probability = lost_.total(),
                              .models = std::vector<double>(model_count(), 0.0)};
  Eigen::ArrayXd models = lost_.by_model();
  for (const MovingHypothesis& hypothesis : hypotheses_) {
    const Eigen::ArrayXd weights = hypothesis.weights.by_model();
    const double total = weights.sum();
    models += weights;
    std::vector<double> of_models;
    of_models.reserve(model_count());
    for (std::size_t k = 0; k < model_count(); ++k)
      of_models.push_back(weights[static_cast<Eigen::Index>(k)] / total);
    const PlacedObject object = reported(hypothesis, constant_);
    result.hypotheses.push_back(
        {.world =
             to_world()(ConcentratedGaussian<SE3d>::trusted(object.pose, object.pose_covariance())),
         .twist = object.twist,
         .twist_covariance = object.covariance.block<6, 6>(kTwistRow, kTwistRow),
         .probability = total,
         .models = std::move(of_models),
         .id = hypothesis.id,
         .detections = hypothesis.detections});
  }
  for (std::size_t k = 0; k < model_count(); ++k)
    result.models[k] = models[static_cast<Eigen::Index>(k)];
  std::stable_sort(result.hypotheses.begin(), result.hypotheses.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  return result;
}

}  // namespace posemix::internal
