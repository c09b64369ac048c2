// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/simulation.hpp"
#include "settings.hpp"
#include "slam.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

constexpr const char* kAxes = "numpy.typing.ArrayLike";

void bind_shared(nb::module_& m) {
  using S = SimulationSd;
  Settings<S>(m, "SimulationSd", "Standard deviations of a pose error about and along x, y, z.")
      .field("rotation_rad", &S::rotation_rad, kAxes,
             "Standard deviations about the axes, shape (3,) [rad].")
      .field("translation_m", &S::translation_m, kAxes,
             "Standard deviations along the axes, shape (3,) [m; for NoiseFrame.ray of the range].")
      .done();
  using R = SimulationRuns;
  Settings<R>(m, "SimulationRuns", "A disturbance that comes in runs of frames.")
      .field("fraction", &R::fraction, "float",
             "Fraction of the frames that are disturbed, in [0, 1].")
      .field("mean_run_s", &R::mean_run_s, "float",
             "Mean length of a run, which is at least that of independent frames [s].")
      .done();
}

void bind_view(nb::module_& m) {
  Words<SimulationSetUp>(m, "SimulationSetUp", "Motion of the camera, and what tells its pose.")
      .value(SimulationSetUp::moving, "Along its path; odometry tells its motion.")
      .value(SimulationSetUp::still, "At the first pose of its path, with one error for good.")
      .value(SimulationSetUp::on_arm,
             "Along its path; an arm tells its pose with an error of its own in every image.");
  using V = SimulationView;
  Settings<V>(m, "SimulationView", "A pinhole camera with the principal point in the middle.")
      .field("width_px", &V::width_px, "int", "Width of the image [px].")
      .field("height_px", &V::height_px, "int", "Height of the image [px].")
      .field("focal_length_px", &V::focal_length_px, "float", "Focal length [px].")
      .field("least_range_m", &V::least_range_m, "float",
             "Least distance of an object that is seen, along the optical axis [m].")
      .field("largest_range_m", &V::largest_range_m, "float",
             "Largest distance of an object that is seen, along the optical axis [m].")
      .done();
}

constexpr const char* kStart = "Time at which the motion starts [s].";
constexpr const char* kStop = "Time at which the motion stops [s].";

void bind_places(nb::module_& m) {
  using P = SimulationPlace;
  Settings<P>(m, "SimulationPlace", "A pose in the world.")
      .field("position_m", &P::position_m, kAxes, "Position, shape (3,) [m].")
      .field("rotation_rad", &P::rotation_rad, kAxes, "Rotation vector, shape (3,) [rad].")
      .done();
  using M = SimulationMoves;
  Settings<M>(m, "SimulationMoves", "Times and places of the moves of an object.")
      .field("start_s", &M::start_s, "float", kStart)
      .field("stop_s", &M::stop_s, "float", "Time after which no move begins [s].")
      .field("times_s", &M::times_s, "collections.abc.Sequence[float]",
             "Times of the moves; assigned as a whole [s].")
      .field("rate_per_s", &M::rate_per_s, "float",
             "Rate, in place of times, at which an object that stands is moved [1/s].")
      .field("places", &M::places, "collections.abc.Sequence[SimulationPlace]",
             "Places in turn; empty: anywhere in the area. Assigned as a whole.")
      .field("area_m", &M::area_m, kAxes,
             "Half the edges of the box about the first place, shape (3,) [m].")
      .done();
}

