// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "run.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "posemix/base/random.hpp"
#include "posemix/reduction/loss.hpp"

namespace posemix {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

Json stage_json(const SaltBoxStage& stage) {
  const PoseSpread spread = spread_of(stage.mixture);
  Json json{{"stage", stage.name}, {"components", stage.mixture.size()}, {"log_evidence", nullptr}};
  if (stage.log_evidence) json["log_evidence"] = *stage.log_evidence;
  json["rotation_sd"] = std::vector<double>(spread.rotation.begin(), spread.rotation.end());
  json["translation_sd"] =
      std::vector<double>(spread.translation.begin(), spread.translation.end());
  return json;
}

/// The loss of a reduction of a mixture, measured and bounded.
Json reduction_json(const PoseMpg& mixture, const char* rule, ReductionSettings reduction) {
  reduction.bound_loss = true;
  const auto reduced = reduce(mixture, reduction);
  RandomStream stream(1);
  const DivergenceEstimate loss = measured_loss(mixture, reduced.mixture, stream);
  return {{"rule", rule},
          {"components", reduced.mixture.size()},
          {"kl", loss.value},
          {"kl_error", loss.error},
          {"dropped", reduced.report.bounded_loss->dropped},
          {"merged_kl_bound", reduced.report.bounded_loss->merged_kl},
          {"total_variation_bound", reduced.report.bounded_loss->total_variation}};
}

/// Rules that reduce one mixture.
Json reductions(const SaltBoxSettings& settings, const PoseMpg& mixture) {
  ReductionSettings base = salt_box_reduction(settings);
  Json rows = Json::array();
  const std::array<std::pair<const char*, PairRule>, 3> rules{
      {{"symmetric_kl", PairRule::symmetric_kl},
       {"weighted_symmetric_kl", PairRule::weighted_symmetric_kl},
       {"runnalls", PairRule::runnalls}}};
  for (const auto& [name, pair] : rules) {
    base.pair = pair;
    rows.push_back(reduction_json(mixture, name, base));
  }
  ReductionSettings heaviest = base;
  heaviest.drop_smallest = 0;
  heaviest.keep_heaviest = settings.keep;
  rows.push_back(reduction_json(mixture, "keep_heaviest", heaviest));
  ReductionSettings one = base;
  one.max_components = 1;
  rows.push_back(reduction_json(mixture, "one_component", one));
  return rows;
}

/// A tilt drawn uniformly from the disc that the elements approximate.
Vector3d draw_tilt(const SaltBoxSettings& settings, RandomStream& stream) {
  const double radius = std::sqrt(4.0 * settings.tilt_sd * settings.tilt_sd +
                                  12.0 / 7.0 * settings.cone * settings.cone) *
                        std::sqrt(stream.uniform());
  const double around = 2.0 * std::numbers::pi * stream.uniform();
  return {radius * std::cos(around), radius * std::sin(around), 0.0};
}

/// Detections of all features under the truth, with a tilt of their own or one for all.
SaltBoxSettings simulate(const SaltBoxSettings& settings, bool shared_view, RandomStream& stream) {
  SaltBoxSettings simulated = settings;
  simulated.depth_sd = settings.trial_depth_sd;
  Vector3d tilt = draw_tilt(settings, stream);
  for (SaltBoxFeature& feature : simulated.features) {
    if (!shared_view) tilt = draw_tilt(settings, stream);
    const SE3d truth = salt_box_truth() * SE3d(SO3d(), feature.point);
    const Vector3d spin(0.0, 0.0, settings.spin_sd * stream.normal());
    const Vector3d ray = truth.translation().normalized();
    // One by one: compilers differ in the order of the arguments of a call.
    Vector3d noise;
    for (Eigen::Index axis = 2; axis >= 0; --axis) noise[axis] = stream.normal();
    noise = settings.lateral_sd * (noise - ray * ray.dot(noise)) +
            simulated.depth_sd * ray * ray.dot(noise);
    feature.detected =
        SE3d(truth.rotation() * SO3d::exp(spin) * SO3d::exp(-tilt), truth.translation() + noise);
  }
  return simulated;
}

/// Errors of the estimates from one, two, ... features.
Json errors(const SaltBoxSettings& simulated) {
  Json rows = Json::array();
  std::size_t features = 0;
  for (const SaltBoxStage& stage : run_salt_box(simulated)) {
    const bool first = features == 0 && stage.name.starts_with("object_");
    if (!first && !stage.name.starts_with("merged_")) continue;
    ++features;
    const PoseSpread spread = spread_of(stage.mixture);
    const SE3d truth = salt_box_truth();
    Vector6d error;
    error << 2.0 * gnomonic::lift(spread.mean.rotation(), truth.rotation()),
        truth.translation() - spread.mean.translation();
    const Eigen::LLT<Matrix6d> factor(spread.covariance);
    const Eigen::LLT<Eigen::Matrix3d> rotation(
        Eigen::Matrix3d(spread.covariance.topLeftCorner<3, 3>()));
    rows.push_back(
        {{"features", features},
         {"rotation_error", (spread.mean.rotation().inverse() * truth.rotation()).angle()},
         {"translation_error", error.tail<3>().norm()},
         {"squared", factor.matrixL().solve(error).squaredNorm() / 6.0},
         {"squared_rotation",
          rotation.matrixL().solve(Vector3d(error.head<3>())).squaredNorm() / 3.0}});
  }
  return rows;
}

}  // namespace

std::string salt_box_example(const SaltBoxSettings& settings) {
  Json stages = Json::array();
  const std::string first_fusion = "fused_" + settings.features[1].name;
  Json reduced = Json::array();
  for (const SaltBoxStage& stage : run_salt_box(settings)) {
    stages.push_back(stage_json(stage));
    if (stage.name == first_fusion) reduced = reductions(settings, stage.mixture);
  }
  return Json{{"stages", stages}, {"reductions", reduced}}.dump();
}

std::string salt_box_trial(const SaltBoxSettings& settings, std::size_t trial) {
  RandomStream stream(settings.seed, trial);
  return Json{{"independent", errors(simulate(settings, false, stream))},
              {"shared_view", errors(simulate(settings, true, stream))}}
      .dump();
}

}  // namespace posemix
