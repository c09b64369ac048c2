// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A camera among tags whose odometry drifts by many standard deviations of the detector, as it
// says.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "moving_object_scene.hpp"
#include "posemix/filter/multi_object_filter.hpp"

namespace posemix::testing {

inline DetectorNoise sharp_tag_noise(const Eigen::Vector3d& position_sds_m, double volume_m3 = 1.0,
                                     bool is_typical = false) {
  const Matrix6d covariance =
      pose_covariance(Eigen::Vector3d::Constant(radians(1.0)), position_sds_m);
  return DetectorNoise({{.weight = 0.95, .covariance = covariance, .frame = NoiseFrame::ray}},
                       {.weight = 0.05, .volume_m3 = volume_m3}, {.is_typical = is_typical});
}

inline DetectorNoise sharp_tag_noise(double position_sd_m) {
  return sharp_tag_noise(Eigen::Vector3d::Constant(position_sd_m));
}

/// A camera among tags that stand still; detections and odometry err as they say.
class TagTrip {
 public:
  TagTrip(std::uint64_t seed, const std::vector<ObjectSensor>& sensors, std::vector<SE3d> tags)
      : tags_(std::move(tags)),
        stream_(seed, 5),
        noise_(sensors.front().noise),
        filter_(ConcentratedGaussian<SE3d>(
                    SE3d::exp(draw(isotropic(0.01, 1e-3), stream_)).inverse() * camera_,
                    isotropic(0.01, 1e-3)),
                sensors, {}) {}
  TagTrip(std::uint64_t seed, const DetectorNoise& noise, const std::vector<SE3d>& tags)
      : TagTrip(seed, std::vector<ObjectSensor>(tags.size(), ObjectSensor{noise}), tags) {}

