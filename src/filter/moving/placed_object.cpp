// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "placed_object.hpp"

#include <algorithm>

namespace posemix::internal {
namespace {

/// Iterations of the mean of poses near each other; the error falls by the cube of the distance.
constexpr int kMeanIterations = 2;

}  // namespace

DetectionState PlacedObject::seen_from(const KnownFrame& camera) const {
  DetectionState state{.camera = camera.pose, .object = pose, .slow = slow};
  state.covariance.block<6, 6>(kCameraRow, kCameraRow) = camera.covariance;
  state.covariance.block<6, 6>(kObjectRow, kObjectRow) = pose_covariance();
  state.covariance.block<6, 6>(kObjectRow, kSlowRow) = covariance.block<6, 6>(0, kLastSlowRow);
  state.covariance.block<6, 6>(kSlowRow, kObjectRow) = covariance.block<6, 6>(kLastSlowRow, 0);
  state.covariance.block<6, 6>(kSlowRow, kSlowRow) =
      covariance.block<6, 6>(kLastSlowRow, kLastSlowRow);
  return state;
}

void PlacedObject::set_motion(const MotionState& state, const Matrix12d& jacobian) {
  pose = state.pose;
  twist = state.twist;
  covariance.topLeftCorner<12, 12>() = state.covariance;
  if (covariance.bottomRightCorner<6, 6>().isZero(0.0)) return;
  Eigen::Matrix<double, 12, 6> cross;
  for (const Eigen::Index row : {0, 6}) {
    cross.middleRows<6>(row) = jacobian.block<6, 6>(row, 0) * covariance.block<6, 6>(0, 12);
    cross.middleRows<6>(row) += jacobian.block<6, 6>(row, 6) * covariance.block<6, 6>(6, 12);
  }
  covariance.topRightCorner<12, 6>() = cross;
  covariance.bottomLeftCorner<6, 12>() = cross.transpose();
}

void PlacedObject::move(const Vector18d& by) {
  pose = SE3d::exp(Vector6d(by.head<6>())) * pose;
  twist += by.segment<6>(kTwistRow);
  slow += by.tail<6>();
}

void PlacedObject::transform(const Matrix18d& f) {
  covariance = (f * covariance * f.transpose()).eval();
  symmetrize(covariance);
}

Vector18d PlacedObject::from(const PlacedObject& other) const {
  Vector18d apart;
  apart << (pose * other.pose.inverse()).log(), twist - other.twist, slow - other.slow;
  return apart;
}

Matrix18d PlacedObject::transported(const Vector6d& distance) const {
  Matrix18d p = covariance;
  if (distance.isZero(0.0)) return p;
  const Matrix6d j = SE3d::left_jacobian_inverse(distance);
  const Matrix6d half = j * p.topLeftCorner<6, 6>();
  p.topLeftCorner<6, 6>() = half * j.transpose();
  for (const Eigen::Index column : {kTwistRow, kLastSlowRow}) {
    const Matrix6d cross = j * p.block<6, 6>(0, column);
    p.block<6, 6>(0, column) = cross;
    p.block<6, 6>(column, 0) = cross.transpose();
  }
  return p;
}

PlacedObject mixed(std::span<const WeightedObject> parts) {
  const auto& heaviest = *std::max_element(
      parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.weight < b.weight; });
  if (parts.size() == 1) return *heaviest.object;
  double total = 0.0;
  for (const auto& part : parts) total += part.weight;
  PlacedObject result = *heaviest.object;
  std::vector<Vector18d> from(parts.size(), Vector18d::Zero());
  Vector18d mean;
  for (int iteration = 0; iteration < kMeanIterations; ++iteration) {
    mean.setZero();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (iteration > 0 || parts[i].object != heaviest.object)
        from[i] = parts[i].object->from(result);
      mean += parts[i].weight / total * from[i];
    }
    if (iteration + 1 < kMeanIterations) result.move(mean);
  }
  result.covariance.setZero();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Vector18d apart = from[i] - mean;
    result.covariance +=
        parts[i].weight / total *
        (parts[i].object->transported(from[i].head<6>()) + apart * apart.transpose());
  }
  result.move(mean);
  symmetrize(result.covariance);
  return result;
}

void decay_slow(PlacedObject& object, double correlation, const Matrix6d& stationary) {
  object.slow *= correlation;
  object.covariance.bottomRows<6>() *= correlation;
  object.covariance.rightCols<6>() *= correlation;
  object.covariance.bottomRightCorner<6, 6>() += (1.0 - correlation * correlation) * stationary;
}

