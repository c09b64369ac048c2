// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"

namespace posemix {
namespace {

ConsistencyCell by_view(std::string name) {
  return {.name = std::move(name), .correlation_angle_deg = 60.0};
}

ConsistencyCell by_time(std::string name, double correlation_s) {
  return {.name = std::move(name), .correlation_s = correlation_s};
}

template <class Change>
ConsistencyCell changed(ConsistencyCell cell, Change change) {
  change(cell);
  return cell;
}

// A table, however long.
std::vector<ConsistencyCell> all_cells() {  // NOLINT(readability-function-size)
  using Cell = ConsistencyCell;
  return {
      {.name = "white", .slow = false},
      by_time("slow_1_s", 1.0),
      by_time("slow_10_s", 10.0),
      by_time("slow_100_s", 100.0),
      by_view("view"),
      changed(by_view("bursts"),
              [](Cell& c) {
                c.seen_s = 2.0;
                c.pause_s = 4.0;
                c.turns = 10;
              }),
      changed(by_view("pause_100_s"),
              [](Cell& c) {
                c.seen_s = 20.0;
                c.pause_s = 100.0;
                c.turns = 2;
              }),
      changed(by_view("pause_1000_s"),
              [](Cell& c) {
                c.seen_s = 20.0;
                c.pause_s = 1000.0;
                c.turns = 2;
              }),
      changed(by_view("five_objects"), [](Cell& c) { c.objects = 5; }),
      changed(by_view("axis"), [](Cell& c) { c.shape = ObjectShape::axis; }),
      changed(by_view("ball"), [](Cell& c) { c.shape = ObjectShape::ball; }),
      changed(by_view("half_turn"), [](Cell& c) { c.shape = ObjectShape::half_turn; }),
      changed(by_view("good_odometry"), [](Cell& c) { c.odometry = OdometryQuality::good; }),
      changed(by_view("no_odometry"), [](Cell& c) { c.odometry = OdometryQuality::none; }),
      changed(by_view("late_object"),
              [](Cell& c) {
                c.objects = 2;
                c.late_s = 30.0;
              }),
      changed(by_view("flips"), [](Cell& c) { c.flips = 0.2; }),
      changed(by_view("clutter"), [](Cell& c) { c.clutter = 0.1; }),
      changed(by_view("two_wrong_starts"),
              [](Cell& c) {
                c.flips = 0.1;
                c.wrong_starts = 2;
              }),
      {.name = "default_detector", .default_detector = true},
      changed(by_view("candidates_after_100_s"),
              [](Cell& c) {
                c.candidates = true;
                c.seen_s = 5.0;
                c.pause_s = 100.0;
                c.turns = 2;
              }),
  };
}

/// Two modes that look the same, with other evidence of which is right.
ConsistencyCell two_modes(std::string name, ModeInput modes, bool in_runs) {
  return changed(by_view(std::move(name)), [&](ConsistencyCell& c) {
    c.modes = modes;
    c.modes_in_runs = in_runs;
  });
}

/// The first three seconds of such recordings.
ConsistencyCell first_seconds(ConsistencyCell cell) {
  return changed(std::move(cell), [](ConsistencyCell& c) {
    c.seen_s = 3.0;
    c.first_look_s = 0.1;
    c.look_every_s = 0.1;
  });
}

std::vector<ConsistencyCell> cells_with_modes() {
  const auto pair = [](const std::string& name, bool in_runs) {
    return std::vector{first_seconds(two_modes(name, ModeInput::mixture, in_runs)),
                       first_seconds(two_modes(name + "_best_only", ModeInput::best, in_runs))};
  };
  std::vector<ConsistencyCell> cells{
      two_modes("modes", ModeInput::mixture, false),
      changed(two_modes("modes_white", ModeInput::mixture, false),
              [](ConsistencyCell& c) { c.slow = false; }),
      changed(two_modes("modes_five_objects", ModeInput::mixture, false),
              [](ConsistencyCell& c) { c.objects = 5; }),
      two_modes("modes_in_runs", ModeInput::mixture, true),
      two_modes("modes_in_runs_best_only", ModeInput::best, true)};
  for (const auto& list : {pair("first_modes", false), pair("first_modes_in_runs", true)})
    cells.insert(cells.end(), list.begin(), list.end());
  return cells;
}

/// What competes for long, and detections of which the place alone tells.
std::vector<ConsistencyCell> cells_that_compete() {
  using Cell = ConsistencyCell;
  const auto cluttered = [](ObjectShape shape) {
    return [shape](Cell& c) {
      c.shape = shape;
      c.clutter = 0.25;
    };
  };
  const auto five_flipped = [](double flips) {
    return [flips](Cell& c) {
      c.objects = 5;
      c.flips = flips;
    };
  };
  return {changed(by_view("axis_with_clutter"), cluttered(ObjectShape::axis)),
          changed(by_view("ball_with_clutter"), cluttered(ObjectShape::ball)),
          changed(by_view("flips_five_objects"), five_flipped(0.2)),
          changed(by_view("ties_five_objects"), five_flipped(0.5))};
}

}  // namespace

const std::vector<ConsistencyCell>& consistency_cells() {
  static const std::vector<ConsistencyCell> cells = [] {
    std::vector<ConsistencyCell> list = all_cells();
    for (const auto& more : {cells_with_modes(), cells_that_compete()})
      list.insert(list.end(), more.begin(), more.end());
    return list;
  }();
  return cells;
}

}  // namespace posemix
