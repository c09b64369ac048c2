// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"
#include "study/engine/settings_toml.hpp"

namespace posemix {

// One stage after the other, and nothing of them stands alone.
// NOLINTNEXTLINE(readability-function-size)
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
      "frame", s.frame,
      {{"object", NoiseFrame::object}, {"camera", NoiseFrame::camera}, {"ray", NoiseFrame::ray}});
  s.free_means = table.get_enum_or<bool>("means", false, {{"zero", false}, {"free", true}});
  s.full_covariance =
      table.get_enum_or<bool>("covariance", false, {{"diagonal", false}, {"full", true}});
  s.clutter = table.get_bool_or("clutter", s.frame == NoiseFrame::ray);
  s.clutter_volume_m3 = table.get_double_or("clutter_volume_m3", s.clutter_volume_m3, kPositive);
  s.least_clutter =
      table.get_double_or("clutter_least", s.least_clutter, {.lowest = 0, .highest = 0.5});
  s.modes = table.get_bool_or("modes", s.modes);
  s.mode.radius_deg = table.get_double_or("mode_radius_deg", s.mode.radius_deg, kPositive);
  s.mode.least_share = table.get_double_or("mode_share", s.mode.least_share, kPositive);
  s.mode.least_recordings =
      table.get_double_or("mode_recordings", s.mode.least_recordings, kPositive);
  s.folds =
      static_cast<std::size_t>(table.get_integer_or("folds", 0, {.lowest = 0, .highest = 1000}));
  s.odometry.windows_s = read_numbers(table, "windows_s", s.odometry.windows_s, kPositive);
  s.odometry.bootstrap = static_cast<int>(
      table.get_integer_or("bootstrap", s.odometry.bootstrap, {.lowest = 0, .highest = 100000}));
  s.odometry.seed = s.seed;
  s.detectors = table.get_strings_or("detectors", {});
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
