// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "filter.hpp"

#include <functional>

#include <nanobind/stl/function.h>

#include "posemix/filter/predict.hpp"
#include "settings.hpp"

namespace posemix::python {

nb::dict report_dict(const UpdateReport& report) {
  nb::dict dict;
  dict["gated"] = report.gated;
  dict["failed"] = report.failed;
  dict["log_evidence"] = report.log_evidence;
  dict["reductions"] =
      list_of(report.reductions, [](const ReductionReport& r) { return report_dict(r); });
  dict["update_seconds"] = report.update_seconds;
  dict["reduce_seconds"] = report.reduce_seconds;
  return dict;
}

nb::dict report_dict(const ObjectUpdateReport& report) {
  nb::dict dict;
  dict["started"] = report.started;
  dict["changed_leader"] = report.changed_leader;
  dict["log_evidence"] = report.log_evidence;
  dict["merges"] = report.merges;
  dict["inlier_probability"] = report.inlier_probability;
  dict["clutter_probability"] = report.clutter_probability;
  dict["residual"] = vector_array(report.residual);
  return dict;
}

nb::list hypothesis_list(const std::vector<ObjectHypothesis>& hypotheses) {
  return list_of(hypotheses, [](const ObjectHypothesis& h) {
    nb::dict dict;
    dict["pose"] = h.pose;
    dict["covariance"] = matrix_array(h.covariance);
    dict["cross_covariance"] = matrix_array(h.cross_covariance);
    dict["log_weight"] = h.log_weight;
    dict["probability"] = h.probability;
    dict["score"] = h.score;
    dict["id"] = h.id;
    dict["detections"] = h.detections;
    return dict;
  });
}

namespace {

using MultiObjectFields = Settings<MultiObjectSettings>;

void add_hypothesis_fields(MultiObjectFields& settings) {
  using S = MultiObjectSettings;
  settings.field("max_hypotheses", &S::max_hypotheses, "int", "Of one object.")
      .field("protected_hypotheses", &S::protected_hypotheses, "int",
             "Of these, those of the best recent score.")
      .field("explained_probability", &S::explained_probability, "float",
             "Quantile within which a hypothesis explains a detection; one that none explains "
             "starts one.")
      .field("birth_covariance_factor", &S::birth_covariance_factor, "float",
             "Of the detector's noise, for a new hypothesis.")
      .field("birth_score", &S::birth_score, "float", "Of a new hypothesis [nats].")
      .field("score_memory", &S::score_memory, "float",
             "Share of the score that is left after a detection.")
      .field("merge_rotation_rad", &S::merge_rotation_rad, "float",
             "Hypotheses merge when they differ by less [rad].")
      .field("merge_translation_m", &S::merge_translation_m, "float",
             "Hypotheses merge when they differ by less [m].")
      .field("merge_probability", &S::merge_probability, "float",
             "And lie within this quantile of each other as seen from the camera.");
}

void add_noise_fields(MultiObjectFields& settings) {
  using S = MultiObjectSettings;
  settings
      .field("leader_margin", &S::leader_margin, "float",
             "A hypothesis takes the lead when it is ahead by more [nats].")
      .field("has_odometry", &S::has_odometry, "bool", "Whether the camera has odometry.")
      .field("odometry_camera_fraction", &S::odometry_camera_fraction, "float",
             "Share of the odometry's noise that is the camera's; the rest is the map's drift.")
      .field("noise_scale_detections", &S::noise_scale_detections, "float",
             "Detections that the noise as given counts as; infinity: it is not learned.")
      .field("least_noise_scale", &S::least_noise_scale, "float", "Of the learned scale.")
      .field("correlation_s", &S::correlation_s, "float",
             "Detections within this time count as one [s].")
      .field("correlation_detections", &S::correlation_detections, "float",
             "Detections that this value counts as.")
      .field("bias_variance_fraction", &S::bias_variance_fraction, "float",
             "Share of the noise's variance that all frames have in common.")
      .field("mode_correlation_factor", &S::mode_correlation_factor, "float",
             "So many times as many detections count as one in the mode's probability.")
      .field("camera_gain_noise", &S::camera_gain_noise, "float",
             "Noise with which the camera's gain is computed, in units of a detection's.");
}

void bind_multi_object_settings(nb::module_& m) {
  MultiObjectFields settings(
      m, "MultiObjectSettings",
      "Settings of `MultiObjectFilter`. Distances that are probabilities are quantiles of "
      "the\nchi-square distribution with six degrees of freedom.");
  add_hypothesis_fields(settings);
  add_noise_fields(settings);
  settings.done();
}

/// Predictions and updates.
void bind_steps(nb::class_<MultiObjectFilter>& filter) {
  using F = MultiObjectFilter;
  filter
      .def("predict_with_odometry", [](F& self, const SE3d& motion, const Matrix6d& q,
                                       double dt) { self.predict_with_odometry(motion, q, dt); })
      .def("predict_random_walk",
           [](F& self, const Matrix6d& q, double dt) { self.predict_random_walk(q, dt); })
      .def("predict_constant_velocity",
           [](F& self, double periods, const Matrix6d& q, const Matrix6d& q_motion,
              const Matrix6d& at_rest,
              double dt) { self.predict_constant_velocity(periods, q, q_motion, at_rest, dt); })
      .def("update",
           [](F& self, std::size_t object, const SE3d& camera_object) {
             return report_dict(self.update(object, camera_object));
           })
      .def("forget", [](F& self, std::size_t object) { self.forget(object); })
      .def("copy", [](const F& self) { return F(self); });
}

void require_hypothesis(const MultiObjectFilter& self, std::size_t object, std::size_t hypothesis) {
  const std::size_t count = self.hypotheses(object).size();
  if (hypothesis >= count) {
    throw InvalidInput(fmt::format("object {} has {} hypotheses; there is none at index {}", object,
                                   count, hypothesis));
  }
}

void bind_multi_object(nb::module_& m) {
  using F = MultiObjectFilter;
  nb::class_<F> filter(m, "MultiObjectFilter");
  filter.def(
      nb::init<const ConcentratedSE3&, std::vector<ObjectSensor>, const MultiObjectSettings&>());
  bind_steps(filter);
  filter.def("objects", &F::objects)
      .def("correlation_length", &F::correlation_length)
      .def("noise_scale",
           [](const F& self, std::size_t j) { return vector_array(self.noise_scale(j)); })
      .def("camera", &F::camera)
      .def("hypotheses",
           [](const F& self, std::size_t j) { return hypothesis_list(self.hypotheses(j)); })
      .def("leading", &F::leading)
      .def("mode_probability", &F::mode_probability)
      .def("log_absent", &F::log_absent)
      .def("relative",
           [](const F& self, std::size_t object, std::size_t hypothesis) {
             require_hypothesis(self, object, hypothesis);
             return self.relative(object, hypothesis);
           })
      .def("joint", &F::joint)
      .def("pose_index", &F::pose_index)
      .def("settings", [](const F& self) { return self.settings(); });
}

}  // namespace

void bind_multi_object_filter(nb::module_& m) {
  bind_multi_object_settings(m);
  bind_multi_object(m);
}

}  // namespace posemix::python
