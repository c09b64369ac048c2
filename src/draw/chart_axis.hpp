// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace posemix::internal {

using ChartRange = std::pair<double, double>;

struct ChartTick {
  double value;
  std::string label;  ///< empty: a grid line only
};

/// True if an axis can show the value: finite (1e300 at most), and positive on a logarithmic
/// axis (1e-300 at least).
bool shows(double value, bool log);

/// A range with a margin around the values that can be shown. A linear range begins at zero if no
/// value is negative and the least is small compared with the largest.
ChartRange range_around(std::span<const double> values, bool log);

/// Maps values to pixels.
class ChartAxis {
 public:
  /// `from` and `to` are the pixels of the range's ends.
  ChartAxis(const ChartRange& range, bool log, double from, double to);

  double at(double value) const;
  const ChartRange& range() const { return range_; }
  bool log() const { return log_; }

  /// About `count` ticks with labels, three at least where the axis is linear; on a logarithmic
  /// axis also lines between the decades.
  std::vector<ChartTick> ticks(int count) const;

  /// Ticks at those of the values that the range has.
  std::vector<ChartTick> ticks_at(std::span<const double> values) const;

 private:
  std::vector<ChartTick> even_ticks(int count) const;
  std::vector<ChartTick> linear_ticks(int count) const;
  std::vector<ChartTick> decade_ticks(std::span<const int> labelled, int count) const;

  ChartRange range_;
  bool log_;
  double from_;
  double to_;
};

}  // namespace posemix::internal