Matrix18d rescale_slow(PlacedObject& object, const ObjectSensor& sensor, const KnownFrame& camera,
                       const Vector6d& factor) {
  const Matrix6d a =
      slow_error_map(object.seen_from(camera), sensor.noise.components().front(), sensor);
  Matrix18d f = Matrix18d::Identity();
  f.topRightCorner<6, 6>() = a * (Vector6d::Ones() - factor).asDiagonal();
  f.bottomRightCorner<6, 6>() = factor.asDiagonal();
  object.transform(f);
  Vector18d by = Vector18d::Zero();
  by.tail<6>() = (factor - Vector6d::Ones()).cwiseProduct(object.slow);
  by.head<6>() = -a * by.tail<6>();
  object.move(by);
  return f;
}

namespace {

/// The pose becomes T Exp(-u), with u along its own axes: how a twist in the frame changes by u.
Matrix6d turn_of_twist(const PlacedObject& object, MotionFrame frame) {
  if (frame == MotionFrame::object) return -SE3d::ad(object.twist);
  // Only the origin, of which the linear part is the velocity, is another point.
  Matrix6d by = Matrix6d::Zero();
  by.bottomRightCorner<3, 3>() =
      -SO3d::hat(object.twist.head<3>()) * object.pose.rotation().matrix();
  return by;
}

/// The factor on the spin about axes of symmetry, of which nothing tells, that leaves no more than
/// an object has of which no motion is known. `of_spin` takes the spin out of a twist.
double bounded_spin(const PlacedObject& object, const Matrix6d& of_spin,
                    const ConstantVelocityMotion& motion) {
  const Matrix6d twist = object.covariance.block<6, 6>(kTwistRow, kTwistRow);
  const Matrix6d start = motion.start_sds.cwiseAbs2().asDiagonal();
  const auto variance = [&](const Matrix6d& of_twist) {
    return Matrix6d(of_spin * of_twist * of_spin.transpose()).diagonal().head<3>().sum();
  };
  return std::min(1.0, std::sqrt(variance(start) / variance(twist)));
}

}  // namespace

void fix_unobserved(PlacedObject& object, const SymmetryGroup& symmetries,
                    const ObjectMotion& motion) {
  if (symmetries.axes().empty()) return;
  const Matrix6d to_world = object.pose.adjoint();
  const Matrix6d from_world = object.pose.inverse().adjoint();
  const Matrix6d project = symmetries.observed_projection();
  const Matrix6d unobserved = Matrix6d::Identity() - project;
  Matrix18d f = Matrix18d::Identity();
  f.topLeftCorner<6, 6>() = to_world * project * from_world;
  if (const auto* velocity = std::get_if<ConstantVelocityMotion>(&motion)) {
    f.block<6, 6>(kTwistRow, 0) = turn_of_twist(object, velocity->frame) * unobserved * from_world;
    Matrix6d along = Matrix6d::Identity();  // from the object's axes to those of the twist
    if (velocity->frame == MotionFrame::world) {
      const Eigen::Matrix3d r = object.pose.rotation().matrix();
      along.topLeftCorner<3, 3>() = r;
      along.bottomRightCorner<3, 3>() = r;
    }
    const Matrix6d of_spin = along * unobserved * along.transpose();
    const Matrix6d bounded =
        Matrix6d::Identity() - (1.0 - bounded_spin(object, of_spin, *velocity)) * of_spin;
    f.middleRows<6>(kTwistRow) = (bounded * f.middleRows<6>(kTwistRow)).eval();
    object.twist = (bounded * object.twist).eval();
  }
  object.transform(f);
  const Matrix6d fixed = kFixedAngle * symmetries.unobserved_covariance();
  object.covariance.topLeftCorner<6, 6>() += to_world * fixed * to_world.transpose();
}

WorldTwist world_twist(const PlacedObject& object, const ObjectMotion& motion) {
  if (!twist_frame(motion)) return {Vector6d::Zero(), Matrix6d::Zero()};
  const ConstantVelocityMotion world{.frame = MotionFrame::world};
  const MotionState state = as_state_of(object.motion_state(), motion, world);
  return {state.twist, state.covariance.bottomRightCorner<6, 6>()};
}

}  // namespace posemix::internal
