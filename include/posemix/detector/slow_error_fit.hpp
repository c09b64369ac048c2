// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/noise_observation.hpp"

/// How long the errors of a detector last, from detections with their truth.
namespace posemix {

/// What the correlation of the slow error decays with.
enum class SlowErrorDecay {
  none,           ///< there is no slow error: errors are white
  angle,          ///< the path of the viewing direction
  time,           ///< time
  angle_and_time  ///< both
};

/// The words of SlowErrorDecay in files and in Python.
template <>
inline constexpr WordTable<SlowErrorDecay, 4> words<SlowErrorDecay>{{
    {"none", SlowErrorDecay::none},
    {"angle", SlowErrorDecay::angle},
    {"time", SlowErrorDecay::time},
    {"angle_and_time", SlowErrorDecay::angle_and_time},
}};

/// One of the models between which the fit chooses, at its greatest likelihood.
struct SlowErrorModel {
  SlowErrorDecay decay = SlowErrorDecay::none;
  bool common = false;          ///< with an error that a recording has in common
  double log_likelihood = 0.0;  ///< of the inliers' residuals [nats]
  std::size_t parameters = 0;   ///< free parameters
  double bic = 0.0;             ///< parameters log(detections) - 2 log_likelihood
  double below_best = 0.0;      ///< log-likelihood of the model of the least BIC less this one's
  /// Of that difference, from its values by recording; NaN with fewer than five.
  double standard_error = 0.0;
};

/// The white, slow and common parts of a detector's error. Deviations and their standard errors are
/// by axis, [rad], then [m, or for NoiseFrame::ray a fraction of the range]; a standard error is
/// NaN where the part is zero and where there are too few detections.
struct SlowErrorFit {
  std::optional<SlowError> slow = {};   ///< none where white errors explain the residuals
  std::optional<Matrix6d> common = {};  ///< along the object's axes [rad, m]
  Matrix6d white = Matrix6d::Identity();
  Vector6d slow_sd = Vector6d::Zero();
  Vector6d slow_sd_error = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  Vector6d white_sd = Vector6d::Zero();
  Vector6d white_sd_error = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  Vector6d common_sd = Vector6d::Zero();  ///< along the object's axes [rad, m]
  Vector6d common_sd_error = Vector6d::Constant(std::numeric_limits<double>::quiet_NaN());
  double correlation_angle_error_rad = std::numeric_limits<double>::quiet_NaN();
  double correlation_time_error_s = std::numeric_limits<double>::quiet_NaN();
  std::size_t detections = 0;  ///< inliers
  std::size_t recordings = 0;  ///< that have inliers
  /// Standard errors are those of a jackknife over recordings where these are greater; else, and
  /// with fewer than five recordings, from the curvature of the likelihood, which takes the model
  /// for true.
  bool is_jackknife = false;
  std::vector<SlowErrorModel> models = {};  ///< all that were tried
  std::size_t chosen = 0;                   ///< index of the chosen one in `models`
};

/// Fits e_k = b_k + n_k + c to the residuals of the inliers of a component (the detections within
/// kInlierGate): b is the slow error (SlowError), n white, and c an error that all detections of a
/// track have in common, constant along the object's axes. All are Gaussian and independent by
/// axis; with a component whose covariance is not diagonal, b and n have its correlation
/// coefficients. Axes that share one value: for NoiseFrame::ray the two across the ray; for other
/// frames none of the white part. With fewer than five recordings there are few draws of b: the
/// rotations, and the translations, then share one value of it, in proportion to the changes from
/// one detection to the next, unless the BIC is for one by axis. Standard errors take these
/// proportions for true.
///
/// The likelihood is exact, that of a scalar Kalman filter per axis, and maximised over the logs of
/// all parameters for white errors and for slow ones that decay with the angle, with time and with
/// both, each without and, from three recordings on, with errors in common. The least BIC over all
/// inliers chooses. Dependent detections tell less than it assumes: from five recordings on, the
/// model of the fewest parameters is taken over which the gain is below two standard errors (Vuong,
/// Likelihood ratio tests for model selection, 1989, by recording), of those that no model of as
/// few parameters surpasses; and decay with the angle where decay with time is not better by two
/// standard errors, as it averages nothing while a camera rests. Decay with time is
/// not tried where a track has no stamps.
///
/// Standard errors are the greater of two: from the curvature of the likelihood, and of a jackknife
/// over recordings with one Newton step each, which counts errors of the model as well.
/// @throws InvalidInput when the stamps of a track decrease
SlowErrorFit fit_slow_error(std::span<const NoiseTrack> tracks, const NoiseComponent& inlier);

}  // namespace posemix
