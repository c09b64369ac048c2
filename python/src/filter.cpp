// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "filter.hpp"

#include <fmt/ranges.h>

#include "array_like.hpp"
#include "record.hpp"
#include "settings.hpp"

namespace posemix::python {

namespace {

constexpr const char* kFilterDoc =
    R"(Object SLAM with many hypotheses for every object and none for their product.

The hypotheses of different objects are independent given the camera. A detection that no hypothesis
explains starts one. Cost: linear in hypotheses; in objects quadratic per detection, cubic while modes
compete.

Parameters
----------
camera : ConcentratedGaussian
    Prior of T_world_camera.
objects : sequence of ObjectSensor
    How every object is seen.
settings : MultiObjectSettings, optional
    Hypotheses, merging, what is learned.

Raises
------
ValueError
    When a setting is out of range; predictions and updates also, and change nothing, when an argument
    is not finite or a variance or a time step negative.

Examples
--------
>>> from posemix import (SE3, ConcentratedGaussian, MultiObjectFilter, ObjectSensor,
...                      default_detector_noise, pose_covariance)
>>> camera = ConcentratedGaussian(SE3(), pose_covariance(0.001, 0.002))
>>> tracker = MultiObjectFilter(camera, [ObjectSensor(noise=default_detector_noise())])
>>> tracker.update(0, SE3(translation=[0, 0, 0.8])).started
True
>>> tracker.predict_with_odometry(SE3(translation=[0.01, 0, 0]), pose_covariance(0.001, 0.001), dt=0.1)
>>> tracker.relative(0, tracker.leading(0)).mean.translation.round(2)
array([-0.01,  0.  ,  0.8 ])
)";

constexpr const char* kOdometryDoc = R"(T_C <- T_C motion over `dt` seconds.

Parameters
----------
motion : SE3
    T_camera(k-1)_camera(k).
q : array_like, shape (6, 6)
    Noise of the step, right perturbation, camera frame.
dt : float
    Time step [s].
)";

constexpr const char* kVelocityDoc =
    R"(Constant velocity: the camera's motion per period becomes part of the state.

Parameters
----------
periods : float
    The step in reference periods.
q, q_motion : array_like, shape (6, 6)
    Noise of the pose and of the motion per period, of the step.
at_rest : array_like, shape (6, 6)
    Covariance of the motion at the first call.
dt : float
    Time step [s].
)";

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

void bind_results(nb::module_& m) {
  using H = ObjectHypothesis;
  constexpr const char* kArray = "numpy.typing.NDArray[numpy.float64]";
  Record<H>(m, "ObjectHypothesis",
            "One alternative for the pose of one object, X = Exp(xi) X0 in the world frame.")
      .field("pose", &H::pose, "posemix.lie.SE3", "T_world_object.")
      .field("covariance", &H::covariance, kArray, "Shape (6, 6), of xi of the object.")
      .field("cross_covariance", &H::cross_covariance, kArray,
             "Shape (6, 6), of xi of the object (rows) and of the camera.")
      .field("log_weight", &H::log_weight, "float",
             "Among the hypotheses of the object and its absence; counts every detection as "
             "independent.")
      .field("probability", &H::probability, "float",
             "The weight with dependent detections counted once.")
      .field("score", &H::score, "float", "Recent log evidence over that of clutter [nats].")
      .field("id", &H::id, "int", "Kept over time; a merge keeps that of the heavier.")
      .field("detections", &H::detections, "int", "Detections processed since it began.")
      .done();
  using R = ObjectUpdateReport;
  Record<R>(m, "ObjectUpdateReport", "What became of a detection in `MultiObjectFilter.update`.")
      .field("started", &R::started, "bool", "The detection began a hypothesis.")
      .field("changed_leader", &R::changed_leader, "bool", "Another hypothesis leads than before.")
      .field("log_evidence", &R::log_evidence, "float", "Of the detection given all before [nats].")
      .field("merges", &R::merges, "int", "Hypotheses that became one with another.")
      .field("inlier_probability", &R::inlier_probability, "float",
             "Probability that the first noise component of the leading hypothesis explains the "
             "detection.")
      .field("clutter_probability", &R::clutter_probability, "float",
             "Probability that nothing of the leading hypothesis explains it.")
      .field("residual", &R::residual, kArray,
             "Shape (6,), from the leading hypothesis, white under that component.")
      .done();
}

