// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "simulation_paths.hpp"

/// Random motion in a hand.
namespace posemix::internal::simulation {
namespace {

constexpr Real kStep = 0.01L;    // of the integration, seconds
constexpr Real kDamping = 1.4L;  // 2 zeta of an oscillator with zeta = 0.7
constexpr Real kReaches = 3;     // the reach is so many stationary deviations

/// Coordinates and speeds at the steps of the integration.
struct Knot {
  Vector6 x = Vector6::Zero();
  Vector6 v = Vector6::Zero();
};

/// The mean square of the factor on the acceleration.
Real mean_square_factor(const SimulationHandHeld& hand) {
  const Real agile = static_cast<Real>(hand.agile_s) / (hand.agile_s + hand.calm_s);
  return 1 + agile * (static_cast<Real>(hand.agile_factor) * hand.agile_factor - 1);
}

Vector6 reach_of(const SimulationHandHeld& hand) {
  Vector6 reach;
  reach << Vector3::Constant(hand.reach_rad), hand.reach_m.cast<Real>();
  return reach;
}

Vector6 acceleration_of(const SimulationHandHeld& hand) {
  Vector6 acceleration;
  acceleration << hand.acceleration.rotation_rad.cast<Real>(),
      hand.acceleration.translation_m.cast<Real>();
  return acceleration;
}

/// w of every coordinate: the variance of a damped oscillator is a^2 / (2 * 1.4 w^3).
Vector6 frequency_of(const SimulationHandHeld& hand) {
  const Vector6 reach = reach_of(hand);
  const Vector6 acceleration = acceleration_of(hand);
  Vector6 frequency = Vector6::Zero();
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!(reach[i] > 0)) continue;
    const Real deviation = reach[i] / kReaches;
    const Real square = mean_square_factor(hand) * acceleration[i] * acceleration[i];
    frequency[i] = std::cbrt(square / (2 * kDamping * deviation * deviation));
  }
  return frequency;
}

/// The oscillators at whole steps of the local time. Between calm and agile the hand changes like a
/// Markov chain.
std::vector<Knot> integrate(const SimulationHandHeld& hand, Real duration, RandomStream random) {
  const Vector6 frequency = frequency_of(hand);
  const Vector6 acceleration = acceleration_of(hand);
  const auto count = static_cast<std::size_t>(std::ceil(duration / kStep)) + 2;
  std::vector<Knot> knots{Knot{}};
  bool agile = false;
  while (knots.size() < count) {
    const Real mean = agile ? hand.agile_s : hand.calm_s;
    const bool changes = random.uniform() * mean < kStep;
    if (changes && hand.agile_s > 0.0) agile = !agile;
    const Real factor = agile ? hand.agile_factor : 1.0;
    const Vector6 white = draw_normal(random);
    Knot next = knots.back();
    const Vector6 force =
        -kDamping * frequency.cwiseProduct(next.v) - frequency.cwiseAbs2().cwiseProduct(next.x);
    next.v += kStep * force + std::sqrt(kStep) * factor * acceleration.cwiseProduct(white);
    next.x += kStep * next.v;
    knots.push_back(next);
  }
  return knots;
}

/// The coordinates between two steps: a cubic, so that the speed is continuous.
Vector6 coordinates_at(const std::vector<Knot>& knots, Real time) {
  const auto before = static_cast<std::size_t>(std::floor(time / kStep));
  const std::size_t i = std::min(before, knots.size() - 2);
  const Real u = time / kStep - static_cast<Real>(i);
  const Knot& a = knots[i];
  const Knot& b = knots[i + 1];
  const Real square = u * u;
  const Real cube = square * u;
  return (2 * cube - 3 * square + 1) * a.x + (cube - 2 * square + u) * kStep * a.v +
         (3 * square - 2 * cube) * b.x + (cube - square) * kStep * b.v;
}

/// Bends what is beyond two thirds of the reach back into it, with continuous curvature.
Real within(Real x, Real reach) {
  if (!(reach > 0)) return 0;
  constexpr Real kFree = 2 / Real(3);
  const Real u = std::abs(x) / reach;
  if (u <= kFree) return x;
  const Real bent = kFree + (1 - kFree) * std::tanh((u - kFree) / (1 - kFree));
  return std::copysign(bent * reach, x);
}

/// Time that passes for the motion by time t from its start: its rate grows from 0 to 1 and falls
/// back along u^2 (3 - 2 u), whose integral is u^3 - u^4 / 2.
Real local_time(Real t, Real duration, Real ramp) {
  t = std::clamp(t, Real(0), duration);
  const auto risen = [ramp](Real time) {
    if (!(ramp > 0)) return time;
    const Real u = std::min(time / ramp, Real(1));
    return ramp * u * u * u * (1 - u / 2) + std::max(time - ramp, Real(0));
  };
  const Real rest = std::max(duration - t, Real(0));
  const Real whole = risen(duration / 2);
  return t <= duration / 2 ? risen(t) : 2 * whole - risen(rest);
}

}  // namespace

Motion hand_motion(const SimulationHandHeld& hand, const Pose& start, double end_s,
                   RandomStream random) {
  const Real begin = hand.start_s;
  // A motion that is still going on at the last frame does not stop there.
  const bool goes_on = hand.stop_s > end_s;
  const Real ramp = std::min<Real>(hand.ramp_s, (hand.stop_s - hand.start_s) / 2);
  const Real duration = goes_on ? end_s + 2 * ramp - begin : hand.stop_s - begin;
  const auto knots = std::make_shared<const std::vector<Knot>>(integrate(hand, duration, random));
  return [=, reach = reach_of(hand)](Real t) {
    Vector6 x = coordinates_at(*knots, local_time(t - begin, duration, ramp));
    for (Eigen::Index i = 0; i < 6; ++i) x[i] = within(x[i], reach[i]);
    return Pose(start.rotation() * SO3<Real>::exp(Vector3(x.head<3>())),
                start.translation() + Vector3(x.tail<3>()));
  };
}

}  // namespace posemix::internal::simulation
