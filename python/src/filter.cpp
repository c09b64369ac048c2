// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "filter.hpp"

#include <fmt/ranges.h>

#include "argument.hpp"
#include "array_like.hpp"
#include "record.hpp"

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
    The detector's view of every object.
settings : MultiObjectSettings, optional
    Hypotheses, merging, what is learned.

Raises
------
ValueError
    When a setting is out of range, a standard deviation of the camera or of a prior more than 3e6
    times that of a noise, or a pose so far from the origin that rounding leaves nothing of its
    covariance; predictions and updates also, and change nothing, when an argument is not finite or a
    variance or a time step negative.

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

void bind_results(nb::module_& m) {
  using H = ObjectHypothesis;
  Record<H>(m, "ObjectHypothesis",
            "One alternative for the pose of one object, X = Exp(xi) X0 in the world frame.")
      .field("pose", &H::pose, "posemix.lie.SE3", "T_world_object.")
      .field("covariance", &H::covariance, kFloatArray,
             "Covariance of xi of the object, shape (6, 6).")
      .field("cross_covariance", &H::cross_covariance, kFloatArray,
             "Covariance of xi of the object (rows) and of the camera, shape (6, 6).")
      .field("log_weight", &H::log_weight, "float",
             "Logarithm of the weight among the hypotheses of the object and its absence, which "
             "counts every detection as "
             "independent.")
      .field("probability", &H::probability, "float",
             "The weight in which dependent detections count once.")
      .field("score", &H::score, "float", "Recent log evidence over that of clutter [nats].")
      .field("id", &H::id, "int",
             "Number that stays the same over time; a merge keeps that of the heavier hypothesis.")
      .field("detections", &H::detections, "int", "Detections processed since it began.")
      .done();
  using R = ObjectUpdateReport;
  Record<R>(m, "ObjectUpdateReport", "Report on one detection by `MultiObjectFilter.update`.")
      .field("started", &R::started, "bool", "Whether the detection began a hypothesis.")
      .field("changed_leader", &R::changed_leader, "bool",
             "Whether another hypothesis leads than before.")
      .field("log_evidence", &R::log_evidence, "float",
             "Log density of the detection given all before [nats].")
      .field("merges", &R::merges, "int", "Number of hypotheses that became one with another.")
      .field("inlier_probability", &R::inlier_probability, "float",
             "Probability that the first noise component of the leading hypothesis explains the "
             "detection.")
      .field("clutter_probability", &R::clutter_probability, "float",
             "Probability that nothing of the leading hypothesis explains it.")
      .field("nis", &R::nis, "float | None",
             "z^T S^-1 z of the leading hypothesis under the noise's first component, of six "
             "degrees of freedom; None without a hypothesis before the detection.")
      .field("residual", &R::residual, kFloatArray,
             "Residual from the leading hypothesis, white under that component; shape (6,).")
      .done();
}

