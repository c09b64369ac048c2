// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/stamped_slam.hpp"

#include <algorithm>

#include <fmt/ranges.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "argument.hpp"
#include "arrays.hpp"
#include "copies.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "slam.hpp"
#include "slam_state.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

constexpr const char* kStampedSlamDoc =
    R"(Object SLAM by stamps: observations and odometry come late and in any order.

The result is that of the inputs sorted by their stamps, whatever the order in which they come, to
the last bit, as long as none is older than the history. Observations newer than the odometry wait
for it.

Parameters
----------
body : ConcentratedGaussian
    Prior of T_world_body at the first stamp; the body is the camera where there is one.
objects : sequence of ObjectModel
    The objects.
settings : MultiObjectSlamSettings, optional
    Filter, association, cameras of the body.
motion : MotionSettings, optional
    Motion model of the body.
stamped : StampedSlamSettings, optional
    History, and stamps that jump.
record_hypotheses : bool, optional
    Whether every estimate holds the alternatives of every object.

Raises
------
ValueError
    When a setting is out of range or models do not fit each other.

Examples
--------
>>> from posemix import (SE3, ConcentratedGaussian, ObjectModel, Observation, ObservationComponent,
...                      StampedSlam, pose_covariance)
>>> slam = StampedSlam(ConcentratedGaussian(SE3(), pose_covariance(0.001, 0.002)), [ObjectModel(id="mug")])
>>> for stamp in (10.0, 10.1):
...     _ = slam.add_odometry(stamp, SE3())
>>> late = Observation([ObservationComponent(SE3(translation=[0, 0, 0.8]))], object="mug", stamp_s=10.05)
>>> slam.add(late)
StampAdmission.replayed
>>> slam.estimate().estimate.objects["mug"].mean.translation.round(2)
array([0. , 0. , 0.8])
)";

void bind_stamps(nb::module_& m) {
  Words<StampJump>(m, "StampJump", "Answer to a stamp that lies far before the newest one.")
      .value(StampJump::refuse, "ValueError.")
      .value(StampJump::reset, "All is forgotten, and begins with that stamp.");
  Words<StampAdmission>(m, "StampAdmission", "Fate of an input.")
      .value(StampAdmission::taken, "Newer than all before.")
      .value(StampAdmission::replayed, "Late, and what came after it is played again.")
      .value(StampAdmission::too_late, "Older than the history, and left out.");
  using S = StampedSlamSettings;
  Settings<S>(m, "StampedSlamSettings", "Settings of StampedSlam.")
      .field("history_s", &S::history_s, "float",
             "Inputs that are up to so much older than the newest stamp are taken in at their own "
             "time [s]; older ones are refused and counted.")
      .field("jump_back_s", &S::jump_back_s, "float",
             "A stamp that is older by more than this has jumped back [s].")
      .field("on_jump_back", &S::on_jump_back, "StampJump",
             "Answer to a stamp that has jumped back.")
      .field("jump_ahead_s", &S::jump_ahead_s, "float",
             "A stamp may be so much newer than the newest before it [s].")
      .field("checkpoints", &S::checkpoints, "int",
             "Copies of the state over the history from which it is played again.")
      .done();
  using C = StampCounts;
  Record<C>(m, "StampCounts", "Number of inputs by what became of them.")
      .field("taken", &C::taken, "int", "Newer than all before.")
      .field("replayed", &C::replayed, "int", "Late, within the history.")
      .field("too_late", &C::too_late, "int", "Refused.")
      .field("resets", &C::resets, "int", "Number of resets.")
      .done();
  using E = EstimateAtStamp;
  Record<E>(m, "EstimateAtStamp", "An estimate and its time.")
      .made_from([] {
        return E{0.0, {unit_density(), {}, {}, {}}};
      })
      .field("stamp_s", &E::stamp_s, "float", "Time of the estimate [s].")
      .field("estimate", &E::estimate, "FrameEstimate", "The estimate.")
      .done();
}

}  // namespace

