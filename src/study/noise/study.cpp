// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/noise/study.hpp"

#include <memory>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "study/engine/fingerprint.hpp"
#include "study/noise/groups.hpp"
#include "study/noise/item.hpp"
#include "study/noise/odometry_report.hpp"
#include "study/noise/report.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

void add_poses(const std::vector<std::optional<SE3d>>& poses, Fingerprint& fingerprint) {
  for (const auto& pose : poses) {
    fingerprint.add(pose ? 1.0 : 0.0);
    if (pose) fingerprint.add(*pose);
  }
}

Json settings_json(const NoiseData& data, const NoiseStudySettings& s) {
  Json json = {{"max_components", s.fit.max_components},
               {"restarts", s.fit.restarts},
               {"seed", s.seed},
               {"frame", word_of(s.fit.frame.value_or(NoiseFrame::object))},
               {"means", s.fit.free_means ? "free" : "zero"},
               {"covariance", s.fit.full_covariance ? "full" : "diagonal"},
               {"clutter", s.fit.clutter},
               {"clutter_volume_m3", s.fit.clutter_volume_m3},
               {"clutter_least", s.fit.least_clutter},
               {"modes", s.fit.modes},
               {"mode_radius_deg", s.fit.mode.radius_deg},
               {"mode_share", s.fit.mode.least_share},
               {"mode_recordings", s.fit.mode.least_recordings},
               {"folds", s.fit.folds},
               {"windows_s", s.odometry.windows_s},
               {"bootstrap", s.odometry.bootstrap},
               {"bic", s.fit.criterion == NoiseCriterion::bic ? "frames" : "effective"},
               {"max_rotation_sd_deg", s.fit.max_rotation_sd_deg},
               {"max_translation_sd_m", s.fit.max_translation_sd_m},
               {"gross_rotation_deg", s.gross_rotation_deg},
               {"gross_translation_m", s.gross_translation_m},
               {"bins", s.bins}};
  for (const ResidualSet& set : data.residuals) {
    Fingerprint poses;
    add_poses(set.truth, poses);
    add_poses(set.detected, poses);
    for (const double stamp : set.stamps_s) poses.add(stamp);
    json["data"].push_back(
        {set.detector, set.object, set.recording, set.symmetric, set.truth.size(), poses.text()});
  }
  for (const OdometryRecording& recording : data.odometry) {
    Fingerprint poses;
    add_poses(recording.odometry, poses);
    add_poses(recording.camera_truth, poses);
    json["odometry"].push_back({recording.name, recording.stamps.size(), poses.text()});
  }
  return json;
}

void check(const std::vector<ResidualSet>& sets, const NoiseFitSettings& fit) {
  require(!sets.empty(), "study noise: there are no detections with a truth");
  if (fit.free_means && fit.frame && *fit.frame != NoiseFrame::object) {
    throw InvalidInput(fmt::format(
        "study noise: free means in the {} frame cannot be written as a noise model, expected "
        "means = \"zero\" or frame = \"object\"",
        word_of(*fit.frame)));
  }
  require(
      !fit.free_means || !fit.clutter,
      "study noise: free means beside clutter, expected means = \"zero\" (with modes = true for "
      "offset poses) or clutter = false");
  require(!fit.modes || fit.clutter, "study noise: modes without clutter, expected clutter = true");
  for (const ResidualSet& set : sets) {
    if (set.truth.size() == set.detected.size()) continue;
    throw InvalidInput(
        fmt::format("study noise: {} of {} has {} frames of truth and {} of detections", set.object,
                    set.recording, set.truth.size(), set.detected.size()));
  }
}

}  // namespace

Study make_noise_study(const NoiseData& data, const NoiseStudySettings& settings) {
  check(data.residuals, settings.fit);
  const std::string text = settings_json(data, settings).dump();
  const auto groups = std::make_shared<const std::vector<NoiseGroup>>(noise_groups(data.residuals));
  const auto odometry = std::make_shared<const std::vector<OdometryRecording>>(data.odometry);
  return {"noise", text, groups->size() + (odometry->empty() ? 0 : 1),
          [groups, odometry, settings](std::size_t item) {
            if (item == groups->size()) return study_odometry(*odometry, settings).dump();
            return study_noise((*groups)[item], settings, item).dump();
          },
          report_noise};
}

}  // namespace posemix
