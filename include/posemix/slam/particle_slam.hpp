// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "posemix/slam/motion_settings.hpp"
#include "posemix/slam/tracker.hpp"

/// A Rao-Blackwellised particle filter over the poses of the objects, a baseline for object SLAM.
namespace posemix {

namespace internal {
class ParticleCloud;
}  // namespace internal

/// Settings of ParticleSlam.
struct ParticleFilterSettings {
  std::size_t particles = 300;
  std::uint64_t seed = 1;
  /// Resample when the effective sample size falls below this share of the particles, in [0, 1].
  double resample_below = 0.5;
  /// Random walk of every object's pose (right perturbation, the object's frame), which keeps
  /// resampled particles apart: 0.05 deg, 0.2 mm.
  ProcessNoise object_walk{
      pose_covariance(Eigen::Vector3d::Constant(radians(0.05)), Eigen::Vector3d::Constant(2e-4))};
  /// Covariance (object's frame) with which an object stands in a particle's Gaussian, so that it
  /// is one: 0.1 deg, 0.5 mm.
  Matrix6d kernel =
      pose_covariance(Eigen::Vector3d::Constant(radians(0.1)), Eigen::Vector3d::Constant(5e-4));
  std::size_t hypotheses = 32;  ///< the heaviest particles that are reported as hypotheses
  MergeSettings merge = {};     ///< of the particles into one Gaussian
};

/// Object SLAM by particles (Doucet et al. 2000, the camera's part Chen and Liu's
/// mixture Kalman filter, 2000). A particle holds the poses of all objects and, given these, one
/// Gaussian of the camera.
///
///  - *Start*: an object enters a particle by its first detection. A noise component is drawn by
///    weight, the object's pose from its distribution given the particle's camera, and the camera
///    is conditioned on that pose. With the weight of clutter the object does not enter: the
///    detection is then uniform over the clutter's volume, and the object enters by a later one.
///  - *Update*: a particle's weight is multiplied by sum_c w_c N(z; 0, P_RR + R_c) + w_clutter / (8
///    pi^2 V). One of the terms is drawn by its share, and the camera is updated by it (by the
///    component's update covariance where it has one), linearized at the prior mean.
///  - *Resampling* is systematic, and before each frame the objects take a step of their walk.
///
/// Per frame the estimate is the merge of the particles that hold the map, which is every object
/// that the heaviest of the particles with most objects holds. Hypotheses are the heaviest of these
/// particles with `kernel` about the objects. The same seed gives the same run.
///
/// Satisfies ObjectTracker.
class ParticleSlam {
 public:
  /// `camera` is the prior of T_world_camera at the first frame.
  /// @throws InvalidInput when a setting is out of range or two models share an id
  ParticleSlam(const PoseDensity& camera, std::vector<ObjectModel> objects,
               const ParticleFilterSettings& settings = {}, const MotionSettings& motion = {},
               bool record_hypotheses = false);
  ParticleSlam(const ParticleSlam& other);
  ParticleSlam(ParticleSlam&& other) noexcept;
  ParticleSlam& operator=(const ParticleSlam& other);
  ParticleSlam& operator=(ParticleSlam&& other) noexcept;
  ~ParticleSlam();

  /// @throws InvalidInput also for candidates: a particle has no births
  FrameEstimate step(const FrameInput& input);

  /// The heaviest of the particles that hold the map.
  Posterior posterior() const;
  /// The merge of all particles that hold the map.
  const Hypothesis& estimate() const { return estimate_; }
  std::optional<std::size_t> pose_index(std::size_t object) const {
    objects_.require(object);
    return indices_[object];
  }
  const std::vector<ObjectModel>& objects() const { return objects_.models(); }
  std::size_t detections(std::size_t object) const {
    objects_.require(object);
    return counts_[object];
  }

 private:
  TrackedObjects objects_;
  ParticleFilterSettings settings_;
  bool record_hypotheses_;
  std::unique_ptr<internal::ParticleCloud> cloud_;
  std::vector<std::optional<std::size_t>> indices_;
  std::vector<std::size_t> counts_;
  Hypothesis estimate_;
};

static_assert(ObjectTracker<ParticleSlam>);

}  // namespace posemix
