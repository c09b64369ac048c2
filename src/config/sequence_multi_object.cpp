// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <limits>

#include "posemix/base/units.hpp"
#include "posemix/filter/multi_object_ranges.hpp"
#include "sequence_parts.hpp"

namespace posemix {

MultiObjectSettings read_multi_object(const TomlTable& filter, MultiObjectSettings s) {
  constexpr IntegerRange kHypotheses{.lowest = 1, .highest = 100000};
  constexpr IntegerRange kProtected{.lowest = 0, .highest = 100000};
  const auto count = [&](std::string_view key, std::size_t& value, const IntegerRange& range) {
    value = static_cast<std::size_t>(
        filter.get_integer_or(key, static_cast<std::int64_t>(value), range));
  };
  count("max_hypotheses", s.max_hypotheses, kHypotheses);
  count("protected_hypotheses", s.protected_hypotheses, kProtected);
  for (const MultiObjectNumber& number : kMultiObjectNumbers) {
    s.*number.field = filter.get_double_or(number.name, s.*number.field, number.range);
  }
  s.merge_rotation_rad = radians(filter.get_double_or(
      "merge_rotation_deg", degrees(s.merge_rotation_rad), {.lowest = 0, .highest = 180}));
  if (filter.get_enum_or<bool>("camera", false, {{"estimated", false}, {"considered", true}}))
    s.camera_gain_noise = std::numeric_limits<double>::infinity();
  return s;
}

}  // namespace posemix
