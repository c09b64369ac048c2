// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "moving_object.hpp"

#include "argument.hpp"
#include "copies.hpp"
#include "filter.hpp"
#include "posemix/detector/default_noise.hpp"
#include "posemix/filter/moving_object_smoother.hpp"
#include "record.hpp"

namespace posemix::python {

namespace {

constexpr const char* kFilterDoc =
    R"(The pose of one object that moves before a camera whose pose is known.

An interacting mixture of motion models times hypotheses for the place of the object, for detectors
that err in flips, gross errors, clutter and wrong answers in runs.

Parameters
----------
sensor : ObjectSensor
    The detector's view of the object.
models : MotionModels, optional
    Ways in which the object may move; by default it stands still.
settings : MovingObjectSettings, optional
    Hypotheses, clutter, merging, what is learned.

Raises
------
ValueError
    When a setting, a model, a rate or a probability is out of range, sizes differ, or the sensor has other
    detectors; updates and predictions also, and change nothing, for a time before the last one, an observation
    that is not valid, a covariance that is not positive semidefinite, and when a frame is missing.

Examples
--------
>>> from posemix import (SE3, MovingObjectFilter, ObjectSensor, Observation, ObservationComponent, calm_and_agile,
...                      exact_camera)
>>> tracker = MovingObjectFilter(ObjectSensor(), calm_and_agile())
>>> for k in range(30):
...     seen = ObservationComponent(SE3(translation=[0.01 * k, 0, 0.8]))
...     report = tracker.update(Observation([seen], stamp_s=0.1 * k), exact_camera(SE3()))
>>> now = tracker.estimate().hypotheses[0]
>>> now.world.mean.translation.round(2)
array([0.29, 0.  , 0.8 ])
>>> now.twist[3:].round(1)
array([0.1, 0. , 0. ])
)";

constexpr const char* kSmootherDoc =
    R"(A filter of one moving object that also looks back.

Parameters
----------
sensor : ObjectSensor
    The detector's view of the object.
models : MotionModels, optional
    Ways in which the object may move; by default it stands still.
settings : MovingObjectSettings, optional
    Settings of the filter.
most_steps : int, optional
    Observations that are kept, the last ones; None: all. With n + 1 the first of `smoothed` is the estimate
    with a fixed lag of n observations.

Raises
------
ValueError
    As `MovingObjectFilter`, and for less than one step.
)";

constexpr const char* kSmoothDoc = R"(The object at every step of a recording from all of its steps.

Parameters
----------
sensor : ObjectSensor
    The detector's view of the object.
models : MotionModels
    Ways in which the object may move.
steps : sequence of MovingObjectStep
    The observations by their stamps.
settings : MovingObjectSettings, optional
    Settings of the filter.

Returns
-------
MovingObjectSmoothing
    Estimates given all steps, those of the filter, and its reports.

Raises
------
ValueError
    As `MovingObjectFilter`, and when there are no steps.

Examples
--------
>>> from posemix import (SE3, MotionModels, MovingObjectStep, ObjectSensor, Observation, ObservationComponent,
...                      smooth_moving_object)
>>> steps = [MovingObjectStep(Observation([ObservationComponent(SE3(translation=[0, 0, 0.8 + 0.002 * (k % 2)]))],
...                                       stamp_s=0.1 * k)) for k in range(20)]
>>> result = smooth_moving_object(ObjectSensor(), MotionModels(), steps)
>>> print(f"{result.estimates[0].hypotheses[0].world.mean.translation[2]:.3f}")
0.801
)";

MovingObjectHypothesis blank_hypothesis() {
  return {.world = ConcentratedSE3(SE3d(), Matrix6d::Identity()),
          .twist = Vector6d::Zero(),
          .twist_covariance = Matrix6d::Zero(),
          .probability = 0.0,
          .models = {},
          .id = 0,
          .detections = 0};
}

