// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>
#include <utility>

#include "moving_object_state.hpp"

/// Births, and the places of runs: what an observation begins.
namespace posemix::internal {
namespace {

/// Volume in which an object is put by a jump, for models with jumps.
double volume_of(const ObjectMotion& motion, double otherwise) {
  const auto* put_down = std::get_if<PutDownMotion>(&motion);
  return put_down ? put_down->volume_m3 : otherwise;
}

}  // namespace

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

/// The hypothesis of a weight by now that explains a component of the observation best, within the
/// quantile.
MovingHypothesis* MovingObjectState::explaining(const Evidence& evidence, std::size_t component,
                                                double least_weight, SplitHypotheses& split) {
  constexpr double kLeastModelShare = 0.01;
  double least = explained_;
  MovingHypothesis* nearest = nullptr;
  for (std::size_t h = 0; h < evidence.size(); ++h) {
    const SplitHypotheses::Place& place = split.places[h];
    const std::optional<std::size_t> of_component = place.of_component[component];
    if (place.is_split && !of_component) continue;
    MovingHypothesis& at = at_place(h, of_component.value_or(0), split);
    const Eigen::ArrayXd by_model = at.weights.by_model();
    if (!(by_model.sum() > least_weight)) continue;
    for (std::size_t k = 0; k < model_count(); ++k) {
      if (by_model[static_cast<Eigen::Index>(k)] < kLeastModelShare * by_model.sum()) continue;
      if (evidence[h][k].squared_distances[component] >= least) continue;
      least = evidence[h][k].squared_distances[component];
      nearest = &at;
    }
  }
  return nearest;
}

/// Eq. (15): the weights, by model and mode, of the case that a component of the observation shows
/// the object at a place that no hypothesis has: anywhere, or turned where it was.
Eigen::ArrayXXd MovingObjectState::begun_from_lost(const MovingObservation& observation,
                                                   double peak, std::size_t component) const {
  const double volume = sensor().noise.clutter().volume_m3;
  Eigen::ArrayXXd part = lost_.right;
  for (std::size_t k = 0; k < model_count(); ++k)
    part.row(static_cast<Eigen::Index>(k)) *=
        std::exp(-peak - std::log(8.0 * std::numbers::pi * std::numbers::pi *
                                  volume_of(models_.models[k], volume)));
  const WrongShares wrong = wrong_shares(observation.clutter, settings_.isolated_clutter);
  return (1.0 - wrong.alone) * observation.weighed.components[component].weight * part;
}

Eigen::ArrayXXd MovingObjectState::begun_by_turn(const MovingObservation& observation,
                                                 const Evidence& evidence, double peak,
                                                 std::size_t component,
                                                 std::size_t hypothesis) const {
  Eigen::ArrayXXd part = hypotheses_[hypothesis].turned;
  for (std::size_t k = 0; k < model_count(); ++k)
    part.row(static_cast<Eigen::Index>(k)) *=
        std::exp(evidence[hypothesis][k].log_here[component] - peak);
  const WrongShares wrong = wrong_shares(observation.clutter, settings_.isolated_clutter);
  return (1.0 - wrong.alone) * observation.weighed.components[component].weight * part;
}

/// What a component of the observation begins, of every mode, from where.
Arrival MovingObjectState::arrival(const MovingObservation& observation, const Evidence& evidence,
                                   double peak, std::size_t component) const {
  Arrival result{.from_lost = begun_from_lost(observation, peak, component)};
  result.weight = result.from_lost;
  for (std::size_t h = 0; h < evidence.size(); ++h) {
    Eigen::ArrayXXd turned = begun_by_turn(observation, evidence, peak, component, h);
    result.weight += turned;
    if (trace_) result.turned.emplace_back(hypotheses_[h].id, std::move(turned));
  }
  return result;
}

/// Notes where the weight of a hypothesis came from, in one mode or in all.
void MovingObjectState::trace_arrival(const Arrival& all, std::uint64_t id,
                                      std::optional<std::size_t> mode) {
  if (!trace_) return;
  const auto of = [&](const Eigen::ArrayXXd& weights) -> Eigen::ArrayXXd {
    return mode ? Eigen::ArrayXXd(weights.col(static_cast<Eigen::Index>(*mode)))
                : Eigen::ArrayXXd(weights.rowwise().sum());
  };
  Arrival entry{.id = id, .weight = of(all.weight), .from_lost = of(all.from_lost)};
  for (const auto& [from, weights] : all.turned) entry.turned.emplace_back(from, of(weights));
  trace_->arrivals.push_back(std::move(entry));
}

/// Births at components that no hypothesis explains, or one that is hardly more probable by now:
/// one for each mode of the noise. Returns the place of every component.
std::vector<std::uint64_t> MovingObjectState::begin(const MovingObservation& observation,
                                                    const Evidence& evidence, double peak,
                                                    SplitHypotheses& split,
                                                    std::vector<MovingHypothesis>& births) {
  constexpr double kLeastBirth = 1e-14;
  // What joins a hypothesis does not move it, and so has to be a small part of it.
  constexpr double kMostJoining = 0.05;
  double of_others = 0.0;
  for (const auto* list : {&hypotheses_, &split.parts})
    for (const MovingHypothesis& hypothesis : *list) of_others += hypothesis.weights.total();
  std::vector<std::uint64_t> places;
  for (std::size_t i = 0; i < observation.weighed.components.size(); ++i) {
    const Arrival all = arrival(observation, evidence, peak, i);
    const Eigen::ArrayXXd& part = all.weight;
    if (MovingHypothesis* nearest = explaining(evidence, i, part.sum() / kMostJoining, split)) {
      nearest->weights.right += part;
      trace_arrival(all, nearest->id, std::nullopt);
      places.push_back(nearest->id);
      continue;
    }
    places.push_back(kAnyPlace);
    for (std::size_t m = 0; m < modes_.count(); ++m) {
      const auto column = static_cast<Eigen::Index>(m);
      if (!(part.col(column).sum() > kLeastBirth * of_others)) continue;
      births.push_back(birth(observation.weighed.components[i], m, observation.camera));
      births.back().id = next_id_++;
      births.back().weights.right.col(column) = part.col(column);
      trace_arrival(all, births.back().id, m);
      if (m == 0) places.back() = births.back().id;
    }
  }
  return places;
}

/// Eq. (14): runs that began are at the places of the observation's components; at its own place
/// the detector is right.
void MovingObjectState::place_runs(const MovingObservation& observation,
                                   const std::vector<std::uint64_t>& places,
                                   SplitHypotheses& split) {
  const Eigen::ArrayXd lost_begun = lost_.runs.front().weight;
  lost_.runs.front().weight.setZero();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double weight = observation.weighed.components[i].weight;
    for (std::size_t h = 0; h < hypotheses_.size(); ++h) {
      const SplitHypotheses::Place& place = split.places[h];
      MovingHypothesis& hypothesis = at_place(h, place.of_wrong, split);
      if (places[i] == hypothesis.id) {
        hypothesis.weights.right.col(0) += weight * place.begun;
      } else {
        hypothesis.weights.run_at(places[i]) += weight * place.begun;
      }
    }
    lost_.run_at(places[i]) += weight * lost_begun;
  }
}

}  // namespace posemix::internal
