// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "joint_gaussian_parts.hpp"
#include "posemix/base/state_fields.hpp"
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/filter/update.hpp"
#include "posemix/lie/pose_blocks.hpp"
#include "transport.hpp"

namespace posemix::internal {

/// The joint Gaussian of the camera (block 0), the poses of cameras on it that are estimated, the
/// extrinsics (blocks 1, 2, ...), its motion where that is estimated, and for every
/// object with hypotheses the pose of the leading one, followed by its slow error where the
/// detector has one; with their full covariance B (docs/many-objects.md). A block has six
/// coordinates.
///
/// Blocks are active or passive ("Hundreds of landmarks"; guivant2001optimization). Those of the
/// camera and of objects that were seen lately are active, and their moments are stored. A passive
/// block follows them, x = s (x_0 + U y): x_0 has the covariance of a base that does not change,
/// and the carriers y, few coordinates that all passive blocks share, have moments like those of an
/// active block. All that changes the active blocks and the carriers by linear maps thus changes
/// the passive ones in no time, exactly. All blocks are active until rebase() is called.
///
/// Invariants: the camera, the extrinsics and the motion are active; camera and extrinsics have the
/// first coordinates; both blocks of an object are active, or none; without passive blocks the
/// coordinates of the blocks stand in their order.
class JointGaussian {
 public:
  explicit JointGaussian(const ConcentratedGaussian<SE3d>& camera)
      : blocks_{{.pose = camera.mean()}}, covariance_(camera.covariance()) {}

  /// Number of blocks.
  std::size_t size() const { return blocks_.size(); }
  bool is_pose(std::size_t index) const { return !blocks_[index].slow; }
  const SE3d& pose(std::size_t index) const { return blocks_[index].pose; }
  void set_pose(std::size_t index, const SE3d& pose) { blocks_[index].pose = pose; }
  const Vector6d& slow(std::size_t index) const { return blocks_[index].slow.value(); }
  /// The covariance of two blocks; the camera's is stored, that of passive blocks made.
  Matrix6d covariance(std::size_t row, std::size_t column) const;
  /// The covariance of all blocks, made for the call: quadratic in the objects.
  Eigen::MatrixXd covariance() const;

  /// Number of blocks of the object at `index`: two with a slow error.
  std::size_t blocks_of(std::size_t index) const {
    return index + 1 < size() && !is_pose(index + 1) ? 2 : 1;
  }
  /// Pose and slow error of the object at `index`, given the camera.
  ConditionalPose conditional(std::size_t index) const;

  /// Covariance of every pose, and with the camera, by the index of its block.
  std::vector<PoseMoments> pose_moments() const;

  // --- extrinsics

  /// Appends the pose of a camera on the body, which depends on nothing. Nothing but the camera and
  /// other extrinsics may be there.
  void append_extrinsic(const ConcentratedGaussian<SE3d>& body_camera);
  std::size_t extrinsics() const { return extrinsics_; }
  /// Index of the block of an extrinsic.
  static constexpr std::size_t extrinsic_block(std::size_t extrinsic) { return 1 + extrinsic; }
  bool is_extrinsic(std::size_t index) const { return index > 0 && index <= extrinsics_; }
  /// Whether the block is a pose in the world.
  bool is_in_world(std::size_t index) const {
    return is_pose(index) && !blocks_[index].is_motion && !is_extrinsic(index);
  }
  /// The pose of the body at which detections by cameras on it are linearised, eq. (38): its own
  /// before the first one.
  const SE3d& linearised_at() const { return linearised_at_ ? *linearised_at_ : pose(kCamera); }
  bool is_linearised() const { return linearised_at_.has_value(); }
  void linearise_at(const SE3d& body) { linearised_at_ = body; }
  /// T_world_camera of the camera that made an observation.
  SE3d seeing_camera(const ObservationSource& source) const;
  /// The error of that camera is this, 6 rows, times [xi_C; xi_E ...].
  Eigen::MatrixXd seen_by(const ObservationSource& source) const;
  /// Covariance of [xi_C; xi_E ...].
  auto rig() const { return covariance_.topLeftCorner(rig_dof(), rig_dof()); }
  /// Camera and extrinsics in the tangent space at their means in `at`.
  CameraMoments camera_moments(const JointGaussian& at) const;
  CameraMoments camera_moments() const { return camera_moments(*this); }

