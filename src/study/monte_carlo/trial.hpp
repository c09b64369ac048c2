// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "posemix/filter/gaussian_sum_filter.hpp"
#include "study.hpp"

namespace posemix {

/// The odometry between two detections, and the second detection.
struct MonteCarloStep {
  std::vector<SE3d> odometry;  ///< measured T_camera(i)_camera(i+1)
  SE3d detection;              ///< detected T_camera_object
  SE3d true_camera;            ///< T_world_camera at the detection
};

/// One simulated run.
struct MonteCarloTrial {
  Matrix6d odometry_noise;  ///< covariance of one odometry step
  SE3d true_object;         ///< T_world_object
  Hypothesis prior;         ///< of camera and object before the first step
  std::vector<MonteCarloStep> steps;
};

MonteCarloTrial simulate_trial(const MonteCarloStudySettings& settings, double noise_exponent,
                               std::size_t run);

/// A filter of the study, by its name.
struct MonteCarloMethod {
  GaussianSumSettings filter;
  bool single_gaussian;  ///< the detector's noise as one Gaussian
};

/// @throws InvalidInput for another name
MonteCarloMethod monte_carlo_method(const std::string& name,
                                    const MonteCarloStudySettings& settings);

}  // namespace posemix
