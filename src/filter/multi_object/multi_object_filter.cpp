// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/multi_object_filter.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "global_hypotheses.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/filter/update.hpp"

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

void require_detector(std::size_t detector, std::size_t detectors) {
  if (detector >= detectors) {
    throw InvalidInput(
        fmt::format("the object has {} detectors; there is none at index {}", detectors, detector));
  }
}

void require_camera(std::size_t camera, std::size_t cameras) {
  if (camera >= cameras) {
    throw InvalidInput(
        fmt::format("there is no camera {} whose pose on the body is estimated; there are {}",
                    camera, cameras));
  }
}

void require_hypothesis(std::size_t hypothesis, std::size_t object, std::size_t hypotheses) {
  if (hypothesis >= hypotheses) {
    throw InvalidInput(fmt::format("object {} has {} hypotheses; there is none at index {}", object,
                                   hypotheses, hypothesis));
  }
}

/// The marginal of the blocks at `order`: poses, then slow errors.
JointState marginal_of(const JointGaussian& joint, const std::vector<std::size_t>& order) {
  std::vector<SE3d> poses;
  JointState state;
  const Eigen::MatrixXd all = joint.covariance();
  state.covariance.resize(offset(order.size()), offset(order.size()));
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (joint.is_pose(order[i])) {
      poses.push_back(joint.pose(order[i]));
    } else {
      state.slow.conservativeResize(state.slow.size() + kPoseDof);
      state.slow.tail<kPoseDof>() = joint.slow(order[i]);
    }
    for (std::size_t k = 0; k < order.size(); ++k)
      block(state.covariance, i, k) = block(all, order[i], order[k]);
  }
  state.poses = PoseStackd(std::move(poses));
  return state;
}

}  // namespace

MultiObjectFilter::MultiObjectFilter(const ConcentratedGaussian<SE3d>& camera,
                                     const std::vector<ObjectSensor>& objects,
                                     const MultiObjectSettings& settings)
    : state_(std::make_unique<GlobalHypotheses>(MultiObjectState(camera, objects, settings))) {}

MultiObjectFilter::MultiObjectFilter(const MultiObjectFilter& other)
    : state_(std::make_unique<GlobalHypotheses>(other.hypotheses_of_all())) {}
MultiObjectFilter::MultiObjectFilter(MultiObjectFilter&&) noexcept = default;
MultiObjectFilter& MultiObjectFilter::operator=(const MultiObjectFilter& other) {
  if (this != &other) state_ = std::make_unique<GlobalHypotheses>(other.hypotheses_of_all());
  return *this;
}
MultiObjectFilter& MultiObjectFilter::operator=(MultiObjectFilter&&) noexcept = default;
MultiObjectFilter::~MultiObjectFilter() = default;

GlobalHypotheses& MultiObjectFilter::hypotheses_of_all() {
  require(state_ != nullptr, "the filter was moved from; expected one with a state");
  return *state_;
}

const GlobalHypotheses& MultiObjectFilter::hypotheses_of_all() const {
  require(state_ != nullptr, "the filter was moved from; expected one with a state");
  return *state_;
}

const MultiObjectState& MultiObjectFilter::current() const { return hypotheses_of_all().summary(); }

void MultiObjectFilter::predict_with_odometry(const SE3d& motion, const Matrix6d& q, double dt) {
  require_finite(motion, "odometry");
  require_noise(q, "noise of the odometry");
  require_time(dt);
  hypotheses_of_all().for_each(
      [&](MultiObjectState& s) { s.predict_with_odometry(motion, q, dt); });
}

void MultiObjectFilter::predict_random_walk(const Matrix6d& q, double dt) {
  require_noise(q, "noise of the random walk");
  require_time(dt);
  hypotheses_of_all().for_each([&](MultiObjectState& s) { s.predict_random_walk(q, dt); });
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
  hypotheses_of_all().for_each(
      [&](MultiObjectState& s) { s.predict_constant_velocity(periods, q, q_motion, at_rest, dt); });
}

void MultiObjectFilter::set_camera(const ConcentratedGaussian<SE3d>& world_camera, double dt) {
  require_finite(world_camera.mean(), "pose of the camera");
  require_time(dt);
  // The constructor checks the covariance.
  const ConcentratedGaussian<SE3d> camera(world_camera.mean(), world_camera.covariance());
  hypotheses_of_all().for_each([&](MultiObjectState& s) { s.set_camera(camera, dt); });
}

ObjectUpdateReport MultiObjectFilter::update(std::size_t object, const SE3d& camera_object) {
  require_object(object, object_count());
  require_finite(camera_object, "detection");
  return hypotheses_of_all().update(object, observation_of(camera_object), {});
}

