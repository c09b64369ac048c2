// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "trace_hypotheses.hpp"
#include "trace_series.hpp"

namespace posemix::internal {

/// Keys that lead to a value, from the outside in.
using TraceKeys = std::vector<std::string>;

/// Compresses columns and describes them.
void write_columns(const std::vector<TraceColumn>& columns, Deflater& data, Json& headers);

/// The arrays over frames of the camera or of an object.
class TraceEntity {
 public:
  /// `path` names the entity in error messages; `prefix` is "camera" or "objects/<id>" and begins
  /// the names of its columns.
  /// Alternatives go to `hypotheses`, which must outlive the entity.
  TraceEntity(std::string path, std::string prefix, HypothesisStore& hypotheses)
      : path_(std::move(path)), prefix_(std::move(prefix)), hypotheses_(hypotheses) {}

  /// The series for the array under these keys of the entity; null if a report does not need it.
  /// @throws InvalidInput when the array has been opened before
  TraceSeries* open(TraceKeys keys, const TraceScales& scales);

  /// Whether an array was there under the name that it had in the release before.
  bool has_old_keys() const { return has_old_keys_; }

  /// Compresses all arrays, which have equal lengths, and a mask of the entries that exist.
  /// @throws InvalidInput when an array that a report needs is missing, or when poses lack
  /// deviations
  void write(Deflater& data, Json& headers);

 private:
  bool is_camera() const { return prefix_ == "camera"; }
  bool has(const std::string& key) const { return series_.contains(key); }
  TraceSeriesPtr make(const TraceKeys& keys, const std::string& path,
                      const TraceScales& scales) const;
  void check() const;
  void require_same(const std::string& key, const std::string& pose) const;
  TraceColumn mask() const;

  std::string path_;
  std::string prefix_;
  HypothesisStore& hypotheses_;
  bool has_old_keys_ = false;
  std::map<std::string, TraceSeriesPtr> series_;  ///< by the keys within the entity
};

}  // namespace posemix::internal
