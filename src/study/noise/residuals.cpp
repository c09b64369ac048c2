// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/tum.hpp"
#include "posemix/slam/evaluation.hpp"
#include "study/noise/study.hpp"
#include "study/recordings/recordings.hpp"

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
    set.stamps_s.push_back(detection.stamp);
  }
  return set;
}

/// YCB-V objects that the BOP calls symmetric.
bool is_symmetric(const std::string& object) {
  constexpr std::array kSymmetric{"1", "13", "14", "16", "18", "19", "20", "21"};
  return std::find(kSymmetric.begin(), kSymmetric.end(), object) != kSymmetric.end();
}

/// Adds the odometry and the camera's truth of a sequence that is not there yet and has both.
void add_odometry_of(const SlamJob& job, const std::string& name, NoiseData& data) {
  const Sequence& sequence = job.sequence;
  const bool known =
      std::any_of(data.odometry.begin(), data.odometry.end(),
                  [&](const OdometryRecording& other) { return other.name == name; });
  if (known || sequence.odometry.empty() || sequence.camera_truth.empty()) return;
  data.odometry.push_back({name, sequence.stamps, sequence.odometry, sequence.camera_truth});
}

}  // namespace

std::vector<ResidualSet> residuals_of(const SlamJob& job, const std::string& detector,
                                      const std::string& recording) {
  std::vector<ResidualSet> sets;
  for (std::size_t i = 0; i < job.sequence.objects.size(); ++i) {
    const ObjectRecording& object = job.sequence.objects[i];
    ResidualSet set{.detector = detector,
                    .object = object.id,
                    .recording = recording,
                    .stamps_s = job.sequence.stamps};
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

NoiseData find_noise_data(const std::filesystem::path& data) {
  NoiseData all;
  for (const Recording& recording : find_recordings(data)) {
    const SlamJob job = read_recording(recording);
    add_odometry_of(job, recording.sequence, all);
    for (ResidualSet& set : residuals_of(job, recording.detector, recording.sequence)) {
      set.proxy = recording.detector == "cosypose";
      set.symmetric = recording.detector != "dope" && !set.proxy && is_symmetric(set.object);
      all.residuals.push_back(std::move(set));
    }
  }
  return all;
}

NoiseData read_noise_data(const NoiseStudySettings& settings,
                          const std::optional<std::filesystem::path>& data) {
  NoiseData all;
  if (!settings.detections.empty()) {
    all.residuals = {read_pair(settings)};
  } else if (settings.sequences.empty()) {
    all = find_noise_data(data.value_or(default_data_folder()));
  }
  for (const std::string& path : settings.sequences) {
    const TomlDocument document = TomlDocument::load(path);
    const SlamJob job = read_slam_job(document, data_folders(path, data));
    add_odometry_of(job, job.name, all);
    for (ResidualSet& set : residuals_of(job, "detector", job.name))
      all.residuals.push_back(std::move(set));
  }
  const std::vector<std::string>& wanted = settings.detectors;
  std::erase_if(all.residuals, [&](const ResidualSet& set) {
    return !wanted.empty() && std::find(wanted.begin(), wanted.end(), set.detector) == wanted.end();
  });
  return all;
}

}  // namespace posemix
