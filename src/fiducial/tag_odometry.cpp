// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/tag_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

namespace posemix {
namespace {

constexpr double kShortest = 1.0;  // [s]
constexpr double kLongest = 5.0;
constexpr double kLongestGap = 0.5;         // between poses of the odometry [s]
constexpr double kUnambiguousAbove = 0.99;  // leading weight
constexpr std::size_t kLeastMotions = 20;
constexpr double kDof = 4.0;
constexpr int kIterations = 200;

/// Difference of the two motions, Log(odometry^-1 tag), and the covariance of the sightings in it.
struct Difference {
  double seconds;
  Vector6d residual;
  Matrix6d covariance;
};

std::optional<SE3d> odometry_at(std::span<const StampedPose> odometry, double stamp) {
  const auto after =
      std::lower_bound(odometry.begin(), odometry.end(), stamp,
                       [](const StampedPose& pose, double s) { return pose.stamp < s; });
  if (after == odometry.end() || !after->pose) return std::nullopt;
  if (after->stamp == stamp) return after->pose;
  if (after == odometry.begin()) return std::nullopt;
  const StampedPose& before = *std::prev(after);
  const double gap = after->stamp - before.stamp;
  if (!before.pose || gap > kLongestGap) return std::nullopt;
  const SE3d motion = before.pose->inverse() * *after->pose;
  return *before.pose * SE3d::exp((stamp - before.stamp) / gap * motion.log());
}

std::optional<Difference> difference(const Observation& first, const Observation& second,
                                     const SE3d& rig_camera,
                                     std::span<const StampedPose> odometry) {
  const auto start = odometry_at(odometry, first.stamp_s);
  const auto end = odometry_at(odometry, second.stamp_s);
  if (!start || !end) return std::nullopt;
  const ObservationComponent& a = first.components[best_component(first)];
  const ObservationComponent& b = second.components[best_component(second)];
  const SE3d by_tag = rig_camera * a.pose * b.pose.inverse() * rig_camera.inverse();
  const SE3d by_odometry = start->inverse() * *end;
  // A Exp(n_a) (B Exp(n_b))^-1 = A B^-1 Exp(Ad_B (n_a - n_b)).
  const Matrix6d covariance =
      (rig_camera * b.pose).adjoint_congruence(Matrix6d(*a.covariance + *b.covariance));
  return Difference{second.stamp_s - first.stamp_s, (by_odometry.inverse() * by_tag).log(),
                    covariance};
}

std::vector<Difference> differences(std::span<const Observation> observations,
                                    std::span<const RigCamera> cameras,
                                    std::span<const StampedPose> odometry) {
  std::map<std::string, SE3d> poses;
  for (const RigCamera& camera : cameras)
    if (camera.rig_camera) poses.emplace(camera.name, camera.rig_camera->pose);
  std::map<std::pair<std::string, std::string>, std::vector<const Observation*>> tracks;
  for (const Observation& seen : observations) {
    const ObservationComponent& best = seen.components[best_component(seen)];
    if (best.weight > kUnambiguousAbove && best.covariance && poses.count(seen.camera) != 0)
      tracks[{seen.camera, seen.object}].push_back(&seen);
  }
  std::vector<Difference> list;
  for (auto& [key, track] : tracks) {
    std::stable_sort(track.begin(), track.end(),
                     [](const auto* a, const auto* b) { return a->stamp_s < b->stamp_s; });
    const Observation* first = nullptr;
    for (const Observation* seen : track) {
      const double seconds = first ? seen->stamp_s - first->stamp_s : kLongest + 1.0;
      if (seconds < kShortest) continue;
      if (seconds <= kLongest) {
        if (const auto one = difference(*first, *seen, poses.at(key.first), odometry))
          list.push_back(*one);
      }
      first = seen;
    }
  }
  return list;
}

}  // namespace

std::optional<TagOdometryNoise> fit_tag_odometry(std::span<const Observation> observations,
                                                 std::span<const RigCamera> cameras,
                                                 std::span<const StampedPose> odometry) {
  const std::vector<Difference> all = differences(observations, cameras, odometry);
  if (all.size() < kLeastMotions) return std::nullopt;
  double rotation = 1e-4;  // scales of the walk [rad^2 / s, m^2 / s]
  double translation = 1e-4;
  for (int i = 0; i < kIterations; ++i) {
    double sum_rotation = 0.0;
    double sum_translation = 0.0;
    for (const Difference& one : all) {
      Vector6d walk;
      walk << Eigen::Vector3d::Constant(rotation), Eigen::Vector3d::Constant(translation);
      walk *= one.seconds;
      Matrix6d s = one.covariance;
      s.diagonal() += walk;
      const Eigen::LLT<Matrix6d> factor(s);
      const Vector6d y = factor.solve(one.residual);
      // The moments of the walk's part given the difference, and Student's weight.
      const double weight = (kDof + 6.0) / (kDof + one.residual.dot(y));
      const Matrix6d gained = factor.solve(Matrix6d(walk.asDiagonal()));
      const Vector6d second =
          weight * walk.cwiseProduct(y).cwiseAbs2() + walk - walk.cwiseProduct(gained.diagonal());
      sum_rotation += second.head<3>().sum() / (3.0 * one.seconds);
      sum_translation += second.tail<3>().sum() / (3.0 * one.seconds);
    }
    rotation = sum_rotation / static_cast<double>(all.size());
    translation = sum_translation / static_cast<double>(all.size());
  }
  const double variance = kDof / (kDof - 2.0);
  return TagOdometryNoise{std::sqrt(variance * rotation), std::sqrt(variance * translation),
                          all.size()};
}

}  // namespace posemix
