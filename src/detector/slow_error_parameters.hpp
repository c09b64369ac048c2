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

/// Which axes share one deviation of a part of the error.
struct AxisGroups {
  std::array<std::size_t, 6> group;
  Vector6d scale;  ///< deviations are those of the group times these
  std::size_t count;
};

/// Those of the white part and of the slow one: there are many white draws even in one recording,
/// but few of a slow error, whose shape is then one of chance.
struct PartGroups {
  AxisGroups white;
  AxisGroups slow;
};

/// The groups between which the likelihood decides, the fewest first.
std::vector<PartGroups> part_groups(NoiseFrame frame, std::span<const SlowTrack> tracks,
                                    std::size_t recordings);

/// Moments of residuals and lengths of tracks, from which an optimiser starts.
struct SlowScales {
  Vector6d sd;                        ///< root mean square of the residuals, about zero
  Vector6d object_sd;                 ///< the same along the object's axes [rad, m]
  double least_angle_rad, angle_rad;  ///< between successive inliers, and of tracks: medians
  double least_time_s, time_s;
};

SlowScales slow_scales(std::span<const SlowTrack> tracks);

/// A kind of model and its vector of parameters: the logs of the white deviations by group, then
/// where there are any those of the slow ones by group, of the angle, of the time, and of the
/// deviations in common by axis.
class SlowParameters {
 public:
  SlowParameters(SlowErrorDecay decay, bool common, const PartGroups& groups)
      : groups_(groups), decay_(decay), common_(common) {}

  bool has_slow() const { return decay_ != SlowErrorDecay::none; }
  bool has_angle() const { return has_slow() && decay_ != SlowErrorDecay::time; }
  bool has_time() const { return has_slow() && decay_ != SlowErrorDecay::angle; }
  bool has_common() const { return common_; }
  SlowErrorDecay decay() const { return decay_; }
  const PartGroups& groups() const { return groups_; }

  std::size_t slow_at() const { return groups_.white.count; }
  std::size_t angle_at() const { return slow_at() + (has_slow() ? groups_.slow.count : 0); }
  std::size_t time_at() const { return angle_at() + (has_angle() ? 1 : 0); }
  std::size_t common_at() const { return time_at() + (has_time() ? 1 : 0); }
  std::size_t size() const { return common_at() + (common_ ? 6 : 0); }

  /// Bounds of the vector: deviations between a thousandth and ten times their scale, lengths up
  /// to a thousand tracks.
  std::vector<double> lower(const SlowScales& scales) const;
  std::vector<double> upper(const SlowScales& scales) const;

  /// The logs of the white and slow deviations that are `factor` times their scale.
  std::vector<double> deviations(const SlowScales& scales, double factor) const;

  /// A length at its upper bound is infinite, and a deviation in common at its lower bound is zero.
  SlowVariances variances(std::span<const double> x, const SlowScales& scales) const;

 private:
  std::vector<double> by_scale(const SlowScales& scales, double sd, double least,
                               double greatest) const;

  PartGroups groups_;
  SlowErrorDecay decay_;
  bool common_;
};

}  // namespace posemix::internal
