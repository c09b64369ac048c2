// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "transport.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "camera_regression.hpp"
#include "joint_gaussian.hpp"
#include "significant_motion.hpp"

namespace posemix::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// The part of the sharpest standard deviation up to which an error is not told from others: what
/// is linearised anew again and again learns of what no detection tells.
constexpr double kSmallPart = 0.3;

/// Half of the angle up to which a turn is small [rad].
constexpr double kSmallTurn = 0.15;

}  // namespace

bool is_far_less_certain(const Matrix6d& difference, const Matrix6d& noise,
                         const Eigen::Vector3d& place) {
  constexpr double kFar = 25.0;
  const SE3d to_place(SO3d(), -place);
  const auto position = [&](const Matrix6d& covariance) -> Eigen::Matrix3d {
    return to_place.adjoint_congruence(covariance).bottomRightCorner<3, 3>();
  };
  const Eigen::LLT<Eigen::Matrix3d> of_noise(position(noise));
  if (of_noise.info() != Eigen::Success) return false;
  const Eigen::Matrix3d half = of_noise.matrixL().solve(position(difference));
  const Eigen::Matrix3d ratio = of_noise.matrixL().solve(half.transpose());
  return ratio.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff() > kFar;
}

LinearRange::LinearRange(const Matrix6d& white)
    : least_position_(std::sqrt(std::max(0.0, white.diagonal().tail<3>().minCoeff()))) {}

bool LinearRange::has(const SE3d& from, const SE3d& to, double rotation_variance) const {
  const double way = (to.translation() - from.translation()).norm();
  const double angle = (to.rotation() * from.rotation().inverse()).log().norm();
  return 0.5 * angle <= kSmallTurn &&
         0.5 * way * std::sqrt(rotation_variance) <= kSmallPart * least_position_;
}

PairTransport::PairTransport(const PoseMove& camera, const PoseMove& object,
                             const Matrix6d& camera_part)
    : camera_part_(camera_part) {
  const auto branch = [](const PoseMove& move) -> Branch {
    const Vector6d moved = (move.to * move.from.inverse()).log();
    return {moved, SE3d::left_jacobian(moved)};
  };
  camera_ = branch(camera);
  object_ = branch(object);
}

TransportMap PairTransport::of_root(const Matrix6d& jacobian) const {
  const Matrix6d of_common = Matrix6d::Identity() - jacobian;
  return {jacobian, of_common * camera_part_, of_common * (Matrix6d::Identity() - camera_part_)};
}

TransportMap PairTransport::of_branch(const Branch& branch, Matrix6d TransportMap::*own) const {
  TransportMap map = of_root(branch.jacobian);
  map.*own += std::exchange(map.own, Matrix6d::Zero());
  return map;
}

TransportMap PairTransport::of_other(const SE3d& from, SE3d& to) const {
  const Vector6d moved = (to * from.inverse()).log();
  const auto to_place = SE3d(SO3d(), -from.translation()).adjoint_blocks();
  const auto way = [&](const Vector6d& by) { return to_place.times(by).tail<3>().norm(); };
  const Vector6d beyond_camera = moved - camera_.moved;
  const Vector6d beyond_object = moved - object_.moved;
  const bool with_camera = way(beyond_camera) <= way(beyond_object);
  const Vector6d& beyond = with_camera ? beyond_camera : beyond_object;
  if (way(moved) <= way(beyond)) return of_root(SE3d::left_jacobian(moved));
  const SE3d shift = SE3d::exp(with_camera ? camera_.moved : object_.moved);
  to = shift * SE3d::exp(beyond) * from;
  TransportMap map = with_camera ? of_camera() : of_object();
  map.own = shift.adjoint() * SE3d::left_jacobian(beyond);
  (with_camera ? map.camera : map.object) -= map.own;
  return map;
}

