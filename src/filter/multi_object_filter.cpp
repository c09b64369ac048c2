// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/multi_object_filter.hpp"

#include <algorithm>
#include <array>
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

constexpr double kUsualFrameS = 0.1;
/// Detections closer in time count as that far apart.
constexpr double kLeastS = 1e-3;

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
  require(s.camera_share >= 0.0 && s.camera_share <= 1.0, "camera_share must lie in [0, 1]");
  require(s.noise_scale_detections > 0.0, "noise_scale_detections must be positive");
  require(s.least_noise_scale > 0.0 && s.least_noise_scale <= 1.0,
          "least_noise_scale must lie in (0, 1]");
  require(s.correlation_s >= 0.0, "correlation_s must not be negative");
  require(s.correlation_detections >= 0.0, "correlation_detections must not be negative");
  require(s.common_error_share >= 0.0 && s.common_error_share < 1.0,
          "common_error_share must lie in [0, 1)");
  require(s.dependent_answers > 0.0, "dependent_answers must be positive");
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
    for (ObjectSensor& sensor : sensors) objects.push_back({.sensor = std::move(sensor)});
  }

  ObjectUpdateReport update(std::size_t j, const SE3d& detected);
  void forget(std::size_t j);

  void pass(double dt) {
    now_s += dt;
    frame_s = dt;
  }

  double dependent_detections() const {
    double sum = 0.0;
    double weight = 0.0;
    for (const ObjectState& object : objects) {
      if (object.detections == 0) continue;
      const double interval = object.detections > 1 ? (object.last_s - object.first_s) /
                                                          static_cast<double>(object.detections - 1)
                                                    : frame_s;
      const double prior = object.sensor.noise.dependence().dependent_frames.value_or(
          std::max(1.0, settings.correlation_s / std::max(interval, kLeastS)));
      const double share = 1.0 + object.seen;
      sum += share * object.dependence.estimate(prior, settings.correlation_detections);
      weight += share;
    }
    return weight > 0.0 ? sum / weight : 1.0;
  }

  /// Of the filter's covariances, to be those of the true error. Until the first detection they
  /// are.
  double factor() const { return settings.has_odometry ? dependent_detections() : 1.0; }

  /// Of the hypotheses of an object, w^(1 / dependent) normalised with that of absence.
  std::vector<double> probabilities(const ObjectState& object) const {
    const double dependent = std::max(1.0, settings.dependent_answers * dependent_detections());
    std::vector<double> terms;
    for (const ObjectHypothesis& hypothesis : object.hypotheses)
      terms.push_back(hypothesis.log_weight / dependent);
    terms.push_back(object.log_absent / dependent);
    const double total = log_sum_exp(terms);
    terms.pop_back();
    for (double& term : terms) term = std::exp(term - total);
    return terms;
  }

  /// What all detections of an object have in common, in the world frame.
  Matrix6d common_error(const ObjectState& object, const SE3d& pose) const {
    return common_error(object, backbone.pose(kCamera), pose);
  }
  Matrix6d common_error(const ObjectState& object, const SE3d& camera, const SE3d& pose) const {
    const Pair there{camera, pose, internal::Matrix12d::Zero()};
    NoiseComponent component = object.sensor.noise.components().front();
    if (const auto& bias = object.sensor.noise.dependence().bias) {
      component.covariance = *bias;
      return internal::component_noise(there, component, {object.sensor.noise});
    }
    return settings.common_error_share * internal::component_noise(there, component, object.sensor);
  }

  Pair honest_pair(const ObjectState& object, std::size_t h) const {
    Pair pair = internal::pair_of(backbone, object, h);
    pair.covariance *= factor();
    pair.covariance.bottomRightCorner<6, 6>() += common_error(object, pair.object);
    return pair;
  }

  MultiObjectSettings settings;
  double explained;
  MergeBounds merge_bounds;
  Backbone backbone;
  std::vector<ObjectState> objects;
  double now_s = 0.0;
  double frame_s = kUsualFrameS;      ///< between the last two frames
  std::optional<std::size_t> motion;  ///< index of the camera's motion in the backbone
  std::uint64_t next_id = 0;
  Matrix6d drift = Matrix6d::Zero();  ///< of the map, in the world frame

 private:
  void begin(ObjectState& object);
  void walk(ObjectState& object);
  void learn_scale(ObjectState& object, const PairUpdate& update);
  ObjectHypothesis newborn(const ObjectState& object, const SE3d& detected);
  void move_camera(ObjectState& object, const std::vector<PairUpdate>& updates,
                   const std::vector<double>& weights, double unmoved);
};

