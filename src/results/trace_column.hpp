// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compression.hpp"
#include "io/json_numbers.hpp"

namespace posemix {

enum class ColumnType { uint8, uint16, int16, int32 };
enum class ColumnMap { linear, exponential };

/// How a column holds values: scale * q, or exp(scale * q), with integers q.
struct ColumnFormat {
  std::size_t width = 1;  ///< values per frame
  ColumnType type = ColumnType::uint8;
  double scale = 1.0;
  ColumnMap map = ColumnMap::linear;
};

/// Values over the frames as a report holds them: integers, each minus the one before it and
/// folded, the bytes of equal rank together. docs/formats.md describes it.
class TraceColumn {
 public:
  TraceColumn(std::string name, const ColumnFormat& format);

  /// Whether the integers of a linear column reach so far.
  bool holds(double value) const;
  /// Values of one frame, as many as the width; those out of reach become the nearest ones.
  void add(std::span<const double> values);
  /// A frame without values.
  void repeat();
  /// Frames without values until there are so many.
  void repeat_until(std::size_t frames);

  std::size_t frames() const { return planes_.front().size(); }
  void put_before_name(const std::string& prefix) { name_ = prefix + name_; }
  /// {"name", "width", "type", "scale", "map", "fold"}
  Json header() const;
  void write(Deflater& out) const;

 private:
  std::int64_t quantised(double value) const;

  std::string name_;
  ColumnFormat format_;
  std::vector<std::int64_t> last_;
  std::vector<std::string> planes_;  ///< per value, then per byte, the lowest first
};

}  // namespace posemix