/// Binds predictions and updates.
void bind_steps(nb::class_<MultiObjectFilter>& filter) {
  using F = MultiObjectFilter;
  filter
      .def(
          "predict_with_odometry",
          [](F& self, const Argument<SE3d>& motion, const ArrayLike& q, double dt) {
            self.predict_with_odometry(motion.as("motion"), q.as<Matrix6d>("q"), dt);
          },
          "motion"_a, "q"_a, "dt"_a, kOdometryDoc)
      .def(
          "predict_random_walk",
          [](F& self, const ArrayLike& q, double dt) {
            self.predict_random_walk(q.as<Matrix6d>("q"), dt);
          },
          "q"_a, "dt"_a,
          "Predicts a frame without odometry: the mean stays, and `q` counts in full.")
      .def(
          "predict_constant_velocity",
          [](F& self, double periods, const ArrayLike& q, const ArrayLike& q_motion,
             const ArrayLike& at_rest, double dt) {
            self.predict_constant_velocity(periods, q.as<Matrix6d>("q"),
                                           q_motion.as<Matrix6d>("q_motion"),
                                           at_rest.as<Matrix6d>("at_rest"), dt);
          },
          "periods"_a, "q"_a, "q_motion"_a, "at_rest"_a, "dt"_a, kVelocityDoc)
      // First the one that takes nothing but an observation; poses are made of many things.
      .def(
          "update",
          [](F& self, std::size_t object, const Observation& observation,
             const std::optional<ObservationSource>& source) {
            return self.update(object, observation, source.value_or(ObservationSource{}));
          },
          "object"_a, "observation"_a, "source"_a = nb::none(),
          "Processes one observation of the object at index `object`.")
      .def(
          "update",
          [](F& self, std::size_t object, const Argument<SE3d>& camera_object) {
            return self.update(object, camera_object.as("camera_object"));
          },
          "object"_a, "camera_object"_a,
          "Processes one detection T_camera_object of the object at index `object`.")
      .def(
          "add_camera",
          [](F& self, const Argument<ConcentratedSE3>& body_camera) {
            return self.add_camera(body_camera.as("body_camera"));
          },
          "body_camera"_a,
          "Adds a camera on the body whose pose T_body_camera is estimated, before the first "
          "detection; returns its index.")
      .def("extrinsic", &F::extrinsic, "camera"_a,
           "T_body_camera of a camera of `add_camera` as it is known by now.")
      .def_prop_ro("extrinsic_count", &F::extrinsic_count,
                   "Number of cameras whose pose on the body is estimated.")
      .def(
          "add_object",
          [](F& self, const ObjectSensor& object, const std::optional<ObjectPrior>& prior) {
            return self.add_object(object, prior);
          },
          "object"_a, "prior"_a = nb::none(),
          "One more object, never detected; returns its index. With a prior it has one hypothesis "
          "from the beginning.")
      .def(
          "forget", [](F& self, std::size_t object) { self.forget(object); }, "object"_a,
          "Forgets an object, as if it had never been seen; what it said about the camera and "
          "others stays.")
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
      .def(
          "predicted_detection",
          [](const F& self, std::size_t object, std::size_t hypothesis,
             const std::optional<ObservationSource>& source) {
            require_hypothesis(self, object, hypothesis);
            return self.predicted_detection(object, hypothesis,
                                            source.value_or(ObservationSource{}));
          },
          "object"_a, "hypothesis"_a, "source"_a = nb::none(),
          "T_camera_object as the detector sees it under one hypothesis: with the slow error of "
          "its detections, without their white error.")
      .def("object_mixture", &F::object_mixture, "object"_a,
           "T_world_object given that it was detected: a component for each hypothesis under each "
           "global hypothesis.")
      .def("pose_index", &F::pose_index, "object"_a,
           "Index of the object's pose in the joint Gaussian.");
}

void bind_source(nb::module_& m) {
  using O = ObservationSource;
  Record<O>(m, "ObservationSource", "Camera and detector of an observation.")
      .field("body_camera", &O::body_camera, "posemix.lie.SE3",
             "T_body_camera: with several cameras the camera of the filter is their body.")
      .field("camera", &O::camera, "int | None",
             "Index of a camera of `MultiObjectFilter.add_camera`, in place of `body_camera`.")
      .field("detector", &O::detector, "int",
             "Zero for `ObjectSensor.noise`, n for the n-th of `other_detectors`.")
      .constructible(0)
      .done();
}

void bind_multi_object(nb::module_& m) {
  using F = MultiObjectFilter;
  nb::class_<F> filter(m, "MultiObjectFilter", kFilterDoc);
  filter.def(
      "__init__",
      [](F* self, const Argument<ConcentratedSE3>& camera,
         const Argument<std::vector<ObjectSensor>>& objects,
         const std::optional<MultiObjectSettings>& settings) {
        new (self)
            F(camera.as("camera", kOneDensity), entries_of(objects, "objects", "an ObjectSensor"),
              settings.value_or(MultiObjectSettings{}));
      },
      "camera"_a, "objects"_a, "settings"_a = nb::none());
  bind_steps(filter);
  bind_objects(filter);
  filter.def_prop_ro("object_count", &F::object_count, "Number of objects.")
      .def_prop_ro(
          "camera", [](const F& self) { return self.camera(); }, "T_world_camera.")
      .def_prop_ro(
          "camera_mixture", [](const F& self) { return self.camera_mixture(); },
          "T_world_camera with a component for each global hypothesis; `camera` has its moments.")
      .def_prop_ro(
          "settings", [](const F& self) { return frozen(self.settings()); },
          nb::for_getter(nb::sig("def settings(self, /) -> MultiObjectSettings")),
          "A copy of the settings, which cannot be changed.")
      .def("joint", &F::joint, "Camera, then the leading hypotheses, at `pose_index`, jointly.")
      .def("__repr__", [](const F& self) {
        std::vector<std::size_t> counts;
        for (std::size_t j = 0; j < self.object_count(); ++j)
          counts.push_back(self.hypotheses(j).size());
        return fmt::format("<MultiObjectFilter of {} objects, hypotheses {}>", self.object_count(),
                           counts);
      });
}

}  // namespace

void bind_multi_object_filter(nb::module_& m) {
  bind_results(m);
  bind_source(m);
  bind_multi_object(m);
}

}  // namespace posemix::python
