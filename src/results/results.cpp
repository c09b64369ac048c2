// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/results.hpp"

#include <cmath>

#include <fmt/format.h>

#include "io/covariance_columns.hpp"
#include "io/json_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/draw/picture.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/io/tum.hpp"

namespace posemix {
namespace {

using namespace internal;
using Densities = std::vector<std::optional<PoseDensity>> FrameEstimate::*;

bool is_finite(const SE3d& pose) { return pose.log().allFinite(); }

bool is_finite(const FrameEstimate& frame) {
  bool finite = is_finite(frame.camera.mean()) && frame.camera.covariance().allFinite();
  for (const Densities densities : {&FrameEstimate::objects, &FrameEstimate::relative}) {
    for (const auto& density : frame.*densities) {
      if (!density) continue;
      finite = finite && is_finite(density->mean()) && density->covariance().allFinite();
    }
  }
  return finite;
}

void require_finite(const SlamJob& job, const SlamRun& run) {
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    if (is_finite(run.frames[k])) continue;
    throw InvalidInput(
        fmt::format("the estimate at stamp {} s is not finite: numbers in the files or settings of "
                    "'{}' are too extreme",
                    job.sequence.stamps[k], job.name));
  }
}

std::string object_tum(const SlamJob& job, const SlamRun& run, Densities densities,
                       std::size_t object) {
  std::vector<StampedPose> poses;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const auto& density = (run.frames[k].*densities)[object];
    if (density) poses.push_back({job.sequence.stamps[k], density->mean()});
  }
  return format_tum(poses);
}

std::string camera_tum(const SlamJob& job, const SlamRun& run) {
  std::vector<StampedPose> poses;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    poses.push_back({job.sequence.stamps[k], run.frames[k].camera.mean()});
  }
  return format_tum(poses);
}

Json medians_json(const PoseMedians& medians) {
  return {{"position_median_m", json_number(medians.position_m)},
          {"rotation_median_deg", json_number(medians.rotation_deg)}};
}

/// Puts existence and health into the metrics of an object, where there are any.
void add_health(const ObjectMetrics& object, Json& json) {
  if (!object.health) return;
  json["existence"] = json_number(object.existence);
  json["health"] = word_of(*object.health);
  Json& shares = json["health_shares"];
  for (const auto& [word, health] : words<TrackHealth>)
    shares[std::string(word)] = object.health_shares[static_cast<std::size_t>(health)];
}

Json object_metrics(const ObjectMetrics& object) {
  Json json = {{"position_rmse_m", json_number(object.world.position_rmse_m)},
               {"rotation_rmse_deg", json_number(object.world.rotation_rmse_deg)},
               {"relative_position_rmse_m", json_number(object.relative.position_rmse_m)},
               {"relative_rotation_rmse_deg", json_number(object.relative.rotation_rmse_deg)},
               {"detection_relative_position_rmse_m",
                json_number(object.detection_relative.position_rmse_m)},
               {"detection_relative_rotation_rmse_deg",
                json_number(object.detection_relative.rotation_rmse_deg)},
               {"paired",
                {{"frames", object.paired.frames},
                 {"estimate", medians_json(object.paired.estimate)},
                 {"detection", medians_json(object.paired.detection)}}},
               {"detections", object.detections},
               {"gated", object.gated},
               {"right_mode_share", json_number(object.right_mode_share)},
               {"mode_probability", json_number(object.mode_probability)}};
  add_health(object, json);
  return json;
}

Json consistency_json(const Consistency& consistency) {
  return {{"anees", json_number(consistency.anees)},
          {"median_nees", json_number(consistency.median_nees)},
          {"rotation_anees", json_number(consistency.rotation_anees)},
          {"position_anees", json_number(consistency.position_anees)}};
}

/// The alternatives of one object, without those of probability zero.
Mixture<PoseDensity> world_mixture(const std::vector<ObjectHypothesis>& alternatives) {
  constexpr double kLeastProbability = 1e-12;
  std::vector<Component<PoseDensity>> components;
  for (const ObjectHypothesis& hypothesis : alternatives) {
    if (hypothesis.probability < kLeastProbability) continue;
    components.push_back({std::log(hypothesis.probability),
                          PoseDensity::trusted(hypothesis.pose, hypothesis.covariance)});
  }
  return Mixture<PoseDensity>(std::move(components));
}

