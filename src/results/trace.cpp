// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>

#include "draw/position_covariance.hpp"
#include "io/json_numbers.hpp"
#include "posemix/results/results.hpp"
#include "trace_names.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr int kPoseDigits = 9;
constexpr int kCompactDigits = 7;

Json poses_of(const std::vector<std::optional<SE3d>>& poses) {
  Json array = Json::array();
  for (const auto& pose : poses) array.push_back(json_pose(pose, kPoseDigits));
  return array;
}

/// [xx, xy, xz, yy, yz, zz] of the position's covariance.
Json position_covariance_of(const PoseDensity& density) {
  const Eigen::Matrix3d covariance = position_covariance(density);
  Eigen::Matrix<double, 6, 1> upper;
  upper << covariance(0, 0), covariance(0, 1), covariance(0, 2), covariance(1, 1), covariance(1, 2),
      covariance(2, 2);
  return json_vector(upper, kCompactDigits);
}

/// The upper triangle of a covariance, row by row.
Json upper_triangle_of(const Matrix6d& covariance) {
  Eigen::Matrix<double, 21, 1> upper;
  Eigen::Index next = 0;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = i; j < 6; ++j) upper[next++] = covariance(i, j);
  }
  return json_vector(upper, kPoseDigits);
}

Json vector_of(const Eigen::Vector3d& vector) { return json_vector(vector, kPoseDigits); }

/// The symmetries of an object: its motions, and the axes of free rotation.
Json symmetries_of(const SymmetryGroup& group) {
  Json elements = Json::array();
  for (const SE3d& element : group.elements()) elements.push_back(json_pose(element, kPoseDigits));
  Json axes = Json::array();
  for (const SymmetryAxis& axis : group.axes()) {
    axes.push_back({{"direction", vector_of(axis.direction)}, {"point_m", vector_of(axis.point)}});
  }
  return {{"elements", std::move(elements)}, {"axes", std::move(axes)}};
}

/// Means and standard deviations of one pose over the frames.
class Track {
 public:
  void add(const std::optional<PoseDensity>& density) {
    poses_.push_back(density ? json_pose(density->mean(), kPoseDigits) : Json(nullptr));
    sds_.push_back(density
                       ? json_vector(density->covariance().diagonal().cwiseSqrt(), kCompactDigits)
                       : Json(nullptr));
    positions_.push_back(density ? position_covariance_of(*density) : Json(nullptr));
    covariances_.push_back(density ? upper_triangle_of(density->covariance()) : Json(nullptr));
  }

  Json json() && {
    return {{"pose", std::move(poses_)},
            {"sd", std::move(sds_)},
            {"position_covariance", std::move(positions_)},
            {"covariance", std::move(covariances_)}};
  }

 private:
  Json poses_ = Json::array();
  Json sds_ = Json::array();
  Json positions_ = Json::array();
  Json covariances_ = Json::array();
};

Json truth_or_null(const std::vector<std::optional<SE3d>>& truth) {
  const bool known =
      std::any_of(truth.begin(), truth.end(), [](const auto& pose) { return pose.has_value(); });
  return known ? poses_of(truth) : Json(nullptr);
}

Json camera_of(const SlamJob& job, const SlamRun& run) {
  Track track;
  for (const FrameEstimate& frame : run.frames) track.add(frame.camera);
  Json camera = std::move(track).json();
  camera["truth"] = truth_or_null(job.sequence.camera_truth);
  return camera;
}

