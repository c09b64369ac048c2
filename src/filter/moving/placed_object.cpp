// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "placed_object.hpp"

#include <algorithm>

namespace posemix::internal {
namespace {

/// Iterations of the mean of poses near each other; the error falls by the cube of the distance.
constexpr int kMeanIterations = 2;

/// The covariance in the tangent space at a pose that is at -d from the object's, eq. 14 of the
/// midway-merge paper.
Matrix18d transported(const PlacedObject& object, const Vector6d& d) {
  Matrix18d p = object.covariance;
  if (d.isZero(0.0)) return p;
  const Matrix6d j = SE3d::left_jacobian_inverse(d);
  p.topRows<6>() = (j * p.topRows<6>()).eval();
  p.leftCols<6>() = (p.leftCols<6>() * j.transpose()).eval();
  return p;
}

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
  const Eigen::Matrix<double, 12, 6> cross = jacobian * covariance.topRightCorner<12, 6>();
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
      const PlacedObject& part = *parts[i].object;
      from[i].head<6>() = (part.pose * result.pose.inverse()).log();
      from[i].segment<6>(kTwistRow) = part.twist - result.twist;
      from[i].tail<6>() = part.slow - result.slow;
      mean += parts[i].weight / total * from[i];
    }
    if (iteration + 1 < kMeanIterations) result.move(mean);
  }
  result.covariance.setZero();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Vector18d apart = from[i] - mean;
    result.covariance +=
        parts[i].weight / total *
        (transported(*parts[i].object, from[i].head<6>()) + apart * apart.transpose());
  }
  result.move(mean);
  symmetrize(result.covariance);
  return result;
}

void predict(PlacedObject& object, const ObjectMotion& motion, double dt,
             const SE3d& frame_motion) {
  const MotionPrediction next = posemix::predict(object.motion_state(), motion, dt, frame_motion);
  object.set_motion(next.state, next.jacobian);
}

void decay_slow(PlacedObject& object, double correlation, const Matrix6d& stationary) {
  object.slow *= correlation;
  object.covariance.bottomRows<6>() *= correlation;
  object.covariance.rightCols<6>() *= correlation;
  object.covariance.bottomRightCorner<6, 6>() += (1.0 - correlation * correlation) * stationary;
}

void rescale_slow(PlacedObject& object, const ObjectSensor& sensor, const KnownFrame& camera,
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
}

void fix_unobserved(PlacedObject& object, const SymmetryGroup& symmetries,
                    const ObjectMotion& motion) {
  if (symmetries.axes().empty()) return;
  const Matrix6d to_world = object.pose.adjoint();
  const Matrix6d project = symmetries.observed_projection();
  Matrix18d f = Matrix18d::Identity();
  f.topLeftCorner<6, 6>() = to_world * project * object.pose.inverse().adjoint();
  const auto frame = twist_frame(motion);
  Matrix6d along = Matrix6d::Identity();  // from the object's axes to those of the twist
  if (frame == MotionFrame::world) {
    const Eigen::Matrix3d r = object.pose.rotation().matrix();
    along.topLeftCorner<3, 3>() = r;
    along.bottomRightCorner<3, 3>() = r;
  }
  const Matrix6d of_twist = along * project * along.transpose();
  if (frame) {
    f.block<6, 6>(kTwistRow, kTwistRow) = of_twist;
    object.twist = (of_twist * object.twist).eval();
  }
  object.transform(f);
  const Matrix6d fixed = kFixedAngle * symmetries.unobserved_covariance();
  object.covariance.topLeftCorner<6, 6>() += to_world * fixed * to_world.transpose();
  if (frame)
    object.covariance.block<6, 6>(kTwistRow, kTwistRow) += along * fixed * along.transpose();
}

WorldTwist world_twist(const PlacedObject& object, const ObjectMotion& motion) {
  if (!twist_frame(motion)) return {Vector6d::Zero(), Matrix6d::Zero()};
  const ConstantVelocityMotion world{.frame = MotionFrame::world};
  const MotionState state = as_state_of(object.motion_state(), motion, world);
  return {state.twist, state.covariance.bottomRightCorner<6, 6>()};
}

}  // namespace posemix::internal
