// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "trace_column.hpp"
#include "trace_place.hpp"

/// Converts the arrays over frames of trace.json to columns of a report.
namespace posemix::internal {

/// A position that does not fit into its column: another attempt with a coarser scale will do.
struct PositionOutOfReach {};

/// Quantization steps of poses.
struct TraceScales {
  double position_m = 1e-5;
  double quaternion = 1.0 / 32767.0;

  /// Coarser steps for detections and hypotheses, which are numerous and only displayed.
  TraceScales coarse() const { return {10.0 * position_m, 1.0 / 8191.0}; }
};

/// Position and quaternion of a pose over the frames; the quaternion's sign does not jump.
class PoseColumns {
 public:
  PoseColumns(const std::string& prefix, const TraceScales& scales);

  /// [tx, ty, tz, qx, qy, qz, qw], as the columns can hold it.
  /// @throws InvalidInput for another entry, PositionOutOfReach for one that is too far out
  std::array<double, 7> read(const TracePlace& place) const;
  void add(const std::array<double, 7>& pose);
  void repeat_until(std::size_t frames);
  void move_to(std::vector<TraceColumn>& columns) &&;

 private:
  TraceColumn position_;
  TraceColumn quaternion_;
  std::array<double, 4> last_{0.0, 0.0, 0.0, 1.0};
};

/// One array, which receives its entries in turn.
class TraceSeries {
 public:
  /// `path` names the array in error messages.
  explicit TraceSeries(std::string path) : path_(std::move(path)) {}
  virtual ~TraceSeries() = default;
  TraceSeries(const TraceSeries&) = delete;
  TraceSeries& operator=(const TraceSeries&) = delete;

  void add(const Json& entry) {
    present_.push_back(!entry.is_null());
    read({entry, path_, frames() - 1});
  }
  /// The frames whose entry is not null.
  const std::vector<bool>& present() const { return present_; }
  std::size_t frames() const { return present_.size(); }
  const std::string& path() const { return path_; }

  /// Takes the entries that have been read.
  virtual void move_to(std::vector<TraceColumn>& columns) = 0;

 protected:
  /// Reads the entry of frame frames() - 1.
  virtual void read(const TracePlace& place) = 0;

 private:
  std::string path_;
  std::vector<bool> present_;
};

using TraceSeriesPtr = std::unique_ptr<TraceSeries>;

/// Poses: columns `prefix`/position and `prefix`/quaternion.
TraceSeriesPtr pose_series(std::string path, const std::string& prefix, const TraceScales& scales);
/// Standard deviations: column `prefix`/log_sd.
TraceSeriesPtr sd_series(std::string path, const std::string& prefix);
/// Covariances of positions: columns `prefix`/position_log_sd and `prefix`/position_correlation.
TraceSeriesPtr position_series(std::string path, const std::string& prefix);
/// Probabilities: column `name`.
TraceSeriesPtr probability_series(std::string path, const std::string& name);
/// Probabilities of several cases, as many as the first entry has: column `name` of that width, and
/// none where no frame has an entry.
TraceSeriesPtr shares_series(std::string path, const std::string& name);
/// Squared Mahalanobis distances, such as NEES: column `name`.
TraceSeriesPtr distance_series(std::string path, const std::string& name);
/// Status of detections: column `name` of values of DetectionStatus.
TraceSeriesPtr status_series(std::string path, const std::string& name);
/// Health of a track: column `name` of values of TrackHealth.
TraceSeriesPtr health_series(std::string path, const std::string& name);
/// Truth values: column `name` of ones and zeros.
TraceSeriesPtr flag_series(std::string path, const std::string& name);

}  // namespace posemix::internal
