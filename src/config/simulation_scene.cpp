// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "simulation_parts.hpp"

#include <fmt/format.h>

#include "posemix/base/units.hpp"

/// What moves in a simulation file, what the camera sees, and parts that all tables share.
namespace posemix::internal {
namespace {

using Eigen::Vector3d;

/// The range of standard deviations that nine decimals in a sequence file can show.
constexpr NumberRange kSdShown{.lowest = 1e-6, .highest = 1e3};

constexpr NumberRange kEnd{.lowest = 0, .with_infinity = true};
constexpr NumberRange kDuration{.lowest = 1e-3, .highest = 1e6};
constexpr NumberRange kAcceleration{.lowest = 0, .highest = 1e3};
constexpr NumberRange kAccelerationDeg{.lowest = 0, .highest = 5e4};

SimulationPlace get_place(const TomlTable& table) {
  SimulationPlace place;
  place.position_m = get_vector3(table, "position_m", place.position_m);
  place.rotation_rad = get_rotation(table, "rotation_deg");
  return place;
}

std::vector<SimulationPlace> get_places(const TomlTable& table) {
  std::vector<SimulationPlace> places;
  for (const TomlTable& place : table.find_tables("places")) places.push_back(get_place(place));
  return places;
}

/// Reads `start_s` and `stop_s` of a motion.
template <class Motion>
void get_span(const TomlTable& table, Motion& motion) {
  motion.start_s = table.get_double_or("start_s", motion.start_s, kSimulationTime);
  motion.stop_s = table.get_double_or("stop_s", motion.stop_s, kEnd);
}

SimulationConveyor get_conveyor(const TomlTable& table) {
  SimulationConveyor conveyor;
  get_span(table, conveyor);
  conveyor.velocity_m_s = get_vector3(table, "velocity_m_s", conveyor.velocity_m_s);
  conveyor.turn_rad_s = get_rotation(table, "turn_deg_s");
  return conveyor;
}

/// One number for all axes or three, times `unit`.
Vector3d get_axes(const TomlTable& table, std::string_view key, const Vector3d& otherwise,
                  const NumberRange& range, double unit) {
  return table.has(key) ? read_sd(table, key, range, unit) : otherwise;
}

SimulationHandHeld get_hand_held(const TomlTable& table) {
  constexpr NumberRange kHalfTurnDeg{.lowest = 0, .highest = 180};
  SimulationHandHeld hand;
  get_span(table, hand);
  hand.reach_m = get_axes(table, "reach_m", hand.reach_m, kSimulationBox, 1.0);
  hand.reach_rad = radians(table.get_double_or("reach_deg", degrees(hand.reach_rad), kHalfTurnDeg));
  SimulationSd& sd = hand.acceleration;
  sd.rotation_rad = get_axes(table, "acceleration_rotation_sd_deg", sd.rotation_rad,
                             kAccelerationDeg, kRadPerDeg);
  sd.translation_m =
      get_axes(table, "acceleration_translation_sd_m", sd.translation_m, kAcceleration, 1.0);
  hand.agile_factor = table.get_double_or("agile_factor", hand.agile_factor, kAcceleration);
  hand.calm_s = table.get_double_or("calm_s", hand.calm_s, kDuration);
  hand.agile_s = table.get_double_or("agile_s", hand.agile_s, kSimulationTime);
  hand.ramp_s = table.get_double_or("ramp_s", hand.ramp_s, kSimulationTime);
  return hand;
}

SimulationMoves get_moves(const TomlTable& table) {
  constexpr NumberRange kDetectionRate{.lowest = 0, .highest = 100, .without_lowest = true};
  SimulationMoves moves;
  get_span(table, moves);
  if (table.has("times_s") == table.has("rate_per_s"))
    table.fail("times_s", "is expected, or rate_per_s in its place, and not both");
  if (table.has("times_s")) {
    const Eigen::VectorXd times = table.get_vector("times_s", {}, kSimulationTime);
    if (times.size() == 0) table.fail("times_s", "is empty, expected at least one time");
    moves.times_s.assign(times.begin(), times.end());
  } else {
    moves.rate_per_s = table.get_double("rate_per_s", kDetectionRate);
  }
  moves.places = get_places(table);
  moves.area_m = get_axes(table, "area_m", moves.area_m, kSimulationBox, 1.0);
  return moves;
}

SimulationPickAndPlace get_pick_and_place(const TomlTable& table) {
  SimulationPickAndPlace carried;
  carried.moves = get_moves(table);
  carried.duration_s = table.get_double_or("duration_s", carried.duration_s, kDuration);
  carried.lift_m = table.get_double_or("lift_m", carried.lift_m, kSimulationLength);
  return carried;
}

SimulationPutDown get_put_down(const TomlTable& table) {
  SimulationPutDown put;
  put.moves = get_moves(table);
  put.hidden_s = table.get_double_or("hidden_s", put.hidden_s, kSimulationTime);
  return put;
}

SimulationHeld get_held(const TomlTable& table) {
  SimulationHeld held;
  held.frame = table.get_string("frame");
  get_span(table, held);
  return held;
}

/// All tables of an array.
template <class Part>
std::vector<Part> get_all(const TomlTable& table, std::string_view key,
                          Part (*get)(const TomlTable&)) {
  std::vector<Part> parts;
  for (const TomlTable& each : table.find_tables(key)) parts.push_back(get(each));
  return parts;
}

SimulationWaypoint get_waypoint(const TomlTable& table) {
  SimulationWaypoint waypoint;
  waypoint.time_s = table.get_double("time_s", kSimulationTime);
  waypoint.place = get_place(table);
  return waypoint;
}

SimulationFrame get_frame(const TomlTable& table) {
  SimulationFrame frame;
  frame.name = get_name(table, "name");
  for (const TomlTable& waypoint : table.get_tables("waypoints"))
    frame.waypoints.push_back(get_waypoint(waypoint));
  frame.error = get_sd(table, frame.error);
  return frame;
}

SimulationClutter get_clutter_source(const TomlTable& table) {
  constexpr NumberRange kDetectionRate{.lowest = 0, .highest = 100};
  SimulationClutter clutter;
  clutter.class_id = table.get_string_or("class", clutter.class_id);
  clutter.object = table.get_string_or("object", clutter.object);
  clutter.rate_per_image =
      table.get_double_or("rate_per_image", clutter.rate_per_image, kDetectionRate);
  clutter.places = get_places(table);
  clutter.runs = get_runs(table);
  clutter.sd = get_sd(table, clutter.sd);
  return clutter;
}

}  // namespace

Vector3d get_vector3(const TomlTable& table, std::string_view key, const Vector3d& otherwise) {
  return table.get_vector_or(key, otherwise, kSimulationLength);
}

Vector3d get_rotation(const TomlTable& table, std::string_view key) {
  return kRadPerDeg * table.get_vector_or(key, Vector3d::Zero(), kSimulationAngleDeg);
}

SimulationSd get_sd(const TomlTable& table, const SimulationSd& otherwise, NoiseFrame frame) {
  const char* const translation =
      frame == NoiseFrame::ray ? "translation_sd_of_range" : "translation_sd_m";
  SimulationSd sd = otherwise;
  if (table.has("rotation_sd_deg")) {
    sd.rotation_rad = read_sd(table, "rotation_sd_deg", kSdShown, kRadPerDeg);
  }
  if (table.has(translation)) sd.translation_m = read_sd(table, translation, kSdShown, 1.0);
  return sd;
}

SimulationRuns get_runs(const TomlTable& table) {
  return {table.get_double_or("fraction", 0.0, kUnitInterval),
          table.get_double_or("mean_run_s", 0.0, kSimulationTime)};
}

std::string get_name(const TomlTable& table, std::string_view key) {
  std::string name = table.get_string(key);
  constexpr std::string_view kAllowed =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";
  if (name.empty() || name.find_first_not_of(kAllowed) != std::string::npos) {
    table.fail(key, fmt::format("is \"{}\", expected letters, digits, '_', '.' and '-'", name));
  }
  return name;
}

void get_motions(const TomlTable& table, SimulationObject& object) {
  object.appears_s = table.get_double_or("appears_s", object.appears_s, kSimulationTime);
  object.removed_s = table.get_double_or("removed_s", object.removed_s, kEnd);
  object.conveyor = get_all(table, "conveyor", get_conveyor);
  object.hand_held = get_all(table, "hand_held", get_hand_held);
  object.pick_and_place = get_all(table, "pick_and_place", get_pick_and_place);
  object.put_down = get_all(table, "put_down", get_put_down);
  object.held = get_all(table, "held", get_held);
}

std::optional<SimulationView> get_view(const TomlTable& camera) {
  constexpr IntegerRange kPixels{.lowest = 1, .highest = 100'000};
  constexpr NumberRange kFocal{.lowest = 1, .highest = 1e5};
  constexpr NumberRange kRange{.lowest = 1e-6, .highest = 1e3};
  const auto table = camera.find_table("view");
  if (!table) return std::nullopt;
  SimulationView view;
  view.width_px = table->get_integer_or("width_px", view.width_px, kPixels);
  view.height_px = table->get_integer_or("height_px", view.height_px, kPixels);
  view.focal_length_px = table->get_double_or("focal_length_px", view.focal_length_px, kFocal);
  view.least_range_m = table->get_double_or("least_range_m", view.least_range_m, kRange);
  view.largest_range_m = table->get_double_or("largest_range_m", view.largest_range_m, kRange);
  return view;
}

std::vector<SimulationFrame> get_frames(const TomlTable& root) {
  return get_all(root, "frames", get_frame);
}

std::vector<SimulationClutter> get_clutter(const TomlTable& root) {
  return get_all(root, "clutter", get_clutter_source);
}

}  // namespace posemix::internal
