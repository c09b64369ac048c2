// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/multi_object_filter.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <utility>

#include "object_hypotheses.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/filter/predict.hpp"
#include "posemix/filter/update.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix {
namespace {

using internal::Backbone;
using internal::CameraAlternative;
using internal::MergeBounds;
using internal::ObjectState;
using internal::Pair;
using internal::PairMoments;
using internal::PairUpdate;

double squared_distance_at(double probability, const char* name) {
  if (!(probability > 0.0 && probability < 1.0)) {
    throw InvalidInput(fmt::format("{} is {}, expected a number in (0, 1)", name, probability));
  }
  return boost::math::quantile(boost::math::chi_squared(6.0), probability);
}

void check(const MultiObjectSettings& s) {
  require(s.max_hypotheses > 0, "max_hypotheses is 0, expected at least 1");
  require(s.birth_covariance_factor > 0.0, "birth_covariance_factor must be positive");
  require(s.score_memory >= 0.0 && s.score_memory <= 1.0, "score_memory must lie in [0, 1]");
  require(s.leader_margin >= 0.0, "leader_margin must not be negative");
  require(s.camera_gain_noise >= 1.0, "camera_gain_noise must be at least 1");
}

/// Moments of the camera under all hypotheses but the leading one, and under the object's absence
/// (or its birth), where the camera is as before.
class AlternativeMoments {
 public:
  explicit AlternativeMoments(const Matrix6d& before) : before_(before) {}

  void add_unmoved(double weight) {
    weight_ += weight;
    second_ += weight * before_;
  }
  void add(double weight, const PairMoments& pair) {
    const Vector6d mean = pair.mean.head<6>();
    weight_ += weight;
    mean_ += weight * mean;
    second_ += weight * (pair.covariance.topLeftCorner<6, 6>() + mean * mean.transpose());
  }
  CameraAlternative moments() const {
    if (weight_ <= 0.0) return {0.0, Vector6d::Zero(), before_};
    const Vector6d mean = mean_ / weight_;
    return {weight_, mean, second_ / weight_ - mean * mean.transpose()};
  }

 private:
  Matrix6d before_;
  double weight_ = 0.0;
  Vector6d mean_ = Vector6d::Zero();
  Matrix6d second_ = Matrix6d::Zero();
};

}  // namespace

class MultiObjectFilter::State {
 public:
  State(const ConcentratedGaussian<SE3d>& camera, std::vector<ObjectSensor> sensors,
        const MultiObjectSettings& given)
      : settings(given),
        explained(squared_distance_at(given.explained_probability, "explained_probability")),
        merge_bounds{given.merge_rotation_rad, given.merge_translation_m,
                     squared_distance_at(given.merge_probability, "merge_probability")},
        backbone(camera) {
    check(settings);
    for (ObjectSensor& sensor : sensors) objects.push_back({std::move(sensor)});
  }

  ObjectUpdateReport update(std::size_t j, const SE3d& detected);

  MultiObjectSettings settings;
  double explained;
  MergeBounds merge_bounds;
  Backbone backbone;
  std::vector<ObjectState> objects;
  std::optional<std::size_t> motion;  ///< index of the camera's motion in the backbone
  std::uint64_t next_id = 0;

 private:
  void walk(ObjectState& object);
  ObjectHypothesis newborn(const ObjectState& object, const SE3d& detected);
  void move_camera(ObjectState& object, const std::vector<PairUpdate>& updates,
                   const std::vector<double>& weights, double unmoved);
};

/// The object's covariance grows by what its walk adds until now.
void MultiObjectFilter::State::walk(ObjectState& object) {
  const Matrix6d q = object.waited_s * settings.object_walk;
  object.waited_s = 0.0;
  for (ObjectHypothesis& hypothesis : object.hypotheses)
    hypothesis.covariance += hypothesis.pose.adjoint_congruence(q);
  if (object.index) {
    const std::size_t i = *object.index;
    internal::block(backbone.covariance(), i, i) += backbone.pose(i).adjoint_congruence(q);
  }
}

/// A hypothesis at the detection, with the likelihood of an object that was not seen before.
ObjectHypothesis MultiObjectFilter::State::newborn(const ObjectState& object,
                                                   const SE3d& detected) {
  const NullNoise& null = object.sensor.noise.null();
  const Matrix6d camera = backbone.covariance(kCamera, kCamera);
  const NoiseComponent& component = object.sensor.noise.components().front();
  const SE3d seen = detected * component.offset.inverse();
  const Pair there{backbone.pose(kCamera), backbone.pose(kCamera) * seen, {}};
  const Matrix6d noise =
      internal::innovation({there.camera, there.object, internal::Matrix12d::Zero()}, detected,
                           component, object.sensor.symmetries)
          .noise;
  ObjectHypothesis result{.pose = there.object,
                          .covariance = camera + settings.birth_covariance_factor * noise,
                          .with_camera = camera};
  constexpr double kPi = std::numbers::pi;
  result.log_weight =
      object.log_absent + std::log1p(-null.weight) - std::log(8.0 * kPi * kPi * null.volume_m3);
  result.score = settings.birth_score;
  result.id = next_id++;
  result.detections = 1;
  return result;
}