/// The most probable alternatives of one object at one frame.
Json alternatives_of(std::vector<ObjectAlternative> list, std::size_t most) {
  std::stable_sort(list.begin(), list.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  if (list.size() > most) list.resize(most);
  Json array = Json::array();
  for (const ObjectAlternative& alternative : list) {
    array.push_back({{"id", alternative.id},
                     {"probability", rounded(alternative.probability, kCompactDigits)},
                     {"pose", json_pose(alternative.pose, kCompactDigits)}});
  }
  return array;
}

/// The equivalent truth that is nearest to the estimate, where there is one.
std::optional<SE3d> nearest_truth(const ErrorReduction& reduction, const std::optional<SE3d>& truth,
                                  const std::optional<PoseDensity>& estimate) {
  if (!truth || !estimate) return truth;
  return reduction.nearest(*truth, estimate->mean());
}

/// Puts the motion of an object that moves into its part of the trace.
void add_motion(const SlamJob& job, const SlamRun& run, std::size_t object, Json& json) {
  const MotionModels& motion = job.models[object].motion;
  if (!has_own_track(motion)) return;
  Json names = Json::array();
  for (const ObjectMotion& model : motion.models) names.push_back(name_of(model));
  Json models = Json::array();
  Json twists = Json::array();
  Json sds = Json::array();
  for (const FrameEstimate& frame : run.frames) {
    const bool known = object < frame.twists.size() && frame.twists[object];
    models.push_back(known ? Json::array() : Json(nullptr));
    if (known) {
      for (const double probability : frame.motion_models[object])
        models.back().push_back(rounded(probability, kCompactDigits));
    }
    twists.push_back(known ? json_vector(frame.twists[object]->mean, kCompactDigits)
                           : Json(nullptr));
    sds.push_back(
        known ? json_vector(frame.twists[object]->covariance.diagonal().cwiseSqrt(), kCompactDigits)
              : Json(nullptr));
  }
  json["model_names"] = std::move(names);
  json["models"] = std::move(models);
  json["twist"] = std::move(twists);
  json["twist_sd"] = std::move(sds);
}

/// Puts existence and health of an object into its part of the trace, where the tracker has them.
void add_health(const SlamRun& run, std::size_t object, Json& json) {
  const auto has = [](const FrameEstimate& frame) { return !frame.healths.empty(); };
  if (std::none_of(run.frames.begin(), run.frames.end(), has)) return;
  Json existences = Json::array();
  Json healths = Json::array();
  Json register_again = Json::array();
  for (const FrameEstimate& frame : run.frames) {
    // Objects on sight are unknown to earlier frames.
    const bool known = object < frame.healths.size();
    existences.push_back(known && frame.existences[object]
                             ? Json(rounded(*frame.existences[object], kCompactDigits))
                             : Json(nullptr));
    healths.push_back(word_of(known ? frame.healths[object] : TrackHealth::none));
    register_again.push_back(known && frame.register_again[object]);
  }
  json["existence"] = std::move(existences);
  json["health"] = std::move(healths);
  json["register_again"] = std::move(register_again);
}

Json object_of(const SlamJob& job, const SlamRun& run, std::size_t object) {
  const ErrorReduction reduction(job.models[object].symmetries);
  Track world;
  Track relative;
  Json statuses = Json::array();
  std::vector<std::optional<SE3d>> world_truth;
  std::vector<std::optional<SE3d>> relative_truth;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    world.add(run.frames[k].objects[object]);
    relative.add(run.frames[k].relative[object]);
    statuses.push_back(word_of(run.frames[k].report.statuses[object]));
    world_truth.push_back(nearest_truth(reduction, true_world_pose(job.sequence, object, k),
                                        run.frames[k].objects[object]));
    relative_truth.push_back(nearest_truth(reduction, true_relative_pose(job.sequence, object, k),
                                           run.frames[k].relative[object]));
  }
  Json json = {{"world", std::move(world).json()}, {"relative", std::move(relative).json()}};
  json["world"]["truth"] = truth_or_null(world_truth);
  json["relative"]["truth"] = truth_or_null(relative_truth);
  Json probabilities = Json::array();
  Json alternatives = Json::array();
  for (const FrameEstimate& frame : run.frames) {
    if (!frame.mode_probabilities.empty())
      probabilities.push_back(json_number(frame.mode_probabilities[object]));
    if (!frame.alternatives.empty())
      alternatives.push_back(alternatives_of(frame.alternatives[object], job.trace_hypotheses));
  }
  const SymmetryGroup& symmetries = job.models[object].symmetries;
  if (!symmetries.is_trivial()) json["symmetries"] = symmetries_of(symmetries);
  if (!probabilities.empty()) json["mode_probability"] = std::move(probabilities);
  if (!alternatives.empty()) json["alternatives"] = std::move(alternatives);
  add_health(run, object, json);
  add_motion(job, run, object, json);
  json["detection"] = poses_of(job.sequence.objects[object].detections);
  json["status"] = std::move(statuses);
  return json;
}

Json hypothesis_of(const HypothesisSnapshot& hypothesis,
                   const std::vector<std::optional<std::size_t>>& indices) {
  Json poses = Json::array({json_pose(hypothesis.poses[kCamera], kCompactDigits)});
  for (const auto& index : indices) {
    poses.push_back(index ? json_pose(hypothesis.poses[*index], kCompactDigits) : Json(nullptr));
  }
  return {{"weight", rounded(std::exp(hypothesis.log_weight), kCompactDigits)},
          {"poses", std::move(poses)}};
}

Json hypotheses_of(const FrameEstimate& frame, std::size_t most) {
  std::vector<const HypothesisSnapshot*> sorted;
  for (const HypothesisSnapshot& hypothesis : frame.hypotheses) sorted.push_back(&hypothesis);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto* a, const auto* b) { return a->log_weight > b->log_weight; });
  if (sorted.size() > most) sorted.resize(most);
  Json array = Json::array();
  for (const auto* hypothesis : sorted)
    array.push_back(hypothesis_of(*hypothesis, frame.pose_indices));
  return array;
}

Json conventions() {
  return {
      {"pose", "[tx, ty, tz, qx, qy, qz, qw], metres and unit quaternion"},
      {"sd",
       "[rx, ry, rz, tx, ty, tz], radians and metres: square roots of the covariance diagonal of "
       "xi in "
       "X = Exp(xi) X0, in the reference frame"},
      {"position_covariance",
       "[xx, xy, xz, yy, yz, zz], square metres: of the position in the reference frame, to first "
       "order"},
      {"covariance",
       "upper triangle row by row of the covariance of xi = [rotation, translation] in X = Exp(xi) "
       "X0"},
      {"camera", "T_world_camera"},
      {"world", "T_world_object"},
      {"relative", "T_camera_object"},
      {"detection", "T_camera_object"},
      {"hypotheses",
       "poses of the camera, then of the objects in the order of `order`; weights as fractions of "
       "the whole mixture"}};
}

}  // namespace

std::string format_trace(const SlamJob& job, const SlamRun& run) {
  Json order = Json::array();
  Json objects = Json::object();
  for (std::size_t object = 0; object < job.models.size(); ++object) {
    order.push_back(job.models[object].id);
    objects[job.models[object].id] = object_of(job, run, object);
  }
  Json merges = Json::array();
  Json hypotheses = Json::array();
  for (const FrameEstimate& frame : run.frames) {
    merges.push_back(frame.report.merges);
    hypotheses.push_back(hypotheses_of(frame, job.trace_hypotheses));
  }
  const Json json = {{"schema", kTraceSchema},
                     {"type", "posemix.trace"},
                     {"name", job.name},
                     {"method", job.method},
                     {"conventions", conventions()},
                     {"frames", run.frames.size()},
                     {"stamps_s", job.sequence.stamps},
                     {"order", std::move(order)},
                     {"camera", camera_of(job, run)},
                     {"objects", std::move(objects)},
                     {"merges", std::move(merges)},
                     {"hypotheses", std::move(hypotheses)}};
  return json_text(json);
}

}  // namespace posemix
