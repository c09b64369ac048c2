// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "chart_axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "svg.hpp"

namespace posemix::internal {
namespace {

constexpr double kRoom = 0.04;
constexpr double kFarthestPixel = 1e5;
constexpr double kLargest = 1e300;
constexpr double kSmallest = 1e-300;
constexpr std::size_t kFewestTicks = 3;

/// The label of a tick, such as "0.5", "1200" or "1e-5".
std::string number_text(double value, int digits = 6) {
  std::string text = fmt::format("{:.{}g}", value, digits);
  const std::size_t exponent = text.find('e');
  if (exponent == std::string::npos) return text;
  std::string power = text.substr(exponent + 1);
  const std::string sign = power[0] == '-' ? "-" : "";
  power.erase(0, std::min(power.find_first_not_of("+-0"), power.size() - 1));
  return text.substr(0, exponent) + "e" + sign + power;
}

ChartRange log_range_around(const ChartRange& ends) {
  const auto [lowest, highest] = ends;
  if (lowest == highest) return {0.5 * lowest, 2.0 * highest};
  const double factor = std::exp(kRoom * (std::log(highest) - std::log(lowest)));
  return {std::max(lowest / factor, 0.5 * kSmallest), std::min(highest * factor, 2.0 * kLargest)};
}

ChartRange linear_range_around(const ChartRange& ends) {
  const auto [lowest, highest] = ends;
  if (lowest == highest) {
    const double room = lowest == 0.0 ? 1.0 : 0.1 * std::abs(lowest);
    return {lowest - room, highest + room};
  }
  const double room = kRoom * (highest - lowest);
  const bool from_zero = lowest >= 0.0 && lowest <= 0.4 * highest;
  return {from_zero ? 0.0 : lowest - room, highest + room};
}

std::size_t labelled(const std::vector<ChartTick>& ticks) {
  return static_cast<std::size_t>(std::count_if(
      ticks.begin(), ticks.end(), [](const ChartTick& tick) { return !tick.label.empty(); }));
}

}  // namespace

bool shows(double value, bool log) {
  return log ? value >= kSmallest && value <= kLargest : std::abs(value) <= kLargest;
}

ChartRange range_around(std::span<const double> values, bool log) {
  ChartRange ends{std::numeric_limits<double>::infinity(),
                  -std::numeric_limits<double>::infinity()};
  for (const double value : values) {
    if (!shows(value, log)) continue;
    ends = {std::min(ends.first, value), std::max(ends.second, value)};
  }
  if (ends.first > ends.second) return log ? ChartRange{1.0, 10.0} : ChartRange{0.0, 1.0};
  return log ? log_range_around(ends) : linear_range_around(ends);
}

ChartAxis::ChartAxis(const ChartRange& range, bool log, double from, double to)
    : range_(range), log_(log), from_(from), to_(to) {}

double ChartAxis::at(double value) const {
  const auto [lowest, highest] = range_;
  const double part =
      log_ ? (std::log(value) - std::log(lowest)) / (std::log(highest) - std::log(lowest))
           : (value - lowest) / (highest - lowest);
  return std::clamp(from_ + part * (to_ - from_), -kFarthestPixel, kFarthestPixel);
}

std::vector<ChartTick> ChartAxis::linear_ticks(int count) const {
  std::vector<ChartTick> ticks = even_ticks(count);
  // Round steps are up to 2.5 times as wide as asked for: of a few, one may be left.
  for (int more = count + 1; ticks.size() < kFewestTicks && more <= 3 * count; ++more)
    ticks = even_ticks(more);
  return ticks;
}

std::vector<ChartTick> ChartAxis::even_ticks(int count) const {
  const auto [lowest, highest] = range_;
  const double step = round_step(highest - lowest, count);
  const double room = 1e-9 * step;
  const double farthest = std::max(std::abs(lowest), std::abs(highest));
  const int digits = std::clamp(static_cast<int>(std::log10(farthest / step)) + 2, 6, 15);
  const double first = std::ceil((lowest - room) / step);
  std::vector<ChartTick> ticks;
  for (int i = 0; i <= 2 * count && (first + i) * step <= highest + room; ++i) {
    const double value = first + i == 0.0 ? 0.0 : (first + i) * step;
    ticks.push_back({value, number_text(value, digits)});
  }
  return ticks;
}

std::vector<ChartTick> ChartAxis::decade_ticks(std::span<const int> labelled_digits,
                                               int count) const {
  const auto [lowest, highest] = range_;
  const int first = static_cast<int>(std::floor(std::log10(lowest)));
  const int last = static_cast<int>(std::ceil(std::log10(highest)));
  const int stride = 1 + (last - first) / (count + 1);
  std::vector<ChartTick> ticks;
  for (int decade = first; decade <= last; ++decade) {
    for (int digit = 1; digit <= 9; ++digit) {
      const double value = digit * std::pow(10.0, decade);
      if (value < lowest * (1.0 - 1e-9) || value > highest * (1.0 + 1e-9)) continue;
      const bool label =
          decade % stride == 0 &&
          std::find(labelled_digits.begin(), labelled_digits.end(), digit) != labelled_digits.end();
      if (label || stride == 1 || digit == 1)
        ticks.push_back({value, label ? number_text(value) : std::string()});
    }
  }
  return ticks;
}

std::vector<ChartTick> ChartAxis::ticks_at(std::span<const double> values) const {
  std::vector<ChartTick> ticks;
  for (const double value : values) {
    if (value >= range_.first && value <= range_.second)
      ticks.push_back({value, number_text(value)});
  }
  return ticks;
}

std::vector<ChartTick> ChartAxis::ticks(int count) const {
  if (!log_) return linear_ticks(count);
  constexpr std::array kDecades{1};
  constexpr std::array kRound{1, 2, 5};
  std::vector<ChartTick> ticks = decade_ticks(kDecades, count);
  if (labelled(ticks) >= kFewestTicks) return ticks;
  ticks = decade_ticks(kRound, count);
  return labelled(ticks) >= kFewestTicks ? ticks : linear_ticks(count);
}

}  // namespace posemix::internal