  // --- the error of the world, a shift that moves the block at every index by a factor `moved`

  /// Eq. (31): its information W^-1 = N^T B^-1 N, where N has these factors. None with passive
  /// blocks, and where the covariance is numerically not positive definite.
  std::optional<Matrix6d> world_information(const WorldMoves& moved) const;
  /// B <- B - N D N^T, with all blocks active.
  void take_out(const Matrix6d& d, const WorldMoves& moved);
  /// Adds the covariance of an independent shift to all poses in the world.
  void add_world_error(const Matrix6d& shift);

  /// The origin of the world moves. `shared` is that of all that share a base.
  void move_world(const WorldShift& shift, MovedBases& shared);
  /// Adds the rows of passive poses to those of the base.
  void add_passive_rows(MovedBases& shared) const;

  /// Appends an object that depends on the rest through the camera alone. Returns its index.
  std::size_t append(const ConditionalPose& object);
  /// Appends the camera's motion, which depends on nothing, with its covariance. Returns its index.
  std::size_t append_motion(const SE3d& motion, const Matrix6d& covariance);
  /// Puts an object that depends on the rest through the camera alone at `index`.
  void replace(std::size_t index, const ConditionalPose& object);
  /// Erases the object at `index`; blocks behind it move up. The rest keeps its moments.
  void erase(std::size_t index);

  /// The rows of the object at `index`, which becomes active: 6 or 12 rows, with a column for every
  /// coordinate of active blocks and carriers.
  Eigen::MatrixXd rows_of(std::size_t index);
  /// The rows that an object would have that depends on the rest through the camera alone.
  KeptMatrix<> regressed_rows(const ConditionalPose& object) const;
  /// Replaces the object at `index`, which is active, and its rows of the covariance; the part in
  /// its own columns is `own`.
  void set_rows(std::size_t index, const SE3d& pose, const std::optional<Vector6d>& slow,
                const Eigen::Ref<const Eigen::MatrixXd>& rows, const Matrix12d& own);
  /// x <- F x for the coordinates x of the object at `index`, with F of 6 or 12 rows.
  void transform(std::size_t index, const Eigen::Ref<const Eigen::MatrixXd>& f);
  /// Moves the object at `index` and its slow error by [xi_O; b].
  void move_object(std::size_t index, const Vector12d& by);
  /// Multiplies the slow error of the object at `index` by `factor` and adds `q` to its covariance.
  void decay_slow(std::size_t index, double factor, const Matrix6d& q);
  /// Adds independent noise of covariance `q` to a block.
  void add_noise(std::size_t index, const Matrix6d& q);
  /// The camera becomes independent of all else, with this covariance.
  void release_camera(const Matrix6d& covariance);
  /// Other coordinates for an active block, of which the other one is active, too.
  void combine(const BlockCoordinates& coordinates);
  void make_symmetric() { symmetrize(covariance_); }

  /// A detection of the object at `index`, explained under its leading hypothesis, which holds with
  /// probability 1 - alternative.weight; otherwise the camera has the moments of `alternative`.
  /// Projects this mixture onto one Gaussian with the least loss (docs/many-objects.md, eq. 5 to
  /// 8) and moves the blocks to its mean. The gain of all but the object has the camera's
  /// factor. The rows of the change are those of active blocks and carriers, the camera first.
  CameraChange update(std::size_t index, const Explanation& leading,
                      const CameraAlternative& alternative, const GainFactors& factors,
                      const ObservationSource& source = {});
  /// The same by dense products and factors: for extrinsics and passive objects, where the
  /// covariance is nearly singular, and as the reference.
  CameraChange update_densely(std::size_t index, const Explanation& leading,
                              const CameraAlternative& alternative, const GainFactors& factors,
                              const ObservationSource& source = {});
  /// Becomes the mixture of this with 1 - `weight` and of `other` with `weight`, eq. (11): the
  /// blocks in `shared`, by their index here and there, take its moments, and the others keep their
  /// regression on them. Returns the mean of camera and extrinsics in the tangent space at the mean
  /// before.
  Eigen::VectorXd mix(double weight, const JointGaussian& other, const BlockPairs& shared);
  /// The covariance in the tangent spaces at means that have moved, by a map of every block whose
  /// coordinates change; all of them are active. `object` is the index of the one detected; the
  /// camera's coordinates are those of the camera that sees.
  TransportMoments transport_all(std::size_t object,
                                 const KeptVector<std::optional<TransportMap>>& maps);
  /// Takes the part `back` of the camera's correction back, see eq. (10).
  void shift_back(const CameraChange& change, const Matrix6d& back);

