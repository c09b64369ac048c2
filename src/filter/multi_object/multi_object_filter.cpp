// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/multi_object_filter.hpp"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "filter_checks.hpp"
#include "global_hypotheses.hpp"
#include "lie/checked_noise.hpp"
#include "posemix/lie/pose_checks.hpp"

namespace posemix {

using namespace internal;

namespace {

void check_step(double dt) { kTimeStep.check(dt, "dt"); }

void check_density(const ConcentratedGaussian<SE3d>& density, const char* name) {
  check_pose(density.mean(), name);
  check_variances(density.covariance(), name);
  require_precise(density, name);
}

}  // namespace

MultiObjectFilter::MultiObjectFilter(const ConcentratedGaussian<SE3d>& camera,
                                     const std::vector<ObjectSensor>& objects,
                                     const MultiObjectSettings& settings) {
  check_density(camera, "pose of the camera");
  const Eigen::Vector3d origin = origin_near(camera.mean().translation(), Eigen::Vector3d::Zero());
  const auto near = WorldShift(-origin)(camera);
  state_ = std::make_unique<GlobalHypotheses>(MultiObjectState(near, objects, settings), origin);
  for (const ObjectSensor& object : objects) {
    require_precision(near.covariance(), object, "the pose of the camera");
    require_noise_precision(object);
  }
}

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
  check_pose(motion, "odometry");
  const Matrix6d noise = checked_noise(q, "noise of the odometry");
  check_step(dt);
  hypotheses_of_all().for_each(
      [&](MultiObjectState& s) { s.predict_with_odometry(motion, noise, dt); });
}

void MultiObjectFilter::predict_random_walk(const Matrix6d& q, double dt) {
  const Matrix6d noise = checked_noise(q, "noise of the random walk");
  check_step(dt);
  hypotheses_of_all().for_each([&](MultiObjectState& s) { s.predict_random_walk(noise, dt); });
}

void MultiObjectFilter::predict_constant_velocity(double periods, const Matrix6d& q,
                                                  const Matrix6d& q_motion, const Matrix6d& at_rest,
                                                  double dt) {
  const Matrix6d noise = checked_noise(q, "noise of the pose");
  const Matrix6d motion_noise = checked_noise(q_motion, "noise of the motion");
  const Matrix6d resting = checked_noise(at_rest, "covariance of the motion at rest");
  check_step(dt);
  kStamp.check(periods, "periods");
  hypotheses_of_all().for_each([&](MultiObjectState& s) {
    s.predict_constant_velocity(periods, noise, motion_noise, resting, dt);
  });
}

void MultiObjectFilter::set_camera(const ConcentratedGaussian<SE3d>& world_camera, double dt) {
  check_density(world_camera, "pose of the camera");
  check_step(dt);
  // The constructor checks the covariance.
  const ConcentratedGaussian<SE3d> camera(world_camera.mean(), world_camera.covariance());
  const Eigen::Vector3d origin = hypotheses_of_all().origin_for(camera.mean());
  const auto near = WorldShift(-origin)(camera);
  hypotheses_of_all().move_origin_to(origin);
  hypotheses_of_all().for_each([&](MultiObjectState& s) { s.set_camera(near, dt); });
}

ObjectUpdateReport MultiObjectFilter::update(std::size_t object, const SE3d& camera_object) {
  require_object(object, object_count());
  check_pose(camera_object, "detection");
  return hypotheses_of_all().update(object, camera_object);
}

ObjectUpdateReport MultiObjectFilter::update(std::size_t object, const Observation& observation,
                                             const ObservationSource& source) {
  require_object(object, object_count());
  require_detector(source.detector, hypotheses_of_all().first().objects[object].detectors.size());
  validate(observation);
  if (source.camera) require_camera(*source.camera, extrinsic_count());
  check_pose(source.body_camera, "pose of the camera on its body");
  return hypotheses_of_all().update(object, observation, source);
}

std::size_t MultiObjectFilter::add_camera(const ConcentratedGaussian<SE3d>& body_camera) {
  check_density(body_camera, "pose of the camera on its body");
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
  require_noise_precision(object);
  std::optional<ObjectPrior> near = prior;
  const Eigen::Vector3d origin = hypotheses_of_all().origin_for_camera();
  if (prior) {
    check_density(prior->world, "the prior");
    near->world = WorldShift(-origin)(prior->world);
    require_precision(seen_from_near(prior->world).covariance(), object, "the prior");
    require_precise(near->world, "the prior", "the camera",
                    "one that is nearer, or whose rotation is more certain");
    if (!(prior->probability > 0.0 && prior->probability <= 1.0)) {
      throw InvalidInput(fmt::format("the prior has the probability {}, expected one in (0, 1]",
                                     prior->probability));
    }
  }
  if (motion) validate(*motion);
  // An object of which nothing is known leaves the origin to the next detection, as predictions do.
  if (prior) hypotheses_of_all().move_origin_to(origin);
  hypotheses_of_all().for_each([&](MultiObjectState& s) { s.add_object(object, near, motion); });
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
  return hypotheses_of_all().to_world()(current().reported_camera());
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
  const WorldShift to_world = hypotheses_of_all().to_world();
  std::vector<ObjectHypothesis> list;
  for (std::size_t h = 0; h < tracked.belief.size(); ++h) {
    const Standing& standing = tracked.belief.standing(h);
    const DetectionState state = current().reported(tracked, h);
    Matrix6d covariance = to_world(state.covariance.block<6, 6>(kObjectRow, kObjectRow));
    symmetrize(covariance);
    list.push_back({.pose = to_world(state.object),
                    .covariance = covariance,
                    .cross_covariance = to_world(state.covariance.block<6, 6>(kObjectRow, 0)),
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
  return current().hypothesis_means(current().objects[object], hypotheses_of_all().to_world());
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

bool MultiObjectFilter::is_known(std::size_t object) const {
  require_object(object, object_count());
  return hypotheses_of_all().is_known(object);
}

std::vector<std::optional<LeadingEstimate>> MultiObjectFilter::leading_estimates() const {
  return current().leading_estimates(hypotheses_of_all().to_world());
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

}  // namespace posemix
