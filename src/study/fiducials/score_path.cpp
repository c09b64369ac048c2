// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>

#include <Eigen/SVD>

#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"
#include "score.hpp"

namespace posemix {
namespace {

/// Stamps that differ by no more are one [s].
constexpr double kSameReferenceStamp = 1e-6;

/// The rigid motion that takes points nearest to others; columns are points.
SE3d nearest_motion(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& others) {
  const Eigen::Vector3d mean = points.rowwise().mean();
  const Eigen::Vector3d target = others.rowwise().mean();
  const Eigen::Matrix3d moments =
      (others.colwise() - target) * (points.colwise() - mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1.0, 1.0, 1.0);
  signs.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() > 0.0 ? 1.0 : -1.0;
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return {SO3d::from_matrix(rotation), target - rotation * mean};
}

}  // namespace

double angle_between_deg(const SE3d& a, const SE3d& b) {
  return degrees((a.rotation().inverse() * b.rotation()).angle());
}

bool is_finite(const SE3d& pose) {
  return pose.translation().allFinite() && pose.rotation().quaternion().coeffs().allFinite();
}

bool is_wrong_mode(const SE3d& pose, const SE3d& reference) {
  return !is_finite(pose) || angle_between_deg(pose, reference) > kWrongModeDeg;
}

double normal_angle_deg(const SE3d& a, const SE3d& b) {
  const Eigen::Vector3d first = a.rotation() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d second = b.rotation() * Eigen::Vector3d::UnitZ();
  return degrees(std::atan2(first.cross(second).norm(), first.dot(second)));
}

ReferencePath::ReferencePath(std::span<const StampedPose> poses) {
  for (const StampedPose& pose : poses) {
    if (!pose.pose) continue;
    stamps_.push_back(pose.stamp);
    poses_.push_back(*pose.pose);
  }
}

std::optional<SE3d> ReferencePath::at(double stamp_s, double longest_gap_s) const {
  const auto after = static_cast<std::size_t>(
      std::lower_bound(stamps_.begin(), stamps_.end(), stamp_s) - stamps_.begin());
  if (after < stamps_.size() && stamps_[after] - stamp_s < kSameReferenceStamp)
    return poses_[after];
  if (after > 0 && stamp_s - stamps_[after - 1] < kSameReferenceStamp) return poses_[after - 1];
  if (after == 0 || after == stamps_.size()) return std::nullopt;
  const double gap = stamps_[after] - stamps_[after - 1];
  if (gap > longest_gap_s) return std::nullopt;
  const double part = (stamp_s - stamps_[after - 1]) / gap;
  const SE3d& a = poses_[after - 1];
  const SE3d& b = poses_[after];
  const Eigen::Vector3d turn = part * (a.rotation().inverse() * b.rotation()).log();
  return SE3d(a.rotation() * SO3d::exp(turn),
              (1.0 - part) * a.translation() + part * b.translation());
}

std::optional<PathScore> score_path(std::span<const StampedPose> path,
                                    const ReferencePath& reference, PathAlignment alignment) {
  std::vector<Eigen::Vector3d> own, truth;
  PathScore score;
  for (const StampedPose& pose : path) {
    const std::optional<SE3d> known = reference.at(pose.stamp);
    if (!pose.pose || !known) continue;
    own.push_back(pose.pose->translation());
    truth.push_back(known->translation());
    score.stamps_s.push_back(pose.stamp);
  }
  if (own.size() < 3) return std::nullopt;
  const auto columns = [](const std::vector<Eigen::Vector3d>& points) {
    return Eigen::Matrix3Xd(Eigen::Map<const Eigen::Matrix3Xd>(
        points.front().data(), 3, static_cast<Eigen::Index>(points.size())));
  };
  if (alignment == PathAlignment::rigid)
    score.alignment = nearest_motion(columns(own), columns(truth));
  double squares = 0.0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const double distance = (score.alignment * own[i] - truth[i]).norm();
    squares += distance * distance;
    score.distances_m.push_back(distance);
  }
  score.rms_m = std::sqrt(squares / static_cast<double>(own.size()));
  score.median_m = median(score.distances_m);
  score.p95_m = quantile(score.distances_m, 0.95);
  score.max_m = *std::max_element(score.distances_m.begin(), score.distances_m.end());
  return score;
}

}  // namespace posemix
