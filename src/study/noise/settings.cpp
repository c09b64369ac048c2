// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/engine/settings_toml.hpp"
#include "study/noise/study.hpp"

namespace posemix {

// One stage after the other, and nothing of them stands alone.
// NOLINTNEXTLINE(readability-function-size)
NoiseStudySettings read_noise_settings(const TomlTable& table) {
  NoiseStudySettings s;
  const auto count = [&](const char* key, std::int64_t otherwise, std::int64_t highest) {
    return table.get_integer_or(key, otherwise, {.lowest = 1, .highest = highest});
  };
  s.fit.max_components = static_cast<std::size_t>(count("max_components", 4, 100));
  s.fit.restarts = static_cast<int>(count("restarts", s.fit.restarts, 1000));
  s.seed = static_cast<std::uint64_t>(table.get_integer_or("seed", 1, kAtLeastZero));
  s.bins = static_cast<std::size_t>(count("bins", 60, 10000));
  s.fit.frame = table.get_enum_or("frame", NoiseFrame::object);
  s.fit.free_means = table.get_enum_or<bool>("means", false, {{"zero", false}, {"free", true}});
  s.fit.full_covariance =
      table.get_enum_or<bool>("covariance", false, {{"diagonal", false}, {"full", true}});
  s.fit.clutter = table.get_bool_or("clutter", s.fit.frame == NoiseFrame::ray);
  s.fit.clutter_volume_m3 =
      table.get_double_or("clutter_volume_m3", s.fit.clutter_volume_m3, kPositive);
  s.fit.least_clutter =
      table.get_double_or("clutter_least", s.fit.least_clutter, {.lowest = 0, .highest = 0.5});
  s.fit.modes = table.get_bool_or("modes", s.fit.modes);
  s.fit.mode.radius_deg = table.get_double_or("mode_radius_deg", s.fit.mode.radius_deg, kPositive);
  s.fit.mode.least_share = table.get_double_or("mode_share", s.fit.mode.least_share, kPositive);
  s.fit.mode.least_recordings =
      table.get_double_or("mode_recordings", s.fit.mode.least_recordings, kPositive);
  s.fit.folds =
      static_cast<std::size_t>(table.get_integer_or("folds", 0, {.lowest = 0, .highest = 1000}));
  s.odometry.windows_s = read_numbers(table, "windows_s", s.odometry.windows_s, kPositive);
  s.odometry.bootstrap = static_cast<int>(
      table.get_integer_or("bootstrap", s.odometry.bootstrap, {.lowest = 0, .highest = 100000}));
  s.odometry.seed = s.seed;
  s.detectors = table.get_strings_or("detectors", {});
  s.fit.criterion = table.get_enum_or<NoiseCriterion>(
      "bic", NoiseCriterion::bic,
      {{"frames", NoiseCriterion::bic}, {"effective", NoiseCriterion::bic_independent_frames}});
  s.fit.max_rotation_sd_deg =
      table.get_double_or("max_rotation_sd_deg", s.fit.max_rotation_sd_deg, kPositive);
  s.fit.max_translation_sd_m =
      table.get_double_or("max_translation_sd_m", s.fit.max_translation_sd_m, kPositive);
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

void rename_noise_keys(TomlDocument& document) {
  document.rename_key("null", "clutter");
  document.rename_key("null_volume_m3", "clutter_volume_m3");
  document.rename_key("null_least", "clutter_least");
}

}  // namespace posemix
