// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/evaluation.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "slam.hpp"

namespace posemix::python {
namespace {

nb::tuple errors_tuple(const PoseErrors& errors) {
  return nb::make_tuple(errors.position_rmse_m, errors.rotation_rmse_deg,
                        errors.position_log_rmse_m);
}

nb::dict object_dict(const ObjectMetrics& object) {
  nb::dict dict;
  dict["id"] = object.id;
  dict["world"] = errors_tuple(object.world);
  dict["relative"] = errors_tuple(object.relative);
  dict["detection_relative"] = errors_tuple(object.detection_relative);
  dict["detections"] = object.detections;
  dict["gated"] = object.gated;
  dict["right_mode_frames"] = object.right_mode_frames;
  dict["right_mode_share"] = object.right_mode_share;
  dict["right_mode_anees"] = object.right_mode_anees;
  dict["mode_probability"] = object.mode_probability;
  dict["forecasts"] = list_of(object.forecasts, [](const ModeForecast& forecast) {
    return nb::make_tuple(forecast.probability, forecast.right);
  });
  dict["relative_anees"] = object.relative_anees;
  return dict;
}

nb::tuple metrics_tuple(const Metrics& metrics) {
  const Timing& t = metrics.timing;
  return nb::make_tuple(
      metrics.frames, errors_tuple(metrics.camera), errors_tuple(metrics.odometry),
      list_of(metrics.objects, [](const ObjectMetrics& object) { return object_dict(object); }),
      nb::make_tuple(t.frame_median_us, t.update_median_us, t.reduce_median_us,
                     t.merges_per_frame));
}

using TruthAt = std::optional<SE3d> (*)(const Sequence&, std::size_t, std::size_t);

Array truth_rows(const Sequence& sequence, std::size_t object, TruthAt truth_at) {
  if (object >= sequence.objects.size()) {
    throw InvalidInput(fmt::format("there is no object {}; expected less than {}", object,
                                   sequence.objects.size()));
  }
  MaybePoses poses;
  for (std::size_t i = 0; i < sequence.stamps.size(); ++i)
    poses.push_back(truth_at(sequence, object, i));
  return rows_of(poses);
}

}  // namespace

void bind_evaluation(nb::module_& m) {
  nb::class_<Metrics>(m, "Metrics").def("values", &metrics_tuple);
  m.def("evaluate", [](const Sequence& sequence, const SlamRun& run) {
    const nb::gil_scoped_release unlocked;
    return evaluate(sequence, run);
  });
  m.def("true_relative_pose", [](const Sequence& sequence, std::size_t object) {
    return truth_rows(sequence, object, &true_relative_pose);
  });
  m.def("true_world_pose", [](const Sequence& sequence, std::size_t object) {
    return truth_rows(sequence, object, &true_world_pose);
  });
  m.def("squared_normalized_error", [](const ConcentratedSE3& estimate, const SE3d& truth) {
    return squared_normalized_error(estimate, truth);
  });
  m.def("on_right_mode",
        [](const SE3d& estimate, const SE3d& truth) { return on_right_mode(estimate, truth); });
}

}  // namespace posemix::python