  /// From now on a camera on the body sees, whose pose there is known with this covariance.
  void see_from(const SE3d& body_camera, const Matrix6d& covariance) {
    mount_ = SE3d::exp(draw(covariance, stream_)) * body_camera;
    mounts_.push_back(mount_);
    source_.camera = filter_.add_camera({body_camera, covariance});
  }
  /// The detector turns the tag by `turn`, to one that looks the same.
  ObjectUpdateReport see(std::size_t tag, const SE3d& turn = {}) {
    return filter_.update(tag, seen((camera_ * mount_).inverse() * tags_[tag] * turn), source_);
  }
  /// With one of the cameras that were added.
  void see_with(std::size_t camera, std::size_t tag) {
    filter_.update(tag, seen((camera_ * mounts_[camera]).inverse() * tags_[tag]),
                   {.camera = camera});
  }
  /// With the camera that is the body itself.
  void see_exactly(std::size_t tag) { filter_.update(tag, seen(camera_.inverse() * tags_[tag])); }
  void go(const SE3d& motion, double rotation_sd_deg, double position_sd_m) {
    go(motion, isotropic(rotation_sd_deg, position_sd_m));
  }
  void go(const SE3d& motion, const Matrix6d& q) { go(motion, q, q); }
  /// With odometry that errs by less than it says.
  void go(const SE3d& motion, const Matrix6d& q, const Matrix6d& error) {
    camera_ = camera_ * motion;
    filter_.predict_with_odometry(motion * SE3d::exp(draw(error, stream_)).inverse(), q, 0.1);
  }
  /// Stands, where a random walk is expected.
  void stand(const Matrix6d& q) { filter_.predict_random_walk(q, 0.1); }
  /// The body moves, and its pose is given with an error along its axes.
  void go_and_give(const SE3d& motion, const Matrix6d& covariance) {
    camera_ = camera_ * motion;
    const SE3d given = camera_ * SE3d::exp(draw(covariance, stream_)).inverse();
    filter_.set_camera({given, given.adjoint_congruence(covariance)}, 0.1);
  }
  /// The body moves by a motion that changes from frame to frame with the covariance `q_motion`.
  void go_on(const SE3d& motion, const Matrix6d& q, const Matrix6d& q_motion) {
    camera_ = camera_ * motion;
    filter_.predict_constant_velocity(1.0, q, q_motion, q_motion, 0.1);
  }
  const SE3d& camera() const { return camera_; }
  SE3d any_turn() { return SE3d::exp(6.28 * stream_.uniform() * Vector6d::Unit(2)); }
  double camera_nees() const { return nees_of(camera_, filter_.camera()) / 6.0; }
  double extrinsic_nees() const {
    return nees_of(mount_, filter_.extrinsic(*source_.camera)) / 6.0;
  }
  const MultiObjectFilter& filter() const { return filter_; }
  /// As seen from the camera.
  double relative_nees(std::size_t tag) const {
    return nees_of(camera_.inverse() * tags_[tag], filter_.leading_estimates()[tag]->relative) /
           6.0;
  }
  double tag_nees(std::size_t tag) const {
    return nees_of(tags_[tag], filter_.leading_estimates()[tag]->world) / 6.0;
  }
  /// Of all tags from the camera together.
  double all_relative_nees() const {
    const auto joint = filter_.joint();
    const Eigen::Index n = 6 * static_cast<Eigen::Index>(tags_.size());
    const SE3d from_world = joint.mean()[0].inverse();
    Eigen::VectorXd error(n);
    Eigen::MatrixXd f = Eigen::MatrixXd::Zero(n, n + 6);
    for (std::size_t i = 0; i < tags_.size(); ++i) {
      const Eigen::Index at = 6 * static_cast<Eigen::Index>(i);
      const SE3d seen = from_world * joint.mean()[i + 1];
      error.segment<6>(at) = (camera_.inverse() * tags_[i] * seen.inverse()).log();
      f.block<6, 6>(at, 0) = -from_world.adjoint();
      f.block<6, 6>(at, at + 6) = from_world.adjoint();
    }
    const Eigen::MatrixXd covariance = f * joint.covariance() * f.transpose();
    return error.dot(covariance.ldlt().solve(error)) / static_cast<double>(n);
  }
  /// Of tag 1 from tag 0.
  double beside_nees() const {
    const auto joint = filter_.joint();
    const SE3d from_world = joint.mean()[1].inverse();
    const SE3d beside = from_world * joint.mean()[2];
    const Vector6d error = (tags_[0].inverse() * tags_[1] * beside.inverse()).log();
    Eigen::Matrix<double, 6, 12> f;
    f << -from_world.adjoint(), from_world.adjoint();
    const Matrix6d covariance = f * joint.covariance().block<12, 12>(6, 6) * f.transpose();
    return error.dot(covariance.ldlt().solve(error)) / 6.0;
  }
  /// Of the camera and all tags together.
  double joint_nees() const {
    const auto joint = filter_.joint();
    Eigen::VectorXd error(joint.covariance().rows());
    for (std::size_t i = 0; i < joint.mean().size(); ++i) {
      const SE3d& truth = i == 0 ? camera_ : tags_[i - 1];
      error.segment<6>(6 * static_cast<Eigen::Index>(i)) =
          (truth * joint.mean()[i].inverse()).log();
    }
    return error.dot(joint.covariance().ldlt().solve(error)) / static_cast<double>(error.size());
  }

 private:
  Observation seen(const SE3d& truth) {
    const NoiseAtPose at = noise_at(noise_.components().front(), truth);
    const SE3d error = at.axes * SE3d::exp(draw(at.covariance, stream_)) * at.axes.inverse();
    return observation_of(error * truth);
  }

  SE3d camera_ = pose(0.1, 0.2, 0.3, 0, 0, 0);
  SE3d mount_;  ///< of the camera that sees
  std::vector<SE3d> mounts_;
  ObservationSource source_;
  std::vector<SE3d> tags_;
  RandomStream stream_;
  DetectorNoise noise_;
  MultiObjectFilter filter_;
};

struct NeesSummary {
  double sum = 0.0;
  double worst = 0.0;
  std::size_t count = 0;

  void add(double value) {
    sum += value;
    worst = std::max(worst, value);
    ++count;
  }
  double mean() const { return sum / static_cast<double>(count); }
};

inline void expect_true_nees(std::initializer_list<NeesSummary> all) {
  for (const NeesSummary& nees : all) {
    EXPECT_GT(nees.mean(), 0.6);
    EXPECT_LT(nees.mean(), 1.5);
    EXPECT_LT(nees.worst, 6.0);
  }
}

}  // namespace posemix::testing
