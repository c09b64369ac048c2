// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "posemix/slam/simulation.hpp"

/// What the filter is told of the motion of simulated objects and of clutter.
namespace posemix {
namespace {

/// A model beside that of the object at rest, and how often it begins and ends [1/s].
struct Model {
  ObjectMotion motion;
  double begins;
  double ends;
};

/// A motion without an end ends rarely.
constexpr double kRarely = 0.01;

double end_rate(double start_s, double stop_s) {
  return std::isinf(stop_s) ? kRarely : 1.0 / (stop_s - start_s);
}

double begin_rate(const SimulationMoves& moves, double length_s) {
  if (moves.times_s.empty()) return moves.rate_per_s;
  return std::max(kRarely, static_cast<double>(moves.times_s.size()) / length_s);
}

/// Edges of the box in which the places of moves are, at least 0.1 m each.
Eigen::Vector3d extent_of(const SimulationMoves& moves) {
  constexpr double kLeast = 0.1;
  if (moves.places.empty()) return (2.0 * moves.area_m).cwiseMax(kLeast);
  Eigen::Vector3d least = moves.places.front().position_m;
  Eigen::Vector3d most = least;
  for (const SimulationPlace& place : moves.places) {
    least = least.cwiseMin(place.position_m);
    most = most.cwiseMax(place.position_m);
  }
  return (most - least).cwiseMax(kLeast);
}

Vector6d sds_of(double rotation, double translation) {
  Vector6d sds;
  sds << Eigen::Vector3d::Constant(rotation), Eigen::Vector3d::Constant(translation);
  return sds;
}

ObjectMotion model_of(const SimulationConveyor& conveyor) {
  constexpr double kTurn = 0.05;   // rad / s^(3/2)
  constexpr double kShift = 0.02;  // m / s^(3/2)
  const double turn = conveyor.turn_rad_s.norm();
  const double speed = conveyor.velocity_m_s.norm();
  return ConstantVelocityMotion{
      .acceleration_sds = sds_of(kTurn + 0.1 * turn, kShift + 0.1 * speed),
      .frame = MotionFrame::world,
      .start_sds = sds_of(0.1 + turn, 0.02 + speed)};
}

/// White acceleration of the size of that of the smooth profile, 5.8 of the way per square of the
/// time, over a quarter of the time.
ObjectMotion model_of(const SimulationPickAndPlace& carried) {
  const double way = extent_of(carried.moves).norm() + 2.0 * std::abs(carried.lift_m);
  const double scale = 5.8 / std::pow(carried.duration_s, 2) * std::sqrt(carried.duration_s / 4.0);
  return ConstantVelocityMotion{.acceleration_sds = sds_of(1.6 * scale, way * scale),
                                .frame = MotionFrame::world,
                                .start_sds = sds_of(0.5, 0.1)};
}

/// Calm or agile parts.
ObjectMotion model_of(const SimulationHandHeld& hand, double factor) {
  ConstantVelocityMotion motion{.frame = MotionFrame::world, .start_sds = sds_of(0.5, 0.2)};
  motion.acceleration_sds << factor * hand.acceleration.rotation_rad,
      factor * hand.acceleration.translation_m;
  return motion;
}

std::optional<PutDownMotion> put_down_of(const SimulationObject& object, double length_s) {
  if (object.put_down.empty()) return std::nullopt;
  PutDownMotion motion{.jump_rate = 0.0, .volume_m3 = 0.0};
  for (const SimulationPutDown& put : object.put_down) {
    motion.jump_rate += begin_rate(put.moves, length_s);
    motion.volume_m3 = std::max(motion.volume_m3, extent_of(put.moves).prod());
  }
  return motion;
}

std::vector<Model> moving_models(const SimulationConfig& config, const SimulationObject& object,
                                 double length_s) {
  std::vector<Model> models;
  const double once = std::max(kRarely, 1.0 / length_s);
  if (!object.conveyor.empty()) {
    const SimulationConveyor& conveyor = object.conveyor.front();
    models.push_back({model_of(conveyor), once, end_rate(conveyor.start_s, conveyor.stop_s)});
  }
  if (!object.pick_and_place.empty()) {
    const SimulationPickAndPlace& carried = object.pick_and_place.front();
    models.push_back(
        {model_of(carried), begin_rate(carried.moves, length_s), 1.0 / carried.duration_s});
  }
  for (std::size_t i = 0; i < config.frames.size(); ++i) {
    const auto held = std::ranges::find(object.held, config.frames[i].name, &SimulationHeld::frame);
    if (held == object.held.end()) continue;
    models.push_back({AttachedMotion{.frame = i}, once, end_rate(held->start_s, held->stop_s)});
  }
  if (!object.hand_held.empty()) {
    const SimulationHandHeld& hand = object.hand_held.front();
    models.push_back({model_of(hand, 1.0), once, end_rate(hand.start_s, hand.stop_s)});
    if (hand.agile_s > 0.0)
      models.push_back({model_of(hand, hand.agile_factor), 0.0, 1.0 / hand.agile_s});
  }
  return models;
}

/// From rest to each model and back, and from each to the others: one that ends goes over into
/// another half as often as it ends in rest.
Eigen::MatrixXd rates_of(const std::vector<Model>& models) {
  const auto count = static_cast<Eigen::Index>(models.size()) + 1;
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 1; i < count; ++i) {
    const Model& model = models[static_cast<std::size_t>(i - 1)];
    rates(0, i) = model.begins;
    rates.row(i).setConstant(0.5 * model.ends);
    rates(i, 0) = model.ends;
    rates(i, i) = 0.0;
  }
  return rates;
}

MotionModels motion_of(const SimulationConfig& config, const SimulationObject& object) {
  const double length_s = static_cast<double>(config.path.frames) * config.path.period_s;
  const auto put_down = put_down_of(object, length_s);
  const std::vector<Model> moving = moving_models(config, object, length_s);
  MotionModels motion;
  if (put_down) motion.models = {*put_down};
  if (moving.empty()) return motion;
  for (const Model& model : moving) motion.models.push_back(model.motion);
  motion.rates = rates_of(moving);
  if (!object.hand_held.empty() && object.hand_held.front().agile_s > 0.0) {
    // Agile parts begin and end in calm ones; otherwise they change as these do.
    const Eigen::Index agile = motion.rates.rows() - 1;
    const Eigen::Index calm = agile - 1;
    motion.rates.row(agile) = motion.rates.row(calm);
    motion.rates.col(agile).setZero();
    motion.rates(agile, calm) = 1.0 / object.hand_held.front().agile_s;
    motion.rates(calm, agile) = 1.0 / object.hand_held.front().calm_s;
  }
  return motion;
}

}  // namespace

