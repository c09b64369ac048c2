// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "metric.hpp"
#include "posemix/base/random.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"
#include "posemix/slam/evaluation.hpp"
#include "posemix/slam/run.hpp"
#include "posemix/slam/symmetric_error.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFlipDeg = 20.0;
constexpr double kFlipPlaceM = 0.05;
/// The prior of the first camera, which defines the world: nearly exact.
constexpr double kStartDeg = 0.01;
constexpr double kStartM = 1e-4;

Matrix6d odometry_covariance(const TlessStudySettings& s) {
  return pose_covariance(Eigen::Vector3d::Constant(radians(s.odometry_rotation_sd_deg)),
                         Eigen::Vector3d::Constant(s.odometry_translation_sd_m));
}

/// The models of a class: as many as its largest number of detections in one image, and one more.
std::vector<ObjectModel> models_of(const TlessScene& scene, const TlessMetric& metric,
                                   bool declared) {
  std::map<std::string, std::size_t> most;
  for (const auto& candidates : scene.candidates) {
    std::map<std::string, std::size_t> count;
    for (const Candidate& candidate : candidates) ++count[candidate.class_id];
    for (const auto& [name, number] : count) most[name] = std::max(most[name], number);
  }
  std::vector<ObjectModel> models;
  for (const auto& [name, number] : most) {
    for (std::size_t i = 0; i <= number; ++i) {
      models.push_back({.id = fmt::format("{}:{}", name, i),
                        .symmetries = declared ? metric.symmetries(name) : SymmetryGroup(),
                        .class_id = name});
    }
  }
  return models;
}

/// The poses of a class among the estimates of a frame.
std::vector<SE3d> poses_of(const std::string& class_id, const std::vector<ObjectModel>& models,
                           const std::vector<std::optional<PoseDensity>>& estimates) {
  std::vector<SE3d> poses;
  for (std::size_t m = 0; m < models.size(); ++m) {
    if (models[m].class_id == class_id && estimates[m]) poses.push_back(estimates[m]->mean());
  }
  return poses;
}

std::vector<SE3d> poses_of(const std::string& class_id, const std::vector<Candidate>& candidates) {
  std::vector<SE3d> poses;
  for (const Candidate& candidate : candidates) {
    if (candidate.class_id == class_id) poses.push_back(candidate.camera_object);
  }
  return poses;
}

/// Errors of one source over the frames in which an instance is seen.
struct Collected {
  std::vector<double> rotation_deg, translation_m, mssd_m;
  std::int64_t within = 0;

  void add(const std::optional<TlessErrors>& errors) {
    if (!errors) return;
    rotation_deg.push_back(errors->rotation_deg);
    translation_m.push_back(errors->translation_m);
    mssd_m.push_back(errors->mssd_m);
    within += errors->is_within ? 1 : 0;
  }
  void write(Json& row, const std::string& prefix) const {
    const auto middle = [](const std::vector<double>& values) {
      return values.empty() ? Json() : Json(median(values));
    };
    row[prefix + "found"] = rotation_deg.size();
    row[prefix + "within"] = within;
    row[prefix + "rotation_deg"] = middle(rotation_deg);
    row[prefix + "translation_m"] = middle(translation_m);
    row[prefix + "mssd_m"] = middle(mssd_m);
  }
};

/// One true instance: T_camera_object in the frames that show it, and T_world_object at the end.
Json instance_row(const TlessScene& scene, const std::vector<ObjectModel>& models,
                  const SlamRun& run, const TlessMetric& metric, std::size_t index) {
  const ObjectRecording& truth = scene.sequence.objects[index];
  const std::string& name = scene.classes[index];
  Collected estimated, detected, paired, paired_detected;
  std::int64_t frames = 0;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const auto& relative = truth.relative_truth[k];
    if (!relative) continue;
    ++frames;
    const auto estimate =
        metric.nearest(name, poses_of(name, models, run.frames[k].relative), *relative);
    const auto detection = metric.nearest(name, poses_of(name, scene.candidates[k]), *relative);
    estimated.add(estimate);
    detected.add(detection);
    if (!estimate || !detection) continue;
    paired.add(estimate);
    paired_detected.add(detection);
  }
  Json row = {{"object", truth.id}, {"frames", frames}};
  estimated.write(row, "");
  detected.write(row, "detection_");
  paired.write(row, "paired_");
  paired_detected.write(row, "paired_detection_");
  Collected end;
  end.add(metric.nearest(name, poses_of(name, models, run.frames.back().objects),
                         *truth.world_truth.back()));
  end.write(row, "end_");
  return row;
}

