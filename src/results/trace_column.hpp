// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compression.hpp"
#include "io/json_numbers.hpp"

namespace posemix::internal {

enum class ColumnType { uint8, uint16, int16, int32 };
enum class ColumnMap { linear, exponential };

/// The encoding of values in a column: scale * q, or exp(scale * q), with integers q.
struct ColumnFormat {
  std::size_t width = 1;  ///< values per frame
  ColumnType type = ColumnType::uint8;
  double scale = 1.0;
  ColumnMap map = ColumnMap::linear;
};

/// Values over the frames as stored in a report: integers as folded differences from frame to
/// frame, with the bytes of equal rank together. docs/formats.md describes the format.
class TraceColumn {
 public:
  TraceColumn(std::string name, const ColumnFormat& format);

  /// Whether the integers of a linear column can represent the value.
  bool holds(double value) const;
  /// Adds the values of one frame, as many as the width; a value out of range becomes the nearest
  /// one.
  void add(std::span<const double> values);
  /// Adds a frame without values.
  void repeat();
  /// Adds frames without values until the number of frames is `frames`.
  void repeat_until(std::size_t frames);

  std::size_t frames() const { return planes_.front().size(); }
  void put_before_name(const std::string& prefix) { name_ = prefix + name_; }
  /// The head of the column: {"name", "width", "type", "scale", "map", "fold"}.
  Json header() const;
  void write(Deflater& out) const;

 private:
  std::int64_t quantised(double value) const;

  std::string name_;
  ColumnFormat format_;
  std::vector<std::int64_t> last_;
  std::vector<std::string> planes_;  ///< by value, then by byte, the lowest byte first
};

}  // namespace posemix::internal
