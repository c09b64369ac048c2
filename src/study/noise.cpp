// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/study/noise.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <memory>

#include <fmt/format.h>

#include "noise_parts.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

/// FNV-1a over the bits of every pose: names the data in the settings of the study.
class Fingerprint {
 public:
  void add(const std::vector<std::optional<SE3d>>& poses) {
    for (const auto& pose : poses) {
      add(pose ? 1.0 : 0.0);
      if (!pose) continue;
      for (const double q : pose->rotation().quaternion().coeffs()) add(q);
      for (const double t : pose->translation()) add(t);
    }
  }

  std::string text() const { return fmt::format("{:016x}", hash_); }

 private:
  void add(double number) {
    const auto bits = std::bit_cast<std::uint64_t>(number);
    for (int shift = 0; shift < 64; shift += 8) {
      hash_ = (hash_ ^ ((bits >> shift) & 0xffU)) * 0x100000001b3ULL;
    }
  }

  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

Json settings_json(const std::vector<ResidualSet>& sets, const NoiseStudySettings& s) {
  Json json = {{"max_components", s.max_components},
               {"restarts", s.restarts},
               {"seed", s.seed},
               {"frame", name_of(s.frame)},
               {"means", s.free_means ? "free" : "zero"},
               {"covariance", s.full_covariance ? "full" : "diagonal"},
               {"bic", s.count_frames ? "frames" : "effective"},
               {"max_rotation_sd_deg", s.max_rotation_sd_deg},
               {"max_translation_sd_m", s.max_translation_sd_m},
               {"gross_rotation_deg", s.gross_rotation_deg},
               {"gross_translation_m", s.gross_translation_m},
               {"bins", s.bins}};
  for (const ResidualSet& set : sets) {
    Fingerprint data;
    data.add(set.truth);
    data.add(set.detected);
    json["data"].push_back(
        {set.detector, set.object, set.recording, set.truth.size(), data.text()});
  }
  return json;
}

void check(const std::vector<ResidualSet>& sets, const NoiseStudySettings& settings) {
  require(!sets.empty(), "study noise: there are no detections with a truth");
  if (settings.free_means && settings.frame == NoiseFrame::camera) {
    throw InvalidInput(
        "study noise: free means in the camera frame cannot be written as a noise model, expected "
        "means = \"zero\" or frame = \"object\"");
  }
  for (const ResidualSet& set : sets) {
    if (set.truth.size() == set.detected.size()) continue;
    throw InvalidInput(
        fmt::format("study noise: {} of {} has {} frames of truth and {} of detections", set.object,
                    set.recording, set.truth.size(), set.detected.size()));
  }
}

}  // namespace

std::vector<NoiseGroup> noise_groups(const std::vector<ResidualSet>& sets) {
  std::vector<std::string> detectors;
  for (const ResidualSet& set : sets) {
    if (std::find(detectors.begin(), detectors.end(), set.detector) == detectors.end())
      detectors.push_back(set.detector);
  }
  std::vector<NoiseGroup> groups;
  for (const std::string& detector : detectors) {
    const std::size_t first = groups.size();
    NoiseGroup all{detector, "all", {}};
    for (const ResidualSet& set : sets) {
      if (set.detector != detector) continue;
      auto group = std::find_if(groups.begin() + static_cast<std::ptrdiff_t>(first), groups.end(),
                                [&](const NoiseGroup& g) { return g.object == set.object; });
      if (group == groups.end()) group = groups.insert(group, {detector, set.object, {}});
      group->sets.push_back(set);
      all.sets.push_back(set);
    }
    if (groups.size() > first + 1) groups.push_back(std::move(all));
  }
  return groups;
}

std::string noise_name(const std::string& detector, const std::string& object) {
  std::string name = detector + "_" + object;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-') c = '_';
  }
  return name;
}

std::string format_noise_toml(std::string_view name, const DetectorNoise& noise) {
  const auto list = [](const auto& v) { return fmt::format("[{}]", fmt::join(v, ", ")); };
  std::string text = fmt::format("[noise.{}]\ncomponents = [\n", name);
  for (const NoiseComponent& component : noise.components()) {
    text += fmt::format("  {{weight = {}, frame = \"{}\", ", component.weight,
                        name_of(component.frame));
    const Matrix6d& covariance = component.covariance;
    if (covariance.isDiagonal(0.0)) {
      const Vector6d sd = covariance.diagonal().cwiseSqrt();
      const Eigen::Vector3d rotation = sd.head<3>() / kRadPerDeg;
      const Eigen::Vector3d translation = sd.tail<3>();
      text += fmt::format("rotation_sd_deg = {}, translation_sd_m = {}", list(rotation),
                          list(translation));
    } else {
      std::vector<std::string> rows;
      for (const auto& row : covariance.rowwise()) rows.push_back(list(row));
      text += fmt::format("covariance = {}", list(rows));
    }
    if (component.offset.log().norm() > 0.0) {
      const Eigen::Vector3d rotation = component.offset.rotation().log() / kRadPerDeg;
      const Eigen::Vector3d& translation = component.offset.translation();
      text += fmt::format(", offset = {{rotation_deg = {}, translation_m = {}}}", list(rotation),
                          list(translation));
    }
    text += "},\n";
  }
  return text + "]\n";
}

Study make_noise_study(const std::vector<ResidualSet>& residuals,
                       const NoiseStudySettings& settings) {
  check(residuals, settings);
  const std::string text = settings_json(residuals, settings).dump();
  const auto groups = std::make_shared<const std::vector<NoiseGroup>>(noise_groups(residuals));
  return {"noise", text, groups->size(),
          [groups, settings](std::size_t item) {
            return study_noise((*groups)[item], settings, item).dump();
          },
          report_noise};
}

}  // namespace posemix