  // --- active and passive blocks

  bool is_active(std::size_t index) const { return blocks_[index].at >= 0; }
  /// Number of active blocks.
  std::size_t active() const;
  /// The largest variance of the rotation of a pose [rad^2]; of a passive one as it was when it was
  /// active.
  double rotation_variance(std::size_t index) const;
  /// All blocks become active. Nothing else changes: quadratic in the objects.
  void activate_all();
  /// The object at `index` becomes active. Nothing else changes.
  void activate(std::size_t index);
  /// Blocks are active after this where `keeps` is true, and the base is the covariance as it is
  /// now. Nothing else changes. Quadratic in the objects.
  void rebase(const std::vector<bool>& keeps);
  /// The same for the joint Gaussian of another global hypothesis: `first` was rebased, and `same`
  /// has the blocks that are the same in both, by their index here and there. Blocks that are
  /// passive there become passive here and have the regression on the active ones that they have
  /// there (docs/many-objects.md, eq. 18); the others are active.
  void rebase_like(const JointGaussian& first, const BlockPairs& same);

 private:
  template <class>
  friend struct StateFields;

  struct Block {
    SE3d pose;
    std::optional<Vector6d> slow = {};  ///< present where the block is a slow error
    Eigen::Index at = 0;                ///< first coordinate in covariance_; -1 where passive
    bool is_motion = false;             ///< whether it is the motion of the camera
    Eigen::Index row = -1;              ///< first row in the base, where passive; -1: in none
    double scale = 1.0;                 ///< s of a passive block
    double correlation = 1.0;           ///< of a slow error, since the block was active
    Matrix6d noise = Matrix6d::Zero();  ///< of a passive block, independent of everything
  };
  /// Six coordinates by which passive blocks follow the active ones.
  struct Carrier {
    Eigen::Index at;                            ///< first coordinate in covariance_
    Eigen::Index row;                           ///< of the block of the base that it was; -1: none
    std::shared_ptr<const SixColumns> columns;  ///< U; null for a shift of the world
    Vector6d mean = Vector6d::Zero();           ///< since the base was made
  };
  /// Of active blocks, for rebase_like().
  struct Coordinates {
    std::vector<Eigen::Index> kept;          ///< of what stays active
    std::vector<Eigen::Index> common;        ///< of these, of what is active there too
    std::vector<Eigen::Index> common_there;  ///< the same in the other joint Gaussian
  };

