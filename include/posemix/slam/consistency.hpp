// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/slam/observed_error.hpp"

/// Whether the errors of estimated poses are as large as their covariances say.
///
/// The measure is the normalised estimation error squared (Bar-Shalom, Li and Kirubarajan 2001,
/// section 5.4): NEES = e^T P^-1 e with the error e of a pose and its covariance P, chi-square with
/// as many degrees of freedom as e has when the estimate is consistent. ANEES is its mean over the
/// frames and the degrees of freedom: 1 when consistent, 4 where standard deviations are half of
/// what they should be.
namespace posemix {

/// An estimate and the true pose at the same time.
struct EstimateWithTruth {
  double stamp_s = 0.0;
  PoseDensity estimate;
  SE3d truth;
};

/// The axes along which errors are reported. The NEES is the same in all.
enum class ErrorAxes {
  body,      ///< those of the estimated pose
  reference  ///< those of the frame in which the pose is stated; the error is still at the body
};

/// The words of ErrorAxes in files and options.
template <>
inline constexpr WordTable<ErrorAxes, 2> words<ErrorAxes>{{
    {"body", ErrorAxes::body},
    {"reference", ErrorAxes::reference},
}};

struct ConsistencySettings {
  SymmetryGroup symmetries = {};  ///< of the object whose pose it is
  ErrorAxes axes = ErrorAxes::body;
};

/// NEES of one frame, not divided by the degrees of freedom.
struct FrameConsistency {
  double stamp_s = 0.0;
  double nees = 0.0;
  double rotation_nees = 0.0;  ///< of the rotation alone; 0 where none of it can be observed
  double position_nees = 0.0;  ///< of the position alone
};

/// How many errors are within 1, 2 and 3 sigma.
struct Coverage {
  std::array<double, 3> shares;   ///< shares of the frames
  std::array<double, 3> nominal;  ///< their expectations
};

/// Bounds of an interval.
struct Interval {
  double low = 0.0;
  double high = 0.0;

  bool contains(double value) const { return low <= value && value <= high; }
};

/// What a series says.
enum class ConsistencyVerdict { consistent, overconfident, cautious };

/// The words of ConsistencyVerdict in files.
template <>
inline constexpr WordTable<ConsistencyVerdict, 3> words<ConsistencyVerdict>{{
    {"consistent", ConsistencyVerdict::consistent},
    {"overconfident", ConsistencyVerdict::overconfident},
    {"cautious", ConsistencyVerdict::cautious},
}};

/// The NEES of a series, per degree of freedom: 1 when consistent.
struct NeesSummary {
  std::size_t dof = 0;
  double anees = 0.0;  ///< mean over the frames
  double median = 0.0;
  double worst = 0.0;
  double worst_stamp_s = 0.0;
  /// The number of independent frames that carry as much information: successive errors are alike.
  double effective_frames = 0.0;
  /// 95 % confidence interval of the ANEES for one time series with such correlations.
  Interval interval;
  /// Where the ANEES of a consistent estimate lies in 95 % of the cases: for errors correlated like
  /// these, and for independent ones (chi-square with frames * dof degrees of freedom).
  Interval band;
  Interval independent_band;
  /// Where the NEES of one frame lies in 95 % of the cases, and the share of the frames that does.
  Interval frame_band;
  double within_frame_band = 0.0;
  /// Of the ellipsoids NEES <= 1, 4, 9.
  Coverage coverage;
  /// By the confidence interval of the ANEES: of 95 % for the whole pose, and of 99 % for rotation
  /// and position, as several parts are looked at.
  ConsistencyVerdict verdict = ConsistencyVerdict::consistent;
};

/// The error along one axis.
struct AxisConsistency {
  std::string axis;              ///< "rotation x", ..., "position z"
  double mean_error = 0.0;       ///< rad or m
  double rms_error = 0.0;        ///< rad or m
  double rms_sd = 0.0;           ///< root of the mean variance, rad or m
  double normalized_mean = 0.0;  ///< of error / standard deviation: 0 without a bias
  double normalized_rms = 0.0;   ///< 1 when consistent
  /// Standard errors by which the mean differs from zero, from the fluctuations of this series.
  double bias_significance = 0.0;
  Coverage coverage;
};

/// A direction of the error, u^T e.
struct ErrorDirection {
  /// Mean squared error over mean variance along it.
  double ratio = 0.0;
  /// The ratio beyond which 0.5 % of consistent series of this length are.
  double limit = 0.0;
  /// Correlation, by the mean covariance, with the error along each axis: which error it is.
  Vector6d correlation = Vector6d::Zero();
  std::string name;  ///< "rotation z", "0.8 rotation z + 0.6 position x"
};

/// The consistency of a series of estimates.
struct ConsistencyReport {
  std::vector<FrameConsistency> frames;
  NeesSummary pose;
  std::optional<NeesSummary> rotation;  ///< empty where none of it can be observed
  NeesSummary position;
  std::vector<AxisConsistency> axes;  ///< those that can be observed
  /// Extreme ratios of the generalised eigenproblem E[e e^T] u = ratio E[P] u.
  ErrorDirection most_overconfident;
  ErrorDirection most_cautious;
  /// The share of the mean squared normalised error that is one constant error.
  double constant_share = 0.0;
  /// The worst verdict on the whole pose, its rotation, its position, and the extreme directions by
  /// their limits; overconfident is worse than cautious.
  ConsistencyVerdict verdict = ConsistencyVerdict::consistent;
  std::vector<std::string> findings;  ///< the verdict in words, the most important first
};

/// The consistency of at least two estimates with strictly increasing stamps.
///
/// Successive errors of a filter are alike, so that frames are not independent. The number of
/// effective frames is n / (1 + 2 sum r_k) with the autocorrelation r_k of the NEES, which for
/// Gaussian errors is the sum of the squared autocorrelations of the whitened errors, about zero
/// (an error that never changes counts as one look); the sum ends where r_k falls to its own noise.
/// Two frames, which say nothing of their correlation, count as one.
/// The interval of the ANEES is that of a chi-square variable with effective_frames * dof degrees
/// of freedom, fewer where the NEES scatters more than chi-square does. Limits of directions are
/// those of the extreme eigenvalues of a Wishart matrix (Johnstone 2001; Ma 2012), of fewer frames
/// where covariances differ from frame to frame. Of consistent series at most 8 % get another
/// verdict: 5 % by the whole, and 1 % by rotation, by position and by directions each.
/// @throws InvalidInput for fewer than two estimates, stamps that do not increase, and a covariance
/// that is not positive definite, naming the stamp
ConsistencyReport consistency_of(std::span<const EstimateWithTruth> series,
                                 const ConsistencySettings& settings = {});

}  // namespace posemix