void bind_motions(nb::module_& m) {
  using C = SimulationConveyor;
  Settings<C>(m, "SimulationConveyor", "Motion with a constant twist along the world's axes.")
      .field("start_s", &C::start_s, "float", kStart)
      .field("stop_s", &C::stop_s, "float", kStop)
      .field("velocity_m_s", &C::velocity_m_s, kAxes, "Velocity, shape (3,) [m/s].")
      .field("turn_rad_s", &C::turn_rad_s, kAxes,
             "Turning rate about the object's origin, shape (3,) [rad/s].")
      .done();
  using P = SimulationPickAndPlace;
  Settings<P>(m, "SimulationPickAndPlace", "An object that is carried elsewhere.")
      .field("moves", &P::moves, "SimulationMoves", "Times and places.")
      .field("duration_s", &P::duration_s, "float", "Duration of one move [s].")
      .field("lift_m", &P::lift_m, "float", "Height above the straight line half-way [m].")
      .done();
  using D = SimulationPutDown;
  Settings<D>(m, "SimulationPutDown", "An object that is put elsewhere unseen.")
      .field("moves", &D::moves, "SimulationMoves", "Times and places.")
      .field("hidden_s", &D::hidden_s, "float", "Time for which it is nowhere [s].")
      .done();
  using H = SimulationHeld;
  Settings<H>(m, "SimulationHeld", "An object that a frame holds as it finds it.")
      .field("frame", &H::frame, "str", "Name of the frame.")
      .field("start_s", &H::start_s, "float", kStart)
      .field("stop_s", &H::stop_s, "float", kStop)
      .done();
}

void bind_hand(nb::module_& m) {
  using H = SimulationHandHeld;
  Settings<H>(m, "SimulationHandHeld", "Random motion in a hand.")
      .field("start_s", &H::start_s, "float", kStart)
      .field("stop_s", &H::stop_s, "float", kStop)
      .field("reach_m", &H::reach_m, kAxes,
             "Largest distance from the start along the world's axes, shape (3,) [m].")
      .field("reach_rad", &H::reach_rad, "float",
             "Largest coordinate of the rotation vector from the start [rad].")
      .field("acceleration", &H::acceleration, "SimulationSd",
             "White acceleration in calm parts [rad, m per s^(3/2)].")
      .field("agile_factor", &H::agile_factor, "float", "Factor on it in agile parts.")
      .field("calm_s", &H::calm_s, "float", "Mean length of a calm part [s].")
      .field("agile_s", &H::agile_s, "float", "Mean length of an agile part; 0: none [s].")
      .field("ramp_s", &H::ramp_s, "float", "Time in which the motion starts, and stops [s].")
      .done();
}

void bind_frames(nb::module_& m) {
  using W = SimulationWaypoint;
  Settings<W>(m, "SimulationWaypoint", "A place on the path of a frame.")
      .field("time_s", &W::time_s, "float", "Time at which the frame is there [s].")
      .field("place", &W::place, "SimulationPlace", "The place.")
      .done();
  using F = SimulationFrame;
  Settings<F>(m, "SimulationFrame", "A frame that may hold objects, such as a gripper or a hand.")
      .field("name", &F::name, "str", "Name of the frame.")
      .field("waypoints", &F::waypoints, "collections.abc.Sequence[SimulationWaypoint]",
             "Places between which it goes smoothly; assigned as a whole.")
      .field("error", &F::error, "SimulationSd",
             "Error of the poses that are told, about and along the world's axes.")
      .done();
  using C = SimulationClutter;
  Settings<C>(m, "SimulationClutter", "False detections of a class or of an object.")
      .field("class_id", &C::class_id, "str", "Class that they name; empty: `object`.")
      .field("object", &C::object, "str", "Object that they name; empty: `class_id`.")
      .field("rate_per_image", &C::rate_per_image, "float",
             "Mean number per image of those that are anywhere in the view.")
      .field("places", &C::places, "collections.abc.Sequence[SimulationPlace]",
             "Places at which something looks like the object; assigned as a whole.")
      .field("runs", &C::runs, "SimulationRuns", "Number and length of the runs at each place.")
      .field("sd", &C::sd, "SimulationSd", "Error of a detection at a place.")
      .done();
}

}  // namespace

void bind_simulation_motion(nb::module_& m) {
  bind_shared(m);
  bind_view(m);
  bind_places(m);
  bind_motions(m);
  bind_hand(m);
  bind_frames(m);
}

}  // namespace posemix::python
