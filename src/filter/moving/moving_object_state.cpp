// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "moving_object_state.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "posemix/base/statistics.hpp"

namespace posemix::internal {
namespace {

/// The noise with clutter of a default weight where it has none, and with offsets nearest to none
/// under the symmetries.
ObjectSensor prepared(ObjectSensor sensor, double default_clutter) {
  std::vector<NoiseComponent> components = sensor.noise.components();
  if (!sensor.symmetries.is_trivial()) {
    for (NoiseComponent& component : components)
      component.offset = sensor.symmetries.closest(component.offset, SE3d(), Matrix6d::Identity());
  }
  Clutter clutter = sensor.noise.clutter();
  if (!(clutter.weight > 0.0)) clutter.weight = default_clutter / (1.0 - default_clutter);
  sensor.noise = DetectorNoise(std::move(components), clutter, sensor.noise.dependence());
  return sensor;
}

Eigen::MatrixXd generator_of(const MotionModels& models) {
  const auto n = static_cast<Eigen::Index>(models.models.size());
  Eigen::MatrixXd generator = models.rates;
  if (generator.size() == 0) generator = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    generator(i, i) = 0.0;
    generator(i, i) = -generator.row(i).sum();
  }
  return generator;
}

/// Volume in which an object is put by a jump, for models with jumps.
double volume_of(const ObjectMotion& motion, double otherwise) {
  const auto* put_down = std::get_if<PutDownMotion>(&motion);
  return put_down ? put_down->volume_m3 : otherwise;
}

}  // namespace

MovingObjectState::MovingObjectState(ObjectSensor sensor, MotionModels models,
                                     const MovingObjectSettings& settings)
    : models_(std::move(models)),
      settings_(settings),
      detector_(prepared(std::move(sensor), settings.default_clutter)),
      modes_(detector_.sensor().noise),
      generator_(generator_of(models_)),
      explained_(chi_square_quantile(settings.explained_probability, 6, "explained_probability")),
      merge_bounds_{settings.merge_rotation_rad, settings.merge_translation_m,
                    chi_square_quantile(settings.merge_probability, 6, "merge_probability")},
      lost_(static_cast<Eigen::Index>(models_.models.size()),
            static_cast<Eigen::Index>(modes_.count())) {
  for (std::size_t k = 0; k < model_count(); ++k) {
    const double start = models_.start.empty() ? 1.0 : models_.start[k];
    lost_.right(static_cast<Eigen::Index>(k), 0) = start;
  }
  lost_ *= 1.0 / lost_.total();
}

const MovingHypothesis* MovingObjectState::leader() const {
  const auto best = std::max_element(
      hypotheses_.begin(), hypotheses_.end(),
      [](const auto& a, const auto& b) { return a.weights.total() < b.weights.total(); });
  return best == hypotheses_.end() ? nullptr : &*best;
}

double MovingObjectState::normalise() {
  double total = lost_.total();
  for (const MovingHypothesis& hypothesis : hypotheses_) total += hypothesis.weights.total();
  for (MovingHypothesis& hypothesis : hypotheses_) hypothesis.weights *= 1.0 / total;
  lost_ *= 1.0 / total;
  return total;
}

