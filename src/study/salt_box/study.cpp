// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"

#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"
#include "posemix/mixture/projected_mixture.hpp"
#include "report.hpp"
#include "run.hpp"
#include "study/engine/settings_json.hpp"

namespace posemix {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Pose = ProjectedGaussian<SE3d>;

SE3d detection(const Vector3d& translation, double w, double x, double y, double z) {
  return {SO3d::from_quaternion(Eigen::Quaterniond(w, x, y, z)), translation};
}

/// The covariance of an element: u of the rotation in the feature's axes, translation along the
/// line of sight to it. A standard deviation of u is half that of the rotation.
Matrix6d element_covariance(const SaltBoxSettings& settings, const Vector3d& position) {
  Vector3d u(settings.tilt_sd, settings.tilt_sd, settings.spin_sd);
  u *= 0.5;
  const Vector3d ray = position.normalized();
  const Matrix3d along = ray * ray.transpose();
  Matrix6d covariance = Matrix6d::Zero();
  covariance.topLeftCorner<3, 3>() = u.cwiseAbs2().asDiagonal();
  covariance.bottomRightCorner<3, 3>() =
      settings.lateral_sd * settings.lateral_sd * (Matrix3d::Identity() - along) +
      settings.depth_sd * settings.depth_sd * along;
  return covariance;
}

std::string settings_json(const SaltBoxSettings& settings) {
  nlohmann::ordered_json features = nlohmann::ordered_json::array();
  for (const SaltBoxFeature& feature : settings.features) {
    features.push_back({{"name", feature.name},
                        {"point", matrix_json(feature.point.transpose())},
                        {"detected", matrix_json(feature.detected.matrix())}});
  }
  return nlohmann::ordered_json{{"features", features},
                                {"tilt_sd", settings.tilt_sd},
                                {"spin_sd", settings.spin_sd},
                                {"cone", settings.cone},
                                {"lateral_sd", settings.lateral_sd},
                                {"depth_sd", settings.depth_sd},
                                {"composition", static_cast<int>(settings.composition)},
                                {"fusion", static_cast<int>(settings.fusion)},
                                {"pair", static_cast<int>(settings.pair)},
                                {"merge", static_cast<int>(settings.merge)},
                                {"drop", settings.drop},
                                {"keep", settings.keep},
                                {"flags", settings.flags},
                                {"trials", settings.trials},
                                {"trial_depth_sd", settings.trial_depth_sd},
                                {"seed", settings.seed}}
      .dump();
}

}  // namespace

SaltBoxSettings default_salt_box() {
  return {
      .features = {
          {"B",
           {-0.030, -0.020, -0.0275},
           detection({0.021963, -0.056146, 0.569815}, 0.979644, 0.051305, 0.008327, 0.193898)},
          {"l",
           {0.028, -0.055, -0.0275},
           detection({0.085568, -0.067671, 0.568962}, 0.982135, 0.070823, 0.064535, 0.161958)},
          {"mountain",
           {0.005, 0.050, -0.0275},
           detection({0.030102, 0.022489, 0.579058}, 0.983351, -0.013863, 0.028223, 0.178973)}}};
}

SE3d salt_box_truth() {
  return {SO3d::exp({radians(6.0), radians(-5.0), radians(20.0)}), {0.04, -0.03, 0.60}};
}

PoseMpg feature_mixture(const SaltBoxSettings& settings, const SaltBoxFeature& feature) {
  const Vector3d& position = feature.detected.translation();
  const Matrix6d covariance = element_covariance(settings, position);
  std::vector<Component<Pose>> elements{{0.0, Pose(feature.detected, covariance)}};
  for (int k = 0; k < 6; ++k) {
    const double around = k * std::numbers::pi / 3.0;
    const SO3d tilt = SO3d::exp(settings.cone * Vector3d(std::cos(around), std::sin(around), 0.0));
    elements.push_back({0.0, Pose(SE3d(feature.detected.rotation() * tilt, position), covariance)});
  }
  return PoseMpg(std::move(elements));
}

PoseMpg object_mixture(const SaltBoxSettings& settings, const SaltBoxFeature& feature) {
  return transform(feature_mixture(settings, feature), SE3d(SO3d(), -feature.point),
                   {.rule = settings.composition});
}

ReductionSettings salt_box_reduction(const SaltBoxSettings& settings) {
  return {.prune_below = 0.0,
          .drop_smallest = settings.drop,
          .max_components = settings.keep,
          .pair = settings.pair,
          .merge = {.rule = settings.merge}};
}

std::vector<SaltBoxStage> run_salt_box(const SaltBoxSettings& settings) {
  std::vector<SaltBoxStage> stages;
  std::optional<PoseMpg> estimate;
  for (const SaltBoxFeature& feature : settings.features) {
    const PoseMpg object = object_mixture(settings, feature);
    stages.push_back({"feature_" + feature.name, feature_mixture(settings, feature), {}});
    stages.push_back({"object_" + feature.name, object, {}});
    if (!estimate) {
      estimate = object;
      continue;
    }
    const auto fused = fuse(*estimate, object, {.pair = {.rule = settings.fusion}});
    stages.push_back({"fused_" + feature.name, fused.density,
                      fused.log_overlap + gnomonic::kLogHaarPerHalfSphere});
    ReductionSettings reduction = salt_box_reduction(settings);
    const std::size_t keep = reduction.max_components;
    reduction.max_components = fused.density.size();
    PoseMpg dropped = reduce(fused.density, reduction).mixture;
    stages.push_back({"dropped_" + feature.name, dropped, {}});
    reduction.drop_smallest = 0;
    reduction.max_components = keep;
    estimate = reduce(std::move(dropped), reduction).mixture;
    stages.push_back({"merged_" + feature.name, *estimate, {}});
  }
  return stages;
}

PoseSpread spread_of(const PoseMpg& mixture) {
  const Pose one = moments(mixture).density;
  Vector6d scale = Vector6d::Ones();
  scale.head<3>().setConstant(2.0);
  const Matrix6d covariance = scale.asDiagonal() * moments_of(one).covariance * scale.asDiagonal();
  const Vector6d sd = covariance.diagonal().cwiseSqrt();
  return {one.mean(), sd.head<3>(), sd.tail<3>(), covariance};
}

Study make_salt_box_study(const SaltBoxSettings& settings) {
  require(settings.features.size() >= 2, "salt-box: expected at least two features");
  return {"salt-box", settings_json(settings), 1 + settings.trials,
          [settings](std::size_t item) {
            return item == 0 ? salt_box_example(settings) : salt_box_trial(settings, item - 1);
          },
          [settings](std::span<const std::string> results) {
            return report_salt_box(settings, results);
          }};
}

}  // namespace posemix