void bind_results(nb::module_& m) {
  using H = MovingObjectHypothesis;
  Record<H>(m, "MovingObjectHypothesis", "One hypothesis for the place of a moving object.")
      .made_from(blank_hypothesis)
      .field("world", &H::world, "posemix.density.ConcentratedGaussian",
             "T_world_object, over all models.")
      .field("twist", &H::twist, kFloatArray,
             "Shape (6,): turning rate [rad/s] and velocity of the object's origin [m/s], along "
             "the world's axes.")
      .field("twist_covariance", &H::twist_covariance, kFloatArray,
             "Shape (6, 6): covariance of the twist.")
      .field("probability", &H::probability, "float",
             "Probability; with the case that the place is not known, all sum to one.")
      .field("models", &H::models, "list[float]",
             "Probability of each motion model given the hypothesis.")
      .field("id", &H::id, "int",
             "Number that stays the same over time; a merge keeps that of the more probable.")
      .field("detections", &H::detections, "int", "Detections since it began, the first included.")
      .done();
  using R = MovingObjectReport;
  Record<R>(m, "MovingObjectReport", "Report on one observation by `MovingObjectFilter.update`.")
      .field("started", &R::started, "bool", "Whether the observation began a hypothesis.")
      .field("changed_leader", &R::changed_leader, "bool",
             "Whether another hypothesis is the most probable than before.")
      .field("merges", &R::merges, "int", "Number of merges of hypotheses.")
      .field("log_evidence", &R::log_evidence, "float",
             "Log density of the observation given all before [nats].")
      .field("right_probability", &R::right_probability, "float",
             "Probability, under the leading hypothesis, that the detector saw the object.")
      .field("inlier_probability", &R::inlier_probability, "float",
             "Probability of the noise's first component under the leading hypothesis.")
      .field(
          "nis", &R::nis, "float | None",
          "z^T S^-1 z of the leading hypothesis, of six degrees of freedom, under the right mode "
          "that is most probable (that of a flip, where the noise has flips); None for one just "
          "begun.")
      .field("residual", &R::residual, kFloatArray,
             "Shape (6,): residual of the same in standard deviations, along the noise's axes.")
      .done();
  using E = MovingObjectEstimate;
  Record<E>(m, "MovingObjectEstimate", "A moving object at a time.")
      .field("time_s", &E::time_s, "float", "Time [s].")
      .field("hypotheses", &E::hypotheses, "list[MovingObjectHypothesis]",
             "Places of the object, the most probable first.")
      .field("lost_probability", &E::lost_probability, "float", "Probability of no such place.")
      .field("models", &E::models, "list[float]", "Probability of each motion model.")
      .done();
}

using Frames = std::vector<KnownFrame>;

void bind_filter(nb::module_& m) {
  using F = MovingObjectFilter;
  nb::class_<F> filter(m, "MovingObjectFilter", kFilterDoc);
  filter
      .def(
          "__init__",
          [](F* self, const ObjectSensor& sensor, const std::optional<MotionModels>& models,
             const std::optional<MovingObjectSettings>& settings) {
            new (self) F(sensor, models.value_or(MotionModels{}),
                         settings.value_or(MovingObjectSettings{}));
          },
          "sensor"_a, "models"_a = nb::none(), "settings"_a = nb::none())
      .def("update", &F::update, "observation"_a, "camera"_a, "frames"_a = Frames{},
           "Predicts to the observation's stamp, then takes it in.\n\n"
           "Parameters\n----------\nobservation : Observation\n    Its stamp is the time.\n"
           "camera : KnownCamera\n    T_world_camera.\n"
           "frames : sequence of KnownFrame, optional\n"
           "    T_world_frame of those that models name, at that time.\n\n"
           "Returns\n-------\nMovingObjectReport\n    What became of it.\n")
      .def("predict", &F::predict, "time_s"_a, "frames"_a = Frames{},
           "Predicts to a time [s] without an observation.")
      .def("estimate", &F::estimate, "The object at `time_s`.")
      .def("estimate_at", &F::estimate_at, "time_s"_a, "frames"_a = Frames{},
           "The object at a later time [s], which changes nothing.")
      .def("object_mixture", &F::object_mixture,
           "Density of T_world_object given that its place is known.")
      .def("relative_mixture", &F::relative_mixture, "camera"_a,
           "Density of T_camera_object, without the constant error of the camera.")
      .def("predict_to", &F::predict_to, "time_s"_a, "frames"_a = Frames{},
           "Density of T_world_object at a later time [s], without a change of the filter.")
      .def_prop_ro("observation_count", &F::observation_count, "Number of observations so far.")
      .def_prop_ro("time_s", &F::time_s,
                   "Time of the last update or prediction [s]; None before the first.")
      .def_prop_ro(
          "sensor", [](const F& self) { return frozen(self.sensor()); },
          nb::for_getter(nb::sig("def sensor(self, /) -> ObjectSensor")),
          "A copy of the sensor with the scale of its noise as learned by now.")
      .def_prop_ro(
          "models", [](const F& self) { return frozen(self.models()); },
          nb::for_getter(nb::sig("def models(self, /) -> MotionModels")),
          "A copy of the motion models.")
      .def_prop_ro(
          "settings", [](const F& self) { return frozen(self.settings()); },
          nb::for_getter(nb::sig("def settings(self, /) -> MovingObjectSettings")),
          "A copy of the settings, which cannot be changed.");
  with_copies(filter);
}

