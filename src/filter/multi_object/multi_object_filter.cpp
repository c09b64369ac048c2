// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/multi_object_filter.hpp"

#include <cmath>
#include <utility>

#include "multi_object_state.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/filter/predict.hpp"

namespace posemix {

using namespace internal;

namespace {

void require_finite(const SE3d& pose, const char* name) {
  if (!pose.matrix().allFinite())
    throw InvalidInput(fmt::format("{} holds a value that is not finite", name));
}

/// A noise may be zero in some directions.
void require_noise(const Matrix6d& covariance, const char* name) {
  if (!covariance.allFinite())
    throw InvalidInput(fmt::format("{} holds a value that is not finite", name));
  if (covariance.diagonal().minCoeff() < 0.0)
    throw InvalidInput(fmt::format("{} has a negative variance", name));
}

void require_time(double dt) {
  if (!(dt >= 0.0) || std::isinf(dt))
    throw InvalidInput(fmt::format("time step is {}; expected seconds, zero or more", dt));
}

void require_object(std::size_t object, std::size_t objects) {
  if (object >= objects)
    throw InvalidInput(fmt::format("there is no object {}; there are {}", object, objects));
}

void require_hypothesis(std::size_t hypothesis, std::size_t object, std::size_t hypotheses) {
  if (hypothesis >= hypotheses) {
    throw InvalidInput(fmt::format("object {} has {} hypotheses; there is none at index {}", object,
                                   hypotheses, hypothesis));
  }
}

}  // namespace

MultiObjectFilter::MultiObjectFilter(const ConcentratedGaussian<SE3d>& camera,
                                     std::vector<ObjectSensor> objects,
                                     const MultiObjectSettings& settings)
    : state_(std::make_unique<MultiObjectState>(camera, std::move(objects), settings)) {}

MultiObjectFilter::MultiObjectFilter(const MultiObjectFilter& other)
    : state_(std::make_unique<MultiObjectState>(*other.state_)) {}
MultiObjectFilter::MultiObjectFilter(MultiObjectFilter&&) noexcept = default;
MultiObjectFilter& MultiObjectFilter::operator=(const MultiObjectFilter& other) {
  if (this != &other) state_ = std::make_unique<MultiObjectState>(*other.state_);
  return *this;
}
MultiObjectFilter& MultiObjectFilter::operator=(MultiObjectFilter&&) noexcept = default;
MultiObjectFilter::~MultiObjectFilter() = default;

void MultiObjectFilter::predict_with_odometry(const SE3d& motion, const Matrix6d& q, double dt) {
  require_finite(motion, "odometry");
  require_noise(q, "noise of the odometry");
  require_time(dt);
  JointGaussian& joint = state_->joint;
  const SE3d camera = joint.pose(kCamera) * motion;
  joint.set_pose(kCamera, camera);
  const double factor = state_->covariance_factor();
  const double share = state_->settings.odometry_camera_fraction;
  block(joint.covariance(), kCamera, kCamera) += share / factor * camera.adjoint_congruence(q);
  state_->drift += (1.0 - share) / factor * q;
  state_->advance(dt);
}

void MultiObjectFilter::predict_random_walk(const Matrix6d& q, double dt) {
  require_noise(q, "noise of the random walk");
  require_time(dt);
  JointGaussian& joint = state_->joint;
  block(joint.covariance(), kCamera, kCamera) +=
      joint.pose(kCamera).adjoint_congruence(q) / state_->covariance_factor();
  state_->advance(dt);
}

void MultiObjectFilter::predict_constant_velocity(double periods, const Matrix6d& q,
                                                  const Matrix6d& q_motion, const Matrix6d& at_rest,
                                                  double dt) {
  require_noise(q, "noise of the pose");
  require_noise(q_motion, "noise of the motion");
  require_noise(at_rest, "covariance of the motion at rest");
  require_time(dt);
  if (!std::isfinite(periods))
    throw InvalidInput(fmt::format("{} periods; expected a finite number", periods));
  JointGaussian& joint = state_->joint;
  if (!state_->motion) state_->motion = joint.append(SE3d(), at_rest, Matrix6d::Zero());
  const std::size_t motion = *state_->motion;
  const SE3d camera = joint.pose(kCamera);
  const SE3d velocity = joint.pose(motion);
  const Matrix6d transfer = constant_velocity_transfer(camera, velocity, periods);

  // xi_C <- xi_C + F xi_V. First the alternatives, whose poses depend on the camera alone: P_OC
  // grows by P_OC P_CC^-1 P_CV F^T. Then the joint Gaussian.
  const Eigen::LLT<Matrix6d> before(joint.covariance(kCamera, kCamera));
  const Matrix6d with_motion =
      before.solve(joint.covariance(kCamera, motion)) * transfer.transpose();
  for (TrackedObject& object : state_->objects) object.belief.add_to_cross_covariances(with_motion);
  Eigen::MatrixXd& b = joint.covariance();
  rows(b, kCamera) += transfer * rows(b, motion);
  columns(b, kCamera) += columns(b, motion) * transfer.transpose();
  const SE3d moved = camera * SE3d::exp(periods * velocity.log());
  joint.set_pose(kCamera, moved);
  block(b, kCamera, kCamera) += moved.adjoint_congruence(q);
  block(b, motion, motion) += velocity.adjoint_congruence(q_motion);
  symmetrize(b);
  state_->advance(dt);
}

ObjectUpdateReport MultiObjectFilter::update(std::size_t object, const SE3d& camera_object) {
  require_object(object, objects());
  require_finite(camera_object, "detection");
  return state_->update(object, camera_object);
}

void MultiObjectFilter::forget(std::size_t object) {
  require_object(object, objects());
  state_->forget(object);
}

std::size_t MultiObjectFilter::objects() const { return state_->objects.size(); }

double MultiObjectFilter::correlation_length() const { return state_->correlation_length(); }

Vector6d MultiObjectFilter::noise_scale(std::size_t object) const {
  return sensor(object).noise_scale;
}

ConcentratedGaussian<SE3d> MultiObjectFilter::camera() const {
  return ConcentratedGaussian<SE3d>::trusted(
      state_->joint.pose(kCamera),
      state_->covariance_factor() * state_->joint.covariance(kCamera, kCamera));
}

std::vector<ObjectHypothesis> MultiObjectFilter::hypotheses(std::size_t object) const {
  require_object(object, objects());
  const TrackedObject& tracked = state_->objects[object];
  const std::vector<double> probabilities = state_->probabilities(tracked);
  std::vector<ObjectHypothesis> list;
  for (std::size_t h = 0; h < tracked.belief.size(); ++h) {
    const Standing& standing = tracked.belief.standing(h);
    const Pair pair = state_->inflated_pair(tracked, h);
    list.push_back({.pose = pair.object,
                    .covariance = pair.covariance.bottomRightCorner<6, 6>(),
                    .cross_covariance = pair.covariance.bottomLeftCorner<6, 6>(),
                    .log_weight = standing.log_weight,
                    .probability = probabilities[h],
                    .score = standing.score,
                    .id = standing.id,
                    .detections = standing.detections});
  }
  return list;
}

std::optional<std::size_t> MultiObjectFilter::leading(std::size_t object) const {
  require_object(object, objects());
  return state_->objects[object].belief.leading();
}

double MultiObjectFilter::mode_probability(std::size_t object) const {
  const auto leads = leading(object);
  return leads ? state_->probabilities(state_->objects[object])[*leads] : 0.0;
}

double MultiObjectFilter::log_absent(std::size_t object) const {
  require_object(object, objects());
  return state_->objects[object].belief.log_absent();
}

ConcentratedGaussian<SE3d> MultiObjectFilter::relative(std::size_t object,
                                                       std::size_t hypothesis) const {
  require_object(object, objects());
  require_hypothesis(hypothesis, object, state_->objects[object].belief.size());
  const Pair pair = state_->inflated_pair(state_->objects[object], hypothesis);
  return ConcentratedGaussian<SE3d>::trusted(
      pair.camera_object(), pair.camera.inverse().adjoint_congruence(pair.difference()));
}

ConcentratedGaussian<PoseStackd> MultiObjectFilter::joint() const {
  const JointGaussian& joint = state_->joint;
  std::vector<SE3d> poses;
  for (std::size_t i = 0; i < joint.size(); ++i) poses.push_back(joint.pose(i));
  Eigen::MatrixXd covariance = state_->covariance_factor() * joint.covariance();
  for (std::size_t j = 0; j < objects(); ++j) {
    if (const auto i = pose_index(j))
      block(covariance, *i, *i) += bias_covariance(j, joint.pose(kCamera), joint.pose(*i));
  }
  return ConcentratedGaussian<PoseStackd>::trusted(PoseStackd(std::move(poses)),
                                                   std::move(covariance));
}

std::optional<std::size_t> MultiObjectFilter::pose_index(std::size_t object) const {
  require_object(object, objects());
  return state_->objects[object].belief.pose_index();
}

const MultiObjectSettings& MultiObjectFilter::settings() const { return state_->settings; }

const ObjectSensor& MultiObjectFilter::sensor(std::size_t object) const {
  require_object(object, objects());
  return state_->objects[object].detector.sensor();
}

double MultiObjectFilter::covariance_factor() const { return state_->covariance_factor(); }

Matrix6d MultiObjectFilter::bias_covariance(std::size_t object, const SE3d& camera,
                                            const SE3d& pose) const {
  require_object(object, objects());
  return state_->objects[object].detector.bias_covariance(state_->settings, camera, pose);
}

ConcentratedGaussian<PoseStackd> MultiObjectFilter::joint_of(
    std::span<const std::optional<std::size_t>> hypotheses) const {
  if (hypotheses.size() != objects()) {
    throw InvalidInput(
        fmt::format("hypotheses of {} objects, but there are {}", hypotheses.size(), objects()));
  }
  // The joint Gaussian with the alternatives that were asked for appended, then the poses in order.
  JointGaussian all = state_->joint;
  std::vector<std::size_t> order{kCamera};
  if (state_->motion) order.push_back(*state_->motion);
  for (std::size_t j = 0; j < objects(); ++j) {
    const TrackedObject& object = state_->objects[j];
    const auto h = hypotheses[j];
    if (!h) continue;
    require_hypothesis(*h, j, object.belief.size());
    std::size_t at = object.belief.pose_index().value();
    if (h != object.belief.leading()) {
      const ConditionalPose other = object.belief.pose(state_->joint, *h);
      at = all.append(other.pose, other.covariance, other.cross_covariance);
    }
    block(all.covariance(), at, at) +=
        all.pose(at).adjoint_congruence(Matrix6d(state_->drift - object.drift));
    order.push_back(at);
  }
  std::vector<SE3d> poses;
  Eigen::MatrixXd covariance(offset(order.size()), offset(order.size()));
  for (std::size_t i = 0; i < order.size(); ++i) {
    poses.push_back(all.pose(order[i]));
    for (std::size_t k = 0; k < order.size(); ++k)
      block(covariance, i, k) = all.covariance(order[i], order[k]);
  }
  return ConcentratedGaussian<PoseStackd>::trusted(PoseStackd(std::move(poses)),
                                                   std::move(covariance));
}

}  // namespace posemix