TransportMoments JointGaussian::transport_all(std::size_t object,
                                              const KeptVector<std::optional<TransportMap>>& maps) {
  const Index n = rig_dof();
  const auto rig_rows = Eigen::seqN(Index{0}, n);
  std::vector<Index> y;
  append_coordinates(y, first(kCamera));
  append_coordinates(y, first(object));
  TransportMoments moments{.rig = rig(),
                           .rig_with_moved = {},
                           .rig_with_pair = covariance_(rig_rows, y),
                           .pair_with_moved = {},
                           .pair = covariance_(y, y)};
  const auto for_each = [&](auto change) {
    for (std::size_t i = 0; i < size(); ++i) {
      if (maps[i]) change(first(i), *maps[i]);
    }
  };
  MatrixXd pair = covariance_(Eigen::all, y);
  for_each([&](Index at, const TransportMap& map) {
    const SixColumns next = covariance_.middleCols<6>(at) * map.own.transpose() +
                            pair.leftCols<6>() * map.camera.transpose() +
                            pair.rightCols<6>() * map.object.transpose();
    covariance_.middleCols<6>(at) = next;
  });
  moments.rig_with_moved = covariance_(rig_rows, rig_rows);
  moments.pair_with_moved = covariance_(y, rig_rows);
  pair = covariance_(y, Eigen::all);
  for_each([&](Index at, const TransportMap& map) {
    const MatrixXd next = map.own * covariance_.middleRows<6>(at) + map.camera * pair.topRows<6>() +
                          map.object * pair.bottomRows<6>();
    covariance_.middleRows<6>(at) = next;
  });
  symmetrize(covariance_);
  return moments;
}

void transport_pose(ConditionalPose& pose, const TransportMap& map, const TransportMoments& moments,
                    const RegularFactor& rig) {
  const Index n = moments.rig.rows();
  MatrixXd cross(12, n);  // with [xi_C; xi_E ...]
  cross.leftCols<6>() = pose.cross_covariance;
  if (n > 6) cross.rightCols(n - 6) = pose.extrinsics;
  const MatrixXd g = rig.solve(cross.transpose()).transpose();
  Matrix12d a = Matrix12d::Identity();
  a.topLeftCorner<6, 6>() = map.own;
  Matrix12d b = Matrix12d::Zero();
  b.topRows<6>() << map.camera, map.object;
  const Matrix12d with_pair = a * (g * moments.rig_with_pair) * b.transpose();
  pose.covariance = a * pose.covariance * a.transpose() + with_pair + with_pair.transpose() +
                    b * moments.pair * b.transpose();
  symmetrize(pose.covariance);
  cross = a * (g * moments.rig_with_moved) + b * moments.pair_with_moved;
  pose.cross_covariance = cross.leftCols<6>();
  if (n > 6) pose.extrinsics = cross.rightCols(n - 6);
}

Transport::Transport(JointGaussian& joint, std::size_t object, const ObservationSource& source,
                     const DetectionState& state, const Innovation& inlier,
                     KeptVector<ConditionalPose*> others, bool is_whole)
    : joint_(joint),
      object_(object),
      range_(inlier.white),
      noise_(inlier.noise),
      is_needed_(is_whole &&
                 is_far_less_certain(state.difference(), inlier.noise, state.object.translation())),
      others_(std::move(others)) {
  if (source.camera) extrinsic_ = JointGaussian::extrinsic_block(*source.camera);
  if (!is_needed_ && !extrinsic_) return;
  if (is_needed_) camera_part_ = state.common_part(inlier.noise);
  from_.reserve(joint.size());
  for (std::size_t i = 0; i < joint.size(); ++i) from_.push_back(joint.pose(i));
  others_from_.reserve(others_.size());
  for (const ConditionalPose* other : others_) others_from_.push_back(other->pose);
}

/// Whether anything that has the largest rotation variance of all would be beyond the linear range.
bool Transport::is_far() const {
  double largest = 0.0;
  for (std::size_t i = 0; i < joint_.size(); ++i) {
    if (joint_.is_in_world(i)) largest = std::max(largest, joint_.rotation_variance(i));
  }
  const auto has = [&](std::size_t i) { return range_.has(from_[i], joint_.pose(i), largest); };
  if (!has(kCamera) || !has(object_)) return true;
  for (std::size_t k = 0; k < others_.size(); ++k) {
    if (!range_.has(others_from_[k], others_[k]->pose,
                    others_[k]->covariance.topLeftCorner<6, 6>()))
      return true;
  }
  return false;
}

