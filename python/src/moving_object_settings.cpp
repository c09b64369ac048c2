// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "moving_object.hpp"

#include "argument.hpp"
#include "array_like.hpp"
#include "filter.hpp"
#include "posemix/filter/moving_object_filter.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "words.hpp"

namespace posemix::python {

namespace {

constexpr const char* kSds = "numpy.typing.ArrayLike";

void bind_motions(nb::module_& m) {
  Words<MotionFrame>(m, "MotionFrame", "Axes in which the motion of an object is stated.")
      .value(MotionFrame::object,
             "Along the object's axes: a constant twist is a screw motion, as of a vehicle or a "
             "hand.")
      .value(MotionFrame::world,
             "Along the world's axes: the origin goes straight on while the object turns, as on a "
             "conveyor.");
  Settings<StaticMotion>(m, "StaticMotion", "The object stands still.").done();
  using P = PutDownMotion;
  Settings<P>(m, "PutDownMotion",
              "The object stands still until somebody moves it to anywhere in a volume.")
      .field("jump_rate", &P::jump_rate, "float", "Rate of jumps [1/s].")
      .field("volume_m3", &P::volume_m3, "float", "Volume in which it may be put down [m^3].")
      .done();
  using R = RandomWalkMotion;
  Settings<R>(m, "RandomWalkMotion", "The pose changes by independent steps.")
      .field("sds", &R::sds, kSds,
             "Shape (6,): standard deviations over a second, rotation first [rad, m / s^(1/2)].")
      .field("frame", &R::frame, "MotionFrame", "Axes of the steps.")
      .field("break_rate", &R::break_rate, "float",
             "Rate at which the motion is not what the model says [1/s].")
      .done();
  using V = ConstantVelocityMotion;
  Settings<V>(m, "ConstantVelocityMotion", "A twist that is constant up to white acceleration.")
      .field("acceleration_sds", &V::acceleration_sds, kSds,
             "Shape (6,): standard deviations of the change over a second, rotation first "
             "[rad, m / s^(3/2)].")
      .field("frame", &V::frame, "MotionFrame", "Axes of the twist.")
      .field("start_sds", &V::start_sds, kSds,
             "Shape (6,): standard deviations of the twist of an object of which no motion is "
             "known [rad/s, m/s].")
      .field("break_rate", &V::break_rate, "float",
             "Rate at which the motion is not what the model says [1/s].")
      .done();
  using A = AttachedMotion;
  Settings<A>(m, "AttachedMotion", "The object is held by a frame with a known pose.")
      .field("frame", &A::frame, "int", "Index among the frames that are given.")
      .field("slip_sds", &A::slip_sds, kSds,
             "Shape (6,): random walk in the grip, along the object's axes [rad, m / s^(1/2)].")
      .done();
}

void bind_models(nb::module_& m) {
  using M = MotionModels;
  Settings<M>(m, "MotionModels",
              "The ways in which one object may move, and how it changes between them.")
      .field("models", &M::models,
             "list[StaticMotion | PutDownMotion | RandomWalkMotion | ConstantVelocityMotion | "
             "AttachedMotion]",
             "The models, at least one.")
      .field("rates", &M::rates, kSds,
             "Shape (n, n): rates at which an object that moves by the model of the row begins to "
             "move by that of the column [1/s]; shape (0, 0): no changes.")
      .field("start", &M::start, "list[float]",
             "Probability of each model at first sight; empty: equal ones.")
      .done();
  m.def(
      "calm_and_agile",
      [](const std::optional<ConstantVelocityMotion>& calm) {
        return calm_and_agile(calm.value_or(ConstantVelocityMotion{}));
      },
      "calm"_a = nb::none(),
      "The motion of what hands, vehicles or robots move.\n\n"
      "Calm for a second on average, then for a third of one with five times the acceleration.\n\n"
      "Parameters\n----------\ncalm : ConstantVelocityMotion, optional\n    The calm motion.\n\n"
      "Returns\n-------\nMotionModels\n    Both, with rates and start.\n");
  using S = MovingObjectSettings;
  Settings<S>(m, "MovingObjectSettings", "Settings of `MovingObjectFilter`.")
      .field("max_hypotheses", &S::max_hypotheses, "int",
             "Largest number of hypotheses for the place of the object.")
      .field("explained_probability", &S::explained_probability, "float",
             "Quantile within which a hypothesis explains a component of an observation; one that "
             "none explains starts a hypothesis.")
      .field("default_clutter", &S::default_clutter, "float",
             "Weight of clutter for a noise model without clutter.")
      .field("isolated_clutter", &S::isolated_clutter, "float",
             "Part of clutter that stands alone; the rest comes in runs.")
      .field("recurring_clutter", &S::recurring_clutter, "float",
             "Part of runs that are at the place of another hypothesis.")
      .field("turned_clutter", &S::turned_clutter, "float",
             "Part of clutter that is at the place of the object in any orientation.")
      .field("lost_rate", &S::lost_rate, "float",
             "Rate at which the object is anywhere at once, whatever its model says [1/s].")
      .field("merge_rotation_rad", &S::merge_rotation_rad, "float",
             "Angle within which hypotheses merge [rad].")
      .field("merge_translation_m", &S::merge_translation_m, "float",
             "Distance within which hypotheses merge [m].")
      .field("merge_probability", &S::merge_probability, "float",
             "Quantile within which hypotheses must lie of each other to merge.")
      .field("noise_scale_detections", &S::noise_scale_detections, "float",
             "Number of detections that the noise as given counts as; infinity: it is not learned.")
      .field("least_noise_scale", &S::least_noise_scale, "float",
             "Least value of the learned scale.")
      .field("slow_error_gain", &S::slow_error_gain, "float",
             "Factor of the gain of the slow error where the noise is a typical one.")
      .done();
}

void bind_cameras(nb::module_& m) {
  using F = KnownFrame;
  Record<F>(m, "KnownFrame", "A frame with a known pose: a camera, a gripper, a hand.")
      .field("pose", &F::pose, "posemix.lie.SE3", "T_world_frame.")
      .field("covariance", &F::covariance, kFloatArray,
             "Shape (6, 6): covariance of the part of the error that is drawn anew for every "
             "image, perturbation on the left, world frame; zero is exact.")
      .constructible(0)
      .done();
  using C = KnownCamera;
  Record<C>(m, "KnownCamera", "The camera of an observation; its pose is not corrected.")
      .field("frame", &C::frame, "KnownFrame", "T_world_camera.")
      .field("constant_covariance", &C::constant_covariance, kFloatArray,
             "Shape (6, 6): covariance of the part of the error that is the same for all images, "
             "perturbation on the left, world frame.")
      .constructible(0)
      .done();
  m.def(
      "exact_camera",
      [](const Argument<SE3d>& camera) { return exact_camera(camera.as("world_camera")); },
      "world_camera"_a, "A KnownCamera whose pose T_world_camera is exact.");
  m.def(
      "still_camera",
      [](const Argument<ConcentratedSE3>& camera) {
        return still_camera(camera.as("world_camera", kOneDensity));
      },
      "world_camera"_a,
      "A KnownCamera that does not move, and whose pose T_world_camera has one error for good.");
  m.def(
      "camera_on_arm",
      [](const Argument<ConcentratedSE3>& camera, const std::optional<ArrayLike>& constant) {
        return camera_on_arm(camera.as("world_camera", kOneDensity),
                             constant ? constant->as<Matrix6d>("constant") : Matrix6d::Zero());
      },
      "world_camera"_a, "constant"_a = nb::none(),
      "A KnownCamera whose pose T_world_camera has an error that is drawn anew for every image.\n\n"
      "Parameters\n----------\nworld_camera : ConcentratedGaussian\n    T_world_camera.\n"
      "constant : array_like, shape (6, 6), optional\n"
      "    Covariance of the part that is the same for all images, world frame.\n");
}

}  // namespace

void bind_moving_object_settings(nb::module_& m) {
  bind_motions(m);
  bind_models(m);
  bind_cameras(m);
}

}  // namespace posemix::python
