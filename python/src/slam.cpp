// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/object_slam.hpp"

#include <fmt/ranges.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "copies.hpp"
#include "frame_input.hpp"
#include "slam_state.hpp"

namespace posemix::python {
namespace {

constexpr const char* kSlamDoc =
    R"(Live estimation of camera and objects.

A step predicts, updates, reduces and summarises; objects seen for the first time are added after the
update. Frames without detections or without odometry are valid.

Parameters
----------
camera : ConcentratedGaussian
    Prior of T_world_camera at the first frame.
objects : sequence of ObjectModel
    Models of the objects that may be detected.
settings : ObjectSlamSettings, optional
    Filter and motion model.

Raises
------
ValueError
    When a setting is out of range or models of one class differ.

Examples
--------
>>> from posemix import SE3, ConcentratedGaussian, FrameInput, ObjectModel, ObjectSlam, pose_covariance
>>> camera = ConcentratedGaussian(SE3(), pose_covariance(0.001, 0.002))
>>> slam = ObjectSlam(camera, [ObjectModel(id="mug"), ObjectModel(id="box")])
>>> estimate = slam.step(FrameInput(detections={"mug": SE3(translation=[0, 0, 0.8])}))
>>> estimate
<FrameEstimate of 2 objects, seen: mug>
>>> estimate.report.statuses
[DetectionStatus.started, DetectionStatus.none]
>>> moved = SE3(translation=[0.01, 0, 0])
>>> estimate = slam.step(FrameInput(0.1, moved, {"mug": SE3(translation=[-0.01, 0, 0.8])}))
>>> estimate.object("mug").status
DetectionStatus.used
>>> float(estimate.objects["mug"].mean.translation[2].round(3))
0.8
)";

constexpr const char* kStepDoc = R"(Processes the next frame; the first one is not predicted.

Raises
------
ValueError
    When the numbers of detections and object models differ, dt is not positive after the first frame, or
    there are candidates for a filter other than the multi-object filter.
)";

/// @throws InvalidInput for another tracker, naming what was asked for
const MultiObjectSlam& multi_object_of(const ObjectSlam& slam, const char* what) {
  const auto* tracker = std::get_if<MultiObjectSlam>(&slam.tracker());
  if (tracker == nullptr) {
    throw InvalidInput(
        fmt::format("ObjectSlam.{} is there with MultiObjectSlamSettings alone", what));
  }
  return *tracker;
}

std::string slam_text(const ObjectSlam& slam) {
  std::vector<std::string> seen;
  for (std::size_t j = 0; j < slam.objects().size(); ++j)
    if (slam.pose_index(j)) seen.push_back(slam.objects()[j].id);
  return fmt::format("<ObjectSlam of {} objects, seen: {}>", slam.objects().size(),
                     seen.empty() ? "none" : fmt::format("{}", fmt::join(seen, ", ")));
}

}  // namespace

void bind_slam(nb::module_& m) {
  using S = ObjectSlam;
  nb::class_<S> slam(m, "ObjectSlam", kSlamDoc);
  slam.def(
      "__init__",
      [](S* self, const Argument<ConcentratedSE3>& camera, const Argument<Models>& objects,
         const std::optional<ObjectSlamSettings>& settings) {
        new (self) S(camera.as("camera", kOneDensity), models_of(objects, "objects"),
                     settings.value_or(ObjectSlamSettings{}));
      },
      "camera"_a, "objects"_a, "settings"_a = nb::none());
  slam.def(
          "step",
          [](S& self, const Argument<NamedInput>& input) {
            return self.step(input.as("input", "a FrameInput").of(self.objects()));
          },
          "input"_a, kStepDoc)
      .def("forget", &S::forget, "object"_a,
           "Forgets the object at an index: its next sighting begins it anew. All else stays as it "
           "is.\n\n"
           "Raises\n------\nValueError\n    For an index that there is not, and another tracker "
           "than the multi-object filter.\n")
      .def_prop_ro(
          "ids",
          [](const S& self) {
            std::vector<std::string> ids;
            for (const ObjectModel& model : self.objects()) ids.push_back(model.id);
            return ids;
          },
          "Ids of the object models, in their order.")
      .def_prop_ro(
          "objects", [](const S& self) { return frozen(self.objects()); },
          nb::for_getter(nb::sig("def objects(self, /) -> collections.abc.Sequence[ObjectModel]")),
          "Copies of the object models, which cannot be changed.")
      .def_prop_ro(
          "posterior", &S::posterior,
          "The joint posterior; for the multi-object filter that of camera and leading hypotheses.")
      .def_prop_ro(
          "estimate", [](const S& self) { return self.estimate(); },
          "The Gaussian over all poses; pose 0 is the camera, see `pose_index`.")
      .def("pose_index", &S::pose_index, "object"_a,
           "Index of the object's pose in the estimate; None before its first detection.")
      .def("detections", &S::detections, "object"_a,
           "Number of detections that have updated the object, candidates included.")
      .def(
          "existence",
          [](const S& self, std::size_t object) {
            return multi_object_of(self, "existence").existence(object);
          },
          "object"_a,
          "Probability that the object exists; None before its first detection, and 1 with a "
          "prior.")
      .def(
          "is_confirmed",
          [](const S& self, std::size_t object) {
            return multi_object_of(self, "is_confirmed").is_confirmed(object);
          },
          "object"_a,
          "Whether its existence reaches `ExistenceSettings.confirmed_probability`, with enough "
          "detections.")
      .def(
          "instance_counts",
          [](const S& self, std::size_t object) {
            return multi_object_of(self, "instance_counts").instance_counts(object);
          },
          "object"_a, "Number of detections of the object, for `fit_existence`.")
      .def(
          "object_at",
          [](const S& self, std::size_t object, double dt) {
            return multi_object_of(self, "object_at").object_at(object, dt);
          },
          "object"_a, "dt"_a,
          "T_world_object `dt` seconds after the last frame, as far as it is known by then; None "
          "before its first detection.")
      .def_prop_ro(
          "multi_object",
          [](const S& self) -> std::optional<MultiObjectFilter> {
            if (self.multi_object() == nullptr) return std::nullopt;
            return *self.multi_object();
          },
          "A copy of the multi-object filter; None for another tracker.")
      .def("__repr__", &slam_text);
  bind_state_of(slam);
  with_copies(slam);
}

}  // namespace posemix::python