/// The camera that sees moves by the sum of what body and extrinsic move by, and the body has the
/// pose that goes with it.
PoseMove Transport::move_of_camera() {
  const SE3d& body = from_[kCamera];
  if (!extrinsic_) return {body, joint_.pose(kCamera)};
  const SE3d& extrinsic = from_[*extrinsic_];
  const Vector6d by_body = (joint_.pose(kCamera) * body.inverse()).log();
  const Vector6d by_extrinsic = (joint_.pose(*extrinsic_) * extrinsic.inverse()).log();
  const SE3d from = body * extrinsic;
  const SE3d to = SE3d::exp(by_body + joint_.linearised_at().adjoint() * by_extrinsic) * from;
  joint_.set_pose(kCamera, to * joint_.pose(*extrinsic_).inverse());
  return {from, to};
}

void Transport::follow() {
  if (!is_needed_ && !extrinsic_) return;
  const PoseMove camera = move_of_camera();
  if (!is_needed_ || !is_far()) return;
  const PairTransport pair(camera, {from_[object_], joint_.pose(object_)}, camera_part_);
  maps_.resize(joint_.size());
  if (!range_.has(camera.from, camera.to, joint_.rotation_variance(kCamera)))
    maps_[kCamera] = pair.of_camera();
  follow_in_joint(pair);
  others_maps_.resize(others_.size());
  for (std::size_t k = 0; k < others_.size(); ++k) {
    ConditionalPose& other = *others_[k];
    if (!range_.has(others_from_[k], other.pose, other.covariance.topLeftCorner<6, 6>()))
      others_maps_[k] = pair.of_other(others_from_[k], other.pose);
  }
}

void Transport::follow_in_joint(const PairTransport& pair) {
  bool is_passive = false;
  for (std::size_t i = 0; i < joint_.size(); ++i) {
    if (i == kCamera || !joint_.is_in_world(i) ||
        range_.has(from_[i], joint_.pose(i), joint_.rotation_variance(i)))
      continue;
    is_passive = is_passive || !joint_.is_active(i);
    if (i == object_) {
      maps_[i] = pair.of_object();
    } else {
      SE3d to = joint_.pose(i);
      maps_[i] = pair.of_other(from_[i], to);
      joint_.set_pose(i, to);
    }
  }
  if (is_passive) joint_.activate_all();
}

/// xi_C + `sign` Ad_A xi_E in place of xi_C, where cameras are linearised at A: with 1 the error of
/// the camera that sees, and with -1 that of the body again.
void Transport::add_extrinsic(double sign) {
  const Matrix6d by = sign * joint_.linearised_at().adjoint();
  joint_.combine({kCamera, Matrix6d::Identity(), *extrinsic_, by});
  for (ConditionalPose* other : others_) other->add_extrinsic_to_camera(*extrinsic_, by);
}

void Transport::transport_covariances() {
  const TransportMoments moments = joint_.transport_all(object_, maps_);
  const RegularFactor rig(moments.rig);
  for (std::size_t k = 0; k < others_.size(); ++k)
    transport_pose(*others_[k], others_maps_[k].value_or(TransportMap()), moments, rig);
}

void Transport::apply(bool camera_is_told) {
  const SE3d at = joint_.linearised_at();
  const SE3d to = joint_.is_linearised() ? near_body(at, joint_.pose(kCamera), noise_) : at;
  const bool stays = to.matrix() == at.matrix();
  if (stays && maps_.empty()) return;
  if (extrinsic_) add_extrinsic(1.0);
  if (!maps_.empty()) transport_covariances();
  if (!stays && camera_is_told) joint_.linearise_at(to);
  if (extrinsic_) add_extrinsic(-1.0);
  if (!stays) joint_.linearise_at(to);
}

}  // namespace posemix::internal
