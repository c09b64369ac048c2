// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>

#include "base/kept_memory.hpp"
#include "joint_gaussian_parts.hpp"

/// Covariances in the tangent spaces at the means to which a detection moves poses: eq. (33) to
/// (36) of docs/many-objects.md.
namespace posemix::internal {

class JointGaussian;
class RegularFactor;

/// Whether a prediction knows in some direction where an object is, relative to the camera that
/// sees it, by far worse than a detection does: a linearisation where the detection takes the poses
/// is the better one. `difference` is the covariance of xi_O - xi_C, `noise` that of the detection,
/// `place` that of the object.
bool is_far_less_certain(const Matrix6d& difference, const Matrix6d& noise,
                         const Eigen::Vector3d& place);

/// How far a pose may move with its covariance left as it is. Beyond, the error of its rotation
/// becomes, over the way that the pose moves, one of its position that is not small beside the
/// sharpest one of the detector; or it turns by an angle that is not small.
class LinearRange {
 public:
  /// `white` is the covariance of the detector's white error along its axes.
  explicit LinearRange(const Matrix6d& white);
  /// Whether a move of a pose whose rotation has at most this variance [rad^2] is within.
  bool has(const SE3d& from, const SE3d& to, double rotation_variance) const;
  /// The same for a pose with this covariance.
  bool has(const SE3d& from, const SE3d& to, const Matrix6d& covariance) const {
    return has(from, to, covariance.diagonal().head<3>().maxCoeff());
  }

 private:
  double least_position_;  ///< standard deviation [m]
};

/// The coordinates x of a pose become own x + camera xi_C + object xi_O, where xi_C is the camera
/// that sees, and xi_O the pose that was detected, as its leading hypothesis has it. The three sum
/// to the identity: what all poses have in common stays.
struct TransportMap {
  Matrix6d own = Matrix6d::Identity();
  Matrix6d camera = Matrix6d::Zero();
  Matrix6d object = Matrix6d::Zero();
};

/// Where a pose was and is.
struct PoseMove {
  SE3d from;
  SE3d to;
};

/// How coordinates change where a detection moves the camera and the object.
class PairTransport {
 public:
  /// `camera_part` is G of eq. (33).
  PairTransport(const PoseMove& camera, const PoseMove& object, const Matrix6d& camera_part);

  /// Eq. (35).
  TransportMap of_camera() const { return of_branch(camera_, &TransportMap::camera); }
  TransportMap of_object() const { return of_branch(object_, &TransportMap::object); }
  /// The map of any other pose, which moves on to where it is given what it moved with: eq. (35)
  /// or (36).
  TransportMap of_other(const SE3d& from, SE3d& to) const;

 private:
  struct Branch {
    Vector6d moved;
    Matrix6d jacobian;  ///< J_l(moved)
  };

  /// r + J (x - r).
  TransportMap of_root(const Matrix6d& jacobian) const;
  TransportMap of_branch(const Branch& branch, Matrix6d TransportMap::*own) const;

  Branch camera_;
  Branch object_;
  Matrix6d camera_part_;
};

/// Moments of camera and extrinsics, xi = [xi_C; xi_E ...], and of y = [xi_C; xi_O] before they are
/// transported, and with xi' after it.
struct TransportMoments {
  Eigen::MatrixXd rig;              ///< Cov(xi)
  Eigen::MatrixXd rig_with_moved;   ///< Cov(xi, xi')
  Eigen::MatrixXd rig_with_pair;    ///< Cov(xi, y)
  Eigen::MatrixXd pair_with_moved;  ///< Cov(y, xi')
  Matrix12d pair;                   ///< Cov(y)
};

/// The transport of a pose that depends on the rest through camera and extrinsics; `rig` is the
/// factor of their covariance before.
void transport_pose(ConditionalPose& pose, const TransportMap& map, const TransportMoments& moments,
                    const RegularFactor& rig);

/// The transport of everything after an update. Made before the update, which gets the poses by
/// reference: those of the joint Gaussian, and those that depend on it through the camera.
class Transport {
 public:
  /// `object` is the index of the one that is detected, by `source`; `state` is that of its leading
  /// hypothesis with the camera that sees it, and `inlier` its most probable innovation. Nothing is
  /// transported where the correction is not taken whole.
  Transport(JointGaussian& joint, std::size_t object, const ObservationSource& source,
            const DetectionState& state, const Innovation& inlier,
            KeptVector<ConditionalPose*> others, bool is_whole);

  /// The poses have moved: the camera that sees has the pose of its sum, and those that moved with
  /// camera or object beyond the linear range move on.
  void follow();
  /// Transports the covariances. Where cameras on the body are linearised follows it, eq. (38) of
  /// docs/many-objects.md: the error of the camera that sees stays if that is what is told.
  void apply(bool camera_is_told);

 private:
  bool is_far() const;
  PoseMove move_of_camera();
  void follow_in_joint(const PairTransport& pair);
  void add_extrinsic(double sign);
  void transport_covariances();

  JointGaussian& joint_;
  std::size_t object_;
  /// The block of a camera on the body whose pose is estimated, if it is that which sees.
  std::optional<std::size_t> extrinsic_;
  LinearRange range_;
  Matrix6d noise_;  ///< of the detection, world frame
  bool is_needed_;
  Matrix6d camera_part_;
  KeptVector<SE3d> from_;  ///< by block of the joint Gaussian
  KeptVector<ConditionalPose*> others_;
  KeptVector<SE3d> others_from_;
  /// None where the coordinates stay.
  KeptVector<std::optional<TransportMap>> maps_;
  KeptVector<std::optional<TransportMap>> others_maps_;
};

}  // namespace posemix::internal