/// Counts the detection. At the first of all the filter's covariances become those of detections
/// that count as independent.
void MultiObjectFilter::State::begin(ObjectState& object) {
  const double before = factor();
  if (object.detections++ == 0) object.first_s = now_s;
  object.last_s = now_s;
  const bool first = std::all_of(objects.begin(), objects.end(), [&](const ObjectState& other) {
    return &other == &object ? other.detections == 1 : other.detections == 0;
  });
  if (first) backbone.covariance() *= before / factor();
}

/// When the last object is forgotten the filter's covariances become those of the true error again,
/// see begin().
void MultiObjectFilter::State::forget(std::size_t j) {
  const double before = factor();
  ObjectState& object = objects[j];
  if (object.index) {
    const std::size_t erased = *object.index;
    backbone.erase(erased);
    for (ObjectState& other : objects) {
      if (other.index && *other.index > erased) --*other.index;
    }
    if (motion && *motion > erased) --*motion;
  }
  ObjectSensor sensor = std::move(object.sensor);
  sensor.noise_scale = object.given_noise_scale;
  object = {.sensor = std::move(sensor)};
  if (std::all_of(objects.begin(), objects.end(),
                  [](const ObjectState& other) { return other.detections == 0; })) {
    backbone.covariance() *= before / factor();
  }
}

/// The object's covariance grows by the map's drift since its last detection, and by what no
/// detection can tell: about an axis of symmetry nothing is kept, because what was learned about
/// one estimate of the axis is not about the next.
void MultiObjectFilter::State::walk(ObjectState& object) {
  const Matrix6d grown = drift - object.drift + object.sensor.symmetries.unobserved_covariance();
  object.drift = drift;
  for (ObjectHypothesis& hypothesis : object.hypotheses)
    hypothesis.covariance += hypothesis.pose.adjoint_congruence(grown);
  if (object.index) {
    const std::size_t i = *object.index;
    internal::block(backbone.covariance(), i, i) += backbone.pose(i).adjoint_congruence(grown);
  }
}

/// The scale of the noise from the innovations of the leading hypothesis: rotation, translation
/// across the ray and along it, each the posterior mean of a variance with `noise_scale_detections`
/// imagined ones of scale one.
void MultiObjectFilter::State::learn_scale(ObjectState& object, const PairUpdate& update) {
  if (!std::isfinite(settings.noise_scale_detections)) return;
  const Vector6d ratio = update.residual.cwiseAbs2().cwiseQuotient(update.residual_variance);
  const Vector6d now = object.sensor.noise_scale.cwiseAbs2();
  constexpr std::array<std::array<int, 2>, 3> kGroups{{{0, 3}, {3, 2}, {5, 1}}};
  object.seen += update.inlier_share;
  const double rate = 1.0 / (settings.noise_scale_detections + object.seen);
  for (const auto& [first, count] : kGroups) {
    const double change =
        ratio.segment(first, count).mean() / (1.0 - settings.common_error_share) - 1.0;
    const double variance = now[first] * (1.0 + update.inlier_share * rate * change);
    object.sensor.noise_scale.segment(first, count)
        .setConstant(std::sqrt(
            std::clamp(variance, settings.least_noise_scale * settings.least_noise_scale, 1.0)));
  }
}

/// A hypothesis at the detection, with the likelihood of an object that was not seen before.
ObjectHypothesis MultiObjectFilter::State::newborn(const ObjectState& object,
                                                   const SE3d& detected) {
  const NullNoise& null = object.sensor.noise.null();
  const Matrix6d camera = backbone.covariance(kCamera, kCamera);
  const NoiseComponent& component = object.sensor.noise.components().front();
  const SE3d seen = detected * component.offset.inverse();
  const Pair there{backbone.pose(kCamera), backbone.pose(kCamera) * seen,
                   internal::Matrix12d::Zero()};
  const Matrix6d noise = internal::innovation(there, detected, component, object.sensor).noise;
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
      internal::follow_camera(hypothesis, pair.mean.head<6>(),
                              pair.covariance.topLeftCorner<6, 6>(), moved, after);
    }
  }
}

