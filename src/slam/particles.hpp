// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "posemix/slam/particle_slam.hpp"
#include "slam/motion.hpp"

/// The particles of ParticleSlam.
namespace posemix::internal {

/// Poses of objects, and the Gaussian of the camera (with its motion where it has one) given these.
struct Particle {
  Hypothesis camera;
  std::vector<std::optional<SE3d>> objects;  ///< T_world_object; empty: not in this particle's map
};

/// Indices drawn by systematic resampling: index i comes floor(N w_i) or ceil(N w_i) times, in
/// order. `weights` sum to one, `offset` is in [0, 1).
std::vector<std::size_t> systematic_resample(const std::vector<double>& weights, double offset);

/// The filter, frame by frame.
///
/// Invariants: the log-weights are normalised; every particle has one entry for each model.
class ParticleCloud {
 public:
  ParticleCloud(const PoseDensity& camera, const std::vector<ObjectModel>& models,
                const ParticleFilterSettings& settings, const MotionSettings& motion);

  /// Moves camera and objects by one frame.
  void predict(const FrameInput& input);

  /// Weighs and updates by the detections of one frame, one object after another.
  FrameReport observe(const std::vector<std::optional<SE3d>>& detections);

  /// Index of every object of the map in the posterior.
  std::vector<std::optional<std::size_t>> pose_indices() const;

  /// The particles that hold the map as Gaussians over the camera and the map's objects.
  Posterior posterior() const;

 private:
  bool start(Particle& particle, double& log_weight, std::size_t object, const SE3d& detected);
  void weigh(Particle& particle, double& log_weight, std::size_t object, const SE3d& detected);
  DetectionStatus observe(std::size_t object, const SE3d& detected, UpdateReport& report);
  bool resample_if_degenerate();

  std::vector<ObjectModel> models_;
  ParticleFilterSettings settings_;
  MotionSettings motion_;
  RandomStream random_;
  std::vector<Particle> particles_;
  std::vector<double> log_weights_;
};

}  // namespace posemix::internal
