// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/ranges.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include "setting_value.hpp"
#include "slam.hpp"

namespace posemix::python {
namespace {

/// Converts a value of C++ to an attribute in Python.
constexpr auto kCast = [](const auto& value) { return nb::cast(value); };

/// Values of the objects by their ids; empty if there are no values.
template <class Value, class Convert>
nb::dict by_id(const FrameEstimate& frame, const std::vector<Value>& values, Convert convert) {
  nb::dict all;
  for (std::size_t i = 0; i < values.size(); ++i)
    all[nb::str(frame.ids->at(i).c_str())] = convert(values[i]);
  return all;
}

/// The repr of a value's Python object, such as an enum's.
template <class Value>
std::string text_of(const Value& value) {
  return nb::repr(nb::cast(value)).c_str();
}

void bind_reports(nb::module_& m) {
  using C = CandidateReport;
  nb::class_<C>(m, "CandidateReport", "What became of a candidate.")
      .def_ro("status", &C::status, "Whether it is of an instance.")
      .def_ro("object", &C::object, "Index of the model that took it, where assigned or fresh.")
      .def_ro("recycled", &C::recycled, "Another instance was forgotten for it.")
      .def("__repr__", [](const C& self) {
        return fmt::format("CandidateReport(status={}, object={}, recycled={})",
                           text_of(self.status), text_of(self.object), text_of(self.recycled));
      });
  using R = FrameReport;
  nb::class_<R>(m, "FrameReport", "Report of one frame.")
      .def_ro("statuses", &R::statuses, "One per object model.")
      .def_ro("candidates", &R::candidates, "One per candidate.")
      .def_ro("update", &R::update, "Of the Gaussian-sum filter.")
      .def_ro("merges", &R::merges, "Hypotheses that became one with another.")
      .def_ro("seconds", &R::seconds, "Predict, update, reduce and summarise [s].")
      .def("__repr__", [](const R& self) {
        return fmt::format("FrameReport(statuses={}, candidates={}, merges={}, seconds={:.3g})",
                           text_of(self.statuses), text_of(self.candidates), self.merges,
                           self.seconds);
      });
}

void bind_hypotheses(nb::module_& m) {
  using H = HypothesisSnapshot;
  nb::class_<H>(m, "HypothesisSnapshot", "One hypothesis of one frame.")
      .def_ro("log_weight", &H::log_weight, "Its weight, normalised.")
      .def_prop_ro(
          "poses", [](const H& self) { return PoseArray::of(self.poses.poses()); },
          "Mean poses of camera and objects, an SE3 of shape (n,).");
  using A = ObjectAlternative;
  nb::class_<A>(m, "ObjectAlternative", "One alternative of one object at one frame.")
      .def_ro("probability", &A::probability, "Dependent detections counted once.")
      .def_prop_ro(
          "pose", [](const A& self) { return self.pose; }, "T_world_object.")
      .def_ro("id", &A::id, "The same from frame to frame.")
      .def("__repr__", [](const A& self) {
        return fmt::format("ObjectAlternative(probability={:.6g}, pose={}, id={})",
                           self.probability, text_of(self.pose), self.id);
      });
  using E = ObjectEstimate;
  nb::class_<E>(m, "ObjectEstimate", "The estimate of one object at one frame.")
      .def_prop_ro(
          "world", [](const E& self) { return self.world; },
          "T_world_object; None until it was seen.")
      .def_prop_ro(
          "relative", [](const E& self) { return self.relative; },
          "T_camera_object, with the cross-covariance.")
      .def_ro("mode_probability", &E::mode_probability,
              "That the estimate is on the right mode, by the multi-object filter.")
      .def_ro("alternatives", &E::alternatives, "Where hypotheses are recorded.")
      .def_ro("status", &E::status, "What became of the frame's detection.");
}

using FrameClass = nb::class_<FrameEstimate>;

std::string frame_text(const FrameEstimate& frame) {
  std::vector<std::string> seen;
  for (std::size_t i = 0; i < frame.objects.size(); ++i)
    if (frame.objects[i]) seen.push_back(frame.ids->at(i));
  return fmt::format("<FrameEstimate of {} objects, seen: {}>", frame.objects.size(),
                     seen.empty() ? "none" : fmt::format("{}", fmt::join(seen, ", ")));
}

void bind_poses(FrameClass& frame) {
  using F = FrameEstimate;
  constexpr auto kDensity = "posemix.density.ConcentratedGaussian[posemix.lie.SE3]";
  static const std::string objects =
      fmt::format("def objects(self, /) -> dict[str, {} | None]", kDensity);
  static const std::string relative =
      fmt::format("def relative(self, /) -> dict[str, {} | None]", kDensity);
  frame
      .def_prop_ro(
          "camera", [](const F& self) { return self.camera; }, "T_world_camera.")
      .def_prop_ro(
          "objects", [](const F& self) { return by_id(self, self.objects, kCast); },
          nb::for_getter(nb::sig(objects.c_str())),
          "T_world_object by id; None for an object that was not seen so far.")
      .def_prop_ro(
          "relative", [](const F& self) { return by_id(self, self.relative, kCast); },
          nb::for_getter(nb::sig(relative.c_str())),
          "T_camera_object by id, with the cross-covariance.");
}

void bind_modes(FrameClass& frame) {
  using F = FrameEstimate;
  frame
      .def_prop_ro(
          "mode_probabilities",
          [](const F& self) { return by_id(self, self.mode_probabilities, kCast); },
          nb::for_getter(nb::sig("def mode_probabilities(self, /) -> dict[str, float | None]")),
          "That the estimate is on the right mode, by id; by the multi-object filter.")
      .def_prop_ro(
          "alternatives", [](const F& self) { return by_id(self, self.alternatives, kCast); },
          nb::for_getter(
              nb::sig("def alternatives(self, /) -> dict[str, list[ObjectAlternative]]")),
          "Of every object by id, by the multi-object filter; where hypotheses are recorded.")
      .def_ro("hypotheses", &F::hypotheses,
              "Over all poses, by the other filters; where hypotheses are recorded.")
      .def_ro("pose_indices", &F::pose_indices,
              "Of the objects, in their order, in every hypothesis over all poses.");
}

void bind_frame(nb::module_& m) {
  using F = FrameEstimate;
  FrameClass frame(m, "FrameEstimate", "The estimates of one frame, objects by their ids.");
  bind_poses(frame);
  bind_modes(frame);
  frame.def_ro("report", &F::report, "What was done.")
      .def_prop_ro(
          "ids", [](const F& self) { return *self.ids; }, "Of the objects, in their order.")
      .def("object", &F::object, "id"_a,
           "All that is known of one object. ValueError for an id that there is not.")
      .def("__copy__", [](const F& self) { return F(self); })
      .def("__deepcopy__", [](const F& self, const nb::dict& /*memo*/) { return F(self); })
      .def("__repr__", &frame_text);
}

}  // namespace

void bind_frame_estimate(nb::module_& m) {
  bind_reports(m);
  bind_hypotheses(m);
  bind_frame(m);
}

}  // namespace posemix::python
