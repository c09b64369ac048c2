// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>

#include "posemix/slam/method.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "slam_settings.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

void bind_enums(nb::module_& m) {
  Words<MotionModel>(m, "MotionModel", "Model by which the camera is predicted.")
      .value(
          MotionModel::odometry,
          "The odometry; where a frame has none, a random walk with the noise of unknown motion.")
      .value(MotionModel::random_walk, "A random walk: the mean stays.")
      .value(MotionModel::constant_velocity,
             "Constant velocity: the motion per period is part of the state.")
      .value(MotionModel::still, "The camera stays where it is, exactly.")
      .value(MotionModel::given,
             "The pose T_world_camera is given with every frame, with an error drawn anew; without "
             "one a random walk with the noise of unknown motion.");
  Words<NoisePer>(m, "NoisePer", "Unit of time in which a covariance is stated.")
      .value(NoisePer::frame, "One frame.")
      .value(NoisePer::second, "One second.");
  Words<DetectionStatus>(m, "DetectionStatus", "Result of one object's detection in one frame.")
      .value(DetectionStatus::none, "The object was not detected.")
      .value(DetectionStatus::started, "The object entered the map.")
      .value(DetectionStatus::used, "The detection was used.")
      .value(
          DetectionStatus::doubted,
          "The detection was used, but is more likely a gross error under the leading hypothesis.")
      .value(DetectionStatus::birth, "The detection, which no hypothesis explains, began one.")
      .value(DetectionStatus::gated, "The gate left the detection out.")
      .value(DetectionStatus::failed,
             "The detection was left out, because a covariance was not positive definite.");
  nb::enum_<CandidateStatus>(m, "CandidateStatus", "Result of the association of a candidate.")
      .value("assigned", CandidateStatus::assigned, "The candidate is of a known instance.")
      .value("fresh", CandidateStatus::fresh,
             "The candidate is of an instance that was not known so far.")
      .value("rejected", CandidateStatus::rejected,
             "The candidate is of no instance: a second detection of one, or below the score of a "
             "new one.")
      .value("dropped", CandidateStatus::dropped,
             "The candidate is of a new instance, but no model of its class is free.");
}

void bind_motion(nb::module_& m) {
  using P = ProcessNoise;
  Settings<P>(m, "ProcessNoise", "Noise of a motion, right perturbation, camera frame.")
      .field("covariance", &P::covariance, "numpy.typing.ArrayLike",
             "Covariance per frame or per second, shape (6, 6) [rad, m].")
      .field("per", &P::per, "NoisePer", "Unit of time in which the covariance is stated.")
      .done();
  using S = MotionSettings;
  Settings<S>(m, "MotionSettings", "Settings of the motion model.")
      .field("model", &S::model, "MotionModel", "Model by which the camera is predicted.")
      .field("noise", &S::noise, "ProcessNoise",
             "Noise of the odometry, or of the pose under constant velocity.")
      .field("walk", &S::walk, "ProcessNoise", "Noise of the random walk.")
      .field("motion_noise", &S::motion_noise, "ProcessNoise",
             "Noise of the motion per period under constant velocity.")
      .field("unknown_motion", &S::unknown_motion, "ProcessNoise",
             "Noise of a frame without odometry.")
      .field("period_s", &S::period_s, "float",
             "Reference period of the constant-velocity model [s].")
      .done();
}

void bind_association_settings(nb::module_& m) {
  using S = AssociationSettings;
  Settings<S>(m, "AssociationSettings", "Settings of the association of candidates to instances.")
      .field("gate_probability", &S::gate_probability, "float",
             "Part of the distribution of the position's error within which a candidate can be of "
             "an instance.")
      .field(
          "rotation_cap_probability", &S::rotation_cap_probability, "float",
          "Part of the distribution of the rotation's error that bounds the cost of the rotation.")
      .field("least_new_score", &S::least_new_score, "float",
             "Least score of a candidate that begins a new instance.")
      .field("least_separation_m", &S::least_separation_m, "float",
             "Least distance of a new instance from any other [m].")
      .field("certain_probability", &S::certain_probability, "float",
             "Probability of its detection below which an instance takes in all that may be of it.")
      .field("joint_assignments", &S::joint_assignments, "int",
             "Largest number of assignments over which these probabilities are.")
      .done();
}

