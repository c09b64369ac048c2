// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/ranges.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include "record.hpp"
#include "slam.hpp"

namespace posemix::python {

template <>
struct SettingValue<ObjectIds> {
  using Names = std::vector<std::string>;
  static nb::object get(const ObjectIds& ids) { return nb::cast(ids ? *ids : Names{}); }
  static ObjectIds set(nb::handle value, const std::string& /*name*/) {
    return std::make_shared<const Names>(nb::cast<Names>(value));
  }
  static bool same(const ObjectIds& a, const ObjectIds& b) { return get(a).equal(get(b)); }
  static std::string text(const ObjectIds& ids) { return nb::repr(get(ids)).c_str(); }
};

namespace {

constexpr const char* kMaybePose = "posemix.density.ConcentratedGaussian[posemix.lie.SE3] | None";
constexpr const char* kPosesById =
    "dict[str, posemix.density.ConcentratedGaussian[posemix.lie.SE3] | None]";

void bind_reports(nb::module_& m) {
  using C = CandidateReport;
  Record<C>(m, "CandidateReport", "Report on one candidate.")
      .field("status", &C::status, "CandidateStatus", "Result of the association.")
      .field("object", &C::object, "int | None",
             "Index of the model that took it, where assigned or fresh.")
      .field("recycled", &C::recycled, "bool", "Whether another instance was forgotten for it.")
      .done();
  using R = FrameReport;
  Record<R>(m, "FrameReport", "Report of one frame.")
      .field("statuses", &R::statuses, "list[DetectionStatus]",
             "Results of the detections, one per object model.")
      .field("candidates", &R::candidates, "list[CandidateReport]", "Reports, one per candidate.")
      .field("observations", &R::observations, "list[CandidateReport]",
             "Reports, one per observation.")
      .field("nis", &R::nis, "list[float | None]",
             "Squared Mahalanobis distances of the innovations, one per object model, with six "
             "degrees of freedom; empty where the tracker has none.")
      .field("update", &R::update, "UpdateReport", "Report of the Gaussian-sum filter.")
      .field("merges", &R::merges, "int", "Number of hypotheses that became one with another.")
      .field("seconds", &R::seconds, "float",
             "Time for prediction, update, reduction and summary [s].")
      .done();
}

void bind_hypotheses(nb::module_& m) {
  using H = HypothesisSnapshot;
  Record<H>(m, "HypothesisSnapshot", "One hypothesis of one frame.")
      .field("log_weight", &H::log_weight, "float", "Logarithm of the normalised weight.")
      .field("poses", &H::poses, "posemix.lie.SE3",
             "Mean poses of camera and objects, an SE3 of shape (n,).")
      .done();
  using A = ObjectAlternative;
  Record<A>(m, "ObjectAlternative", "One alternative of one object at one frame.")
      .field("probability", &A::probability, "float",
             "Weight in which dependent detections count once.")
      .field("pose", &A::pose, "posemix.lie.SE3", "T_world_object.")
      .field("id", &A::id, "int", "Number that is the same from frame to frame.")
      .done();
  using T = ObjectTwist;
  Record<T>(
      m, "ObjectTwist",
      "Twist of an object about its origin, along the world's axes; zero for models of motion "
      "without.")
      .field("mean", &T::mean, "numpy.typing.NDArray[numpy.float64]",
             "Turning rate [rad/s] and velocity [m/s], shape (6,).")
      .field("covariance", &T::covariance, "numpy.typing.NDArray[numpy.float64]",
             "Covariance of the same, shape (6, 6).")
      .done();
  using E = ObjectEstimate;
  Record<E>(m, "ObjectEstimate", "The estimate of one object at one frame.")
      .field("world", &E::world, kMaybePose, "T_world_object; None until it was seen.")
      .field(
          "relative", &E::relative, kMaybePose,
          "T_camera_object over the frames, including the cross-covariance of camera and object.")
      .field("mode_probability", &E::mode_probability, "float | None",
             "Probability that the estimate is on the right mode, by the multi-object filter.")
      .field(
          "existence", &E::existence, "float | None",
          "Probability that there is such an object, by the multi-object filter; None before its "
          "first detection.")
      .field("health", &E::health, "TrackHealth", "State of the track.")
      .field("register_again", &E::register_again, "bool",
             "Whether the track is lost or inconsistent for some time.")
      .field("motion_models", &E::motion_models, "list[float]",
             "Probabilities of the models of motion of an object that moves.")
      .field("twist", &E::twist, "ObjectTwist | None", "Twist of an object that moves.")
      .field("alternatives", &E::alternatives, "list[ObjectAlternative]",
             "Alternatives, where hypotheses are recorded.")
      .field("status", &E::status, "DetectionStatus", "Result of the frame's detection.")
      .done();
}

std::string frame_text(const FrameEstimate& frame) {
  std::vector<std::string> seen;
  for (std::size_t i = 0; i < frame.objects.size(); ++i)
    if (frame.objects[i]) seen.push_back(frame.ids->at(i));
  return fmt::format("<FrameEstimate of {} objects, seen: {}>", frame.objects.size(),
                     seen.empty() ? "none" : fmt::format("{}", fmt::join(seen, ", ")));
}

/// Values of the objects by their ids; the dict is empty where there are no values.
template <class Value>
auto by_id(std::vector<Value> FrameEstimate::*member) {
  return [member](const FrameEstimate& frame) {
    nb::dict all;
    for (std::size_t i = 0; i < (frame.*member).size(); ++i) {
      const Value& value = (frame.*member)[i];
      all[nb::cast(frame.ids->at(i))] = nb::cast(value);
    }
    return all;
  };
}

/// Values by id, None for every object where there are no values.
auto none_or_by_id(std::vector<std::optional<double>> FrameEstimate::*member) {
  return [member](const FrameEstimate& frame) {
    nb::dict all = by_id(member)(frame);
    if (nb::len(all) == 0 && frame.ids)
      for (const std::string& id : *frame.ids) all[nb::cast(id)] = nb::none();
    return all;
  };
}

void bind_frame(nb::module_& m) {
  using F = FrameEstimate;
  Record<F>(m, "FrameEstimate", "The estimates of one frame, objects by their ids.")
      .made_from([] {
        return F{unit_density(), {}, {}, {}};
      })
      .field("camera", &F::camera, "posemix.density.ConcentratedGaussian[posemix.lie.SE3]",
             "T_world_camera.")
      .field("objects", &F::objects, kPosesById,
             "T_world_object by id; None for an object that was not seen so far.",
             by_id(&F::objects))
      .field("relative", &F::relative, kPosesById,
             "T_camera_object by id, with the cross-covariance.", by_id(&F::relative))
      .field(
          "mode_probabilities", &F::mode_probabilities, "dict[str, float | None]",
          "Probability that the estimate is on the right mode, by id; None for an object that was "
          "not seen so far, and with another filter than the multi-object filter.",
          none_or_by_id(&F::mode_probabilities))
      .field("existences", &F::existences, "dict[str, float | None]",
             "Probability that the object exists, by id; None likewise.",
             none_or_by_id(&F::existences))
      .field("healths", &F::healths, "dict[str, TrackHealth]",
             "State of the track by id, by the multi-object filter.", by_id(&F::healths))
      .field("register_again", &F::register_again, "dict[str, bool]",
             "Whether the track is lost or inconsistent for some time, by id, by the multi-object "
             "filter.",
             by_id(&F::register_again))
      .field("motion_models", &F::motion_models, "dict[str, list[float]]",
             "Probabilities of the models of motion by id; empty for objects that do not move.",
             by_id(&F::motion_models))
      .field("twists", &F::twists, "dict[str, ObjectTwist | None]",
             "Twists by id; None for objects that do not move, or were not seen so far.",
             by_id(&F::twists))
      .field("alternatives", &F::alternatives, "dict[str, list[ObjectAlternative]]",
             "Alternatives by id, by the multi-object filter where hypotheses are recorded.",
             by_id(&F::alternatives))
      .field("hypotheses", &F::hypotheses, "list[HypothesisSnapshot]",
             "Hypotheses over all poses, by the other filters where hypotheses are recorded.")
      .field("pose_indices", &F::pose_indices, "list[int | None]",
             "Indices of the objects, in their order, in every hypothesis over all poses.")
      .field("report", &F::report, "FrameReport", "Report of the frame.")
      .field("ids", &F::ids, "list[str]", "Ids of the objects, in their order.")
      .shown_as(&frame_text)
      .done()
      .def("object", &F::object, "id"_a,
           "All that is known of one object; raises ValueError for another id.");
}

}  // namespace

void bind_frame_estimate(nb::module_& m) {
  bind_reports(m);
  bind_hypotheses(m);
  bind_frame(m);
}

}  // namespace posemix::python