ObjectUpdateReport MultiObjectFilter::State::update(std::size_t j, const SE3d& detected) {
  ObjectState& object = objects[j];
  begin(object);
  walk(object);
  ObjectUpdateReport report;

  // What the detection says to every hypothesis.
  std::vector<PairUpdate> updates;
  updates.reserve(object.hypotheses.size());
  bool is_explained = false;
  for (std::size_t h = 0; h < object.hypotheses.size(); ++h) {
    updates.push_back(internal::observe(internal::pair_of(backbone, object, h), detected,
                                        object.sensor, settings.camera_gain_noise,
                                        settings.has_odometry));
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
    report.null_share = updates[object.leading].null_share;
    learn_scale(object, updates[object.leading]);
    report.residual = updates[object.leading].residual.cwiseQuotient(
        updates[object.leading].residual_variance.cwiseSqrt());
    if (report.inlier_share > 0.5) object.dependence.add(report.residual);
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

void MultiObjectFilter::predict_with_odometry(const SE3d& motion, const Matrix6d& q, double dt) {
  Backbone& backbone = state_->backbone;
  const SE3d camera = backbone.pose(kCamera) * motion;
  backbone.set_pose(kCamera, camera);
  const double factor = state_->factor();
  const double share = state_->settings.camera_share;
  internal::block(backbone.covariance(), kCamera, kCamera) +=
      share / factor * camera.adjoint_congruence(q);
  state_->drift += (1.0 - share) / factor * q;
  state_->pass(dt);
}

void MultiObjectFilter::predict_random_walk(const Matrix6d& q, double dt) {
  Backbone& backbone = state_->backbone;
  internal::block(backbone.covariance(), kCamera, kCamera) +=
      backbone.pose(kCamera).adjoint_congruence(q) / state_->factor();
  state_->pass(dt);
}

void MultiObjectFilter::predict_constant_velocity(double periods, const Matrix6d& q,
                                                  const Matrix6d& q_motion, const Matrix6d& at_rest,
                                                  double dt) {
  Backbone& backbone = state_->backbone;
  if (!state_->motion) state_->motion = backbone.append(SE3d(), at_rest, Matrix6d::Zero());
  const std::size_t motion = *state_->motion;
  const SE3d camera = backbone.pose(kCamera);
  const SE3d velocity = backbone.pose(motion);
  const Matrix6d transfer = constant_velocity_transfer(camera, velocity, periods);

  // xi_C <- xi_C + F xi_V: the rows of others that depend on the camera alone, then the backbone.
  const Eigen::LLT<Matrix6d> before(backbone.covariance(kCamera, kCamera));
  const Matrix6d with_motion =
      before.solve(backbone.covariance(kCamera, motion)) * transfer.transpose();
  for (ObjectState& object : state_->objects) {
    for (ObjectHypothesis& hypothesis : object.hypotheses) {
      const Matrix6d change = hypothesis.with_camera * with_motion;
      hypothesis.with_camera += change;
    }
  }
  Eigen::MatrixXd& b = backbone.covariance();
  internal::rows(b, kCamera) += transfer * internal::rows(b, motion);
  internal::columns(b, kCamera) += internal::columns(b, motion) * transfer.transpose();
  const SE3d moved = camera * SE3d::exp(periods * velocity.log());
  backbone.set_pose(kCamera, moved);
  internal::block(b, kCamera, kCamera) += moved.adjoint_congruence(q);
  internal::block(b, motion, motion) += velocity.adjoint_congruence(q_motion);
  symmetrize(b);
  state_->pass(dt);
}

ObjectUpdateReport MultiObjectFilter::update(std::size_t object, const SE3d& camera_object) {
  if (object >= objects()) {
    throw InvalidInput(fmt::format("detection of object {}, but there are {}", object, objects()));
  }
  return state_->update(object, camera_object);
}

void MultiObjectFilter::forget(std::size_t object) {
  if (object >= objects()) {
    throw InvalidInput(fmt::format("object {} to forget, but there are {}", object, objects()));
  }
  state_->forget(object);
}

std::size_t MultiObjectFilter::objects() const { return state_->objects.size(); }

double MultiObjectFilter::dependent_detections() const { return state_->dependent_detections(); }

Vector6d MultiObjectFilter::noise_scale(std::size_t object) const {
  return state_->objects[object].sensor.noise_scale;
}

ConcentratedGaussian<SE3d> MultiObjectFilter::camera() const {
  return ConcentratedGaussian<SE3d>::trusted(
      state_->backbone.pose(kCamera),
      state_->factor() * state_->backbone.covariance(kCamera, kCamera));
}

std::vector<ObjectHypothesis> MultiObjectFilter::hypotheses(std::size_t object) const {
  const ObjectState& state = state_->objects[object];
  std::vector<ObjectHypothesis> list = state.hypotheses;
  const std::vector<double> probabilities = state_->probabilities(state);
  for (std::size_t h = 0; h < list.size(); ++h) {
    list[h].probability = probabilities[h];
    const Pair pair = state_->honest_pair(state, h);
    list[h].pose = pair.object;
    list[h].covariance = pair.covariance.bottomRightCorner<6, 6>();
    list[h].with_camera = pair.covariance.bottomLeftCorner<6, 6>();
  }
  return list;
}

std::optional<std::size_t> MultiObjectFilter::leading(std::size_t object) const {
  const ObjectState& state = state_->objects[object];
  return state.index ? std::optional(state.leading) : std::nullopt;
}

double MultiObjectFilter::mode_probability(std::size_t object) const {
  const ObjectState& state = state_->objects[object];
  return state.index ? state_->probabilities(state)[state.leading] : 0.0;
}

double MultiObjectFilter::log_absent(std::size_t object) const {
  return state_->objects[object].log_absent;
}

ConcentratedGaussian<SE3d> MultiObjectFilter::relative(std::size_t object,
                                                       std::size_t hypothesis) const {
  const Pair pair = state_->honest_pair(state_->objects[object], hypothesis);
  return ConcentratedGaussian<SE3d>::trusted(
      pair.camera_object(), pair.camera.inverse().adjoint_congruence(pair.difference()));
}

ConcentratedGaussian<PoseStackd> MultiObjectFilter::backbone() const {
  const Backbone& backbone = state_->backbone;
  std::vector<SE3d> poses;
  for (std::size_t i = 0; i < backbone.size(); ++i) poses.push_back(backbone.pose(i));
  Eigen::MatrixXd covariance = state_->factor() * backbone.covariance();
  for (const ObjectState& object : state_->objects) {
    if (object.index)
      internal::block(covariance, *object.index, *object.index) +=
          state_->common_error(object, backbone.pose(*object.index));
  }
  return ConcentratedGaussian<PoseStackd>::trusted(PoseStackd(std::move(poses)),
                                                   std::move(covariance));
}

std::optional<std::size_t> MultiObjectFilter::backbone_index(std::size_t object) const {
  return state_->objects[object].index;
}

const MultiObjectSettings& MultiObjectFilter::settings() const { return state_->settings; }

const ObjectSensor& MultiObjectFilter::sensor(std::size_t object) const {
  return state_->objects[object].sensor;
}

double MultiObjectFilter::covariance_factor() const { return state_->factor(); }

Matrix6d MultiObjectFilter::common_error(std::size_t object, const SE3d& camera,
                                         const SE3d& pose) const {
  return state_->common_error(state_->objects[object], camera, pose);
}

ConcentratedGaussian<PoseStackd> MultiObjectFilter::joint(
    std::span<const std::optional<std::size_t>> hypotheses) const {
  // The backbone with further hypotheses appended, then the poses that were asked for.
  Backbone all = state_->backbone;
  std::vector<std::size_t> order{kCamera};
  if (state_->motion) order.push_back(*state_->motion);
  for (std::size_t j = 0; j < state_->objects.size(); ++j) {
    const ObjectState& object = state_->objects[j];
    if (!hypotheses[j]) continue;
    std::size_t at = object.index.value();
    if (*hypotheses[j] != object.leading) {
      const ObjectHypothesis& other = object.hypotheses.at(*hypotheses[j]);
      at = all.append(other.pose, other.covariance, other.with_camera);
    }
    internal::block(all.covariance(), at, at) +=
        all.pose(at).adjoint_congruence(Matrix6d(state_->drift - object.drift));
    order.push_back(at);
  }
  std::vector<SE3d> poses;
  Eigen::MatrixXd covariance(internal::offset(order.size()), internal::offset(order.size()));
  for (std::size_t i = 0; i < order.size(); ++i) {
    poses.push_back(all.pose(order[i]));
    for (std::size_t k = 0; k < order.size(); ++k)
      internal::block(covariance, i, k) = all.covariance(order[i], order[k]);
  }
  return ConcentratedGaussian<PoseStackd>::trusted(PoseStackd(std::move(poses)),
                                                   std::move(covariance));
}

}  // namespace posemix
