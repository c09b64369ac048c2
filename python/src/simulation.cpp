// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/simulation.hpp"

#include "settings.hpp"
#include "slam.hpp"

namespace posemix::python {
namespace {

constexpr const char* kArray = "numpy.typing.ArrayLike";

void bind_path(nb::module_& m) {
  using W = SimulationSwing;
  Settings<W>(m, "SimulationSwing", "A length that swings: mean + swing sin(2 pi waves t).")
      .field("mean_m", &W::mean_m, "float", "Mean [m].")
      .field("swing_m", &W::swing_m, "float", "Amplitude [m].")
      .field("waves", &W::waves, "int", "Number of whole waves over the recording.")
      .done();
  using P = SimulationPath;
  Settings<P>(m, "SimulationPath", "The camera's path: an orbit that looks at the target.")
      .field("frames", &P::frames, "int", "Number of frames.")
      .field("period_s", &P::period_s, "float", "Time between two frames, whole nanoseconds [s].")
      .field("turns", &P::turns, "int", "Number of turns around the target over the recording.")
      .field("target_m", &P::target_m, kArray,
             "Point that the camera looks at, world frame, shape (3,) [m].")
      .field("range", &P::range, "SimulationSwing", "Distance of the camera from the target.")
      .field("height", &P::height, "SimulationSwing", "Height of the camera above the target.")
      .field("set_up", &P::set_up, "SimulationSetUp", "Motion of the camera, and what tells it.")
      .field("arm", &P::arm, "SimulationSd",
             "Error of the poses of a camera on an arm, right perturbation, camera frame.")
      .field("view", &P::view, "SimulationView | None", "Image; None: the camera sees everything.")
      .done();
}

void bind_errors_of_simulation(nb::module_& m) {
  using N = SimulationNoise;
  Settings<N>(m, "SimulationNoise", "One component of the detector's error.")
      .field("weight", &N::weight, "float", "Probability of the component.")
      .field("sd", &N::sd, "SimulationSd", "Standard deviations.")
      .field("frame", &N::frame, "NoiseFrame", "Axes of the standard deviations.")
      .field("offset_rotation_rad", &N::offset_rotation_rad, kArray,
             "Rotation vector of the mode, shape (3,) [rad].")
      .field("offset_translation_m", &N::offset_translation_m, kArray,
             "Translation of the mode, shape (3,) [m].")
      .done();
}

void bind_disturbances(nb::module_& m) {
  using F = SimulationFlips;
  Settings<F>(m, "SimulationFlips", "Detections of a wrong mode of a near-symmetry.")
      .field("runs", &F::runs, "SimulationRuns", "Number and length of the runs.")
      .field("rotation_rad", &F::rotation_rad, kArray,
             "Rotation vector of the wrong mode, shape (3,) [rad].")
      .field("translation_m", &F::translation_m, kArray,
             "Translation of the wrong mode, shape (3,) [m].")
      .done();
  using O = SimulationOutliers;
  Settings<O>(m, "SimulationOutliers", "Gross errors.")
      .field("runs", &O::runs, "SimulationRuns", "Number and length of the runs.")
      .field("box_m", &O::box_m, kArray,
             "Half the edges of the box of gross errors, shape (3,) [m].")
      .done();
}

void bind_slow_error(nb::module_& m) {
  using S = SimulationSlowError;
  Settings<S>(m, "SimulationSlowError", "The slow part of the detector's error.")
      .field("sd", &S::sd, "SimulationSd", "Standard deviations, in the units of the components.")
      .field("correlation_s", &S::correlation_s, "float", "Correlation time [s].")
      .field("correlation_angle_rad", &S::correlation_angle_rad, "float",
             "Correlation angle of the viewing direction, seen from the object [rad].")
      .done();
}

void bind_object(nb::module_& m) {
  using O = SimulationObject;
  Settings<O>(m, "SimulationObject", "An object, how it moves, and its detector.")
      .field("id", &O::id, "str", "Name of the object.")
      .field("class_id", &O::class_id, "str",
             "Class that its detections name; empty: they name the object.")
      .field("position_m", &O::position_m, kArray, "Translation of T_world_object, shape (3,) [m].")
      .field("rotation_rad", &O::rotation_rad, kArray,
             "Rotation vector of T_world_object, shape (3,) [rad].")
      .field("noise", &O::noise, "collections.abc.Sequence[SimulationNoise]",
             "Components of the detector's error; assigned as a whole.")
      .field("correlation_s", &O::correlation_s, "float",
             "Correlation time of the error; 0: frames are independent [s].")
      .field("slow", &O::slow, "SimulationSlowError | None",
             "Slow error that is added to that of the components.")
      .field("flips", &O::flips, "SimulationFlips", "Detections of a wrong mode.")
      .field("outliers", &O::outliers, "SimulationOutliers", "Gross errors.")
      .field("misses", &O::misses, "SimulationRuns", "Frames without a detection.")
      .field("hidden_frames", &O::hidden_frames, "int", "Number of frames before it appears.")
      .field("appears_s", &O::appears_s, "float", "Time from which on it is there [s].")
      .field("removed_s", &O::removed_s, "float", "Time from which on it is not there [s].")
      .field("conveyor", &O::conveyor, "collections.abc.Sequence[SimulationConveyor]",
             "Motions with a constant twist; assigned as a whole.")
      .field("hand_held", &O::hand_held, "collections.abc.Sequence[SimulationHandHeld]",
             "Motions in a hand; assigned as a whole.")
      .field("pick_and_place", &O::pick_and_place,
             "collections.abc.Sequence[SimulationPickAndPlace]",
             "Moves to other places; assigned as a whole.")
      .field("put_down", &O::put_down, "collections.abc.Sequence[SimulationPutDown]",
             "Unseen moves; assigned as a whole.")
      .field("held", &O::held, "collections.abc.Sequence[SimulationHeld]",
             "Frames that hold it; assigned as a whole.")
      .field("claimed", &O::claimed, "collections.abc.Sequence[SimulationNoise]",
             "Noise that the filter is told; empty: derived from the true one.")
      .done();
}

void bind_config(nb::module_& m) {
  using C = SimulationConfig;
  Settings<C>(m, "SimulationConfig", "The configuration of the simulation.")
      .field("path", &C::path, "SimulationPath", "Path of the camera.")
      .field("odometry", &C::odometry, "SimulationSd",
             "Error of the odometry per square root of a second, right perturbation, camera frame.")
      .field("claimed_odometry", &C::claimed_odometry, "SimulationSd | None",
             "Error of the odometry that the filter is told; None: the true one.")
      .field("start", &C::start, "SimulationSd",
             "Error of the start pose that the filter is told, left perturbation.")
      .field("objects", &C::objects, "collections.abc.Sequence[SimulationObject]",
             "Objects; assigned as a whole.")
      .field("frames", &C::frames, "collections.abc.Sequence[SimulationFrame]",
             "Frames that may hold objects; assigned as a whole.")
      .field("clutter", &C::clutter, "collections.abc.Sequence[SimulationClutter]",
             "False detections; assigned as a whole.")
      .done();
}

nb::dict poses_of_frames(const SimulatedSequence& simulated,
                         std::vector<SimulatedPose> SimulatedFrame::*poses) {
  nb::dict all;
  for (const SimulatedFrame& frame : simulated.frames) {
    std::vector<SE3d> path;
    for (const SimulatedPose& pose : frame.*poses) path.push_back(pose.pose());
    all[frame.name.c_str()] = SettingValue<std::vector<SE3d>>::get(path);
  }
  return all;
}

nb::dict object_truth(const SimulatedSequence& simulated) {
  nb::dict all;
  for (const SimulatedObject& object : simulated.objects) {
    MaybePoses path;
    for (std::size_t k = 0; k < simulated.stamps_ns.size(); ++k) {
      path.push_back(object.is_present(k) ? std::optional(object.world_at(k).pose())
                                          : std::nullopt);
    }
    all[object.id.c_str()] = SettingValue<MaybePoses>::get(path);
  }
  return all;
}

std::vector<std::vector<std::optional<std::string>>> sources(const SimulatedSequence& simulated) {
  std::vector<std::vector<std::optional<std::string>>> all;
  for (const auto& frame : simulated.sightings) {
    auto& ids = all.emplace_back();
    for (const SimulatedSighting& sighting : frame) {
      ids.push_back(sighting.source ? std::optional(simulated.objects[*sighting.source].id)
                                    : std::nullopt);
    }
  }
  return all;
}

void bind_sequence_of_simulation(nb::module_& m) {
  using S = SimulatedSequence;
  nb::class_<S>(m, "SimulatedSequence", "A simulated recording; `simulate` makes it.")
      .def_prop_ro("sequence", &S::sequence,
                   "The recording as object SLAM takes it, with its truth.")
      .def_prop_ro(
          "camera_start", [](const S& self) { return self.camera_start.pose(); },
          "T_world_camera of the first frame as the filter is told.")
      .def_prop_ro(
          "frames", [](const S& self) { return poses_of_frames(self, &SimulatedFrame::given); },
          nb::sig("def frames(self, /) -> dict[str, posemix.lie.SE3]"),
          "T_world_frame of each frame that may hold objects, as a filter is told.")
      .def_prop_ro(
          "frame_truth",
          [](const S& self) { return poses_of_frames(self, &SimulatedFrame::truth); },
          nb::sig("def frame_truth(self, /) -> dict[str, posemix.lie.SE3]"),
          "T_world_frame of each frame that may hold objects.")
      .def_prop_ro(
          "object_truth", [](const S& self) { return object_truth(self); },
          nb::sig("def object_truth(self, /) -> dict[str, posemix.lie.SE3]"),
          "T_world_object of each object by frame, also of those with a class; NaN where it is not "
          "there.")
      .def_prop_ro(
          "sources", [](const S& self) { return sources(self); },
          nb::sig("def sources(self, /) -> list[list[str | None]]"),
          "Id of the detected object of every observation of `sequence`, None for a false one; no "
          "entries where detections name their objects.")
      .def("__repr__", [](const S& self) {
        return fmt::format("<SimulatedSequence: {}>", nb::repr(nb::cast(self.sequence())).c_str());
      });
}

constexpr const char* kSimulateDoc =
    R"(A recording; the same configuration and seed give the same one on any machine.

Parameters
----------
config : SimulationConfig
    Path, objects, errors.
seed : int
    Seed of the errors.

Raises
------
ValueError
    Naming the setting that is out of range.

Examples
--------
>>> from posemix import SimulationConfig, SimulationObject, SimulationPath, simulate
>>> config = SimulationConfig(path=SimulationPath(frames=50), objects=[SimulationObject(id="mug")])
>>> simulate(config, seed=1).sequence
<Sequence of 50 frames over 4.9 s, objects mug>
)";

void bind_functions(nb::module_& m) {
  m.def(
      "simulate",
      [](const SimulationConfig& config, std::uint64_t seed) {
        const nb::gil_scoped_release unlocked;
        return simulate(config, seed);
      },
      "config"_a, "seed"_a, kSimulateDoc);
  m.def("claimed_noise", &claimed_noise, "object"_a,
        "The noise components that the filter is told for an object.");
  m.def("claimed_slow_error", &claimed_slow_error, "object"_a,
        "The slow error that the filter is told for an object.");
  m.def("claimed_mode_time_s", &claimed_mode_time_s, "object"_a,
        "The time for which the detector stays with a mode, as the filter is told [s].");
  m.def("claimed_clutter", &claimed_clutter, "object"_a,
        "The clutter that the filter is told: the fraction of outliers.");
  m.def("object_model", &object_model, "object"_a,
        "The model of an object that the filter is told, without its motion.");
  m.def("object_models", &object_models, "config"_a,
        "The models of all objects that the filter is told, with their motion.");
  m.def("motion_settings", &motion_settings, "config"_a,
        "Motion model with the claimed odometry error.");
  m.def("camera_prior", &camera_prior, "config"_a, "simulated"_a,
        "T_world_camera of the first frame as the filter is told.");
}

}  // namespace

void bind_simulation(nb::module_& m) {
  bind_simulation_motion(m);
  bind_errors_of_simulation(m);
  bind_path(m);
  bind_disturbances(m);
  bind_slow_error(m);
  bind_object(m);
  bind_config(m);
  bind_sequence_of_simulation(m);
  bind_functions(m);
}

}  // namespace posemix::python
