// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/evaluation.hpp"

#include <utility>
#include <variant>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include "posemix/slam/job.hpp"

#include "record.hpp"
#include "slam.hpp"

namespace posemix::python {
namespace {

void bind_pose_errors(nb::module_& m) {
  using P = PoseErrors;
  Record<P>(m, "PoseErrors",
            "Root mean square errors over the frames with estimate and truth; None without any.")
      .field("position_rmse_m", &P::position_rmse_m, "float | None",
             "Euclidean distance of the positions [m].")
      .field("rotation_rmse_deg", &P::rotation_rmse_deg, "float | None",
             "Angle of the rotation between estimate and truth [deg].")
      .field("position_log_rmse_m", &P::position_log_rmse_m, "float | None",
             "Translation part of Log(T_est T_true^-1), the midway paper's number [m].")
      .done();
  using C = Consistency;
  Record<C>(m, "Consistency",
            "NEES per degree of freedom over the frames with estimate and truth: 1 when "
            "consistent; None without any.")
      .field("anees", &C::anees, "float | None", "Mean over the frames.")
      .field("median_nees", &C::median_nees, "float | None", "Median over the frames.")
      .field("rotation_anees", &C::rotation_anees, "float | None",
             "Mean of the rotation alone; None where none of it can be observed.")
      .field("position_anees", &C::position_anees, "float | None", "Mean of the position alone.")
      .done();
  using F = ModeForecast;
  Record<F>(m, "ModeForecast",
            "The probability that an estimate is on the right mode, and whether it was.")
      .field("probability", &F::probability, "float", "The probability.")
      .field("right", &F::right, "bool", "Whether the estimate was on the right mode.")
      .done();
}

void bind_paired_errors(nb::module_& m) {
  using M = PoseMedians;
  Record<M>(m, "PoseMedians", "Median errors of a pose; None without any frame.")
      .field("position_m", &M::position_m, "float | None",
             "Euclidean distance of the positions [m].")
      .field("rotation_deg", &M::rotation_deg, "float | None",
             "Angle of the rotation between estimate and truth [deg].")
      .done();
  using P = PairedErrors;
  Record<P>(m, "PairedErrors",
            "Errors of T_camera_object over the frames with estimate, detection and truth.")
      .field("frames", &P::frames, "int", "Number of these frames.")
      .field("estimate", &P::estimate, "PoseMedians", "Medians of the filtered poses.")
      .field("detection", &P::detection, "PoseMedians", "Medians of the detections.")
      .done();
}

void bind_object_metrics(nb::module_& m) {
  using O = ObjectMetrics;
  Record<O>(m, "ObjectMetrics", "Metrics of one object.")
      .field("id", &O::id, "str", "Name of the object.")
      .field("world", &O::world, "PoseErrors", "Errors of T_world_object.")
      .field("relative", &O::relative, "PoseErrors", "Errors of T_camera_object as filtered.")
      .field("detection_relative", &O::detection_relative, "PoseErrors",
             "Errors of T_camera_object as detected.")
      .field("paired", &O::paired, "PairedErrors",
             "Medians of T_camera_object as filtered and as detected over the same frames.")
      .field("detections", &O::detections, "int", "Frames with a detection.")
      .field("gated", &O::gated, "int", "Detections left out by the gate.")
      .field("unexplained", &O::unexplained, "int",
             "Detections that the filter could not explain: gated, doubted, or the birth of a "
             "hypothesis.")
      .field("right_mode_frames", &O::right_mode_frames, "int",
             "Frames within 20 deg and 10 cm of the truth.")
      .field("right_mode_share", &O::right_mode_share, "float | None",
             "Share of these frames among those with estimate and truth.")
      .field("right_mode_anees", &O::right_mode_anees, "float | None",
             "The measure `relative_anees` over these frames only.")
      .field("mode_probability", &O::mode_probability, "float | None",
             "Probability of the mode at the last frame.")
      .field("existence", &O::existence, "float | None",
             "Probability that the object exists, at the last frame, by the multi-object filter.")
      .field("health", &O::health, "TrackHealth | None", "State of the track at the last frame.")
      .field("health_shares", &O::health_shares, "list[float]",
             "Share of the frames in which the track is in each state, in the order of "
             "`TrackHealth`; empty without.")
      .field("forecasts", &O::forecasts, "list[ModeForecast]", "Forecasts, one per frame.")
      .field("relative_anees", &O::relative_anees, "float | None",
             "Mean of e^T P^-1 e over its degrees of freedom (6 without continuous symmetries), "
             "e = Log(T_true T_est^-1) of T_camera_object; 1 when consistent.")
      .field("relative_consistency", &O::relative_consistency, "Consistency",
             "Consistency of T_camera_object.")
      .field("world_consistency", &O::world_consistency, "Consistency",
             "Consistency of T_world_object.")
      .done();
}

using NamedErrors = std::vector<std::pair<std::string, PoseErrors>>;

NamedErrors named_errors(const Metrics& metrics) {
  NamedErrors named{{"camera", metrics.camera}, {"odometry", metrics.odometry}};
  for (const ObjectMetrics& object : metrics.objects) {
    named.emplace_back(object.id + " from the camera", object.relative);
    named.emplace_back(object.id + " as detected", object.detection_relative);
    named.emplace_back(object.id + " in the world", object.world);
  }
  return named;
}

std::string scaled(const std::optional<double>& value, double factor) {
  return value ? fmt::format("{:.4g}", factor * *value) : "-";
}

std::string text_of(const Metrics& metrics) {
  std::string text = fmt::format("Metrics of {} frames:", metrics.frames);
  for (const auto& [name, errors] : named_errors(metrics)) {
    text += errors.position_rmse_m
                ? fmt::format("\n  {}: {} mm, {} deg", name, scaled(errors.position_rmse_m, 1e3),
                              scaled(errors.rotation_rmse_deg, 1.0))
                : fmt::format("\n  {}: not known", name);
  }
  return text;
}

/// Tables of errors as HTML, for notebooks.
std::string html_of(const Metrics& metrics) {
  const nb::object escape = nb::module_::import_("html").attr("escape");
  std::string rows;
  for (const auto& [name, errors] : named_errors(metrics)) {
    rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>",
                        nb::cast<std::string>(escape(name)), scaled(errors.position_rmse_m, 1e3),
                        scaled(errors.rotation_rmse_deg, 1.0));
  }
  return fmt::format(
      "<table><caption>{} frames, {:.0f} us each</caption><thead><tr><th>pose</th><th>position "
      "RMSE "
      "[mm]</th><th>rotation RMSE [deg]</th></tr></thead><tbody>{}</tbody></table>",
      metrics.frames, metrics.timing.frame_median_us, rows);
}

void bind_metrics(nb::module_& m) {
  using T = Timing;
  Record<T>(m, "Timing", "Medians over the frames after the first, and means.")
      .field("frame_median_us", &T::frame_median_us, "float", "A frame [microseconds].")
      .field("update_median_us", &T::update_median_us, "float", "The update [microseconds].")
      .field("reduce_median_us", &T::reduce_median_us, "float", "The reduction [microseconds].")
      .field("merges_per_frame", &T::merges_per_frame, "float", "Mean number of merges.")
      .done();
  using M = Metrics;
  Record<M>(m, "Metrics", "Errors, consistency and timing of a run.")
      .field("frames", &M::frames, "int", "Frames of the run.")
      .field("camera", &M::camera, "PoseErrors", "Errors of T_world_camera as filtered.")
      .field("camera_consistency", &M::camera_consistency, "Consistency",
             "Consistency of T_world_camera.")
      .field("odometry", &M::odometry, "PoseErrors",
             "Errors of T_world_camera by the odometry alone.")
      .field("objects", &M::objects, "list[ObjectMetrics]",
             "Metrics of the objects, one entry each.")
      .field("timing", &M::timing, "Timing", "Cost of a frame.")
      .shown_as(&text_of)
      .done()
      .def("_repr_html_", &html_of, "Tables of errors, for notebooks.");
}

using TruthAt = std::optional<SE3d> (*)(const Sequence&, std::size_t, std::size_t);

/// A truth of one object over the frames of a recording.
auto over_frames(TruthAt truth_at) {
  return [truth_at](const Sequence& sequence, std::size_t object) {
    if (object >= sequence.objects.size()) {
      throw InvalidInput(fmt::format("there is no object {}; expected less than {}", object,
                                     sequence.objects.size()));
    }
    MaybePoses poses;
    for (std::size_t i = 0; i < sequence.stamps.size(); ++i)
      poses.push_back(truth_at(sequence, object, i));
    return PoseArray::of(rows_of(poses), {poses.size()});
  };
}

constexpr const char* kEvaluateDoc =
    R"(Errors of a run against the ground truth of its recording; None without ground truth.

Parameters
----------
sequence : Sequence or SlamJob
    The recording, or the job with it. With a job, the truth of an object is the nearest of the poses that its declared
    symmetries make equivalent.
run : SlamRun
    The result of the run.
)";

