// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "simulation_paths.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

namespace posemix::internal::simulation {
namespace {

/// The minimum-jerk profile: from 0 to 1 with no speed and no acceleration at both ends.
Real smooth_step(Real u) {
  u = std::clamp(u, Real(0), Real(1));
  return u * u * u * (10 + u * (6 * u - 15));
}

/// Part u of the way: straight on, and the rotation about one axis.
Pose between(const Pose& from, const Pose& to, Real part) {
  const SO3<Real> turn = from.rotation().inverse() * to.rotation();
  return {from.rotation() * SO3<Real>::exp(part * turn.log()),
          from.translation() + part * (to.translation() - from.translation())};
}

Pose place_of(const SimulationPlace& place) {
  return pose_of(place.rotation_rad, place.position_m);
}

/// Time until the next event of a Poisson process.
Real draw_wait(Real rate, RandomStream& random) {
  return -std::log1p(-static_cast<Real>(random.uniform())) / rate;
}

/// Anywhere in the box about `centre`, turned about the vertical.
Pose draw_place(const Pose& centre, const Eigen::Vector3d& area_m, RandomStream& random) {
  Vector3 position = centre.translation();
  for (Eigen::Index i = 0; i < 3; ++i)
    position[i] += (2 * static_cast<Real>(random.uniform()) - 1) * area_m[i];
  const Real turn = 2 * std::numbers::pi_v<Real> * random.uniform();
  return {SO3<Real>::exp(Vector3(0, 0, turn)) * centre.rotation(), position};
}

}  // namespace

Pose pose_of(const Eigen::Vector3d& rotation_rad, const Eigen::Vector3d& translation_m) {
  return {SO3<Real>::exp(rotation_rad.cast<Real>()), translation_m.cast<Real>()};
}

Motion frame_motion(const SimulationFrame& frame) {
  std::vector<std::pair<Real, Pose>> stops;
  stops.reserve(frame.waypoints.size());
  for (const SimulationWaypoint& waypoint : frame.waypoints)
    stops.emplace_back(waypoint.time_s, place_of(waypoint.place));
  return [stops](Real t) {
    std::size_t next = 0;
    while (next < stops.size() && stops[next].first <= t) ++next;
    if (next == 0) return stops.front().second;
    if (next == stops.size()) return stops.back().second;
    const auto& [before, from] = stops[next - 1];
    const auto& [after, to] = stops[next];
    return between(from, to, smooth_step((t - before) / (after - before)));
  };
}

ObjectPath::ObjectPath(const SimulationObject& object, const Motions& frames, double end_s,
                       std::uint64_t seed)
    : first_(pose_of(object.rotation_rad, object.position_m)),
      appears_s_(object.appears_s),
      removed_s_(object.removed_s),
      end_s_(end_s) {
  add_still(0, first_);
  // Motions in the order of their times, each with a stream of its own.
  std::vector<std::pair<Real, std::function<void()>>> motions;
  motions.reserve(object.conveyor.size());
  const auto stream = [&](const char* kind, std::size_t i) {
    return named_stream(seed, fmt::format("{}/{}/{}", object.id, kind, i));
  };
  for (const auto& motion : object.conveyor)
    motions.emplace_back(motion.start_s, [this, &motion] { add(motion); });
  for (const auto& motion : object.held)
    motions.emplace_back(motion.start_s, [this, &motion, &frames] { add(motion, frames); });
  std::size_t i = 0;
  for (const auto& motion : object.hand_held) {
    motions.emplace_back(motion.start_s, [this, &motion, random = stream("hand-held", i++)] {
      add(motion.start_s,
          hand_motion(motion, at(motion.start_s), static_cast<double>(end_s_), random));
    });
  }
  i = 0;
  for (const auto& motion : object.pick_and_place) {
    motions.emplace_back(motion.moves.start_s,
                         [this, &motion, random = stream("pick", i++)] { add(motion, random); });
  }
  i = 0;
  for (const auto& motion : object.put_down) {
    motions.emplace_back(motion.moves.start_s, [this, &motion, random = stream("put-down", i++)] {
      add(motion, random);
    });
  }
  std::ranges::stable_sort(motions, {}, [](const auto& motion) { return motion.first; });
  for (const auto& [start_s, begin] : motions) {
    if (start_s <= end_s_) begin();
  }
}

const ObjectPath::Part& ObjectPath::part_at(Real time_s) const {
  const auto later = std::ranges::upper_bound(parts_, time_s, {}, &Part::start_s);
  return later == parts_.begin() ? parts_.front() : *std::prev(later);
}

Pose ObjectPath::at(Real time_s) const { return part_at(time_s).motion(time_s); }

bool ObjectPath::is_present(Real time_s) const {
  return time_s >= appears_s_ && time_s < removed_s_ && part_at(time_s).present;
}

void ObjectPath::add(Real start_s, Motion motion, bool present) {
  parts_.push_back({start_s, std::move(motion), present});
}

void ObjectPath::add_still(Real start_s, const Pose& pose) {
  add(start_s, [pose](Real) { return pose; });
}

void ObjectPath::add(const SimulationConveyor& conveyor) {
  const Pose start = at(conveyor.start_s);
  add(conveyor.start_s, [conveyor, start](Real t) {
    const Real time = std::min<Real>(t, conveyor.stop_s) - conveyor.start_s;
    const SO3<Real> turn = SO3<Real>::exp(time * conveyor.turn_rad_s.cast<Real>());
    return Pose(turn * start.rotation(),
                start.translation() + time * conveyor.velocity_m_s.cast<Real>());
  });
}

void ObjectPath::add(const SimulationHeld& held, const Motions& frames) {
  const Motion& frame = frames.at(held.frame);
  const Pose grip = frame(held.start_s).inverse() * at(held.start_s);
  add(held.start_s, [frame, grip, stop_s = static_cast<Real>(held.stop_s)](Real t) {
    return frame(std::min(t, stop_s)) * grip;
  });
}

template <class Move>
void ObjectPath::repeat(const SimulationMoves& moves, RandomStream& random, Move&& move) {
  const Real last = std::min<Real>(moves.stop_s, end_s_);
  Real time = moves.start_s;
  for (std::size_t i = 0;; ++i) {
    if (moves.times_s.empty()) {
      time += draw_wait(moves.rate_per_s, random);
    } else if (i < moves.times_s.size()) {
      time = moves.times_s[i];
    } else {
      return;
    }
    if (!(time < last)) return;
    const Pose drawn = draw_place(first_, moves.area_m, random);
    time =
        move(time, moves.places.empty() ? drawn : place_of(moves.places[i % moves.places.size()]));
  }
}

void ObjectPath::add(const SimulationPickAndPlace& carried, RandomStream random) {
  repeat(carried.moves, random, [&](Real time, const Pose& place) {
    const Pose from = at(time);
    const auto duration = static_cast<Real>(carried.duration_s);
    const auto lift = static_cast<Real>(carried.lift_m);
    add(time, [=](Real t) {
      const Real u = std::clamp((t - time) / duration, Real(0), Real(1));
      const Pose pose = between(from, place, smooth_step(u));
      // A bump of height one that begins and ends with no speed and no acceleration.
      const Real bump = 64 * std::pow(u * (1 - u), Real(3));
      return Pose(pose.rotation(), pose.translation() + Vector3(0, 0, lift * bump));
    });
    return time + duration;
  });
}

void ObjectPath::add(const SimulationPutDown& put, RandomStream random) {
  repeat(put.moves, random, [&](Real time, const Pose& place) {
    Pose from = at(time);
    if (put.hidden_s > 0.0)
      add(
          time, [from](Real) { return from; }, false);
    add_still(time + put.hidden_s, place);
    return time + put.hidden_s;
  });
}

}  // namespace posemix::internal::simulation