/// The camera's moments over all hypotheses of the object, and what follows from them for the
/// backbone and for every other hypothesis.
void MultiObjectFilter::State::move_camera(ObjectState& object,
                                           const std::vector<PairUpdate>& updates,
                                           const std::vector<double>& weights, double unmoved) {
  const Matrix6d before = backbone.covariance(kCamera, kCamera);
  AlternativeMoments alternative(before);
  alternative.add_unmoved(unmoved);
  for (std::size_t h = 0; h < updates.size(); ++h) {
    if (h != object.leading) alternative.add(weights[h], updates[h].posterior);
  }
  const Vector6d moved =
      backbone.update(*object.index, updates[object.leading].posterior, alternative.moments());
  const Matrix6d after = backbone.covariance(kCamera, kCamera);
  for (ObjectState& other : objects) {
    for (std::size_t h = 0; h < other.hypotheses.size(); ++h) {
      ObjectHypothesis& hypothesis = other.hypotheses[h];
      if (other.index && h == other.leading) continue;
      if (&other != &object) {
        internal::follow_camera(hypothesis, Vector6d::Zero(), before, moved, after);
        continue;
      }
      const PairMoments& pair = updates[h].posterior;
      hypothesis.pose = SE3d::exp(pair.mean.tail<6>()) * hypothesis.pose;
      hypothesis.covariance = pair.covariance.bottomRightCorner<6, 6>();
      hypothesis.with_camera = pair.covariance.bottomLeftCorner<6, 6>();
      internal::follow_camera(hypothesis, pair.mean.head<6>(), pair.covariance.topLeftCorner<6, 6>(), moved,
                    after);
    }
  }
}

ObjectUpdateReport MultiObjectFilter::State::update(std::size_t j, const SE3d& detected) {
  ObjectState& object = objects[j];
  walk(object);
  ObjectUpdateReport report;

  // What the detection says to every hypothesis.
  std::vector<PairUpdate> updates;
  updates.reserve(object.hypotheses.size());
  bool is_explained = false;
  for (std::size_t h = 0; h < object.hypotheses.size(); ++h) {
    updates.push_back(internal::observe(internal::pair_of(backbone, object, h), detected,
                                        object.sensor, settings.camera_gain_noise));
    is_explained = is_explained || updates.back().squared_distance < explained;
  }

  // Weights: hypotheses, a birth, and absence.
  const double log_null = object.sensor.noise.log_null_density();
  std::vector<ObjectHypothesis> born;
  if (!is_explained && std::isfinite(object.log_absent)) born.push_back(newborn(object, detected));
  std::vector<double> terms;
  for (std::size_t h = 0; h < updates.size(); ++h) {
    ObjectHypothesis& hypothesis = object.hypotheses[h];
    hypothesis.log_weight += updates[h].log_evidence;
    hypothesis.score = settings.score_memory * hypothesis.score +
                       (std::isfinite(log_null) ? updates[h].log_evidence - log_null : 0.0);
    ++hypothesis.detections;
    terms.push_back(hypothesis.log_weight);
  }
  for (const ObjectHypothesis& hypothesis : born) terms.push_back(hypothesis.log_weight);
  object.log_absent += log_null;
  terms.push_back(object.log_absent);
  report.log_evidence = log_sum_exp(terms);

  // The camera, the backbone, and everything that depends on it.
  const std::uint64_t led = object.index ? object.hypotheses[object.leading].id : next_id;
  const Matrix6d before = backbone.covariance(kCamera, kCamera);
  const SE3d camera_before = backbone.pose(kCamera);
  if (object.index) {
    report.inlier_share = updates[object.leading].inlier_share;
    report.residual = updates[object.leading].residual;
    std::vector<double> weights;
    for (std::size_t h = 0; h < updates.size(); ++h)
      weights.push_back(std::exp(object.hypotheses[h].log_weight - report.log_evidence));
    double unmoved = std::exp(object.log_absent - report.log_evidence);
    for (const ObjectHypothesis& hypothesis : born)
      unmoved += std::exp(hypothesis.log_weight - report.log_evidence);
    move_camera(object, updates, weights, unmoved);
  }

  // Births, merging, the cap, and who leads.
  const Vector6d moved = (backbone.pose(kCamera) * camera_before.inverse()).log();
  for (ObjectHypothesis& hypothesis : born) {
    internal::follow_camera(hypothesis, Vector6d::Zero(), before, moved,
                  backbone.covariance(kCamera, kCamera));
    object.hypotheses.push_back(std::move(hypothesis));
    report.started = true;
  }
  if (object.hypotheses.empty()) return report;
  if (!object.index) {
    const ObjectHypothesis& first = object.hypotheses.front();
    object.leading = 0;
    object.index = backbone.append(first.pose, first.covariance, first.with_camera);
  }
  report.merges = internal::merge_hypotheses(backbone, object, merge_bounds);
  internal::normalise(object);
  internal::keep_best(object, settings.max_hypotheses, settings.protected_hypotheses);
  internal::normalise(object);
  internal::choose_leader(backbone, object, settings.leader_margin);
  report.changed_leader = object.hypotheses[object.leading].id != led;
  return report;
}