void bind_slam_settings_struct(nb::module_& m) {
  using B = BodyCamera;
  Settings<B>(m, "BodyCamera", "A camera of several on one body.")
      .field("name", &B::name, "str", "`Observation.camera`.")
      .field("body_camera", &B::body_camera, "posemix.lie.SE3", "T_body_camera.")
      .field("covariance", &B::covariance, "numpy.typing.ArrayLike | None",
             "Shape (6, 6): covariance of n of T_body_camera Exp(n), rotation [rad] before "
             "translation [m]; the pose is then estimated too. None or zero: it is exact.")
      .done();
  using M = MultiObjectSlamSettings;
  Settings<M>(m, "MultiObjectSlamSettings",
              "Object SLAM by the MultiObjectFilter: hypotheses of every object for itself.")
      .field("filter", &M::filter, "MultiObjectSettings",
             "Settings of the filter; has_odometry follows from the motion model.")
      .field("association", &M::association, "AssociationSettings",
             "Settings of the association of candidates.")
      .field("existence", &M::existence, "ExistenceSettings",
             "Settings of the existence of instances.")
      .field("health", &M::health, "HealthSettings", "Settings of the health of tracks.")
      .field("confirming_detections", &M::confirming_detections, "int",
             "Number of detections below which an instance is tentative.")
      .field("cameras", &M::cameras, "list[BodyCamera]",
             "Cameras on the body whose pose is estimated and whose motion is the odometry; none: "
             "the camera is the body.")
      .field("on_sight", &M::on_sight, "ObjectModel | None",
             "Model of objects that were not declared: an observation of an unknown id begins one; "
             "None: it is refused.")
      .field("moving", &M::moving, "MovingObjectSettings", "Settings of objects that move.")
      .field("frames", &M::frames, "list[str]",
             "Names of the frames that may hold objects, whose poses are known.")
      .done();
  using S = NamedSlamSettings;
  Settings<S>(m, "ObjectSlamSettings", "Settings of object SLAM.")
      .field("motion", &S::motion, "MotionSettings", "Motion model of the camera.")
      .field("tracker", &S::tracker,
             "MultiObjectSlamSettings | GaussianSumSettings | ParticleFilterSettings",
             "The filter, which is chosen by its settings.")
      .field("record_hypotheses", &S::record_hypotheses, "bool",
             "Whether every estimate holds the hypotheses.")
      .done();
  using P = ObjectPrior;
  Settings<P>(m, "ObjectPrior", "Pose that an object is known to have before it is seen.",
              [] { return P{PoseDensity(SE3d(), Matrix6d::Identity())}; })
      .field("world", &P::world, "posemix.density.ConcentratedGaussian",
             "T_world_object, independent of the camera and of other objects.")
      .required()
      .field("probability", &P::probability, "float", "Probability that this holds.")
      .done();
  using O = ObjectModel;
  Settings<O>(m, "ObjectModel", "Model of one object, as the tracker knows it.")
      .field("id", &O::id, "str", "Name of the object.")
      .field("noise", &O::noise, "DetectorNoise", "Noise of the object's detector.")
      .field("independent_start", &O::independent_start, "numpy.typing.ArrayLike | None",
             "Covariance (world frame, shape (6, 6)) with which the object starts independently of "
             "everything else; "
             "None: it starts from its first detection.")
      .field("symmetries", &O::symmetries, "SymmetryGroup",
             "Motions that leave the object's appearance as it is; for the multi-object filter.")
      .field("detectors", &O::detectors, "dict[str, DetectorNoise]",
             "Noise by `Observation.detector`, for the multi-object filter; no name stands for "
             "`noise`.")
      .field("class_id", &O::class_id, "str",
             "Class, which objects share that no detector can tell apart and whose noise and "
             "symmetries are the same; empty: the id.")
      .field("prior", &O::prior, "ObjectPrior | None",
             "Known pose of the object, for the multi-object filter.")
      .field("motion", &O::motion, "MotionModels",
             "Ways in which the object may move, for the multi-object filter; by default it stands "
             "still.")
      .done();
}

