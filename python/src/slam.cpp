// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam.hpp"

#include <map>
#include <variant>

#include <fmt/ranges.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>

#include "array_like.hpp"
#include "posemix/slam/smoothing.hpp"
#include "record.hpp"

namespace posemix::python {

/// Detections of one frame, by the objects' ids or one entry per object model.
using Detections = std::variant<std::map<std::string, SE3d>, MaybePoses>;

template <>
struct SettingValue<Detections> {
  static nb::object get(const Detections& value) {
    if (const auto* by_id = std::get_if<0>(&value)) return nb::cast(*by_id);
    return PoseArray::of(rows_of(std::get<1>(value)), {std::get<1>(value).size()}).made;
  }
  static Detections set(nb::handle value, const std::string& name) {
    if (!nb::hasattr(value, "keys")) return SettingValue<MaybePoses>::set(value, name);
    const nb::object dict = nb::module_::import_("builtins").attr("dict")(value);
    return nb::cast<std::map<std::string, SE3d>>(dict);
  }
  static bool same(const Detections& a, const Detections& b) {
    return text(a) == text(b) && get(a).type().is(get(b).type());
  }
  static std::string text(const Detections& value) { return nb::repr(get(value)).c_str(); }
};

namespace {

/// `FrameInput` as Python gives it.
struct NamedInput {
  double dt = 0.0;
  std::optional<SE3d> motion = {};
  Detections detections = {};
  std::vector<Candidate> candidates = {};

  FrameInput of(const std::vector<ObjectModel>& models) const {
    if (const auto* poses = std::get_if<MaybePoses>(&detections))
      return {dt, motion, *poses, candidates};
    std::map<std::string, SE3d> left = std::get<0>(detections);
    MaybePoses poses;
    std::vector<std::string> ids;
    for (const ObjectModel& model : models) {
      const auto found = left.find(model.id);
      poses.push_back(found == left.end() ? std::nullopt : std::optional(found->second));
      if (found != left.end()) left.erase(found);
      ids.push_back(model.id);
    }
    if (!left.empty()) {
      throw InvalidInput(fmt::format("no object is called '{}'; expected one of {}",
                                     left.begin()->first, fmt::join(ids, ", ")));
    }
    return {dt, motion, std::move(poses), candidates};
  }
};

void bind_frame_input(nb::module_& m) {
  using N = NamedInput;
  Record<N>(m, "FrameInput",
            "Input of one frame. In the first frame `dt` and `motion` are ignored.")
      .field("dt", &N::dt, "float", "Time since the last frame, positive [s].")
      .field("motion", &N::motion, "posemix.lie.SE3 | None",
             "T_camera(k-1)_camera(k), from odometry.")
      .field(
          "detections", &N::detections,
          "collections.abc.Sequence[posemix.lie.SE3 | None] | "
          "collections.abc.Mapping[str, posemix.lie.SE3] | posemix.lie.SE3",
          "T_camera_object, one entry per object model; a mapping from ids holds those that were "
          "detected.")
      .field("candidates", &N::candidates, "collections.abc.Sequence[Candidate]",
             "Detections that name a class, for the multi-object filter.")
      .constructible(0)
      .done();
}

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

std::string slam_text(const ObjectSlam& slam) {
  std::vector<std::string> seen;
  for (std::size_t j = 0; j < slam.objects().size(); ++j)
    if (slam.pose_index(j)) seen.push_back(slam.objects()[j].id);
  return fmt::format("<ObjectSlam of {} objects, seen: {}>", slam.objects().size(),
                     seen.empty() ? "none" : fmt::format("{}", fmt::join(seen, ", ")));
}

/// Copies that are objects of their own.
template <class T>
nb::class_<T>& with_copies(nb::class_<T>& made) {
  made.def("__copy__", [](const T& self) { return T(self); });
  made.def("__deepcopy__", [](const T& self, const nb::dict& /*memo*/) { return T(self); });
  return made;
}

using Models = std::vector<ObjectModel>;

void bind_object_slam(nb::module_& m) {
  using S = ObjectSlam;
  nb::class_<S> slam(m, "ObjectSlam", kSlamDoc);
  slam.def(
      "__init__",
      [](S* self, const ConcentratedSE3& camera, const Models& objects,
         const std::optional<ObjectSlamSettings>& settings) {
        new (self) S(camera, objects, settings.value_or(ObjectSlamSettings{}));
      },
      "camera"_a, "objects"_a, "settings"_a = nb::none());
  slam.def(
          "step",
          [](S& self, const NamedInput& input) { return self.step(input.of(self.objects())); },
          "input"_a, kStepDoc)
      .def_prop_ro(
          "ids",
          [](const S& self) {
            std::vector<std::string> ids;
            for (const ObjectModel& model : self.objects()) ids.push_back(model.id);
            return ids;
          },
          "Ids of the object models, in their order.")
      .def_prop_ro(
          "objects", [](const S& self) { return self.objects(); }, "Copies of the object models.")
      .def_prop_ro(
          "posterior", &S::posterior,
          "The joint posterior; for the multi-object filter that of camera and leading hypotheses.")
      .def_prop_ro(
          "estimate", [](const S& self) { return self.estimate(); },
          "One Gaussian over all poses; pose 0 is the camera, see `pose_index`.")
      .def("pose_index", &S::pose_index, "object"_a,
           "Index of the object's pose in the estimate; None before its first detection.")
      .def("detections", &S::detections, "object"_a,
           "Number of detections that have updated the object, candidates included.")
      .def_prop_ro(
          "multi_object",
          [](const S& self) -> std::optional<MultiObjectFilter> {
            if (self.multi_object() == nullptr) return std::nullopt;
            return *self.multi_object();
          },
          "A copy of the multi-object filter; None for another tracker.")
      .def("__repr__", &slam_text);
  with_copies(slam);
}

constexpr const char* kSmootherDoc =
    R"(Object SLAM with smoothed estimates, each reported some frames later.

Parameters
----------
camera, objects, settings
    As for `ObjectSlam`; the filter must be the multi-object filter.
smoothing : SmoothingSettings
    Number of frames that the smoother looks ahead.
record_hypotheses : bool
    Whether estimates have the alternatives of every object.

Raises
------
ValueError
    As for `ObjectSlam`, when a setting is out of range, when the filter is not the multi-object filter,
    and when it only considers the camera.
)";

void bind_smoother(nb::module_& m) {
  using S = FixedLagSmoother;
  nb::class_<S> smoother(m, "FixedLagSmoother", kSmootherDoc);
  smoother.def(
      "__init__",
      [](S* self, const ConcentratedSE3& camera, const Models& objects,
         const SmoothingSettings& smoothing, const std::optional<ObjectSlamSettings>& settings,
         bool record) {
        new (self) S(camera, objects, settings.value_or(ObjectSlamSettings{}), smoothing, record);
      },
      "camera"_a, "objects"_a, "smoothing"_a, "settings"_a = nb::none(),
      "record_hypotheses"_a = false);
  smoother
      .def(
          "step",
          [](S& self, const NamedInput& input) {
            return self.step(input.of(self.slam().objects()));
          },
          "input"_a,
          "Processes the next frame; returns the estimate of the frame `lag_frames` earlier, if "
          "there is one.\n\n"
          "Raises\n------\nValueError\n    As for `ObjectSlam.step`, and for candidates.\n")
      .def("finish", &S::finish,
           "The estimates of the frames that have not been reported, after the last step.")
      .def_prop_ro(
          "slam", [](const S& self) { return ObjectSlam(self.slam()); },
          "A copy of the filter, which is at the last frame processed.")
      .def_prop_ro(
          "joint", [](const S& self) { return self.joint(); },
          "Joint density at the last frame reported: camera, its motion under constant velocity, "
          "objects.");
  with_copies(smoother);
}

constexpr const char* kAssociateDoc =
    R"(The one-to-one assignment of candidates to instances of their class with the least cost.

Parameters
----------
instances : sequence of ConcentratedGaussian
    Predicted T_camera_object of the instances.
candidates : sequence of Candidate
    Candidates of one class in one frame.
noise : NoiseComponent
    Noise of the detector for this class.
symmetries : SymmetryGroup, optional
    Symmetries of the class.
settings : AssociationSettings, optional
    Gate, and criterion for a new instance.

Raises
------
ValueError
    When a probability is not in (0, 1).
)";

