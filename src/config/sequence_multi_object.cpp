// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/units.hpp"
#include "posemix/filter/multi_object_ranges.hpp"
#include "sequence_parts.hpp"

namespace posemix::internal {

MultiObjectSettings read_multi_object(const TomlTable& filter, MultiObjectSettings s) {
  constexpr IntegerRange kHypotheses{.lowest = 1, .highest = 100000};
  constexpr IntegerRange kProtected{.lowest = 0, .highest = 100000};
  const auto count = [&](std::string_view key, std::size_t& value, const IntegerRange& range) {
    value = static_cast<std::size_t>(
        filter.get_integer_or(key, static_cast<std::int64_t>(value), range));
  };
  count("max_hypotheses", s.max_hypotheses, kHypotheses);
  count("protected_hypotheses", s.protected_hypotheses, kProtected);
  count("max_global_hypotheses", s.max_global_hypotheses, kHypotheses);
  for (const MultiObjectNumber& number : kMultiObjectNumbers) {
    s.*number.field = filter.get_double_or(number.name, s.*number.field, number.range);
  }
  s.merge_rotation_rad = radians(filter.get_double_or(
      "merge_rotation_deg", degrees(s.merge_rotation_rad), {.lowest = 0, .highest = 180}));
  filter.ignore_removed(
      {"camera_share", "odometry_camera_fraction", "common_error_share", "bias_variance_fraction",
       "dependent_answers", "mode_correlation_factor", "correlation_s", "correlation_detections",
       "birth_covariance_factor", "camera_gain_noise"},
      "the errors that detections have in common are a part of the noise model, see 'slow' of "
      "[noise.NAME]");
  if (filter.get_enum_or<bool>("camera", false, {{"estimated", false}, {"considered", true}}))
    s.camera_gain = 0.0;
  return s;
}

MovingObjectSettings read_moving_objects(const TomlTable& filter) {
  constexpr IntegerRange kHypotheses{.lowest = 1, .highest = 100000};
  MovingObjectSettings s;
  const auto table = filter.find_table("moving");
  if (!table) return s;
  const auto number = [&](std::string_view key, double& value, const NumberRange& range) {
    value = table->get_double_or(key, value, range);
  };
  s.max_hypotheses = static_cast<std::size_t>(table->get_integer_or(
      "max_hypotheses", static_cast<std::int64_t>(s.max_hypotheses), kHypotheses));
  number("explained_probability", s.explained_probability, kOpenUnitInterval);
  number("default_clutter", s.default_clutter, kOpenUnitInterval);
  number("isolated_clutter", s.isolated_clutter, kUnitInterval);
  number("recurring_clutter", s.recurring_clutter, kUnitInterval);
  number("turned_clutter", s.turned_clutter, {.lowest = 0, .highest = 1, .without_highest = true});
  number("lost_rate", s.lost_rate, kNotNegative);
  s.merge_rotation_rad = radians(table->get_double_or(
      "merge_rotation_deg", degrees(s.merge_rotation_rad), {.lowest = 0, .highest = 180}));
  number("merge_translation_m", s.merge_translation_m, kNotNegative);
  number("merge_probability", s.merge_probability, kOpenUnitInterval);
  number("noise_scale_detections", s.noise_scale_detections,
         {.lowest = 0, .without_lowest = true, .with_infinity = true});
  number("least_noise_scale", s.least_noise_scale,
         {.lowest = 0, .highest = 1, .without_lowest = true});
  number("slow_error_gain", s.slow_error_gain, kUnitInterval);
  return s;
}

ExistenceSettings read_existence(const TomlTable& filter) {
  ExistenceSettings s;
  const auto table = filter.find_table("existence");
  if (!table) return s;
  const auto number = [&](std::string_view key, double& value, const NumberRange& range) {
    value = table->get_double_or(key, value, range);
  };
  const auto beta = [&](std::string_view key, BetaDistribution& value) {
    if (!table->has(key)) return;
    const Eigen::VectorXd numbers = table->get_vector(key, 2, kPositive);
    value = {numbers[0], numbers[1]};
  };
  number("birth_probability", s.birth_probability, kOpenUnitInterval);
  beta("object_rate", s.object_rate);
  beta("clutter_rate", s.clutter_rate);
  number("visible_time_s", s.visible_time_s, kPositive);
  number("hidden_time_s", s.hidden_time_s, kPositive);
  number("lifetime_s", s.lifetime_s, kPositive);
  number("look_time_s", s.look_time_s, kNotNegative);
  number("exclusion_m", s.exclusion_m, kNotNegative);
  number("confirmed_probability", s.confirmed_probability, kOpenUnitInterval);
  number("deleted_probability", s.deleted_probability,
         {.lowest = 0, .highest = s.confirmed_probability, .without_highest = true});
  return s;
}

HealthSettings read_health(const TomlTable& filter) {
  HealthSettings s;
  const auto table = filter.find_table("health");
  if (!table) return s;
  const auto number = [&](std::string_view key, double& value, const NumberRange& range) {
    value = table->get_double_or(key, value, range);
  };
  number("mode_probability", s.mode_probability, kUnitInterval);
  number("window_detections", s.window_detections, {.lowest = 1});
  number("band_probability", s.band_probability, kOpenUnitInterval);
  number("lost_probability", s.lost_probability, kUnitInterval);
  number("register_again_s", s.register_again_s, kNotNegative);
  return s;
}

void read_association(const TomlTable& root, MultiObjectSlamSettings& settings) {
  constexpr IntegerRange kDetections{.lowest = 0, .highest = 1000000};
  constexpr IntegerRange kAssignments{.lowest = 1, .highest = 100000};
  const auto table = root.find_table("association");
  if (!table) return;
  AssociationSettings& a = settings.association;
  const auto number = [&](std::string_view key, double& value, const NumberRange& range) {
    value = table->get_double_or(key, value, range);
  };
  number("gate_probability", a.gate_probability, kOpenUnitInterval);
  number("rotation_cap_probability", a.rotation_cap_probability, kOpenUnitInterval);
  number("least_new_score", a.least_new_score, kAnyNumber);
  number("least_separation_m", a.least_separation_m, kNotNegative);
  number("certain_probability", a.certain_probability, kOpenUnitInterval);
  a.joint_assignments = static_cast<std::size_t>(table->get_integer_or(
      "joint_assignments", static_cast<std::int64_t>(a.joint_assignments), kAssignments));
  settings.confirming_detections = static_cast<std::size_t>(table->get_integer_or(
      "confirming_detections", static_cast<std::int64_t>(settings.confirming_detections),
      kDetections));
}

}  // namespace posemix::internal
