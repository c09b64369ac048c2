// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "simulation_checks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

namespace posemix::internal::simulation {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLatest = 1e9;  // seconds
constexpr double kLargestAcceleration = 1e3;
constexpr double kHighestRate = 100.0;    // events per second or image
constexpr double kLongestHandHeld = 1e4;  // seconds, whose path is in memory as a whole

/// The time in which a motion has the object for itself.
struct Span {
  double start_s;
  double end_s;
  const char* kind;
};

[[noreturn]] void refuse(const std::string& owner, const std::string& why) {
  throw InvalidInput(fmt::format("simulation: {} {}", owner, why));
}

void check_view(const SimulationView& view) {
  const Checker checker("view:");
  constexpr double kMostPixels = 1e5;
  checker.within(static_cast<double>(view.width_px), 1.0, kMostPixels, "width");
  checker.within(static_cast<double>(view.height_px), 1.0, kMostPixels, "height");
  checker.within(view.focal_length_px, 1.0, kMostPixels, "focal length");
  checker.within(view.least_range_m, 1e-6, kFurthest, "least range");
  checker.within(view.largest_range_m, 1e-6, kFurthest, "largest range");
  if (view.least_range_m < view.largest_range_m) return;
  refuse("view:", fmt::format("the least range, {} m, must be below the largest, {} m",
                              view.least_range_m, view.largest_range_m));
}

Span checked_span(const Checker& checker, const std::string& owner, const Span& span) {
  checker.within(span.start_s, 0.0, kLatest, "start of a motion");
  if (span.start_s < span.end_s) return span;
  refuse(owner, fmt::format("motion '{}' starts at {} s and stops at {} s, expected a later stop",
                            span.kind, span.start_s, span.end_s));
}

void check_place(const Checker& checker, const SimulationPlace& place) {
  checker.within(place.position_m, -kFurthest, kFurthest, "position of a place");
  checker.within(place.rotation_rad, -kLargestAngle, kLargestAngle, "rotation of a place");
}

/// The time of the moves, each of which takes so long.
Span check_moves(const Checker& checker, const std::string& owner, const SimulationMoves& moves,
                 double duration_s, const char* kind) {
  if (moves.times_s.empty() == (moves.rate_per_s == 0.0)) {
    refuse(owner,
           fmt::format("motion '{}' has {}, expected one of the two", kind,
                       moves.times_s.empty() ? "neither times nor a rate" : "times and a rate"));
  }
  checker.within(moves.rate_per_s, 0.0, kHighestRate, "rate of moves");
  checker.within(moves.area_m, 0.0, kFurthest, "area of moves");
  for (const SimulationPlace& place : moves.places) check_place(checker, place);
  double earliest = moves.start_s;
  for (const double time : moves.times_s) {
    checker.within(time, earliest, kLatest, "time of a move");
    earliest = std::nextafter(time + duration_s, kInfinity);
  }
  const double last = moves.times_s.empty() ? moves.stop_s : moves.times_s.back();
  return checked_span(checker, owner, {moves.start_s, last + duration_s, kind});
}

Span check_hand(const Checker& checker, const std::string& owner, const SimulationHandHeld& hand,
                double end_s) {
  checker.within(hand.reach_m, 0.0, kFurthest, "reach");
  checker.within(hand.reach_rad, 0.0, std::numbers::pi, "reach of the rotation");
  for (const Eigen::Vector3d& sd :
       {hand.acceleration.rotation_rad, hand.acceleration.translation_m})
    checker.within(sd, 0.0, kLargestAcceleration, "acceleration");
  checker.within(hand.agile_factor, 0.0, kLargestAcceleration, "factor of agile parts");
  checker.within(hand.calm_s, 0.01, kLatest, "length of calm parts");
  checker.within(hand.agile_s, 0.0, kLatest, "length of agile parts");
  checker.within(hand.ramp_s, 0.0, kLongestPeriod, "ramp");
  const double length = std::min(hand.stop_s, end_s) - hand.start_s;
  checker.within(length, -kInfinity, kLongestHandHeld, "time in a hand");
  return checked_span(checker, owner, {hand.start_s, hand.stop_s, "hand_held"});
}

std::vector<Span> check_motions(const SimulationObject& object, const std::set<std::string>& frames,
                                double end_s) {
  const std::string owner = fmt::format("object '{}':", object.id);
  const Checker checker(owner);
  std::vector<Span> spans;
  for (const SimulationConveyor& motion : object.conveyor) {
    checker.within(motion.velocity_m_s, -kFurthest, kFurthest, "velocity");
    checker.within(motion.turn_rad_s, -kLargestAngle, kLargestAngle, "turning rate");
    spans.push_back(checked_span(checker, owner, {motion.start_s, motion.stop_s, "conveyor"}));
  }
  for (const SimulationHandHeld& motion : object.hand_held)
    spans.push_back(check_hand(checker, owner, motion, end_s));
  for (const SimulationPickAndPlace& motion : object.pick_and_place) {
    checker.within(motion.duration_s, 1e-3, kLatest, "duration of a move");
    checker.within(motion.lift_m, -kFurthest, kFurthest, "lift");
    spans.push_back(check_moves(checker, owner, motion.moves, motion.duration_s, "pick_and_place"));
  }
  for (const SimulationPutDown& motion : object.put_down) {
    checker.within(motion.hidden_s, 0.0, kLatest, "hidden time");
    spans.push_back(check_moves(checker, owner, motion.moves, motion.hidden_s, "put_down"));
  }
  for (const SimulationHeld& motion : object.held) {
    if (!frames.contains(motion.frame))
      refuse(owner, fmt::format("it is held by '{}', which is no frame", motion.frame));
    spans.push_back(checked_span(checker, owner, {motion.start_s, motion.stop_s, "held"}));
  }
  return spans;
}

void check_object(const SimulationObject& object, const std::set<std::string>& frames,
                  double end_s) {
  const std::string owner = fmt::format("object '{}':", object.id);
  const Checker checker(owner);
  checker.within(object.appears_s, 0.0, kLatest, "time of appearance");
  if (!(object.appears_s < object.removed_s)) {
    refuse(owner, fmt::format("it appears at {} s and is removed at {} s, expected later",
                              object.appears_s, object.removed_s));
  }
  std::vector<Span> spans = check_motions(object, frames, end_s);
  std::ranges::stable_sort(spans, {}, &Span::start_s);
  for (std::size_t i = 1; i < spans.size(); ++i) {
    if (spans[i].start_s >= spans[i - 1].end_s) continue;
    refuse(owner,
           fmt::format("motion '{}' starts at {} s, before motion '{}' stops, at {} s",
                       spans[i].kind, spans[i].start_s, spans[i - 1].kind, spans[i - 1].end_s));
  }
}

void check_frame(const SimulationFrame& frame) {
  const std::string owner = fmt::format("frame '{}':", frame.name);
  const Checker checker(owner);
  if (frame.waypoints.empty()) refuse(owner, "there is no waypoint");
  checker.sd(frame.error);
  double earliest = 0.0;
  for (const SimulationWaypoint& waypoint : frame.waypoints) {
    checker.within(waypoint.time_s, earliest, kLatest, "time of a waypoint");
    check_place(checker, waypoint.place);
    earliest = std::nextafter(waypoint.time_s, kInfinity);
  }
}

void check_clutter(const SimulationClutter& clutter, const SimulationConfig& config) {
  const bool of_class = !clutter.class_id.empty();
  const std::string name = of_class ? clutter.class_id : clutter.object;
  const std::string owner = fmt::format("clutter of '{}':", name);
  const Checker checker(owner);
  if (of_class != clutter.object.empty()) refuse(owner, "expected a class or an object");
  const bool known = std::ranges::any_of(config.objects, [&](const SimulationObject& object) {
    return of_class ? object.class_id == name : object.id == name && object.class_id.empty();
  });
  if (!known)
    refuse(owner, of_class ? "no object has that class" : "no detections name that object");
  checker.within(clutter.rate_per_image, 0.0, kHighestRate, "rate");
  for (const SimulationPlace& place : clutter.places) check_place(checker, place);
  checker.runs(clutter.runs, "fraction of runs");
  checker.sd(clutter.sd);
  if (clutter.rate_per_image > 0.0 && !config.path.view)
    refuse(owner, "it is anywhere in the view, but the camera has no view");
  if (clutter.rate_per_image == 0.0 && clutter.places.empty())
    refuse(owner, "there is neither a rate nor a place");
}

}  // namespace

void check_scene(const SimulationConfig& config) {
  if (config.path.view) check_view(*config.path.view);
  Checker("arm").sd(config.path.arm);
  std::set<std::string> frames;
  for (const SimulationFrame& frame : config.frames) {
    if (frame.name.empty()) throw InvalidInput("simulation: a frame has no name");
    check_frame(frame);
    if (!frames.insert(frame.name).second)
      refuse("frame name", "'" + frame.name + "' occurs twice");
  }
  const double end_s = static_cast<double>(config.path.frames) * config.path.period_s;
  for (const SimulationObject& object : config.objects) check_object(object, frames, end_s);
  for (const SimulationClutter& clutter : config.clutter) check_clutter(clutter, config);
}

}  // namespace posemix::internal::simulation
