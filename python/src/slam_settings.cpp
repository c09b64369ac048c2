// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <nanobind/stl/string.h>

#include "dict.hpp"
#include "posemix/slam/method.hpp"
#include "settings.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

void bind_enums(nb::module_& m) {
  Words<MotionModel>(m, "MotionModel", "How the camera is predicted.")
      .value(MotionModel::odometry,
             "Where it is missing for a frame, a random walk with the noise of unknown motion.")
      .value(MotionModel::random_walk, "The mean stays.")
      .value(MotionModel::constant_velocity, "The motion per period is part of the state.");
  Words<NoisePer>(m, "NoisePer", "How a covariance grows with time.")
      .value(NoisePer::frame, "Per frame.")
      .value(NoisePer::second, "Per second.");
  Words<DetectionStatus>(m, "DetectionStatus", "What happened to one object in one frame.")
      .value(DetectionStatus::none, "It was not detected.")
      .value(DetectionStatus::started, "It entered the map.")
      .value(DetectionStatus::used, "The detection was used.")
      .value(DetectionStatus::doubted,
             "Used, but more likely a gross error under the leading hypothesis.")
      .value(DetectionStatus::birth, "Explained by no hypothesis, it began one.")
      .value(DetectionStatus::gated, "Left out by the gate.")
      .value(DetectionStatus::failed, "Left out: not positive definite.");
  nb::enum_<CandidateStatus>(m, "CandidateStatus", "What a candidate is.")
      .value("assigned", CandidateStatus::assigned, "Of a known instance.")
      .value("fresh", CandidateStatus::fresh, "Of an instance not known so far.")
      .value("rejected", CandidateStatus::rejected,
             "Of none: a second detection of one object, or below the score of a new one.")
      .value("dropped", CandidateStatus::dropped, "Fresh, but no model of its class is free.");
}

void bind_motion(nb::module_& m) {
  using P = ProcessNoise;
  Settings<P>(m, "ProcessNoise", "Noise of a motion, right perturbation, camera frame.")
      .field("covariance", &P::covariance, "numpy.typing.ArrayLike",
             "Shape (6, 6), per frame or per second [rad, m].")
      .field("per", &P::per, "NoisePer", "Of what.")
      .done();
  using S = MotionSettings;
  Settings<S>(m, "MotionSettings", "Settings of the motion model.")
      .field("model", &S::model, "MotionModel", "How the camera is predicted.")
      .field("noise", &S::noise, "ProcessNoise",
             "Of the odometry, or of the pose under constant velocity.")
      .field("walk", &S::walk, "ProcessNoise", "Of the random walk.")
      .field("motion_noise", &S::motion_noise, "ProcessNoise",
             "Of the motion per period under constant velocity.")
      .field("unknown_motion", &S::unknown_motion, "ProcessNoise", "Of a frame without odometry.")
      .field("period_s", &S::period_s, "float", "Of the constant-velocity motion [s].")
      .done();
}

void bind_association(nb::module_& m) {
  using S = AssociationSettings;
  Settings<S>(m, "AssociationSettings", "Which instance a candidate is of.")
      .field("gate_probability", &S::gate_probability, "float",
             "Part of the position's error within which a detection can be of an instance.")
      .field("rotation_cap_probability", &S::rotation_cap_probability, "float",
             "The rotation costs at most an error at this part of its distribution.")
      .field("least_new_score", &S::least_new_score, "float",
             "From which candidates begin a new instance.")
      .field("least_separation_m", &S::least_separation_m, "float",
             "Of a new instance from any other [m].")
      .done();
}

