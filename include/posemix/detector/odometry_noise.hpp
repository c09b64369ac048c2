// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/lie/lie.hpp"

/// The noise of odometry, from recordings with the camera's ground truth.
namespace posemix {

/// A recording with odometry and the truth of the camera; one entry per frame.
struct OdometryRecording {
  std::string name;
  std::vector<double> stamps;                     ///< [s]
  std::vector<std::optional<SE3d>> odometry;      ///< T_odom_camera
  std::vector<std::optional<SE3d>> camera_truth;  ///< T_world_camera
};

/// Settings of fit_odometry_noise.
struct OdometryNoiseSettings {
  std::vector<double> windows_s = {0.1, 0.2, 0.4, 0.8, 1.5, 3.0, 6.0, 12.0, 20.0, 30.0};
  /// Distance of the scene [m], see OdometryNoise; estimated unless it is given.
  std::optional<double> scene_distance_m = {};
  int bootstrap = 200;  ///< samples of recordings for the standard errors
  std::uint64_t seed = 1;
};

/// The error of the relative pose over windows of one length.
struct OdometryWindow {
  double seconds;
  double independent;  ///< number of windows that do not overlap
  Vector6d variance;   ///< rotation [rad^2], translation [m^2], at the scene point at the end
  Vector6d fitted;     ///< the variance by the fitted model
};

/// The noise of odometry: rotation [rad], then translation [m], along the axes of the camera, of a
/// point that moves with the camera, at the distance of the scene on the optical axis.
///
/// An odometry that follows points of the scene errs in rotation and translation such that those
/// points stay in the image: about the camera itself the two errors depend on each other, about the
/// scene they hardly do.
struct OdometryNoise {
  Vector6d sd_per_sqrt_s;        ///< random walk, right perturbation: ProcessNoise per second
  Vector6d jitter_sd;            ///< of a single pose of the truth: white jitter of the annotation
  Vector6d sd_per_sqrt_s_error;  ///< standard error; NaN for fewer than two recordings
  Vector6d jitter_sd_error;
  std::vector<OdometryWindow> windows;
  std::size_t recordings;
  double scene_distance_m = 0.0;        ///< where the coordinates depend least on each other
  double scene_distance_error_m = 0.0;  ///< standard error; NaN where it was given
};

/// Fits a random walk of the odometry and a white jitter of the truth to the growth of the error.
///
/// Poses T are those of the point of the scene: T_camera Trans(0, 0, scene distance), where the
/// distance is the one of the least sum of the log rates at which the variances grow. With D =
/// T_odom_i^-1 T_odom_j over a window from frame i to j, the error
///   e = Log((T_true_i^-1 T_true_j)^-1 D)
/// is to first order sum_t Ad(D_t) n_t - w_j + Ad(D^-1) w_i, with n_t ~ N(0, Q dt) of the step that
/// ends in frame t, D_t = T_odom_j^-1 T_odom_t, and jitters w ~ N(0, J). For diagonal Q and J the
/// variance of every coordinate is linear in their twelve entries. Its observed value in a
/// recording is the median of the squares divided by that of a standard normal error, because
/// annotations have spikes. The entries maximise the likelihood of the observed variances, as if
/// those came from as many independent normal errors as there are windows that do not overlap, by
/// multiplicative steps that keep them positive (Fevotte and Idier, Algorithms for nonnegative
/// matrix factorization with the beta-divergence, 2011, beta = 0).
/// @throws InvalidInput when no recording has a window with odometry and truth at both ends, when a
/// recording is not complete, its stamps decrease or a pose is not finite, and for settings
/// out of range
OdometryNoise fit_odometry_noise(std::span<const OdometryRecording> recordings,
                                 const OdometryNoiseSettings& settings);

}  // namespace posemix
