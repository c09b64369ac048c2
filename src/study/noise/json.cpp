// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/noise/json.hpp"

#include <cmath>

#include "posemix/base/units.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

NoiseFrame frame_from(const Json& json) {
  for (const auto& [word, frame] : words<NoiseFrame>) {
    if (json == Json(word)) return frame;
  }
  return NoiseFrame::object;
}

template <class Matrix>
Matrix matrix_from(const Json& json) {
  Matrix matrix;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      matrix(row, column) = json.at(row).at(column);
  }
  return matrix;
}

}  // namespace

nlohmann::ordered_json finite_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

DetectorNoise noise_from_json(const nlohmann::ordered_json& json) {
  std::vector<NoiseComponent> components;
  Clutter clutter;
  for (const auto& entry : json) {
    // "null" is the name of the release before.
    for (const char* const key : {"clutter", "null"}) {
      if (entry.contains(key)) clutter = {entry[key].at("weight"), entry[key].at("volume_m3")};
    }
    if (entry.contains("clutter") || entry.contains("null")) continue;
    components.push_back(
        {.weight = entry.at("weight"),
         .covariance = matrix_from<Matrix6d>(entry.at("covariance")),
         .frame = frame_from(entry.at("frame")),
         .offset = SE3d::from_matrix(matrix_from<Eigen::Matrix4d>(entry.at("offset"))),
         .run_length = entry.value("run_length", 1.0)});
  }
  return DetectorNoise(std::move(components), clutter);
}

nlohmann::ordered_json modes_json(const std::vector<NoiseMode>& modes) {
  Json json = Json::array();
  for (const NoiseMode& mode : modes) {
    const Eigen::Vector3d rotation = mode.offset.rotation().log();
    const Eigen::Vector3d axis = rotation.normalized();
    const Eigen::Vector3d& t = mode.offset.translation();
    json.push_back({{"weight", mode.weight},
                    {"angle_deg", degrees(rotation.norm())},
                    {"axis_x", axis[0]},
                    {"axis_y", axis[1]},
                    {"axis_z", axis[2]},
                    {"translation_x_m", t[0]},
                    {"translation_y_m", t[1]},
                    {"translation_z_m", t[2]},
                    {"rotation_sd_deg", mode.rotation_sd_deg},
                    {"recordings", mode.recordings},
                    {"accepted", mode.accepted ? 1 : 0}});
  }
  return json;
}

nlohmann::ordered_json validation_json(const std::vector<NoiseValidation>& rows) {
  Json json = Json::array();
  for (const NoiseValidation& row : rows) {
    json.push_back({{"frame", word_of(row.frame)},
                    {"clutter", row.clutter ? 1 : 0},
                    {"components", row.components},
                    {"log_density", row.log_density},
                    {"below_best", row.below_best},
                    {"standard_error", row.standard_error}});
  }
  return json;
}

nlohmann::ordered_json correlation_json(const NoiseCorrelation& c) {
  Json json = {{"inliers", c.inliers},
               {"dependent_frames", finite_json(c.inlier.about_zero)},
               {"dependent_frames_within", finite_json(c.inlier.within)},
               {"outlier_share", finite_json(c.outlier_share)},
               {"outlier_run", finite_json(c.outlier_run)},
               {"outlier_dependent_frames", finite_json(c.outlier.about_zero)},
               {"outlier_dependent_frames_within", finite_json(c.outlier.within)}};
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const double bias = c.bias_sd[static_cast<Eigen::Index>(axis)];
    json["axes"].push_back({{"dependent_frames", finite_json(c.axes[axis].about_zero)},
                            {"dependent_frames_within", finite_json(c.axes[axis].within)},
                            {"bias_sd", finite_json(axis < 3 ? degrees(bias) : bias)}});
  }
  return json;
}

}  // namespace posemix
