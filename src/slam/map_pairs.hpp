// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "posemix/slam/multi_object_slam.hpp"

/// Two maps, and the pose of one in the world of the other from pairs of their objects
/// (docs/state.md, "A map in a new world").
namespace posemix::internal {

/// The objects of a map that stand still, with the covariances of all their hypotheses, in which an
/// angle about an axis of symmetry is uniform.
class MapSide {
 public:
  MapSide(const MultiObjectSlam& slam, double least_existence);

  /// Hypotheses of an object; empty for one that takes no part.
  const std::vector<ObjectHypothesis>& hypotheses(std::size_t object) const {
    return hypotheses_[object];
  }
  std::size_t size() const { return hypotheses_.size(); }
  const ObjectModel& model(std::size_t object) const { return slam_.objects()[object]; }
  double existence(std::size_t object) const { return *slam_.existence(object); }
  /// The inverse of the camera's covariance, which may be zero where its pose is given.
  const Matrix6d& camera_information() const { return camera_information_; }
  /// Cov(xi, xi') of two hypotheses, world frame. Hypotheses of different objects that do not both
  /// lead depend on each other through the camera alone.
  Matrix6d covariance(std::size_t object, std::size_t h, std::size_t other, std::size_t k) const;

 private:
  bool leads(std::size_t object, std::size_t h) const {
    return slam_.filter().leading(object) == h;
  }

  const MultiObjectSlam& slam_;
  Matrix6d camera_information_;
  std::vector<std::vector<ObjectHypothesis>> hypotheses_;
};

/// An object of the old map and one of the new run, under one hypothesis each.
struct MapPair {
  std::size_t old_object;
  std::size_t old_hypothesis;
  std::size_t new_object;
  std::size_t new_hypothesis;

  bool operator==(const MapPair&) const = default;
};

/// A pair as others predict it.
struct PairPrediction {
  double squared_distance = 0.0;
  double log_density = 0.0;
};

/// An old object in the new world.
struct RelocatedPose {
  ConcentratedGaussian<SE3d> world;
  Matrix6d given_camera;  ///< its covariance where the new camera is at its estimate, eq. (8)
};

/// Generalised least squares for T = T_new_old with a flat prior (docs/state.md, "A map in a new
/// world"). The residual of a pair is
///   r = Log(X_new g (T X_old)^-1) = tau + e,  e = Ad_T xi_old - xi_new,              (1)
/// with the motion g of the object's symmetries that is nearest, and T_true = Exp(tau) T.
class PairsFit {
 public:
  /// Begins at a pose, to which the pairs are fitted.
  PairsFit(const MapSide& old_map, const MapSide& now, SE3d start, std::vector<MapPair> pairs);

  const SE3d& new_old() const { return new_old_; }
  const Matrix6d& covariance() const { return covariance_; }
  const std::vector<MapPair>& pairs() const { return pairs_; }
  /// Of a pair that is none of those that are fitted, eq. (4).
  PairPrediction predict(const MapPair& pair) const;
  /// Squared distance of each pair from where all others expect it, eq. (5).
  std::vector<double> left_out() const;
  /// Density of what the residuals say of each other, with tau integrated out, eq. (6).
  double log_evidence() const;
  /// An old object in the new world: T X_old with all that the pairs tell of it, eq. (4).
  RelocatedPose relocated(std::size_t old_object, std::size_t h) const;
  /// Whether the equations have a solution that is a number.
  bool is_solved() const { return is_solved_; }

 private:
  Vector6d residual(const MapPair& pair) const;
  /// Cov(e, e') of two pairs, eq. (2).
  Matrix6d error(const MapPair& a, const MapPair& b) const;
  void linearise();
  /// A part of the state whose covariance with the errors of the pairs is `cross`, n x 6, and its
  /// own `own`, plus tau: its moments given the residuals.
  std::pair<Vector6d, Matrix6d> given(const Eigen::MatrixXd& cross, const Matrix6d& own) const;

  const MapSide* old_;
  const MapSide* now_;
  SE3d new_old_;
  std::vector<MapPair> pairs_;
  Eigen::VectorXd residuals_;
  Eigen::LLT<Eigen::MatrixXd> factor_;               ///< of Cov(e)
  Eigen::Matrix<double, Eigen::Dynamic, 6> solved_;  ///< Cov(e)^-1 A, A a column of identities
  Vector6d tau_ = Vector6d::Zero();
  Matrix6d covariance_ = Matrix6d::Zero();  ///< of tau
  double log_det_ = 0.0;                    ///< of Cov(e) and of the covariance of tau, inverted
  bool is_solved_ = true;
};

}  // namespace posemix::internal
