// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "detector/slow_error_likelihood.hpp"
#include "posemix/detector/slow_error_fit.hpp"

/// The likelihood of a slow error as a function of a vector, for optimisers.
namespace posemix::internal {

/// Which axes share one variance.
struct AxisGroups {
  std::array<std::size_t, 6> group;
  Vector6d scale;  ///< deviations are those of the group times these
  std::size_t count;
};

AxisGroups axis_groups(const NoiseComponent& inlier, std::size_t recordings);

/// Moments of residuals and lengths of tracks, from which an optimiser starts.
struct SlowScales {
  Eigen::VectorXd sd;                 ///< root mean square of the residuals by group, about zero
  Vector6d object_sd;                 ///< the same along the object's axes [rad, m]
  double least_angle_rad, angle_rad;  ///< between successive inliers, and of tracks: medians
  double least_time_s, time_s;
};

SlowScales slow_scales(std::span<const SlowTrack> tracks, const AxisGroups& groups);

/// A kind of model and its vector of parameters: the logs of the white deviations by group, then
/// where there are any those of the slow ones by group, of the angle, of the time, and of the
/// deviations in common by axis.
class SlowParameters {
 public:
  SlowParameters(SlowErrorDecay decay, bool common, const AxisGroups& groups)
      : groups_(groups), decay_(decay), common_(common) {}

  bool has_slow() const { return decay_ != SlowErrorDecay::none; }
  bool has_angle() const { return has_slow() && decay_ != SlowErrorDecay::time; }
  bool has_time() const { return has_slow() && decay_ != SlowErrorDecay::angle; }
  bool has_common() const { return common_; }
  SlowErrorDecay decay() const { return decay_; }
  const AxisGroups& groups() const { return groups_; }

  std::size_t slow_at() const { return groups_.count; }
  std::size_t angle_at() const { return has_slow() ? 2 * groups_.count : groups_.count; }
  std::size_t time_at() const { return angle_at() + (has_angle() ? 1 : 0); }
  std::size_t common_at() const { return time_at() + (has_time() ? 1 : 0); }
  std::size_t size() const { return common_at() + (common_ ? 6 : 0); }

  /// Bounds of the vector: deviations between a thousandth and ten times their scale, lengths up
  /// to a thousand tracks.
  std::vector<double> lower(const SlowScales& scales) const;
  std::vector<double> upper(const SlowScales& scales) const;

  /// A length at its upper bound is infinite, and a deviation in common at its lower bound is zero.
  SlowVariances variances(std::span<const double> x, const SlowScales& scales) const;

 private:
  std::vector<double> by_scale(const SlowScales& scales, double sd, double least,
                               double greatest) const;

  AxisGroups groups_;
  SlowErrorDecay decay_;
  bool common_;
};

}  // namespace posemix::internal