/// The number of detections assigned to every model since its instance began.
std::vector<std::size_t> detections_of(const SlamRun& run, std::size_t models) {
  std::vector<std::size_t> count(models, 0);
  for (const FrameEstimate& frame : run.frames) {
    for (const CandidateReport& candidate : frame.report.candidates) {
      if (!candidate.object) continue;
      count[*candidate.object] =
          candidate.status == CandidateStatus::fresh ? 1 : count[*candidate.object] + 1;
    }
  }
  return count;
}

/// Counts the confirmed instances at the end, and those that are not the nearest of any true one.
void count_instances(const TlessScene& scene, const std::vector<ObjectModel>& models,
                     const SlamRun& run, double match_m, Json& row) {
  const std::vector<std::size_t> detections = detections_of(run, models.size());
  const MultiObjectSlamSettings settings;
  const FrameEstimate& end = run.frames.back();
  const auto& objects = end.objects;
  const auto is_confirmed = [&](std::size_t m) {
    return objects[m] && detections[m] >= settings.confirming_detections &&
           end.existences[m].value_or(0.0) >= settings.existence.confirmed_probability;
  };
  std::vector<bool> matched(models.size(), false);
  for (std::size_t i = 0; i < scene.classes.size(); ++i) {
    const Eigen::Vector3d truth = scene.sequence.objects[i].world_truth.back()->translation();
    std::optional<std::size_t> nearest;
    double closest = match_m;
    for (std::size_t m = 0; m < models.size(); ++m) {
      if (!is_confirmed(m) || models[m].class_id != scene.classes[i]) continue;
      const double distance = (objects[m]->mean().translation() - truth).norm();
      if (distance > closest) continue;
      closest = distance;
      nearest = m;
    }
    if (nearest) matched[*nearest] = true;
  }
  std::int64_t confirmed = 0;
  std::int64_t wrong = 0;
  for (std::size_t m = 0; m < models.size(); ++m) {
    if (!is_confirmed(m)) continue;
    ++confirmed;
    if (!matched[m]) ++wrong;
  }
  row["confirmed"] = confirmed;
  row["false_confirmed"] = wrong;
}

/// Counts jumps of the world estimates to an equivalent pose from one frame to the next. Turns
/// about an axis of symmetry, which no detection determines, are counted separately.
void count_flips(const std::vector<ObjectModel>& models, const SlamRun& run,
                 const TlessMetric& metric, Json& row) {
  std::array<std::int64_t, 2> steps{0, 0};
  std::array<std::int64_t, 2> flips{0, 0};
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    std::vector<bool> is_new(models.size(), false);
    for (const CandidateReport& candidate : run.frames[k].report.candidates) {
      if (candidate.status == CandidateStatus::fresh) is_new[*candidate.object] = true;
    }
    for (std::size_t m = 0; m < models.size(); ++m) {
      const auto& before = run.frames[k - 1].objects[m];
      const auto& now = run.frames[k].objects[m];
      if (!before || !now || is_new[m]) continue;
      const SymmetryGroup& group = metric.symmetries(models[m].class_id);
      const std::size_t kind = group.axes().empty() ? 0 : 1;
      ++steps[kind];
      const auto plain = symmetric_pose_error(now->mean(), before->mean(), {});
      const auto symmetric = symmetric_pose_error(now->mean(), before->mean(), group);
      if (degrees(plain.rotation_rad) > kFlipDeg && degrees(symmetric.rotation_rad) < kFlipDeg &&
          symmetric.translation_m < kFlipPlaceM)
        ++flips[kind];
    }
  }
  row["steps"] = steps[0];
  row["flips"] = flips[0];
  row["axis_steps"] = steps[1];
  row["axis_turns"] = flips[1];
}

