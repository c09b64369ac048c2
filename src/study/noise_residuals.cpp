// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/slam/evaluation.hpp"
#include "posemix/study/noise.hpp"
#include "posemix/study/recordings.hpp"

namespace posemix {
namespace {

/// Two stamps within this time are the same frame.
constexpr double kSameFrameS = 1e-3;

ResidualSet read_pair(const NoiseStudySettings& settings) {
  const auto detections = read_tum(settings.detections, {.allow_misses = true});
  const auto truth = read_tum(settings.ground_truth, {.allow_misses = true});
  const std::string name = std::filesystem::path(settings.detections).stem().string();
  ResidualSet set{.detector = "detector", .object = name, .recording = name};
  std::size_t at = 0;
  for (const StampedPose& detection : detections) {
    while (at < truth.size() && truth[at].stamp < detection.stamp - kSameFrameS) ++at;
    const bool known =
        at < truth.size() && std::abs(truth[at].stamp - detection.stamp) <= kSameFrameS;
    set.detected.push_back(detection.pose);
    set.truth.push_back(known ? truth[at].pose : std::nullopt);
  }
  return set;
}

}  // namespace

Vector6d detection_residual(const SE3d& truth, const SE3d& detected, NoiseFrame frame) {
  Vector6d residual = (truth.inverse() * detected).log();
  if (frame == NoiseFrame::object) return residual;
  return SE3d(truth.rotation(), Eigen::Vector3d::Zero()).adjoint() * residual;
}

std::vector<ResidualSet> residuals_of(const SlamJob& job, const std::string& detector,
                                      const std::string& recording) {
  std::vector<ResidualSet> sets;
  for (std::size_t i = 0; i < job.sequence.objects.size(); ++i) {
    const ObjectRecording& object = job.sequence.objects[i];
    ResidualSet set{.detector = detector, .object = object.id, .recording = recording};
    bool any = false;
    for (std::size_t frame = 0; frame < job.sequence.stamps.size(); ++frame) {
      set.truth.push_back(true_relative_pose(job.sequence, i, frame));
      set.detected.push_back(object.detections[frame]);
      any = any || (set.truth.back() && set.detected.back());
    }
    if (any) sets.push_back(std::move(set));
  }
  return sets;
}

std::vector<ResidualSet> find_residuals(const std::filesystem::path& data) {
  std::vector<ResidualSet> sets;
  for (const Recording& recording : find_recordings(data)) {
    for (ResidualSet& set :
         residuals_of(read_recording(recording), recording.detector, recording.sequence)) {
      set.proxy = recording.detector == "cosypose";
      sets.push_back(std::move(set));
    }
  }
  return sets;
}

std::vector<ResidualSet> read_residuals(const NoiseStudySettings& settings,
                                        const std::optional<std::filesystem::path>& data) {
  if (!settings.detections.empty()) return {read_pair(settings)};
  std::vector<ResidualSet> sets;
  for (const std::string& path : settings.sequences) {
    const TomlDocument document = TomlDocument::load(path);
    const SlamJob job = read_slam_job(document, data_folders(path, data));
    for (ResidualSet& set : residuals_of(job, "detector", job.name)) sets.push_back(std::move(set));
  }
  if (!settings.sequences.empty()) return sets;
  return find_residuals(data.value_or(default_data_folder()));
}

NoiseStudySettings read_noise_settings(const TomlTable& table) {
  NoiseStudySettings s;
  const auto count = [&](const char* key, std::int64_t otherwise, std::int64_t highest) {
    return table.get_integer_or(key, otherwise, {.lowest = 1, .highest = highest});
  };
  s.max_components = static_cast<std::size_t>(count("max_components", 4, 100));
  s.restarts = static_cast<int>(count("restarts", s.restarts, 1000));
  s.seed = static_cast<std::uint64_t>(table.get_integer_or("seed", 1, kAtLeastZero));
  s.bins = static_cast<std::size_t>(count("bins", 60, 10000));
  s.frame = table.get_enum_or<NoiseFrame>(
      "frame", s.frame, {{"object", NoiseFrame::object}, {"camera", NoiseFrame::camera}});
  s.free_means = table.get_enum_or<bool>("means", false, {{"zero", false}, {"free", true}});
  s.full_covariance =
      table.get_enum_or<bool>("covariance", false, {{"diagonal", false}, {"full", true}});
  s.count_frames = table.get_enum_or<bool>("bic", true, {{"frames", true}, {"effective", false}});
  s.max_rotation_sd_deg =
      table.get_double_or("max_rotation_sd_deg", s.max_rotation_sd_deg, kPositive);
  s.max_translation_sd_m =
      table.get_double_or("max_translation_sd_m", s.max_translation_sd_m, kPositive);
  s.gross_rotation_deg = table.get_double_or("gross_rotation_deg", s.gross_rotation_deg, kPositive);
  s.gross_translation_m =
      table.get_double_or("gross_translation_m", s.gross_translation_m, kPositive);
  if (table.has("sequences")) s.sequences = table.get_strings("sequences");
  if (table.has("detections") || table.has("ground_truth")) {
    s.detections = table.get_string("detections");
    s.ground_truth = table.get_string("ground_truth");
  }
  return s;
}

}  // namespace posemix
