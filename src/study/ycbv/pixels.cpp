// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "pixels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "io/json_fault.hpp"
#include "io/json_place.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFirstOfSecondCamera = "0060";
constexpr double kMetresPerCentimetre = 0.01;

/// Focal lengths [px]. The principal point drops out of differences.
Eigen::Vector2d read_focal_lengths(const fs::path& path) {
  const std::string text = read_file(path);
  LineReader reader(text, path.string());
  Eigen::Vector2d focal = Eigen::Vector2d::Zero();
  while (reader.next_content()) {
    const std::size_t colon = reader.line().find(':');
    if (colon == std::string_view::npos) continue;
    const std::string_view key = trimmed(reader.line().substr(0, colon));
    const std::string_view value = trimmed(reader.line().substr(colon + 1));
    if (key == "Camera.fx") focal.x() = reader.number_from(value, "Camera.fx");
    if (key == "Camera.fy") focal.y() = reader.number_from(value, "Camera.fy");
  }
  if (focal.minCoeff() <= 0.0) {
    throw InvalidInput(
        fmt::format("{}: got focal lengths {:g} and {:g}, expected positive numbers under "
                    "Camera.fx and Camera.fy",
                    path.string(), focal.x(), focal.y()));
  }
  return focal;
}

/// Size of the object's box [m].
std::optional<Eigen::Vector3d> read_cuboid(const fs::path& path, const std::string& object) {
  const auto document =
      internal::json_of(read_file(path), path.string(), "objects with their cuboid_dimensions");
  const internal::JsonPlace root(document, path.string());
  for (const internal::JsonPlace& item : root.member("exported_objects").items()) {
    if (item.member("class").string() != object) continue;
    const Eigen::VectorXd size = item.member("cuboid_dimensions").vector(3);
    return kMetresPerCentimetre * Eigen::Vector3d(size);
  }
  return std::nullopt;
}

}  // namespace

std::optional<PixelMetric> PixelMetric::find(const Recording& recording) {
  const auto experiments = find_experiments(recording.data);
  if (!experiments) return std::nullopt;
  const fs::path cuboids = *experiments / "_ycb_original.json";
  const bool second = recording.sequence >= kFirstOfSecondCamera;
  const fs::path camera = *experiments / "odom" / (second ? "YCB2.yaml" : "YCB.yaml");
  if (!fs::exists(cuboids) || !fs::exists(camera)) return std::nullopt;
  const auto size = read_cuboid(cuboids, recording.object);
  if (!size) return std::nullopt;
  PixelMetric metric;
  metric.focal_ = read_focal_lengths(camera);
  metric.points_.emplace_back(Eigen::Vector3d::Zero());
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d signs(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5,
                                corner & 4 ? 0.5 : -0.5);
    metric.points_.emplace_back(signs.cwiseProduct(*size));
  }
  return metric;
}

double PixelMetric::distance(const SE3d& estimate, const SE3d& truth,
                             const Eigen::Vector3d& point) const {
  const Eigen::Vector3d a = estimate * point;
  const Eigen::Vector3d b = truth * point;
  if (a.z() <= 0.0 || b.z() <= 0.0) return std::numeric_limits<double>::infinity();
  return focal_.cwiseProduct(a.head<2>() / a.z() - b.head<2>() / b.z()).norm();
}

std::optional<double> PixelMetric::median(std::span<const std::pair<SE3d, SE3d>> poses) const {
  if (poses.empty()) return std::nullopt;
  std::vector<double> distances;
  distances.reserve(poses.size() * points_.size());
  for (const auto& [estimate, truth] : poses) {
    for (const Eigen::Vector3d& point : points_)
      distances.push_back(distance(estimate, truth, point));
  }
  return posemix::median(distances);
}

}  // namespace posemix