/// The cameras of a rig, empty where all are exact.
std::string cameras_csv(const std::vector<BodyCamera>& cameras) {
  std::string text = fmt::format("camera,{},{}\n", pose_header(), covariance_header());
  bool any = false;
  for (const BodyCamera& camera : cameras) {
    any = any || !camera.is_exact();
    const auto covariance = camera.is_exact() ? std::nullopt : camera.covariance;
    text += fmt::format("{},{},{}\n", camera.name, pose_fields(camera.body_camera),
                        covariance_fields(covariance));
  }
  return any ? text : "";
}

}  // namespace

std::string format_metrics(const Metrics& metrics, const std::string& method) {
  Json objects = Json::object();
  Json anees = Json::object();
  Json right_anees = Json::object();
  Json world = Json::object();
  Json relative = Json::object();
  for (const ObjectMetrics& object : metrics.objects) {
    objects[object.id] = object_metrics(object);
    anees[object.id] = json_number(object.relative_anees);
    right_anees[object.id] = json_number(object.right_mode_anees);
    world[object.id] = consistency_json(object.world_consistency);
    relative[object.id] = consistency_json(object.relative_consistency);
  }
  const Json json = {
      {"schema", kMetricsSchema},
      {"frames", metrics.frames},
      {"method", method},
      {"camera",
       {{"position_rmse_m", json_number(metrics.camera.position_rmse_m)},
        {"rotation_rmse_deg", json_number(metrics.camera.rotation_rmse_deg)},
        {"position_log_rmse_m", json_number(metrics.camera.position_log_rmse_m)}}},
      {"odometry",
       {{"position_rmse_m", json_number(metrics.odometry.position_rmse_m)},
        {"rotation_rmse_deg", json_number(metrics.odometry.rotation_rmse_deg)}}},
      {"objects", objects},
      {"consistency", {{"relative_anees", anees}, {"right_mode_relative_anees", right_anees}}},
      {"camera_consistency", consistency_json(metrics.camera_consistency)},
      {"world_consistency", world},
      {"relative_consistency", relative},
      {"timing",
       {{"frame_median_us", json_number(metrics.timing.frame_median_us)},
        {"update_median_us", json_number(metrics.timing.update_median_us)},
        {"reduce_median_us", json_number(metrics.timing.reduce_median_us)},
        {"merges_per_frame", json_number(metrics.timing.merges_per_frame)}}}};
  return json_text(json, 2);
}

PosteriorFile last_posterior(const SlamJob& job, const SlamRun& run) {
  const std::size_t size = run.posterior[0].density.mean().size();
  std::vector<NamedPose> poses(size, {"camera_motion", PoseKind::camera_motion});
  poses[kCamera] = {"camera", PoseKind::camera};
  for (std::size_t object = 0; object < job.models.size(); ++object) {
    const auto index = run.pose_indices[object];
    if (index) poses[*index] = {job.models[object].id, PoseKind::object};
  }
  return {job.method, job.sequence.stamps[run.frames.size() - 1], std::move(poses), run.posterior};
}

std::vector<NamedText> format_results(const SlamJob& job, const SlamRun& run,
                                      const Metrics& metrics) {
  require_finite(job, run);
  std::vector<NamedText> files;
  files.emplace_back("camera.tum", camera_tum(job, run));
  for (std::size_t object = 0; object < job.models.size(); ++object) {
    const std::string& id = job.models[object].id;
    files.emplace_back(fmt::format("object_{}.tum", id),
                       object_tum(job, run, &FrameEstimate::objects, object));
    files.emplace_back(fmt::format("relative_{}.tum", id),
                       object_tum(job, run, &FrameEstimate::relative, object));
  }
  for (std::size_t object = 0; object < run.hypotheses.size(); ++object) {
    if (run.hypotheses[object].empty()) continue;
    files.emplace_back(
        fmt::format("mixture_{}.json", job.models[object].id),
        format_mixture({{"world", job.models[object].id}, world_mixture(run.hypotheses[object])}));
  }
  if (std::string cameras = cameras_csv(run.cameras); !cameras.empty())
    files.emplace_back("cameras.csv", std::move(cameras));
  files.emplace_back("metrics.json", format_metrics(metrics, job.method));
  files.emplace_back("posterior.json", format_posterior(last_posterior(job, run)));
  files.emplace_back("trace.json", format_trace(job, run));
  files.emplace_back("picture.svg", format_picture(job, run, metrics));
  return files;
}

}  // namespace posemix