/// Binds predictions and updates.
void bind_steps(nb::class_<MultiObjectFilter>& filter) {
  using F = MultiObjectFilter;
  filter
      .def(
          "predict_with_odometry",
          [](F& self, const SE3d& motion, const ArrayLike& q, double dt) {
            self.predict_with_odometry(motion, q.as<Matrix6d>("q"), dt);
          },
          "motion"_a, "q"_a, "dt"_a, kOdometryDoc)
      .def(
          "predict_random_walk",
          [](F& self, const ArrayLike& q, double dt) {
            self.predict_random_walk(q.as<Matrix6d>("q"), dt);
          },
          "q"_a, "dt"_a, "A frame that the odometry lacks: the mean stays, `q` counts in full.")
      .def(
          "predict_constant_velocity",
          [](F& self, double periods, const ArrayLike& q, const ArrayLike& q_motion,
             const ArrayLike& at_rest, double dt) {
            self.predict_constant_velocity(periods, q.as<Matrix6d>("q"),
                                           q_motion.as<Matrix6d>("q_motion"),
                                           at_rest.as<Matrix6d>("at_rest"), dt);
          },
          "periods"_a, "q"_a, "q_motion"_a, "at_rest"_a, "dt"_a, kVelocityDoc)
      .def(
          "update",
          [](F& self, std::size_t object, const SE3d& camera_object) {
            return self.update(object, camera_object);
          },
          "object"_a, "camera_object"_a,
          "One detection T_camera_object of the object at index `object`.")
      .def(
          "forget", [](F& self, std::size_t object) { self.forget(object); }, "object"_a,
          "The object is as if never seen; what it said about the camera and others stays.")
      .def("__copy__", [](const F& self) { return F(self); })
      .def(
          "__deepcopy__", [](const F& self, const nb::dict& /*memo*/) { return F(self); },
          "memo"_a);
}

void require_hypothesis(const MultiObjectFilter& self, std::size_t object, std::size_t hypothesis) {
  const std::size_t count = self.hypotheses(object).size();
  if (hypothesis >= count) {
    throw InvalidInput(fmt::format("object {} has {} hypotheses; there is none at index {}", object,
                                   count, hypothesis));
  }
}

/// Binds what the filter has estimated for one object, by the object's index.
void bind_objects(nb::class_<MultiObjectFilter>& filter) {
  using F = MultiObjectFilter;
  filter
      .def(
          "noise_scale",
          [](const F& self, std::size_t object) { return vector_array(self.noise_scale(object)); },
          "object"_a,
          nb::sig("def noise_scale(self, object: int) -> numpy.typing.NDArray[numpy.float64]"),
          "Factors of the standard deviations of an object's noise, learned; shape (6,).")
      .def("hypotheses", &F::hypotheses, "object"_a,
           "The hypotheses of an object; none until it was seen.")
      .def("leading", &F::leading, "object"_a, "Index of the hypothesis that leads.")
      .def("mode_probability", &F::mode_probability, "object"_a,
           "Probability that the leading hypothesis is the right one.")
      .def("log_absent", &F::log_absent, "object"_a,
           "Log probability that nothing seen so far was the object.")
      .def(
          "relative",
          [](const F& self, std::size_t object, std::size_t hypothesis) {
            require_hypothesis(self, object, hypothesis);
            return self.relative(object, hypothesis);
          },
          "object"_a, "hypothesis"_a,
          "T_camera_object of one hypothesis, with the cross-covariance.")
      .def("pose_index", &F::pose_index, "object"_a,
           "Index of the object's pose in the joint Gaussian.");
}

void bind_multi_object(nb::module_& m) {
  using F = MultiObjectFilter;
  nb::class_<F> filter(m, "MultiObjectFilter", kFilterDoc);
  filter.def(
      "__init__",
      [](F* self, const ConcentratedSE3& camera, std::vector<ObjectSensor> objects,
         const std::optional<MultiObjectSettings>& settings) {
        new (self) F(camera, std::move(objects), settings.value_or(MultiObjectSettings{}));
      },
      "camera"_a, "objects"_a, "settings"_a = nb::none());
  bind_steps(filter);
  bind_objects(filter);
  filter.def_prop_ro("objects", &F::objects, "Number of objects.")
      .def_prop_ro("correlation_length", &F::correlation_length,
                   "Detections of an object that count as one, over all objects.")
      .def_prop_ro(
          "camera", [](const F& self) { return self.camera(); },
          "T_world_camera, with the covariance of the true error.")
      .def_prop_ro(
          "settings", [](const F& self) { return MultiObjectSettings(self.settings()); },
          "A copy of the settings.")
      .def("joint", &F::joint,
           "Camera, then the leading hypotheses in the order in which they began, jointly.")
      .def("__repr__", [](const F& self) {
        std::vector<std::size_t> counts;
        for (std::size_t j = 0; j < self.objects(); ++j)
          counts.push_back(self.hypotheses(j).size());
        return fmt::format("<MultiObjectFilter of {} objects, hypotheses {}>", self.objects(),
                           counts);
      });
}

}  // namespace

void bind_multi_object_filter(nb::module_& m) {
  bind_multi_object_settings(m);
  bind_results(m);
  bind_multi_object(m);
}

}  // namespace posemix::python
