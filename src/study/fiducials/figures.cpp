// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "figures.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "posemix/base/statistics.hpp"
#include "posemix/fiducial/fiducial_folder.hpp"
#include "posemix/lie/pose_covariance.hpp"
#include "posemix/slam/evaluation.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

/// A survey that differs by more from what the reference sees is taken for another place.
constexpr double kSurveyOffM = 0.5;
constexpr double kSurveyOffDeg = 15.0;
/// Points of a curve in the chart.
constexpr std::size_t kCurvePoints = 300;
constexpr double kMilliseconds = 1e3;

Json json_or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json share_or_null(std::size_t part, std::size_t whole) {
  if (whole == 0) return {};
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// FiducialFigures of one run, computed in the order of the members.
class FiducialFigures {
 public:
  FiducialFigures(const FiducialRun& run, Json head)
      : in_(run),
        head_(std::move(head)),
        tags_(reference_tags(run.observations, run.cameras, run.reference)),
        modes_(score_modes(run.estimate.sightings, run.cameras, tags_, run.reference)),
        detector_(
            score_modes(best_sightings(run.observations), run.cameras, tags_, run.reference)) {}

  Json all() {
    Json row = head_;
    row["frames"] = in_.stamps.size();
    row["sightings"] = in_.observations.size();
    add_paths(row);
    add_modes(row);
    add_tags(row);
    add_camera_consistency(row);
    return {{"row", row}, {"tags", tag_rows_}, {"timing", timing()}, {"path", curve_}};
  }

 private:
  void add_paths(Json& row) {
    const std::vector<StampedPose>& camera = in_.estimate.camera;
    row["frames_not_finite"] = in_.stamps.size() - camera.size();
    const auto aligned = score_path(camera, in_.reference, PathAlignment::rigid);
    if (aligned) map_world_ = aligned->alignment;
    add_path(row, "camera_", aligned);
    std::optional<PathScore> surveyed;
    if (in_.has_priors) surveyed = score_path(camera, in_.reference, PathAlignment::none);
    if (surveyed) map_world_ = surveyed->alignment;
    add_path(row, "survey_frame_", surveyed);
    add_path(row, "odometry_", score_path(in_.odometry, in_.reference, PathAlignment::rigid));
    add_curve(surveyed ? surveyed : aligned);
  }

  static void add_path(Json& row, const std::string& prefix,
                       const std::optional<PathScore>& score) {
    row[prefix + "rms_m"] = score ? Json(score->rms_m) : Json();
    row[prefix + "median_m"] = score ? Json(score->median_m) : Json();
    row[prefix + "p95_m"] = score ? Json(score->p95_m) : Json();
    row[prefix + "max_m"] = score ? Json(score->max_m) : Json();
  }

  /// The largest distance of every part of the time.
  void add_curve(const std::optional<PathScore>& score) {
    curve_ = {{"head", head_}, {"seconds", Json::array()}, {"distances_m", Json::array()}};
    if (!score) return;
    const std::size_t count = score->stamps_s.size();
    const std::size_t step = (count + kCurvePoints - 1) / kCurvePoints;
    for (std::size_t begin = 0; begin < count; begin += step) {
      const auto first = score->distances_m.begin() + static_cast<std::ptrdiff_t>(begin);
      const auto length = static_cast<std::ptrdiff_t>(std::min(step, count - begin));
      curve_["seconds"].push_back(score->stamps_s[begin] - score->stamps_s.front());
      curve_["distances_m"].push_back(*std::max_element(first, first + length));
    }
  }

  void add_modes(Json& row) const {
    row["scored_sightings"] = modes_.sightings;
    row["wrong_share"] = share_or_null(modes_.wrong, modes_.sightings);
    row["scored_frames"] = modes_.frames;
    row["wrong_frame_share"] = share_or_null(modes_.wrong_frames, modes_.frames);
    row["detector_wrong_share"] = share_or_null(detector_.wrong, detector_.sightings);
    row["detector_wrong_frame_share"] = share_or_null(detector_.wrong_frames, detector_.frames);
  }

  /// T_map_tag at the end, nothing for a tag without an estimate.
  std::optional<SE3d> final_pose(const std::string& tag) const {
    const auto found = in_.estimate.tags.find(tag);
    if (found != in_.estimate.tags.end()) return map_world_ * found->second;
    return std::nullopt;
  }

  const StatedPose* survey_of(const std::string& tag) const {
    for (const auto& [id, stated] : in_.survey) {
      if (std::to_string(id) == tag) return &stated;
    }
    return nullptr;
  }

  void add_tags(Json& row) {
    std::size_t scored = 0, last = 0, end = 0, sides = 0, sides_last = 0, sides_end = 0, off = 0;
    std::vector<double> normals, positions;
    for (const auto& [name, tag] : tags_) {
      const Json found = tag_row(name, tag);
      tag_rows_.push_back(found);
      if (found["wrong_at_last"].is_null()) continue;
      const bool is_last = found["wrong_at_last"] == 1;
      const bool is_end = found["wrong_at_end"] == 1;
      ++scored;
      last += is_last ? 1 : 0;
      end += is_end ? 1 : 0;
      if (tag.span_deg > kSeveralSidesDeg) {
        ++sides;
        sides_last += is_last ? 1 : 0;
        sides_end += is_end ? 1 : 0;
      }
      off += found["survey_off"] == 1 ? 1 : 0;
      if (found["survey_off"] != 0 || found["normal_deg"].is_null()) continue;
      normals.push_back(found["normal_deg"].get<double>());
      positions.push_back(found["position_m"].get<double>());
    }
    row.update({{"tags", scored}, {"wrong_at_last", last}, {"wrong_at_end", end}});
    row.update({{"tags_from_several_sides", sides},
                {"several_sides_wrong_at_last", sides_last},
                {"several_sides_wrong_at_end", sides_end}});
    row.update({{"surveyed_tags", normals.size()}, {"survey_off", off}});
    add_quantiles(row, "normal", "_deg", normals);
    add_quantiles(row, "tag_position", "_m", positions);
    add_tag_consistency(row);
  }

  static void add_quantiles(Json& row, const std::string& name, const std::string& unit,
                            const std::vector<double>& values) {
    const bool none = values.empty();
    row[name + "_median" + unit] = none ? Json() : Json(median(values));
    row[name + "_p95" + unit] = none ? Json() : Json(quantile(values, 0.95));
    row[name + "_max" + unit] =
        none ? Json() : Json(*std::max_element(values.begin(), values.end()));
  }

  /// A tag without an estimate has nothing but its reference.
  Json tag_row(const std::string& name, const ReferenceTag& tag) const {
    Json row = head_;
    row.update({{"tag", name}, {"sightings", tag.sightings}, {"span_deg", tag.span_deg}});
    row.update({{"reference_share", tag.share}, {"reference_rival_share", tag.rival_share}});
    const auto mode = modes_.tags.find(name);
    const auto detected = detector_.tags.find(name);
    const std::optional<SE3d> end = final_pose(name);
    const bool known = mode != modes_.tags.end() && end;
    row["wrong_sightings"] = known ? Json(mode->second.wrong) : Json();
    row["detector_wrong_sightings"] =
        detected != detector_.tags.end() ? Json(detected->second.wrong) : Json();
    row["wrong_at_last"] = known ? Json(mode->second.wrong_at_last ? 1 : 0) : Json();
    row["wrong_at_end"] = known ? Json(is_wrong_mode(*end, tag.pose) ? 1 : 0) : Json();
    const StatedPose* const survey = survey_of(name);
    for (const char* key :
         {"survey_rotation_deg", "survey_position_m", "survey_off", "normal_deg", "position_m"})
      row[key] = Json();
    if (!survey) return row;
    const double turn = angle_between_deg(survey->pose, tag.pose);
    const double distance = (survey->pose.translation() - tag.pose.translation()).norm();
    row["survey_rotation_deg"] = turn;
    row["survey_position_m"] = distance;
    row["survey_off"] = turn > kSurveyOffDeg || distance > kSurveyOffM ? 1 : 0;
    if (!end || !is_finite(*end)) return row;
    row["normal_deg"] = normal_angle_deg(*end, survey->pose);
    row["position_m"] = (end->translation() - survey->pose.translation()).norm();
    return row;
  }

  /// T_rig_tag after the last sighting of every tag, against the survey from the reference's rig.
  /// That needs no alignment of the map, and no knowledge of the survey in the filter.
  void add_tag_consistency(Json& row) const {
    ConsistencySum sum;
    if (in_.filter && !in_.has_priors) add_tag_errors(*in_.filter, sum);
    add_consistency(row, "tag_", sum.result());
  }

  void add_tag_errors(const FiducialFilterRun& filter, ConsistencySum& sum) const {
    for (std::size_t i = 0; i < filter.sequence.objects.size(); ++i) {
      const std::string& name = filter.sequence.objects[i].id;
      const auto mode = modes_.tags.find(name);
      const StatedPose* const survey = survey_of(name);
      if (mode == modes_.tags.end() || survey == nullptr || is_survey_off(name)) continue;
      const std::optional<SE3d> rig = in_.reference.at(mode->second.last_s);
      const auto& relative = filter.run.frames[frame_at(mode->second.last_s)].relative[i];
      if (!rig || !relative || !is_finite(relative->mean())) continue;
      const SE3d truth = rig->inverse() * survey->pose;
      const Matrix6d covariance =
          relative->covariance() + truth.adjoint_congruence(survey_covariance(*survey));
      sum.add(PoseDensity(relative->mean(), covariance), truth);
    }
  }

  /// Of n of T_map_tag Exp(n), as known tags have it in sequence files.
  static Matrix6d survey_covariance(const StatedPose& survey) {
    const FiducialSequenceSettings least;
    Matrix6d floor = pose_covariance(Eigen::Vector3d::Constant(least.survey_rotation_sd),
                                     Eigen::Vector3d::Constant(least.survey_position_sd));
    if (!survey.covariance) return floor;
    return survey.covariance->diagonal().cwiseMax(floor.diagonal()).asDiagonal();
  }

  bool is_survey_off(const std::string& tag) const {
    const auto row = std::find_if(tag_rows_.begin(), tag_rows_.end(),
                                  [&](const Json& found) { return found["tag"] == tag; });
    return row == tag_rows_.end() || (*row)["survey_off"] != 0;
  }

  std::size_t frame_at(double stamp_s) const {
    const auto after = std::lower_bound(in_.stamps.begin(), in_.stamps.end(), stamp_s - 1e-6);
    return std::min<std::size_t>(static_cast<std::size_t>(after - in_.stamps.begin()),
                                 in_.stamps.size() - 1);
  }

  void add_camera_consistency(Json& row) const {
    ConsistencySum sum;
    for (std::size_t k = 0; in_.filter && in_.has_priors && k < in_.stamps.size(); ++k) {
      const PoseDensity& camera = in_.filter->run.frames[k].camera;
      if (is_finite(camera.mean())) sum.add(camera, in_.reference.at(in_.stamps[k]));
    }
    add_consistency(row, "camera_", sum.result());
  }

  static void add_consistency(Json& row, const std::string& prefix, const Consistency& found) {
    row[prefix + "anees"] = json_or_null(found.anees);
    row[prefix + "median_nees"] = json_or_null(found.median_nees);
    row[prefix + "rotation_anees"] = json_or_null(found.rotation_anees);
    row[prefix + "position_anees"] = json_or_null(found.position_anees);
  }

  Json timing() const {
    const double span = in_.stamps.back() - in_.stamps.front();
    const std::optional<FiducialTimes>& times = in_.estimate.times;
    Json row = head_;
    row["frames"] = times ? Json(times->frames) : Json();
    row["recorded_s"] = span;
    row["processor_s"] = times ? Json(times->processor_s) : Json();
    row["mean_ms"] =
        times ? Json(kMilliseconds * times->processor_s / static_cast<double>(times->frames))
              : Json();
    row["worst_ms"] = times ? Json(kMilliseconds * times->worst_s) : Json();
    row["times_real_time"] = times ? Json(span / times->processor_s) : Json();
    return row;
  }

  const FiducialRun& in_;
  Json head_;
  ReferenceTags tags_;
  ModeScore modes_;
  ModeScore detector_;
  SE3d map_world_ = {};
  Json tag_rows_ = Json::array();
  Json curve_ = {};
};

}  // namespace

nlohmann::ordered_json fiducial_figures(const FiducialRun& run, nlohmann::ordered_json head) {
  return FiducialFigures(run, std::move(head)).all();
}

}  // namespace posemix