constexpr const char* kSquaredErrorDoc =
    R"(The NEES e^T P^-1 e, e = Log(X_true X_est^-1); if consistent, chi-square with 6 degrees of freedom.

Parameters
----------
estimate : ConcentratedGaussian
    Estimate of one pose.
truth : SE3
    The true pose.
)";

constexpr const char* kTruthDoc =
    R"(True T_camera_object of one object, computed from the ground truth that is known.

Parameters
----------
sequence : Sequence
    The recording.
object : int
    Index of the object.

Returns
-------
SE3, shape (n,)
    NaN in frames without ground truth.
)";

}  // namespace

void bind_evaluation(nb::module_& m) {
  bind_pose_errors(m);
  bind_paired_errors(m);
  bind_object_metrics(m);
  bind_metrics(m);
  m.def(
      "evaluate",
      [](const std::variant<Sequence, SlamJob>& given, const RecordedRun& run) {
        const nb::gil_scoped_release unlocked;
        const auto* job = std::get_if<SlamJob>(&given);
        return job != nullptr ? evaluate(*job, run) : evaluate(std::get<Sequence>(given), run);
      },
      "sequence"_a, "run"_a, kEvaluateDoc);
  m.def("true_relative_pose", over_frames(&true_relative_pose), "sequence"_a, "object"_a,
        kTruthDoc);
  m.def("true_world_pose", over_frames(&true_world_pose), "sequence"_a, "object"_a,
        "True T_world_object of one object; arguments and result as for `true_relative_pose`.");
  m.def(
      "squared_normalized_error",
      [](const ConcentratedSE3& estimate, const Argument<SE3d>& given) {
        const SE3d truth = given.as("truth");
        return squared_normalized_error(estimate, truth);
      },
      "estimate"_a, "truth"_a, kSquaredErrorDoc);
  m.def(
      "on_right_mode",
      [](const Argument<SE3d>& estimate, const Argument<SE3d>& truth) {
        return on_right_mode(estimate.as("estimate"), truth.as("truth"));
      },
      "estimate"_a, "truth"_a, "Whether a pose is within 20 deg and 10 cm of the truth.");
}

}  // namespace posemix::python
