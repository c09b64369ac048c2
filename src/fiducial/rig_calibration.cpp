// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/rig_calibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

/// Poses T_rig_camera nearer to each other than this support each other.
constexpr double kSameRotation = radians(5.0);
constexpr double kSamePosition = 0.1;
/// Fewer pairs of sightings are no calibration.
constexpr std::size_t kLeastPairs = 5;
/// Number of pairs whose poses are tried, and of pairs that are asked for support.
constexpr std::size_t kMostTried = 60;
constexpr std::size_t kMostAsked = 2000;

/// The poses T_rig_camera that one pair of sightings states, the most probable first.
using Pair = std::vector<SE3d>;

double distance(const SE3d& a, const SE3d& b) {
  const Vector6d apart = (a.inverse() * b).log();
  return std::max(apart.head<3>().norm() / kSameRotation, apart.tail<3>().norm() / kSamePosition);
}

const SE3d& nearest(const Pair& pair, const SE3d& to) {
  return *std::min_element(pair.begin(), pair.end(), [&](const SE3d& a, const SE3d& b) {
    return distance(a, to) < distance(b, to);
  });
}

std::vector<Pair> every(const std::vector<Pair>& pairs, std::size_t most) {
  const std::size_t step = (pairs.size() + most - 1) / most;
  std::vector<Pair> some;
  for (std::size_t i = 0; i < pairs.size(); i += step) some.push_back(pairs[i]);
  return some;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The pose that most pairs support, and the spread of a single pair about it.
std::optional<StatedPose> consensus(const std::vector<Pair>& pairs) {
  const std::vector<Pair> asked = every(pairs, kMostAsked);
  std::optional<SE3d> best;
  std::size_t most = 0;
  for (const Pair& pair : every(pairs, kMostTried)) {
    for (const SE3d& tried : pair) {
      const auto support = static_cast<std::size_t>(std::count_if(
          asked.begin(), asked.end(),
          [&](const Pair& other) { return distance(nearest(other, tried), tried) < 1.0; }));
      if (support > most) {
        most = support;
        best = tried;
      }
    }
  }
  if (!best || most < kLeastPairs) return std::nullopt;
  std::array<std::vector<double>, 6> residuals;
  for (const Pair& pair : asked) {
    const SE3d& pose = nearest(pair, *best);
    if (distance(pose, *best) > 1.0) continue;
    const Vector6d residual = (best->inverse() * pose).log();
    for (int i = 0; i < 6; ++i) residuals[i].push_back(residual[i]);
  }
  constexpr double kMedianOfNormal = 0.6744897501960817;  // of the modulus, in standard deviations
  Vector6d center;
  Vector6d sd;
  for (int i = 0; i < 6; ++i) {
    center[i] = median(residuals[i]);
    for (double& value : residuals[i]) value = std::abs(value - center[i]);
    sd[i] = std::max(median(residuals[i]) / kMedianOfNormal, i < 3 ? radians(0.05) : 0.5e-3);
  }
  return StatedPose{*best * SE3d::exp(center), Matrix6d(sd.cwiseAbs2().asDiagonal())};
}

/// Sightings of one tag at one stamp, by the index of the camera.
using Together = std::map<std::pair<double, std::string>, std::map<std::size_t, std::size_t>>;

Together together(std::span<const Observation> observations,
                  const std::vector<RigCamera>& cameras) {
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < cameras.size(); ++i) index[cameras[i].name] = i;
  Together list;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const auto camera = index.find(observations[i].camera);
    if (camera == index.end()) {
      throw InvalidInput(fmt::format("observation {}: there is no camera {}", i,
                                     in_quotes(observations[i].camera)));
    }
    list[{observations[i].stamp_s, observations[i].object}][camera->second] = i;
  }
  return list;
}

/// The pairs of sightings of a camera with those whose pose is known.
std::vector<Pair> pairs_of(std::size_t camera, const Together& list,
                           std::span<const Observation> observations,
                           const std::vector<RigCamera>& cameras) {
  std::vector<Pair> pairs;
  for (const auto& [key, seen] : list) {
    const auto own = seen.find(camera);
    if (own == seen.end()) continue;
    for (const auto& [other, sighting] : seen) {
      if (!cameras[other].rig_camera) continue;
      Pair pair;
      for (const ObservationComponent& there : observations[sighting].components) {
        for (const ObservationComponent& here : observations[own->second].components)
          pair.push_back(cameras[other].rig_camera->pose * there.pose * here.pose.inverse());
      }
      pairs.push_back(std::move(pair));
    }
  }
  return pairs;
}

}  // namespace

std::vector<std::string> calibrate_rig(std::span<const Observation> observations,
                                       std::vector<RigCamera>& cameras) {
  if (cameras.empty()) return {};
  const Together list = together(observations, cameras);
  const bool any = std::any_of(cameras.begin(), cameras.end(), [](const RigCamera& camera) {
    return camera.rig_camera.has_value();
  });
  if (!any) cameras.front().rig_camera = StatedPose{};
  std::vector<bool> failed(cameras.size(), false);
  for (;;) {
    // The camera that shares most with the known ones is next.
    std::vector<Pair> most;
    std::size_t next = cameras.size();
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      if (cameras[i].rig_camera || failed[i]) continue;
      std::vector<Pair> pairs = pairs_of(i, list, observations, cameras);
      if (pairs.size() <= most.size()) continue;
      most = std::move(pairs);
      next = i;
    }
    if (next == cameras.size()) break;
    cameras[next].rig_camera = consensus(most);
    failed[next] = !cameras[next].rig_camera;
  }
  std::vector<std::string> unknown;
  for (const RigCamera& camera : cameras)
    if (!camera.rig_camera) unknown.push_back(camera.name);
  return unknown;
}

}  // namespace posemix