void bind_smoothing(nb::module_& m) {
  using S = MovingObjectSmoother;
  nb::class_<S> smoother(m, "MovingObjectSmoother", kSmootherDoc);
  smoother
      .def(
          "__init__",
          [](S* self, const ObjectSensor& sensor, const std::optional<MotionModels>& models,
             const std::optional<MovingObjectSettings>& settings,
             std::optional<std::size_t> most_steps) {
            new (self) S(sensor, models.value_or(MotionModels{}),
                         settings.value_or(MovingObjectSettings{}), most_steps);
          },
          "sensor"_a, "models"_a = nb::none(), "settings"_a = nb::none(),
          "most_steps"_a = nb::none())
      .def(
          "update",
          [](S& self, const Observation& observation, const KnownCamera& camera,
             const Frames& frames, const std::optional<Matrix6d>& change) {
            return self.update(observation, camera, frames, change.value_or(Matrix6d::Zero()));
          },
          "observation"_a, "camera"_a, "frames"_a = Frames{}, "change"_a = nb::none(),
          "Predicts to the observation's stamp, then takes it in, as `MovingObjectFilter.update`. "
          "`change` is the covariance, shape (6, 6), by which the error of the camera's pose has "
          "changed since the last step (perturbation on the left, world frame).")
      .def(
          "predict",
          [](S& self, double time_s, const Frames& frames, const std::optional<Matrix6d>& change) {
            self.predict(time_s, frames, change.value_or(Matrix6d::Zero()));
          },
          "time_s"_a, "frames"_a = Frames{}, "change"_a = nb::none(),
          "A step to a time [s] without an observation, as `MovingObjectFilter.predict`; `change` "
          "as "
          "for `update`.")
      .def("smoothed", &S::smoothed, nb::call_guard<nb::gil_scoped_release>(),
           "The object at the times of the steps that are kept, the oldest first, given all "
           "observations so far.")
      .def_prop_ro(
          "filter", [](const S& self) { return MovingObjectFilter(self.filter()); },
          "A copy of the filter after the last observation.");
  with_copies(smoother);
  using P = MovingObjectStep;
  Record<P>(m, "MovingObjectStep",
            "An observation of one moving object, with what is known at its time.")
      .field("observation", &P::observation, "Observation", "Observation at the time of its stamp.")
      .field("camera", &P::camera, "KnownCamera", "T_world_camera; by default the world's frame.")
      .field("frames", &P::frames, "collections.abc.Sequence[KnownFrame]",
             "T_world_frame of those that models name.")
      .constructible(1, [](const P& step) { validate(step.observation); })
      .done();
  using R = MovingObjectSmoothing;
  Record<R>(m, "MovingObjectSmoothing", "A recording of one moving object, smoothed.")
      .made_from([] { return R{.sensor = {.noise = default_detector_noise()}}; })
      .field("estimates", &R::estimates, "list[MovingObjectEstimate]",
             "The object at every step given all steps.")
      .field("filtered", &R::filtered, "list[MovingObjectEstimate]",
             "The same given the steps up to it.")
      .field("reports", &R::reports, "list[MovingObjectReport]", "Reports of the filter.")
      .field("sensor", &R::sensor, "ObjectSensor",
             "The sensor with the scale of its noise as learned by the end.")
      .done();
  m.def(
      "smooth_moving_object",
      [](const ObjectSensor& sensor, const MotionModels& models,
         const Argument<std::vector<P>>& steps,
         const std::optional<MovingObjectSettings>& settings) {
        const std::vector<P> all = entries_of(steps, "steps", "a MovingObjectStep");
        const nb::gil_scoped_release release;
        return smooth_moving_object(sensor, models, settings.value_or(MovingObjectSettings{}), all);
      },
      "sensor"_a, "models"_a, "steps"_a, "settings"_a = nb::none(), kSmoothDoc);
}

}  // namespace

void bind_moving_object(nb::module_& m) {
  bind_results(m);
  bind_filter(m);
  bind_smoothing(m);
}

}  // namespace posemix::python