ObjectUpdateReport MultiObjectFilter::update(std::size_t object, const Observation& observation,
                                             const ObservationSource& source) {
  require_object(object, object_count());
  require_detector(source.detector, hypotheses_of_all().first().objects[object].detectors.size());
  validate(observation);
  if (source.camera) require_camera(*source.camera, extrinsic_count());
  require_finite(source.body_camera, "pose of the camera on its body");
  return hypotheses_of_all().update(object, observation, source);
}

std::size_t MultiObjectFilter::add_camera(const ConcentratedGaussian<SE3d>& body_camera) {
  require_finite(body_camera.mean(), "pose of the camera on its body");
  if (current().joint.size() > 1 + extrinsic_count()) {
    throw InvalidInput(
        "a camera whose pose is estimated comes too late; expected it before the first detection "
        "and the first prediction with constant velocity");
  }
  hypotheses_of_all().for_each([&](MultiObjectState& s) { s.add_camera(body_camera); });
  return extrinsic_count() - 1;
}

std::size_t MultiObjectFilter::extrinsic_count() const {
  return hypotheses_of_all().first().joint.extrinsics();
}

ConcentratedGaussian<SE3d> MultiObjectFilter::extrinsic(std::size_t camera) const {
  require_camera(camera, extrinsic_count());
  const std::size_t at = JointGaussian::extrinsic_block(camera);
  return ConcentratedGaussian<SE3d>::trusted(current().joint.pose(at),
                                             current().joint.covariance(at, at));
}

std::size_t MultiObjectFilter::add_object(ObjectSensor object,
                                          const std::optional<ObjectPrior>& prior,
                                          const std::optional<PutDownMotion>& motion) {
  if (prior && !(prior->probability > 0.0 && prior->probability <= 1.0)) {
    throw InvalidInput(fmt::format("the prior has the probability {}, expected one in (0, 1]",
                                   prior->probability));
  }
  if (motion) validate(*motion);
  hypotheses_of_all().for_each([&](MultiObjectState& s) { s.add_object(object, prior, motion); });
  return object_count() - 1;
}

void MultiObjectFilter::forget(std::size_t object) {
  require_object(object, object_count());
  hypotheses_of_all().forget(object);
}

std::size_t MultiObjectFilter::object_count() const { return hypotheses_of_all().object_count(); }

Vector6d MultiObjectFilter::noise_scale(std::size_t object) const {
  return sensor(object).noise_scale;
}

ConcentratedGaussian<SE3d> MultiObjectFilter::camera() const {
  return ConcentratedGaussian<SE3d>::trusted(current().joint.pose(kCamera),
                                             current().joint.covariance(kCamera, kCamera));
}

Mixture<ConcentratedGaussian<SE3d>> MultiObjectFilter::camera_mixture() const {
  return hypotheses_of_all().camera();
}

Mixture<ConcentratedGaussian<SE3d>> MultiObjectFilter::object_mixture(std::size_t object) const {
  require_object(object, object_count());
  if (!leading(object))
    throw InvalidInput(fmt::format("object {} has no hypothesis; it was not detected", object));
  return hypotheses_of_all().object(object);
}

std::vector<ObjectHypothesis> MultiObjectFilter::hypotheses(std::size_t object) const {
  require_object(object, object_count());
  const TrackedObject& tracked = current().objects[object];
  const std::vector<double> probabilities = tracked.belief.probabilities();
  std::vector<ObjectHypothesis> list;
  for (std::size_t h = 0; h < tracked.belief.size(); ++h) {
    const Standing& standing = tracked.belief.standing(h);
    const DetectionState state = current().reported(tracked, h);
    list.push_back({.pose = state.object,
                    .covariance = state.covariance.block<6, 6>(kObjectRow, kObjectRow),
                    .cross_covariance = state.covariance.block<6, 6>(kObjectRow, 0),
                    .log_weight = standing.log_weight,
                    .probability = probabilities[h],
                    .score = standing.score,
                    .id = standing.id,
                    .detections = standing.detections});
  }
  return list;
}

std::vector<HypothesisMean> MultiObjectFilter::hypothesis_means(std::size_t object) const {
  require_object(object, object_count());
  return current().hypothesis_means(current().objects[object]);
}

std::optional<std::size_t> MultiObjectFilter::leading(std::size_t object) const {
  require_object(object, object_count());
  return current().objects[object].belief.leading();
}

double MultiObjectFilter::mode_probability(std::size_t object) const {
  const auto leads = leading(object);
  return leads ? current().objects[object].belief.probabilities()[*leads] : 0.0;
}

double MultiObjectFilter::log_absent(std::size_t object) const {
  require_object(object, object_count());
  return current().objects[object].belief.log_absent();
}

ConcentratedGaussian<SE3d> MultiObjectFilter::relative(std::size_t object,
                                                       std::size_t hypothesis) const {
  require_object(object, object_count());
  require_hypothesis(hypothesis, object, current().objects[object].belief.size());
  const DetectionState state = current().reported(current().objects[object], hypothesis);
  return ConcentratedGaussian<SE3d>::trusted(
      state.camera_object(), state.camera.inverse().adjoint_congruence(state.difference()));
}