MotionModels claimed_motion(const SimulationConfig& config, const SimulationObject& object) {
  if (object.class_id.empty()) return motion_of(config, object);
  for (const SimulationObject& other : config.objects) {
    if (other.class_id != object.class_id) continue;
    MotionModels motion = motion_of(config, other);
    const bool still =
        motion.models.size() == 1 && std::holds_alternative<StaticMotion>(motion.models.front());
    if (!still) return motion;
  }
  return {};
}

Clutter claimed_clutter_of(const SimulationConfig& config, const SimulationObject& object) {
  Clutter claimed = claimed_clutter(object);
  const bool of_class = !object.class_id.empty();
  const auto count = std::ranges::count_if(config.objects, [&](const SimulationObject& other) {
    return of_class ? other.class_id == object.class_id : other.id == object.id;
  });
  for (const SimulationClutter& clutter : config.clutter) {
    const bool named = of_class ? clutter.class_id == object.class_id : clutter.object == object.id;
    if (!named) continue;
    const double recurring = clutter.runs.fraction * static_cast<double>(clutter.places.size());
    claimed.weight += (clutter.rate_per_image + recurring) / static_cast<double>(count);
  }
  return claimed;
}

std::vector<ObjectModel> object_models(const SimulationConfig& config) {
  std::vector<ObjectModel> models;
  for (const SimulationObject& object : config.objects) {
    models.push_back(object_model(object));
    // The noise of the model has weights that sum to one, with the clutter of the object alone.
    double total = claimed_clutter(object).weight;
    for (const SimulationNoise& component : claimed_noise(object)) total += component.weight;
    Clutter clutter = claimed_clutter_of(config, object);
    clutter.weight /= total;
    DetectorNoise& noise = models.back().noise;
    noise = DetectorNoise(noise.components(), clutter, noise.dependence());
    models.back().motion = claimed_motion(config, object);
  }
  return models;
}

}  // namespace posemix