constexpr const char* kAssignmentDoc =
    R"(A different column for each row of a cost matrix such that the sum of the entries is least.

Parameters
----------
cost : array_like, shape (rows, columns)
    Costs, finite, with at least as many columns as rows.

Examples
--------
>>> from posemix import least_cost_assignment
>>> least_cost_assignment([[1, 2], [1, 4]])
[1, 0]
)";

void bind_association_functions(nb::module_& m) {
  using A = Association;
  Record<A>(m, "Association", "What a candidate is.")
      .field("status", &A::status, "CandidateStatus",
             "Whether it is assigned to an instance, fresh, or rejected.")
      .field("instance", &A::instance, "int", "If assigned: index among the instances.")
      .field("camera_object", &A::camera_object, "posemix.lie.SE3",
             "If assigned: the equivalent pose nearest to the instance; otherwise the pose as "
             "detected.")
      .field("cost", &A::cost, "float", "If assigned: its part of the total cost.")
      .done();
  m.def(
      "associate",
      [](const std::vector<ConcentratedSE3>& instances, const std::vector<Candidate>& candidates,
         const NoiseComponent& noise, const std::optional<SymmetryGroup>& symmetries,
         const std::optional<AssociationSettings>& settings) {
        return associate(instances, candidates, noise, symmetries.value_or(SymmetryGroup{}),
                         settings.value_or(AssociationSettings{}));
      },
      "instances"_a, "candidates"_a, "noise"_a, "symmetries"_a = nb::none(),
      "settings"_a = nb::none(), kAssociateDoc);
  m.def(
      "least_cost_assignment",
      [](const ArrayLike& cost) { return least_cost_assignment(cost.as<Eigen::MatrixXd>("cost")); },
      "cost"_a, kAssignmentDoc);
}

}  // namespace

void bind_slam(nb::module_& m) {
  bind_frame_input(m);
  bind_object_slam(m);
  bind_smoother(m);
  bind_association_functions(m);
}

}  // namespace posemix::python