  /// First coordinate and number of coordinates of the object at `index`, which is active.
  Eigen::Index first(std::size_t index) const { return blocks_[index].at; }
  Eigen::Index dof(std::size_t index) const { return offset(blocks_of(index)); }
  Eigen::Index rig_dof() const { return offset(1 + extrinsics_); }
  /// First coordinates of the active poses in the world, and of the carrier of its shifts.
  KeptVector<Eigen::Index> world_coordinates() const;
  /// update() in the columns of what the detection sees, for an object of Own coordinates; none
  /// where the covariance is nearly singular.
  template <int Own>
  std::optional<CameraChange> update_columns(std::size_t index, const Explanation& leading,
                                             const CameraAlternative& alternative,
                                             const GainFactors& factors);
  /// P H^T of a detection of the object at `index` under one component.
  SixColumns times_ht(std::size_t index, const Matrix6d& slow_map,
                      const Eigen::MatrixXd& seen_by) const;
  /// Projects the mixture of the moments (`mean`, `b`) of the leading hypothesis and (`mean` +
  /// `apart`, `other`) with weight `w_a` (eq. 7 and 8). `mean` becomes that of the projection.
  void project(std::size_t index, double w_a, Eigen::VectorXd& mean, const Eigen::MatrixXd& b,
               const Eigen::VectorXd& apart, const Eigen::MatrixXd& other);
  /// The same with the regression on the camera and few neighbours (eq. 13 and 14). `b` is that of
  /// the leading hypothesis.
  void project_near(std::size_t index, const Explanation& leading,
                    const CameraAlternative& alternative, double gain,
                    const Eigen::MatrixXd& seen_by, Eigen::VectorXd& mean, Eigen::MatrixXd& b);
  /// Coordinates of the camera, its motion and the active blocks that tell most of the object at
  /// `index` beyond what the camera tells.
  std::vector<Eigen::Index> neighbours(std::size_t index) const;
  /// Whether everything but the object at `index` is little.
  bool is_small(std::size_t index) const;
  /// The means of `other` in the tangent space at those of this, for the blocks in `shared`.
  Eigen::VectorXd difference(const JointGaussian& other, const BlockPairs& shared) const;
  /// mix() where all blocks in `shared` are active and the carriers are the same.
  Eigen::VectorXd mix_aligned(double weight, const JointGaussian& other, const BlockPairs& shared);
  /// The coordinates `s` get moments, and the others keep their regression on the first `own` of
  /// them. Returns the mean of all.
  bool are_rotations(const Eigen::VectorXd& moved, const Eigen::MatrixXd& covariance,
                     const std::vector<Eigen::Index>& r) const;
  Eigen::VectorXd regressed_on(const std::vector<Eigen::Index>& s, const Eigen::VectorXd& mean_s,
                               const Eigen::MatrixXd& covariance_s, Eigen::Index own);
  /// Blocks that are shared become active where they are in one of the two, and both get the same
  /// carriers.
  void align(JointGaussian& other, const BlockPairs& shared);
  void add_carrier(const Carrier& like);
  /// Base and carriers become those of `first`, from which the means of the common blocks are
  /// `apart`; other coordinates than those kept are dropped.
  void take_carriers(const JointGaussian& first, const Coordinates& coordinates,
                     const Eigen::VectorXd& apart);
  const Carrier* carrier_of(Eigen::Index row) const;
  /// Moves every active block by its part of `mean`. Returns the camera's part.
  Vector6d move_active(const Eigen::VectorXd& mean);
  /// Moves every carrier by its part of `mean`, and the passive blocks with them.
  void move_passive(const Eigen::VectorXd& mean);

  /// U of a passive block, for one carrier.
  Matrix6d loading(const Block& block, const Carrier& carrier) const;
  /// Covariance of two passive blocks of the base, by their rows.
  Matrix6d base(Eigen::Index row, Eigen::Index column) const;
  /// Six columns of the base.
  SixColumns base_columns(Eigen::Index row) const;
  /// Covariance of a passive block with all coordinates, 6 x n.
  Eigen::MatrixXd passive_rows(const Block& block) const;
  Matrix6d passive_block(const Block& row, const Block& column) const;
  /// The same for two passive blocks, given passive_rows() of the first.
  Matrix6d passive_pair(const Block& row, const Eigen::MatrixXd& row_covariance,
                        const Block& column) const;
  /// The covariance of the blocks in `order`, its lower triangle.
  Eigen::MatrixXd lower(const std::vector<std::size_t>& order) const;
  void add_passive(const std::vector<std::size_t>& order, Eigen::MatrixXd& lower) const;
  void add_active(const std::vector<std::size_t>& order, Eigen::MatrixXd& lower) const;
  /// U of the blocks in `order`, zero for active ones.
  Eigen::MatrixXd loadings(const std::vector<std::size_t>& order) const;
  /// A slow error that has forgotten when it was seen last becomes independent of everything.
  void free_slow(Block& slow, const Matrix6d& covariance);
  std::vector<Eigen::Index> carrier_coordinates() const;

  std::vector<Block> blocks_;
  std::size_t extrinsics_ = 0;  ///< their number
  Eigen::MatrixXd covariance_;  ///< of active blocks and carriers
  std::vector<Carrier> carriers_;
  std::shared_ptr<const Eigen::MatrixXd>
      base_;                           ///< its lower triangle; null without passive blocks
  std::optional<SE3d> linearised_at_;  ///< none before a detection by an extrinsic
};

}  // namespace posemix::internal
