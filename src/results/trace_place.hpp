// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "io/json_numbers.hpp"

namespace posemix::internal {

/// A value inside one entry of an array over frames, with its path. The path becomes text only for
/// an error message, because a trace has millions of values. Must not outlive its parent.
class TracePlace {
 public:
  /// The entry `index` of the array `path` ("trace.json: camera: pose").
  TracePlace(const Json& value, std::string_view path, std::size_t index)
      : value_(&value), path_(path), index_(index) {}

  /// Throws InvalidInput `path[index]: key: got ..., expected ...`.
  [[noreturn]] void fail(std::string_view got, std::string_view expected) const;

  const Json& value() const { return *value_; }
  TracePlace member(std::string_view key) const;
  /// Number of entries. Throws InvalidInput if the value is not an array.
  std::size_t size() const;
  TracePlace item(std::size_t index) const { return {(*value_)[index], {}, index, this}; }

  double number() const;
  double number_in(double lowest, double highest) const;
  double probability() const;  ///< rounding may have made it a little more than one
  /// Fills `values`; the entry must have exactly as many numbers.
  void numbers(std::span<double> values) const;

 private:
  TracePlace(const Json& value, std::string_view key, std::size_t index, const TracePlace* parent)
      : value_(&value), path_(key), index_(index), parent_(parent) {}

  std::string text() const;

  const Json* value_;
  std::string_view path_;  ///< path of the array, or the key within the parent; empty for an entry
  std::size_t index_;
  const TracePlace* parent_ = nullptr;
};

}  // namespace posemix::internal