void bind_stamped_slam(nb::module_& m) {
  bind_stamps(m);
  using S = StampedSlam;
  nb::class_<S> slam(m, "StampedSlam", kStampedSlamDoc);
  slam.def(
      "__init__",
      [](S* self, const Argument<ConcentratedSE3>& body, const Argument<Models>& objects,
         const std::optional<MultiObjectSlamSettings>& settings,
         const std::optional<MotionSettings>& motion,
         const std::optional<StampedSlamSettings>& stamped, bool record) {
        new (self)
            S(body.as("body", kOneDensity), models_of(objects, "objects"),
              settings.value_or(MultiObjectSlamSettings{}), motion.value_or(MotionSettings{}),
              stamped.value_or(StampedSlamSettings{}), record);
      },
      "body"_a, "objects"_a, "settings"_a = nb::none(), "motion"_a = nb::none(),
      "stamped"_a = nb::none(), "record_hypotheses"_a = false);
  slam.def("add", &S::add, "observation"_a,
           "Takes in an observation at its stamp.\n\n"
           "Raises\n------\nValueError\n    For an observation that is not valid, names what is "
           "not known, or whose stamp has jumped; nothing is changed.\n")
      .def(
          "add_odometry",
          [](S& self, double stamp_s, const Argument<SE3d>& odom_body) {
            return self.add_odometry(stamp_s, odom_body.as("odom_body"));
          },
          "stamp_s"_a, "odom_body"_a,
          "Takes in T_odom_body at a time [s].\n\n"
          "Raises\n------\nValueError\n    For a stamp that has jumped or has a pose already; "
          "nothing is changed.\n")
      .def("add_image",
           nb::overload_cast<double, const std::string&, const std::optional<std::string>&>(
               &S::add_image),
           "stamp_s"_a, "camera"_a = "", "detector"_a = nb::none(),
           "Takes in that nothing was detected in an image of a camera at a time [s], by one "
           "detector or, without its name, by any.\n\n"
           "Objects that should be seen in it may be gone. Images with observations need not be "
           "told.\n\n"
           "Raises\n------\nValueError\n    For a camera that there is not, a stamp that has "
           "jumped, and where CAMERA@DETECTOR names an image of another camera; nothing is "
           "changed.\n")
      .def("add_frame", &S::add_frame, "name"_a, "stamp_s"_a, "frame"_a,
           "Takes in T_world_frame of a frame that may hold objects, at a time [s].\n\n"
           "Raises\n------\nValueError\n    For a name that there is not, and a stamp that has "
           "jumped or has a pose already; nothing is changed.\n")
      .def(
          "forget",
          [](S& self, const std::string& id, std::optional<double> stamp_s) {
            return self.forget(id, stamp_s);
          },
          "id"_a, "stamp_s"_a = nb::none(),
          "Forgets an object as of a time [s], by default that of the newest stamp.\n\n"
          "Sightings of it until then do not count any more, however late they come; its first one "
          "after it begins it anew. All else stays as it is.\n\n"
          "Raises\n------\nValueError\n    For an id that there is not, and a stamp that has "
          "jumped; nothing is changed.\n")
      .def(
          "estimate", [](S& self) { return self.estimate(); },
          "The estimate at the newest stamp; with odometry, at the newest that odometry has "
          "reached. None before the first.")
      .def(
          "finish", [](S& self) { return self.finish(); },
          "The same with the observations that wait for odometry, as frames without it.")
      .def(
          "hypotheses",
          [](const S& self, const std::string& id) {
            const auto& models = self.slam().objects();
            const auto found =
                std::ranges::find(models, id, [](const ObjectModel& model) { return model.id; });
            if (found == models.end()) {
              std::vector<std::string> ids;
              for (const ObjectModel& model : models) ids.push_back(model.id);
              throw InvalidInput(fmt::format("no object is called '{}'; expected one of {}", id,
                                             fmt::join(ids, ", ")));
            }
            return self.slam().hypotheses(static_cast<std::size_t>(found - models.begin()));
          },
          "id"_a,
          "Hypotheses of an object, whether it moves or not, at the stamp of the last estimate; "
          "none "
          "until it was seen.")
      .def(
          "object_at",
          [](S& self, const std::string& id, double stamp_s) {
            return self.object_at(id, stamp_s);
          },
          "id"_a, "stamp_s"_a,
          "T_world_object at a stamp that is not before that of the estimate, as far as it is "
          "known "
          "by then; None until the object was seen.")
      .def_prop_ro(
          "cameras", [](const S& self) { return frozen(self.slam().estimated_cameras()); },
          nb::for_getter(nb::sig("def cameras(self, /) -> collections.abc.Sequence[BodyCamera]")),
          "Cameras of the rig as they are known by now: estimates of those with a covariance.")
      .def_prop_ro(
          "objects", [](const S& self) { return frozen(self.slam().objects()); },
          nb::for_getter(nb::sig("def objects(self, /) -> collections.abc.Sequence[ObjectModel]")),
          "Copies of the object models, which cannot be changed, with those of objects on sight.")
      .def_prop_ro(
          "counts", [](const S& self) { return self.counts(); }, "Inputs by what became of them.")
      .def_prop_ro("waiting", &S::waiting,
                   "Number of observations that wait for odometry, or for the first pose of a "
                   "frame.")
      .def_prop_ro("missing_frames", &S::missing_frames,
                   "Names of the frames that may hold an object and had no pose so far: without "
                   "them there is no estimate.")
      .def_prop_ro(
          "multi_object", [](const S& self) { return MultiObjectFilter(self.slam().filter()); },
          "A copy of the multi-object filter at the stamp of the last estimate.");
  bind_state_of(slam);
  with_copies(slam);
}

}  // namespace posemix::python