void bind_other_methods(nb::module_& m) {
  using S = SmoothingSettings;
  Settings<S>(m, "SmoothingSettings", "Settings of smoothing.")
      .field("lag_frames", &S::lag_frames, "int",
             "Number of frames that an estimate looks ahead; 0: to the end of the recording.")
      .field("passes", &S::passes, "int", "Number of forward and backward passes.")
      .field("least_probability", &S::least_probability, "float",
             "Least probability of a hypothesis that is smoothed, where hypotheses are recorded.")
      .done();
  using P = ParticleFilterSettings;
  Settings<P>(m, "ParticleFilterSettings",
              "Object SLAM by a Rao-Blackwellised particle filter, a baseline.")
      .field("particles", &P::particles, "int", "Number of particles.")
      .field("seed", &P::seed, "int", "Seed of the draws.")
      .field("resample_below", &P::resample_below, "float",
             "Effective share of the particles below which they are resampled.")
      .field("object_walk", &P::object_walk, "ProcessNoise",
             "Random walk of every object, right perturbation, the object's frame.")
      .field("kernel", &P::kernel, "numpy.typing.ArrayLike",
             "Covariance of an object in a particle's Gaussian, shape (6, 6).")
      .field("hypotheses", &P::hypotheses, "int",
             "Number of particles that are reported as hypotheses.")
      .field("merge", &P::merge, "MergeSettings",
             "Settings for the merge of the particles into one Gaussian.")
      .done();
}

void bind_methods(nb::module_& m) {
  using M = SlamMethod;
  Record<M>(m, "SlamMethod", "A tracker with its settings, and what belongs to it.")
      .field("name", &M::name, "str", "Name in sequence files.")
      .field("description", &M::description, "str", "Description in one line.")
      .field("tracker", &M::tracker,
             "MultiObjectSlamSettings | GaussianSumSettings | ParticleFilterSettings",
             "Settings of its tracker.")
      .field("smoothing", &M::smoothing, "SmoothingSettings | None",
             "Settings of smoothing, for estimates that also look ahead.")
      .field("single_gaussian", &M::single_gaussian, "bool",
             "Whether the detector's noise is used as one Gaussian.")
      .shown_as([](const M& self) {
        return fmt::format("<SlamMethod '{}': {}>", self.name, self.description);
      })
      .done()
      .def_prop_ro("title", &M::title, "Title for display, with the settings.")
      .def(
          "settings",
          [](const M& self, const std::optional<MotionSettings>& motion) {
            return self.settings(motion.value_or(MotionSettings{}));
          },
          "motion"_a = nb::none(), "Settings of `ObjectSlam` for a camera that moves in this way.")
      .def("models", &M::models, "models"_a, "The object models as the method takes them.");
  m.def("slam_methods", &slam_methods,
        "All methods of object SLAM, the same as in sequence files and studies.");
  m.def(
      "find_slam_method", [](const std::string& name) { return find_slam_method(name); }, "name"_a,
      "The method of a name; raises ValueError with all names for another.");
}

}  // namespace

void bind_slam_settings(nb::module_& m) {
  bind_enums(m);
  bind_motion(m);
  bind_association_settings(m);
  bind_other_methods(m);
  bind_slam_settings_struct(m);
  bind_methods(m);
}

}  // namespace posemix::python
