// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "metrics_file.hpp"

#include "io/json_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/results/results.hpp"
#include "provenance_json.hpp"

namespace posemix {
namespace {

using namespace internal;

Json medians_json(const PoseMedians& medians) {
  return {{"position_median_m", json_number(medians.position_m)},
          {"rotation_median_deg", json_number(medians.rotation_deg)}};
}

/// Puts existence and health into the metrics of an object, where there are any.
void add_health(const ObjectMetrics& object, Json& json) {
  if (!object.health) return;
  if (object.health_shares.size() != words<TrackHealth>.size())
    throw InvalidInput(fmt::format("metrics of object '{}': {} shares of healths, expected {}",
                                   object.id, object.health_shares.size(),
                                   words<TrackHealth>.size()));
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
               {"unexplained", object.unexplained},
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

}  // namespace

std::string format_metrics(const Metrics& metrics, const std::string& method) {
  return internal::metrics_text(metrics, method, {});
}

std::string internal::metrics_text(const Metrics& metrics, const std::string& method,
                                   const MetricsExtras& extras) {
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
  Json json = {{"schema", kMetricsSchema}, {"frames", metrics.frames}, {"method", method}};
  if (extras.stamp != nullptr) {
    json["run"] = extras.stamp->run;
    json["files"] = extras.stamp->files;
  }
  if (extras.provenance != nullptr) json["provenance"] = provenance_json(*extras.provenance);
  json.update(
      Json{{"camera",
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
             {"merges_per_frame", json_number(metrics.timing.merges_per_frame)}}}});
  if (extras.verdicts != nullptr) json["consistency"].update(*extras.verdicts);
  return json_text(json, 2);
}

}  // namespace posemix