void bind_slam_settings_struct(nb::module_& m) {
  using M = MultiObjectSlamSettings;
  Settings<M>(m, "MultiObjectSlamSettings",
              "Object SLAM by the MultiObjectFilter: hypotheses of every object for itself.")
      .field("filter", &M::filter, "MultiObjectSettings",
             "Of the filter; has_odometry follows from the motion model.")
      .field("association", &M::association, "AssociationSettings", "Of candidates.")
      .field("confirming_detections", &M::confirming_detections, "int",
             "An instance with fewer is tentative.")
      .done();
  using S = ObjectSlamSettings;
  Settings<S>(m, "ObjectSlamSettings", "Settings of object SLAM.")
      .field("motion", &S::motion, "MotionSettings", "How the camera moves.")
      .field("tracker", &S::tracker,
             "MultiObjectSlamSettings | GaussianSumSettings | ParticleFilterSettings",
             "The filter is chosen by its settings; a copy, which changes nothing until assigned.")
      .field("record_hypotheses", &S::record_hypotheses, "bool",
             "Whether every estimate holds the hypotheses.")
      .done();
  using O = ObjectModel;
  Settings<O>(m, "ObjectModel", "One object as the tracker knows it.")
      .field("id", &O::id, "str", "Its name.")
      .field("noise", &O::noise, "DetectorNoise", "How its detector errs.")
      .field("independent_start", &O::independent_start, "numpy.typing.ArrayLike | None",
             "Shape (6, 6), world frame: it starts independently of everything else with this; "
             "else from its first detection.")
      .field("symmetries", &O::symmetries, "SymmetryGroup",
             "Motions that no detector can tell; for the multi-object filter.")
      .field("class_id", &O::class_id, "str",
             "Objects that no detector can tell apart share one; empty: its id.")
      .done();
}

void bind_other_methods(nb::module_& m) {
  using S = SmoothingSettings;
  Settings<S>(m, "SmoothingSettings", "Settings of smoothing.")
      .field("lag_frames", &S::lag_frames, "int",
             "Frames that an estimate looks ahead; 0: to the end of the recording.")
      .field("passes", &S::passes, "int", "Forward and backward passes.")
      .field("least_probability", &S::least_probability, "float",
             "Of a hypothesis that is smoothed, where hypotheses are recorded.")
      .done();
  using P = ParticleFilterSettings;
  Settings<P>(m, "ParticleFilterSettings",
              "Object SLAM by a Rao-Blackwellised particle filter, a baseline.")
      .field("particles", &P::particles, "int", "How many.")
      .field("seed", &P::seed, "int", "Of the draws.")
      .field("resample_below", &P::resample_below, "float",
             "Effective share of the particles below which they are resampled.")
      .field("object_walk", &P::object_walk, "ProcessNoise",
             "Walk of every object, right perturbation, the object's frame.")
      .field("kernel", &P::kernel, "numpy.typing.ArrayLike",
             "Shape (6, 6): covariance of an object in a particle's Gaussian.")
      .field("hypotheses", &P::hypotheses, "int", "Particles that are reported.")
      .field("merge", &P::merge, "MergeSettings", "Of the particles into one Gaussian.")
      .done();
}

void bind_methods(nb::module_& m) {
  using M = SlamMethod;
  nb::class_<M>(m, "SlamMethod", "A tracker with its settings, and what belongs to it.")
      .def_ro("name", &M::name, "As in sequence files.")
      .def_ro("description", &M::description, "One line.")
      .def_prop_ro(
          "tracker", [](const M& self) { return self.tracker; }, "Settings of its tracker.")
      .def_ro("smoothing", &M::smoothing, "Of estimates that also look ahead, else None.")
      .def_ro("single_gaussian", &M::single_gaussian,
              "Whether the detector's noise is used as one Gaussian.")
      .def_prop_ro("title", &M::title, "For display, with the settings.")
      .def(
          "settings",
          [](const M& self, const std::optional<MotionSettings>& motion) {
            return self.settings(motion.value_or(MotionSettings{}));
          },
          "motion"_a = nb::none(), "Settings of `ObjectSlam` for a camera that moves in this way.")
      .def("models", &M::models, "models"_a, "The object models as the method takes them.")
      .def("__repr__", [](const M& self) {
        return fmt::format("<SlamMethod '{}': {}>", self.name, self.description);
      });
  m.def("slam_methods", &slam_methods,
        "All methods of object SLAM, the same as in sequence files and studies.");
  m.def(
      "find_slam_method", [](const std::string& name) { return find_slam_method(name); }, "name"_a,
      "The method of a name. ValueError with the names for another.");
}

}  // namespace

void bind_slam_settings(nb::module_& m) {
  bind_enums(m);
  bind_motion(m);
  bind_association(m);
  bind_other_methods(m);
  bind_slam_settings_struct(m);
  bind_methods(m);
}

}  // namespace posemix::python
