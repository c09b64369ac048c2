// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/symmetric_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"

namespace posemix {
namespace {

/// ceil(pi / 0.01), as get_symmetry_transformations of the BOP toolkit has it.
constexpr std::size_t kAngles = 315;
constexpr double kAngleStep = 2.0 * std::numbers::pi / kAngles;
constexpr double kAnglePrecision = 1e-9;

/// |q - g p|^2 = constant - 2 (cosine cos phi + sine sin phi) of one point, g a turn by phi.
struct Wave {
  double constant;
  double cosine;
  double sine;
};

double highest(std::span<const Wave> waves, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  double most = 0.0;
  for (const Wave& wave : waves)
    most = std::max(most, wave.constant - 2.0 * (wave.cosine * c + wave.sine * s));
  return most;
}

/// The least value in an interval in which the highest of the waves falls and then rises.
double least_between(std::span<const Wave> waves, double low, double high) {
  constexpr double kGolden = std::numbers::phi - 1.0;
  double a = high - kGolden * (high - low);
  double b = low + kGolden * (high - low);
  double at_a = highest(waves, a);
  double at_b = highest(waves, b);
  while (high - low > kAnglePrecision) {
    if (at_a < at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = highest(waves, a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = highest(waves, b);
    }
  }
  return std::min(at_a, at_b);
}

/// The least over all angles, between the neighbours of every angle that is lower than both.
double least_of(std::span<const Wave> waves) {
  std::array<double, kAngles> heights;
  for (std::size_t k = 0; k < kAngles; ++k)
    heights[k] = highest(waves, static_cast<double>(k) * kAngleStep);
  double least = *std::min_element(heights.begin(), heights.end());
  for (std::size_t k = 0; k < kAngles; ++k) {
    const double before = heights[(k + kAngles - 1) % kAngles];
    const double after = heights[(k + 1) % kAngles];
    if (heights[k] > before || heights[k] > after) continue;
    const double angle = static_cast<double>(k) * kAngleStep;
    least = std::min(least, least_between(waves, angle - kAngleStep, angle + kAngleStep));
  }
  return least;
}

/// The waves of the points p against their images q = error p.
std::vector<Wave> waves_about(const SymmetryAxis& axis, const SE3d& error,
                              std::span<const Eigen::Vector3d> points) {
  std::vector<Wave> waves;
  waves.reserve(points.size());
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d p = point - axis.point;
    const Eigen::Vector3d q = error * point - axis.point;
    const Eigen::Vector3d along = axis.direction.dot(p) * axis.direction;
    const Eigen::Vector3d across = p - along;
    waves.push_back({(q - along).squaredNorm() + across.squaredNorm(), q.dot(across),
                     q.dot(axis.direction.cross(across))});
  }
  return waves;
}

double squared_distance(const SE3d& error, std::span<const Eigen::Vector3d> points) {
  double most = 0.0;
  for (const Eigen::Vector3d& p : points) most = std::max(most, (error * p - p).squaredNorm());
  return most;
}

}  // namespace

double max_symmetric_surface_distance(const SE3d& estimate, const SE3d& truth,
                                      std::span<const Eigen::Vector3d> points,
                                      const SymmetryGroup& symmetries) {
  require(!points.empty(), "the surface distance needs at least one point");
  for (const Eigen::Vector3d& point : points)
    require(point.allFinite(), "a point of the surface is not finite");
  const std::vector<SymmetryAxis>& axes = symmetries.axes();
  double least = std::numeric_limits<double>::infinity();
  for (const SE3d& element : symmetries.elements()) {
    const SE3d error = (truth * element).inverse() * estimate;
    if (axes.empty()) {
      least = std::min(least, squared_distance(error, points));
    } else if (axes.size() == 1) {
      least = std::min(least, least_of(waves_about(axes.front(), error, points)));
    } else {
      const Eigen::Vector3d& centre = axes.front().point;
      least = std::min(least, (error * centre - centre).squaredNorm());
    }
  }
  return std::sqrt(least);
}

SymmetricPoseError symmetric_pose_error(const SE3d& estimate, const SE3d& truth,
                                        const SymmetryGroup& symmetries, double length_m) {
  kPositive.check(length_m, "length_m");
  Matrix6d information = Matrix6d::Identity();
  information.bottomRightCorner<3, 3>() /= length_m * length_m;
  const SE3d nearest = symmetries.closest(truth, estimate, information);
  return {(nearest.rotation().inverse() * estimate.rotation()).angle(),
          (nearest.translation() - estimate.translation()).norm()};
}

}  // namespace posemix
