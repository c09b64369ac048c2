// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <limits>

#include "posemix/base/units.hpp"
#include "sequence_parts.hpp"

namespace posemix {

MultiObjectSettings read_multi_object(const TomlTable& filter) {
  constexpr IntegerRange kHypotheses{.lowest = 1, .highest = 100000};
  constexpr IntegerRange kProtected{.lowest = 0, .highest = 100000};
  constexpr NumberRange kProbability{
      .lowest = 0, .highest = 1, .without_lowest = true, .without_highest = true};
  constexpr NumberRange kZeroOrMore{.lowest = 0};
  constexpr NumberRange kOneOrMore{.lowest = 1};
  constexpr NumberRange kPart{.lowest = 0, .highest = 1};
  MultiObjectSettings s;
  const auto count = [&](std::string_view key, std::size_t& value, const IntegerRange& range) {
    value = static_cast<std::size_t>(
        filter.get_integer_or(key, static_cast<std::int64_t>(value), range));
  };
  const auto number = [&](std::string_view key, double& value, const NumberRange& range) {
    value = filter.get_double_or(key, value, range);
  };
  count("max_hypotheses", s.max_hypotheses, kHypotheses);
  count("protected_hypotheses", s.protected_hypotheses, kProtected);
  number("explained_probability", s.explained_probability, kProbability);
  number("birth_covariance_factor", s.birth_covariance_factor, kPositive);
  number("birth_score", s.birth_score, kZeroOrMore);
  number("score_memory", s.score_memory, kPart);
  s.merge_rotation_rad = radians(filter.get_double_or(
      "merge_rotation_deg", degrees(s.merge_rotation_rad), {.lowest = 0, .highest = 180}));
  number("merge_translation_m", s.merge_translation_m, kZeroOrMore);
  number("merge_probability", s.merge_probability, kProbability);
  number("leader_margin", s.leader_margin, kZeroOrMore);
  number("odometry_camera_fraction", s.odometry_camera_fraction, kPart);
  number("camera_gain_noise", s.camera_gain_noise, kOneOrMore);
  if (filter.get_enum_or<bool>("camera", false, {{"estimated", false}, {"considered", true}}))
    s.camera_gain_noise = std::numeric_limits<double>::infinity();
  number("noise_scale_detections", s.noise_scale_detections, kPositive);
  number("least_noise_scale", s.least_noise_scale,
         {.lowest = 0, .highest = 1, .without_lowest = true});
  number("correlation_s", s.correlation_s, kZeroOrMore);
  number("correlation_detections", s.correlation_detections, kZeroOrMore);
  number("bias_variance_fraction", s.bias_variance_fraction,
         {.lowest = 0, .highest = 1, .without_highest = true});
  number("mode_correlation_factor", s.mode_correlation_factor, kPositive);
  return s;
}

void read_association(const TomlTable& root, MethodSettings& settings) {
  constexpr NumberRange kProbability{
      .lowest = 0, .highest = 1, .without_lowest = true, .without_highest = true};
  constexpr IntegerRange kDetections{.lowest = 0, .highest = 1000000};
  const auto table = root.find_table("association");
  if (!table) return;
  AssociationSettings& a = settings.association;
  const auto number = [&](std::string_view key, double& value, const NumberRange& range) {
    value = table->get_double_or(key, value, range);
  };
  number("gate_probability", a.gate_probability, kProbability);
  number("rotation_cap_probability", a.rotation_cap_probability, kProbability);
  number("least_new_score", a.least_new_score, kAnyNumber);
  number("least_separation_m", a.least_separation_m, {.lowest = 0});
  settings.confirming_detections = static_cast<std::size_t>(table->get_integer_or(
      "confirming_detections", static_cast<std::int64_t>(settings.confirming_detections),
      kDetections));
}

}  // namespace posemix
