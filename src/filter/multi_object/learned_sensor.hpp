// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>

#include "correlation_length.hpp"
#include "pair.hpp"
#include "posemix/filter/multi_object_filter.hpp"

namespace posemix::internal {

/// The detector of one object: its noise as given, and what is learned about the noise from the
/// innovations of the leading hypothesis (docs/many-objects.md, "What real detectors need").
class LearnedSensor {
 public:
  explicit LearnedSensor(ObjectSensor sensor);

  /// The sensor with the scale of its noise as learned by now.
  const ObjectSensor& sensor() const { return sensor_; }
  /// Number of detections.
  std::uint64_t detections() const { return detections_; }
  /// Number of detections that the noise's scale was learned from, weighted by the probability of
  /// an inlier.
  double inliers() const { return inliers_; }
  /// Number of successive detections that count as one. The prior is settings.correlation_s over
  /// the time between detections; `frame_s` is that time after a single detection.
  double correlation_length(const MultiObjectSettings& settings, double frame_s) const;
  /// Covariance of the error that all detections have in common, in the world frame.
  Matrix6d bias_covariance(const MultiObjectSettings& settings, const SE3d& camera,
                           const SE3d& object) const;

  void count_detection(double now_s);
  /// Learns the scale of the noise from an innovation, and from an inlier the correlation length.
  void learn(const PairUpdate& update, const MultiObjectSettings& settings);
  /// The sensor as it was given: no detections, nothing learned.
  void reset();

 private:
  void learn_scale(const PairUpdate& update, const MultiObjectSettings& settings);

  ObjectSensor sensor_;
  Vector6d given_noise_scale_;
  double inliers_ = 0.0;
  std::uint64_t detections_ = 0;
  double first_s_ = 0.0;  ///< time of the first detection
  double last_s_ = 0.0;   ///< time of the last detection
  CorrelationLength correlation_;
};

}  // namespace posemix::internal
