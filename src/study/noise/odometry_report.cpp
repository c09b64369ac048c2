// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/noise/odometry_report.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "draw/picture_colours.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/noise_toml.hpp"
#include "posemix/draw/chart.hpp"
#include "study/engine/table.hpp"
#include "study/noise/json.hpp"
#include "study/noise/report.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const Vector6d& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(finite_json(value));
  return json;
}

/// A number, or NaN, which JSON does not have.
double number_from(const Json& json) {
  return json.is_number() ? json.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

Vector6d vector_from(const Json& json) {
  Vector6d values;
  for (Eigen::Index i = 0; i < 6; ++i)
    values[i] = number_from(json.at(static_cast<std::size_t>(i)));
  return values;
}

OdometryNoise odometry_from(const Json& item) {
  OdometryNoise noise{.sd_per_sqrt_s = vector_from(item.at("sd_per_sqrt_s")),
                      .jitter_sd = vector_from(item.at("jitter_sd")),
                      .sd_per_sqrt_s_error = vector_from(item.at("sd_per_sqrt_s_error")),
                      .jitter_sd_error = vector_from(item.at("jitter_sd_error")),
                      .windows = {},
                      .recordings = item.at("recordings"),
                      .scene_distance_m = item.at("scene_distance_m"),
                      .scene_distance_error_m = number_from(item.at("scene_distance_error_m"))};
  for (const Json& window : item.at("windows")) {
    noise.windows.push_back({window.at("seconds"), window.at("independent"),
                             vector_from(window.at("variance")), vector_from(window.at("fitted"))});
  }
  return noise;
}

/// Degrees or millimetres of a value in radians or metres.
double in_unit(double value, std::size_t axis) {
  return axis < 3 ? degrees(value) : 1000.0 * value;
}

StudyTable window_table(const OdometryNoise& noise) {
  StudyTable table({"axis", "unit", "window_s", "independent_windows", "rms", "fitted_rms"});
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    for (const OdometryWindow& window : noise.windows) {
      table.add({kNoiseAxes[axis], axis < 3 ? "deg" : "mm", window.seconds, window.independent,
                 in_unit(std::sqrt(window.variance[at]), axis),
                 in_unit(std::sqrt(window.fitted[at]), axis)});
    }
  }
  return table;
}

StudyTable odometry_summary(const OdometryNoise& noise) {
  StudyTable table({"axis", "unit", "per sqrt s", "+-", "jitter", "+-"});
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    table.add({kNoiseAxes[axis], axis < 3 ? "deg" : "mm", in_unit(noise.sd_per_sqrt_s[at], axis),
               in_unit(noise.sd_per_sqrt_s_error[at], axis), in_unit(noise.jitter_sd[at], axis),
               in_unit(noise.jitter_sd_error[at], axis)});
  }
  return table;
}

Chart variance_chart(const OdometryNoise& noise, std::size_t first) {
  Chart chart{.title = first == 0 ? "Rotation" : "Translation",
              .x_label = "window [s]",
              .y_label = first == 0 ? "variance [deg^2]" : "variance [mm^2]",
              .log_x = true,
              .log_y = true};
  constexpr std::array kLetters{"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string colour(internal::kAxisColours[i]);
    ChartSeries seen{.label = kLetters[i], .color = colour, .markers = true};
    ChartSeries fitted{
        .label = std::string(kLetters[i]) + ", fitted", .color = colour, .dash = "6 4"};
    for (const OdometryWindow& window : noise.windows) {
      const auto at = static_cast<Eigen::Index>(first + i);
      const double unit = std::pow(in_unit(1.0, first), 2);
      seen.x.push_back(window.seconds);
      seen.y.push_back(unit * window.variance[at]);
      fitted.x.push_back(window.seconds);
      fitted.y.push_back(unit * window.fitted[at]);
    }
    chart.series.push_back(std::move(seen));
    chart.series.push_back(std::move(fitted));
  }
  return chart;
}

}  // namespace

nlohmann::ordered_json study_odometry(const std::vector<OdometryRecording>& recordings,
                                      const NoiseStudySettings& settings) {
  const OdometryNoise noise = fit_odometry_noise(recordings, settings.odometry);
  Json json = {{"sd_per_sqrt_s", vector_json(noise.sd_per_sqrt_s)},
               {"sd_per_sqrt_s_error", vector_json(noise.sd_per_sqrt_s_error)},
               {"jitter_sd", vector_json(noise.jitter_sd)},
               {"jitter_sd_error", vector_json(noise.jitter_sd_error)},
               {"recordings", noise.recordings},
               {"scene_distance_m", noise.scene_distance_m},
               {"scene_distance_error_m", noise.scene_distance_error_m},
               {"windows", Json::array()}};
  for (const OdometryWindow& window : noise.windows) {
    json["windows"].push_back({{"seconds", window.seconds},
                               {"independent", window.independent},
                               {"variance", vector_json(window.variance)},
                               {"fitted", vector_json(window.fitted)}});
  }
  return json;
}

void report_odometry(const nlohmann::ordered_json& item, StudyReport& report) {
  const OdometryNoise noise = odometry_from(item);
  report.files.push_back({"odometry.toml", format_odometry_toml(noise)});
  report.files.push_back({"odometry.csv", window_table(noise).csv()});
  const std::array charts{variance_chart(noise, 0), variance_chart(noise, 3)};
  report.files.push_back(
      {"odometry.svg",
       draw_charts("Error of the odometry by the length of the window", charts, 2)});
  report.summary +=
      fmt::format("\nOdometry in {} recordings, of a point at {:.2f} m (+- {:.2f}):\n",
                  noise.recordings, noise.scene_distance_m, noise.scene_distance_error_m) +
      odometry_summary(noise).text(3);
}

}  // namespace posemix