/// Hypotheses that agree become one, of the id of the more probable: "Reduction".
std::size_t MovingObjectState::merge() {
  const SymmetryGroup& symmetries = sensor().symmetries;
  const auto conditional = [](const PlacedObject& object) {
    ConditionalPose pose{object.pose, {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
    pose.covariance.topLeftCorner<6, 6>() = object.pose_covariance();
    return pose;
  };
  std::stable_sort(hypotheses_.begin(), hypotheses_.end(), [](const auto& a, const auto& b) {
    return a.weights.total() > b.weights.total();
  });
  std::size_t merges = 0;
  for (std::size_t a = 0; a < hypotheses_.size(); ++a) {
    for (std::size_t b = a + 1; b < hypotheses_.size();) {
      MovingHypothesis& first = hypotheses_[a];
      MovingHypothesis& second = hypotheses_[b];
      const ConditionalPose at = conditional(first.objects[first.best_model()]);
      ConditionalPose other = conditional(second.objects[second.best_model()]);
      if (!agree(Matrix6d::Zero(), symmetries, merge_bounds_, at, other)) {
        ++b;
        continue;
      }
      const Eigen::ArrayXd weights = first.weights.by_model();
      const Eigen::ArrayXd added = second.weights.by_model();
      for (std::size_t k = 0; k < model_count(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        PlacedObject& moved = second.objects[k];
        if (!symmetries.is_trivial())
          moved.pose = symmetries.closest(moved.pose, first.objects[k].pose, Matrix6d::Identity());
        const WeightedObject parts[] = {{std::max(weights[row], 1e-300), &first.objects[k]},
                                        {added[row], &moved}};
        if (added[row] > 0.0) first.objects[k] = mixed(parts);
      }
      first.detections = std::max(first.detections, second.detections);
      second.weights.redirect(first.id, kAnyPlace, true);
      first.weights.redirect(second.id, kAnyPlace, true);
      first.weights.add(second.weights);
      const std::uint64_t gone = second.id;
      const std::uint64_t kept = first.id;
      hypotheses_.erase(hypotheses_.begin() + static_cast<std::ptrdiff_t>(b));
      for (MovingHypothesis& hypothesis : hypotheses_)
        hypothesis.weights.redirect(gone, kept, hypothesis.id == kept);
      lost_.redirect(gone, kept, false);
      ++merges;
    }
  }
  return merges;
}

void MovingObjectState::keep_heaviest() {
  constexpr double kNegligible = 1e-14;
  std::stable_sort(hypotheses_.begin(), hypotheses_.end(), [](const auto& a, const auto& b) {
    return a.weights.total() > b.weights.total();
  });
  while (!hypotheses_.empty() && (hypotheses_.size() > settings_.max_hypotheses ||
                                  !(hypotheses_.back().weights.total() > kNegligible))) {
    const std::uint64_t gone = hypotheses_.back().id;
    hypotheses_.pop_back();
    for (MovingHypothesis& hypothesis : hypotheses_)
      hypothesis.weights.redirect(gone, kAnyPlace, false);
    lost_.redirect(gone, kAnyPlace, false);
  }
  normalise();
}

/// A Gaussian at a component of an observation that shows a mode of the noise, for every model.
MovingHypothesis MovingObjectState::birth(const ObservationComponent& seen, std::size_t mode,
                                          const KnownFrame& camera) const {
  const auto& noise = sensor().noise.components();
  PlacedObject born;
  born.pose = camera.pose * seen.pose * noise[modes_.first(mode)].offset.inverse();
  Matrix6d covariance = Matrix6d::Zero();
  const DetectionState state = born.seen_from(camera);
  for (std::size_t c = 0; c < noise.size(); ++c) {
    if (modes_.mode_of(c) == mode)
      covariance +=
          noise[c].weight / modes_.weight(mode) * white_covariance(state, seen, noise[c], sensor());
  }
  if (const auto slow = sensor().slow_covariance()) {
    const Matrix6d a = slow_error_map(state, noise[modes_.first(mode)], sensor());
    covariance += a * *slow * a.transpose();
    born.covariance.topRightCorner<6, 6>() = -a * *slow;
    born.covariance.bottomLeftCorner<6, 6>() = (-a * *slow).transpose();
    born.covariance.bottomRightCorner<6, 6>() = *slow;
  }
  MovingHypothesis result{.id = kAnyPlace,
                          .objects = {},
                          .weights = ModeWeights(static_cast<Eigen::Index>(model_count()),
                                                 static_cast<Eigen::Index>(modes_.count())),
                          .seen_from = seen.pose};
  for (std::size_t k = 0; k < model_count(); ++k) {
    PlacedObject object = born;
    object.covariance.topLeftCorner<6, 6>() = covariance + camera_for(camera, k).covariance;
    symmetrize(object.covariance);
    if (const auto* velocity = std::get_if<ConstantVelocityMotion>(&models_.models[k]))
      object.covariance.block<6, 6>(kTwistRow, kTwistRow) =
          velocity->start_sds.cwiseAbs2().asDiagonal();
    fix_unobserved(object, sensor().symmetries, models_.models[k]);
    result.objects.push_back(object);
  }
  return result;
}

/// Eq. (15): births from the case that the place is not known, and what the components of the
/// observation are to runs.
ComponentPlaces MovingObjectState::begin(const MovingObservation& observation,
                                         const Evidence& evidence, double peak,
                                         std::vector<MovingHypothesis>& births) {
  constexpr double kLeastPart = 0.01;
  constexpr double kLeastBirth = 1e-14;
  double of_others = 0.0;
  for (const MovingHypothesis& hypothesis : hypotheses_) of_others += hypothesis.weights.total();
  const WrongShares wrong = wrong_shares(observation.clutter, settings_.isolated_clutter);
  const double volume = sensor().noise.clutter().volume_m3;
  Eigen::ArrayXd density(static_cast<Eigen::Index>(model_count()));
  for (std::size_t k = 0; k < model_count(); ++k)
    density[static_cast<Eigen::Index>(k)] =
        (1.0 - wrong.alone) * std::exp(-peak - std::log(8.0 * std::numbers::pi * std::numbers::pi *
                                                        volume_of(models_.models[k], volume)));
  ComponentPlaces result;
  const auto& components = observation.weighed.components;
  for (std::size_t i = 0; i < components.size(); ++i) {
    double least = explained_;
    MovingHypothesis* nearest = nullptr;
    for (std::size_t h = 0; h < evidence.size(); ++h) {
      const Eigen::ArrayXd by_model = hypotheses_[h].weights.by_model();
      for (std::size_t k = 0; k < model_count(); ++k) {
        if (by_model[static_cast<Eigen::Index>(k)] < kLeastPart * by_model.sum()) continue;
        if (evidence[h][k].squared_distances[i] >= least) continue;
        least = evidence[h][k].squared_distances[i];
        nearest = &hypotheses_[h];
      }
    }
    Eigen::ArrayXXd part = lost_.right.colwise() * density;
    for (std::size_t h = 0; h < evidence.size(); ++h) {  // turned where it is
      for (std::size_t k = 0; k < model_count(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        part.row(row) += (1.0 - wrong.alone) * std::exp(evidence[h][k].log_here[i] - peak) *
                         hypotheses_[h].turned.row(row);
      }
    }
    part *= components[i].weight;
    if (nearest) {
      nearest->weights.right += part;
      result.place.push_back(nearest->id);
      continue;
    }
    result.place.push_back(kAnyPlace);
    for (std::size_t m = 0; m < modes_.count(); ++m) {
      const auto column = static_cast<Eigen::Index>(m);
      if (!(part.col(column).sum() > kLeastBirth * of_others)) continue;
      MovingHypothesis born = birth(components[i], m, observation.camera);
      born.id = next_id_++;
      born.weights.right.col(column) = part.col(column);
      if (m == 0) result.place.back() = born.id;
      births.push_back(std::move(born));
    }
  }
  lost_.right.setZero();
  return result;
}

Matrix6d MovingObjectState::reported_covariance(const PlacedObject& object, std::size_t model,
                                                const Matrix6d& added) const {
  Matrix6d covariance = object.pose_covariance() + added;
  if (const KnownFrame* frame = frame_of(model)) covariance += frame->covariance;
  Matrix6d local = sensor().symmetries.unobserved_covariance();
  if (const auto common = sensor().common_covariance()) local += *common;
  covariance += object.pose.adjoint_congruence(local);
  symmetrize(covariance);
  return covariance;
}

std::vector<Component<ConcentratedGaussian<SE3d>>> MovingObjectState::components(
    const Matrix6d& added) const {
  std::vector<Component<ConcentratedGaussian<SE3d>>> result;
  for (const MovingHypothesis& hypothesis : hypotheses_) {
    const Eigen::ArrayXd weights = hypothesis.weights.by_model();
    for (std::size_t k = 0; k < model_count(); ++k) {
      const double weight = weights[static_cast<Eigen::Index>(k)];
      if (!(weight > 0.0)) continue;
      const PlacedObject& object = hypothesis.objects[k];
      result.push_back({std::log(weight), ConcentratedGaussian<SE3d>::trusted(
                                              object.pose, reported_covariance(object, k, added))});
    }
  }
  return result;
}

/// What is reported of one Gaussian, with the twist along the world's axes.
PlacedObject MovingObjectState::reported(const PlacedObject& object, std::size_t model) const {
  PlacedObject result{.pose = object.pose};
  const WorldTwist moving = world_twist(object, models_.models[model]);
  result.twist = moving.mean;
  result.covariance.topLeftCorner<6, 6>() = reported_covariance(object, model, constant_);
  result.covariance.block<6, 6>(kTwistRow, kTwistRow) = moving.covariance;
  return result;
}

MovingObjectEstimate MovingObjectState::estimate() const {
  MovingObjectEstimate result{.time_s = time_s_.value_or(0.0),
                              .hypotheses = {},
                              .lost_probability = lost_.total(),
                              .models = std::vector<double>(model_count(), 0.0)};
  Eigen::ArrayXd models = lost_.by_model();
  for (const MovingHypothesis& hypothesis : hypotheses_) {
    const Eigen::ArrayXd weights = hypothesis.weights.by_model();
    const double total = weights.sum();
    models += weights;
    std::vector<PlacedObject> reported;
    std::vector<double> of_models;
    for (std::size_t k = 0; k < model_count(); ++k) {
      of_models.push_back(weights[static_cast<Eigen::Index>(k)] / total);
      reported.push_back(this->reported(hypothesis.objects[k], k));
    }
    std::vector<WeightedObject> parts;
    for (std::size_t k = 0; k < model_count(); ++k) {
      if (of_models[k] > 0.0) parts.push_back({of_models[k], &reported[k]});
    }
    const PlacedObject object = mixed(parts);
    result.hypotheses.push_back(
        {.world = ConcentratedGaussian<SE3d>::trusted(object.pose, object.pose_covariance()),
         .twist = object.twist,
         .twist_covariance = object.covariance.block<6, 6>(kTwistRow, kTwistRow),
         .probability = total,
         .models = std::move(of_models),
         .id = hypothesis.id,
         .detections = hypothesis.detections});
  }
  for (std::size_t k = 0; k < model_count(); ++k)
    result.models[k] = models[static_cast<Eigen::Index>(k)];
  std::stable_sort(result.hypotheses.begin(), result.hypotheses.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  return result;
}

}  // namespace posemix::internal
