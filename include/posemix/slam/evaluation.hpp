// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "posemix/slam/job.hpp"
#include "posemix/slam/observed_error.hpp"
#include "posemix/slam/run.hpp"

/// Errors and consistency of a run against ground truth. Everything is empty where there is no
/// ground truth. The truth of an object is the nearest of the poses that its declared symmetries
/// make equivalent.
namespace posemix {

/// Root mean square errors of a pose over the frames that have both estimate and truth.
struct PoseErrors {
  std::optional<double> position_rmse_m;    ///< Euclidean distance of the positions
  std::optional<double> rotation_rmse_deg;  ///< angle of the rotation between estimate and truth
  std::optional<double>
      position_log_rmse_m;  ///< translation part of Log(T_est T_true^-1), the midway paper's number
};

/// Accumulates PoseErrors over frames; those without an estimate or a truth are left out.
class PoseErrorSum {
 public:
  void add(const std::optional<SE3d>& estimate, const std::optional<SE3d>& truth);
  PoseErrors errors() const;

 private:
  double position_ = 0.0;
  double rotation_ = 0.0;
  double position_log_ = 0.0;
  std::size_t count_ = 0;
};

/// e^T P^-1 e with e = Log(X_true X_est^-1): chi-square with as many degrees of freedom as the
/// group has when the estimate is consistent.
template <LieGroup G>
double squared_normalized_error(const ConcentratedGaussian<G>& estimate, const G& truth) {
  const typename G::Tangent e = (truth * estimate.mean().inverse()).log();
  const Eigen::LLT<typename G::TangentMatrix> factor(estimate.covariance());
  return factor.matrixL().solve(e).squaredNorm();
}

/// The consistency of a pose with its covariance over the frames that have both estimate and truth:
/// normalised estimation error squared per degree of freedom that can be observed, one when
/// consistent.
struct Consistency {
  std::optional<double> anees;           ///< mean over the frames
  std::optional<double> median_nees;     ///< median over the frames
  std::optional<double> rotation_anees;  ///< of the rotation alone; empty where none is observed
  std::optional<double> position_anees;  ///< of the position alone
};

/// Accumulates Consistency over frames, all of poses with the same symmetries.
class ConsistencySum {
 public:
  explicit ConsistencySum(const ErrorReduction& reduction = ErrorReduction())
      : reduction_(reduction) {}

  void add(const std::optional<PoseDensity>& estimate, const std::optional<SE3d>& truth);
  Consistency result() const;

 private:
  ErrorReduction reduction_;
  std::vector<double> nees_;
  double rotation_ = 0.0;
  double position_ = 0.0;
};

/// The probability that an estimate is on the right mode, and whether it was.
struct ModeForecast {
  double probability;
  bool right;
};

/// Whether a pose is within 20 deg and 10 cm of the truth.
bool on_right_mode(const SE3d& estimate, const SE3d& truth);

/// Median errors of a pose.
struct PoseMedians {
  std::optional<double> position_m;    ///< Euclidean distance of the positions
  std::optional<double> rotation_deg;  ///< angle of the rotation between estimate and truth
};

/// Errors of T_camera_object as filtered and as detected over the same frames, those that have
/// both and a truth, and so comparable.
struct PairedErrors {
  std::size_t frames = 0;
  PoseMedians estimate;
  PoseMedians detection;
};

/// Metrics of one object.
struct ObjectMetrics {
  std::string id;
  PoseErrors world;
  PoseErrors relative;            ///< T_camera_object as filtered
  PoseErrors detection_relative;  ///< T_camera_object as detected
  PairedErrors paired;            ///< medians of both over the same frames
  std::size_t detections = 0;     ///< frames with one, also one of its class that it was given
  std::size_t gated = 0;          ///< those that a gate left out
  /// Those that the filter could not explain: gated, doubted, or the birth of a hypothesis.
  std::size_t unexplained = 0;
  /// Frames within 20 deg and 10 cm of the truth, and their share of those with estimate and truth.
  std::size_t right_mode_frames = 0;
  std::optional<double> right_mode_share;
  std::optional<double> right_mode_anees;  ///< as relative_anees, over these frames
  /// Probability of the mode at the last frame.
  std::optional<double> mode_probability;
  /// By the multi-object tracker, where nothing is smoothed: that the object exists, and the state
  /// of its track, at the last frame.
  std::optional<double> existence;
  std::optional<TrackHealth> health;
  /// Share of the frames in which the track is in each state, in the order of TrackHealth; empty
  /// where there is none.
  std::vector<double> health_shares;
  std::vector<ModeForecast> forecasts;
  /// Mean over the frames of e^T P^-1 e over its degrees of freedom, 6 without continuous
  /// symmetries, with e = Log(T_true T_est^-1) of T_camera_object; 1 when consistent.
  std::optional<double> relative_anees;
  Consistency relative_consistency;  ///< of T_camera_object
  Consistency world_consistency;     ///< of T_world_object
};

/// Medians over the frames after the first, and means.
struct Timing {
  double frame_median_us = 0.0;
  double update_median_us = 0.0;
  double reduce_median_us = 0.0;
  double merges_per_frame = 0.0;
};

struct Metrics {
  std::size_t frames = 0;
  PoseErrors camera;
  Consistency camera_consistency;  ///< of T_world_camera
  PoseErrors odometry;  ///< of the odometry alone, which agrees with the truth at its first frame
  std::vector<ObjectMetrics> objects;
  Timing timing;
};

/// The metrics of a run; `symmetries` are those of the objects, none where the list is empty.
/// @throws InvalidInput when the run has no frame, more of them than the sequence, or another
/// number of objects, or when the list is neither empty nor as long as the objects
Metrics evaluate(const Sequence& sequence, const SlamRun& run,
                 std::span<const SymmetryGroup> symmetries = {});

/// The metrics of a job's run, with the symmetries of its models.
/// @throws InvalidInput as above
Metrics evaluate(const SlamJob& job, const SlamRun& run);

/// True T_camera_object and T_world_object of one object at one frame, from whichever of relative,
/// world and camera truth is known.
std::optional<SE3d> true_relative_pose(const Sequence& sequence, std::size_t object,
                                       std::size_t frame);
std::optional<SE3d> true_world_pose(const Sequence& sequence, std::size_t object,
                                    std::size_t frame);

}  // namespace posemix