ConcentratedGaussian<SE3d> MultiObjectFilter::predicted_detection(std::size_t object,
                                                                  std::size_t hypothesis,
                                                                  const SE3d& body_camera) const {
  return predicted_detection(object, hypothesis, ObservationSource{.body_camera = body_camera});
}

ConcentratedGaussian<SE3d> MultiObjectFilter::predicted_detection(
    std::size_t object, std::size_t hypothesis, const ObservationSource& source) const {
  require_object(object, object_count());
  require_hypothesis(hypothesis, object, current().objects[object].belief.size());
  if (source.camera) require_camera(*source.camera, extrinsic_count());
  const TrackedObject& tracked = current().objects[object];
  const DetectionState state = tracked.belief.state_from(current().joint, hypothesis, source);
  const ObjectSensor& sensor = tracked.sensor();
  const Matrix6d a = slow_error_map(state, sensor.noise.components().front(), sensor);
  // xi_O - xi_C + A b.
  Eigen::Matrix<double, 6, 18> h;
  h << -Matrix6d::Identity(), Matrix6d::Identity(), a;
  const SE3d seen = SE3d::exp(a * state.slow) * state.object;
  const Matrix6d covariance = h * state.covariance * h.transpose();
  return ConcentratedGaussian<SE3d>::trusted(state.camera.inverse() * seen,
                                             state.camera.inverse().adjoint_congruence(covariance));
}

ConcentratedGaussian<PoseStackd> MultiObjectFilter::joint() const { return current_joint(); }

const ConcentratedGaussian<PoseStackd>& MultiObjectFilter::current_joint() const {
  return hypotheses_of_all().joint();
}

bool MultiObjectFilter::is_known(std::size_t object) const {
  require_object(object, object_count());
  return hypotheses_of_all().is_known(object);
}

std::vector<std::optional<LeadingEstimate>> MultiObjectFilter::leading_estimates() const {
  return current().leading_estimates();
}

std::optional<std::size_t> MultiObjectFilter::pose_index(std::size_t object) const {
  require_object(object, object_count());
  const auto index = current().objects[object].belief.pose_index();
  if (!index) return std::nullopt;
  std::size_t poses = 0;
  for (std::size_t i = 0; i < *index; ++i) poses += current().joint.is_pose(i) ? 1 : 0;
  return poses - extrinsic_count();
}

const MultiObjectSettings& MultiObjectFilter::settings() const {
  return hypotheses_of_all().first().settings;
}

const ObjectSensor& MultiObjectFilter::sensor(std::size_t object, std::size_t detector) const {
  require_object(object, object_count());
  require_detector(detector, current().objects[object].detectors.size());
  return current().objects[object].detectors[detector].sensor();
}

Matrix6d MultiObjectFilter::unseen_covariance(std::size_t object, const SE3d& pose) const {
  require_object(object, object_count());
  return MultiObjectState::unseen_covariance(current().objects[object], pose);
}

ConcentratedGaussian<PoseStackd> MultiObjectFilter::joint_of(
    std::span<const std::optional<std::size_t>> hypotheses) const {
  JointState state = joint_state(hypotheses);
  const Eigen::Index dof = state.poses.dof();
  Eigen::MatrixXd covariance = state.covariance.topLeftCorner(dof, dof);
  std::size_t index = current().motion ? 2 : 1;
  for (std::size_t j = 0; j < object_count(); ++j) {
    if (!hypotheses[j]) continue;
    block(covariance, index, index) += unseen_covariance(j, state.poses[index]);
    ++index;
  }
  return ConcentratedGaussian<PoseStackd>::trusted(state.poses, std::move(covariance));
}

JointState MultiObjectFilter::joint_state(
    std::span<const std::optional<std::size_t>> hypotheses) const {
  if (hypotheses.size() != object_count()) {
    throw InvalidInput(fmt::format("hypotheses of {} objects, but there are {}", hypotheses.size(),
                                   object_count()));
  }
  // The joint Gaussian with the alternatives that were asked for; the poses, then the slow errors.
  JointGaussian all = current().joint;
  std::vector<std::size_t> order{kCamera};
  if (current().motion) order.push_back(*current().motion);
  std::vector<std::size_t> slow;
  for (std::size_t j = 0; j < object_count(); ++j) {
    const auto& belief = current().objects[j].belief;
    const auto h = hypotheses[j];
    if (!h) continue;
    require_hypothesis(*h, j, belief.size());
    const std::size_t index = h == belief.leading() ? belief.pose_index().value()
                                                    : all.append(belief.pose(current().joint, *h));
    order.push_back(index);
    if (all.blocks_of(index) > 1) slow.push_back(index + 1);
  }
  order.insert(order.end(), slow.begin(), slow.end());
  return marginal_of(all, order);
}

}  // namespace posemix
