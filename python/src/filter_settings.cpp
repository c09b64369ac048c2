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
      .field("default_clutter", &S::default_clutter, "float",
             "Weight of clutter for a noise model without clutter.")
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
      .field(
          "leader_margin", &S::leader_margin, "float",
          "Lead in log probability with which another hypothesis becomes the leading one [nats].")
      .field(
          "split_loss", &S::split_loss, "float",
          "Loss of one camera for all hypotheses of an object from which the state is split into "
          "global hypotheses [nats].")
      .field("max_global_hypotheses", &S::max_global_hypotheses, "int",
             "Largest number of global hypotheses.")
      .field("has_odometry", &S::has_odometry, "bool", "Whether the camera has odometry.")
      .field("noise_scale_detections", &S::noise_scale_detections, "float",
             "Number of detections that the noise as given counts as; infinity: it is not learned.")
      .field("least_noise_scale", &S::least_noise_scale, "float",
             "Least value of the learned scale.")
      .field("camera_gain", &S::camera_gain, "float",
             "Factor of the gain with which a detection moves the camera and other objects, where "
             "there is odometry.")
      .field(
          "slow_error_gain", &S::slow_error_gain, "float",
          "Factor of the gain with which a detection moves the slow error of its detector, where "
          "there is odometry.")
      .field("camera_rotation_correction", &S::camera_rotation_correction, "float",
             "Part of a correction's rotation that the camera keeps, where there is odometry.")
      .field("camera_position_correction", &S::camera_position_correction, "float",
             "Part of a correction's translation that the camera keeps, where there is odometry.");
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