void count_candidates(const SlamRun& run, Json& row) {
  std::int64_t all = 0, assigned = 0, fresh = 0, recycled = 0;
  for (const FrameEstimate& frame : run.frames) {
    for (const CandidateReport& candidate : frame.report.candidates) {
      ++all;
      assigned += candidate.status == CandidateStatus::assigned ? 1 : 0;
      fresh += candidate.status == CandidateStatus::fresh ? 1 : 0;
      recycled += candidate.recycled ? 1 : 0;
    }
  }
  row["detections"] = all;
  row["assigned"] = assigned;
  row["fresh"] = fresh;
  row["recycled"] = recycled;
}

void add_camera(const Sequence& sequence, const SlamRun& run, Json& row) {
  PoseErrorSum camera, odometry;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    camera.add(run.frames[k].camera.mean(), sequence.camera_truth[k]);
    odometry.add(sequence.odometry[k], sequence.camera_truth[k]);
  }
  const auto write = [&](const std::string& name, const PoseErrors& errors) {
    row[name + "_rotation_rmse_deg"] =
        errors.rotation_rmse_deg ? Json(*errors.rotation_rmse_deg) : Json();
    row[name + "_position_rmse_m"] =
        errors.position_rmse_m ? Json(*errors.position_rmse_m) : Json();
  };
  write("camera", camera.errors());
  write("synthetic_odometry", odometry.errors());
}

}  // namespace

Sequence with_synthetic_odometry(const TlessScene& scene, const TlessStudySettings& settings) {
  Sequence sequence = scene.sequence;
  sequence.candidates = scene.candidates;
  sequence.odometry.assign(sequence.stamps.size(), std::nullopt);
  RandomStream stream(settings.seed, static_cast<std::uint64_t>(scene.scene));
  const Vector6d sd = odometry_covariance(settings).diagonal().cwiseSqrt();
  std::optional<std::size_t> before;
  for (std::size_t k = 0; k < sequence.stamps.size(); ++k) {
    const auto& truth = sequence.camera_truth[k];
    if (!truth) continue;
    if (!before) {
      sequence.odometry[k] = truth;
    } else {
      Eigen::VectorXd white(6);
      stream.fill_normal(white);
      const double dt = sequence.stamps[k] - sequence.stamps[*before];
      const SE3d motion = sequence.camera_truth[*before]->inverse() * *truth;
      sequence.odometry[k] = *sequence.odometry[*before] * motion *
                             SE3d::exp(Vector6d(std::sqrt(dt) * sd.cwiseProduct(white)));
    }
    before = k;
  }
  return sequence;
}

nlohmann::ordered_json run_tless(const TlessScene& scene, const TlessStudySettings& settings,
                                 bool declared) {
  const TlessMetric metric(settings);
  const Sequence sequence = with_synthetic_odometry(scene, settings);
  const std::vector<ObjectModel> models = models_of(scene, metric, declared);
  // The run takes one recording per model, without the truth.
  Sequence input = sequence;
  input.objects.clear();
  for (const ObjectModel& model : models) {
    ObjectRecording recording;
    recording.id = model.id;
    recording.detections.resize(sequence.stamps.size());
    input.objects.push_back(std::move(recording));
  }
  ObjectSlamSettings slam;
  slam.motion.noise = {odometry_covariance(settings)};
  const Matrix6d start = pose_covariance(Eigen::Vector3d::Constant(radians(kStartDeg)),
                                         Eigen::Vector3d::Constant(kStartM));
  const SlamRun done = run(input, PoseDensity(*sequence.camera_truth.front(), start), models, slam);

  const Json head = {{"scene", scene.scene}, {"symmetries", declared ? "declared" : "none"}};
  Json result = {{"instances", Json::array()}, {"scene", head}};
  for (std::size_t i = 0; i < scene.classes.size(); ++i) {
    Json row = head;
    row.update(instance_row(scene, models, done, metric, i));
    result["instances"].push_back(std::move(row));
  }
  Json& row = result["scene"];
  row["frames"] = sequence.stamps.size();
  row["instances"] = scene.classes.size();
  row["models"] = models.size();
  count_instances(scene, models, done, settings.match_m, row);
  count_candidates(done, row);
  count_flips(models, done, metric, row);
  add_camera(sequence, done, row);
  return result;
}

}  // namespace posemix
