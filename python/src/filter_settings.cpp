// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "filter.hpp"
#include "settings.hpp"

namespace posemix::python {
namespace {

using MultiObjectFields = Settings<MultiObjectSettings>;

void add_hypothesis_fields(MultiObjectFields& settings) {
  using S = MultiObjectSettings;
  settings
      .field("max_hypotheses", &S::max_hypotheses, "int",
             "Largest number of hypotheses of one object.")
      .field("protected_hypotheses", &S::protected_hypotheses, "int",
             "Number of these places that are kept for the hypotheses of the best recent score.")
      .field(
          "explained_probability", &S::explained_probability, "float",
          "Quantile within which a hypothesis explains a detection; a detection that none explains "
          "starts a hypothesis.")
      .field("birth_covariance_factor", &S::birth_covariance_factor, "float",
             "Factor of the detector's covariance for a new hypothesis.")
      .field("birth_score", &S::birth_score, "float", "Score of a new hypothesis [nats].")
      .field("score_memory", &S::score_memory, "float",
             "Share of the score that is left after a detection.")
      .field("merge_rotation_rad", &S::merge_rotation_rad, "float",
             "Angle within which hypotheses merge [rad].")
      .field("merge_translation_m", &S::merge_translation_m, "float",
             "Distance within which hypotheses merge [m].")
      .field("merge_probability", &S::merge_probability, "float",
             "Quantile within which hypotheses must lie of each other to merge, seen from the "
             "camera.");
}

void add_noise_fields(MultiObjectFields& settings) {
  using S = MultiObjectSettings;
  settings
      .field("leader_margin", &S::leader_margin, "float",
             "Lead in log weight with which another hypothesis becomes the leading one [nats].")
      .field("has_odometry", &S::has_odometry, "bool", "Whether the camera has odometry.")
      .field("odometry_camera_fraction", &S::odometry_camera_fraction, "float",
             "Share of the odometry's noise that is the camera's; the rest is the map's drift.")
      .field("noise_scale_detections", &S::noise_scale_detections, "float",
             "Number of detections that the noise as given counts as; infinity: it is not learned.")
      .field("least_noise_scale", &S::least_noise_scale, "float",
             "Least value of the learned scale.")
      .field("correlation_s", &S::correlation_s, "float",
             "Time within which detections count as one [s].")
      .field("correlation_detections", &S::correlation_detections, "float",
             "Number of detections that this time counts as.")
      .field("bias_variance_fraction", &S::bias_variance_fraction, "float",
             "Share of the noise's variance that all frames have in common.")
      .field("mode_correlation_factor", &S::mode_correlation_factor, "float",
             "Factor of the correlation length in the probability of the mode.")
      .field("camera_gain_noise", &S::camera_gain_noise, "float",
             "Noise with which the camera's gain is computed, in units of a detection's.");
}

}  // namespace

void bind_multi_object_settings(nb::module_& m) {
  MultiObjectFields settings(
      m, "MultiObjectSettings",
      "Settings of `MultiObjectFilter`. Distances that are probabilities are quantiles of "
      "the\nchi-square distribution with six degrees of freedom.");
  add_hypothesis_fields(settings);
  add_noise_fields(settings);
  settings.done();
}

}  // namespace posemix::python