MultiObjectFilter::MultiObjectFilter(const ConcentratedGaussian<SE3d>& camera,
                                     std::vector<ObjectSensor> objects,
                                     const MultiObjectSettings& settings)
    : state_(std::make_unique<State>(camera, std::move(objects), settings)) {}

MultiObjectFilter::MultiObjectFilter(const MultiObjectFilter& other)
    : state_(std::make_unique<State>(*other.state_)) {}
MultiObjectFilter::MultiObjectFilter(MultiObjectFilter&&) noexcept = default;
MultiObjectFilter& MultiObjectFilter::operator=(const MultiObjectFilter& other) {
  if (this != &other) state_ = std::make_unique<State>(*other.state_);
  return *this;
}
MultiObjectFilter& MultiObjectFilter::operator=(MultiObjectFilter&&) noexcept = default;
MultiObjectFilter::~MultiObjectFilter() = default;

void MultiObjectFilter::predict(const SE3d& motion, const Matrix6d& q, double dt) {
  Backbone& backbone = state_->backbone;
  const SE3d camera = backbone.pose(kCamera) * motion;
  backbone.set_pose(kCamera, camera);
  internal::block(backbone.covariance(), kCamera, kCamera) += camera.adjoint_congruence(q);
  for (ObjectState& object : state_->objects) object.waited_s += dt;
}

ObjectUpdateReport MultiObjectFilter::update(std::size_t object, const SE3d& camera_object) {
  if (object >= objects()) {
    throw InvalidInput(fmt::format("detection of object {}, but there are {}", object, objects()));
  }
  return state_->update(object, camera_object);
}

std::size_t MultiObjectFilter::objects() const { return state_->objects.size(); }

ConcentratedGaussian<SE3d> MultiObjectFilter::camera() const {
  return ConcentratedGaussian<SE3d>::trusted(state_->backbone.pose(kCamera),
                                             state_->backbone.covariance(kCamera, kCamera));
}

std::vector<ObjectHypothesis> MultiObjectFilter::hypotheses(std::size_t object) const {
  const ObjectState& state = state_->objects[object];
  std::vector<ObjectHypothesis> list = state.hypotheses;
  if (state.index) {
    const Pair pair = state_->backbone.pair(*state.index);
    ObjectHypothesis& leader = list[state.leading];
    leader.pose = pair.object;
    leader.covariance = pair.covariance.bottomRightCorner<6, 6>();
    leader.with_camera = pair.covariance.bottomLeftCorner<6, 6>();
  }
  return list;
}

std::optional<std::size_t> MultiObjectFilter::leading(std::size_t object) const {
  const ObjectState& state = state_->objects[object];
  return state.index ? std::optional(state.leading) : std::nullopt;
}

double MultiObjectFilter::log_absent(std::size_t object) const {
  return state_->objects[object].log_absent;
}

ConcentratedGaussian<SE3d> MultiObjectFilter::relative(std::size_t object,
                                                       std::size_t hypothesis) const {
  const Pair pair = internal::pair_of(state_->backbone, state_->objects[object], hypothesis);
  return ConcentratedGaussian<SE3d>::trusted(
      pair.camera_object(), pair.camera.inverse().adjoint_congruence(pair.difference()));
}

ConcentratedGaussian<PoseStackd> MultiObjectFilter::backbone() const {
  const Backbone& backbone = state_->backbone;
  std::vector<SE3d> poses;
  for (std::size_t i = 0; i < backbone.size(); ++i) poses.push_back(backbone.pose(i));
  return ConcentratedGaussian<PoseStackd>::trusted(PoseStackd(std::move(poses)),
                                                   backbone.covariance());
}

std::optional<std::size_t> MultiObjectFilter::backbone_index(std::size_t object) const {
  return state_->objects[object].index;
}

}  // namespace posemix
