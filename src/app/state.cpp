// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <Eigen/Eigenvalues>

#include "command_files.hpp"
#include "exit_codes.hpp"
#include "mixture_commands.hpp"
#include "posemix/base/units.hpp"
#include "posemix/results/state_file.hpp"
#include "posemix/slam/relocalise.hpp"

/// The commands on saved states (docs/state.md).
namespace posemix {
namespace {

struct StateOptions {
  std::string file;
  bool json = false;
};

struct RelocaliseOptions {
  std::string old_map;
  std::string now;
  RelocaliseSettings settings;
  bool json = false;
};

/// What a command found, on the standard output.
int print_found(const Json& found, bool json) {
  write_output("-", json ? found.dump() + "\n" : format_table(found));
  return kExitDone;
}

/// The tracker of a state, at its last estimate.
MultiObjectSlam tracker_of(SlamState state) {
  if (auto* stamped = std::get_if<StampedSlam>(&state)) {
    stamped->estimate();
    return stamped->slam();
  }
  return std::get<MultiObjectSlam>(std::move(state));
}

Json pose_json(const PoseDensity& density) {
  const Eigen::Vector3d& t = density.mean().translation();
  const Eigen::Quaterniond& q = density.mean().rotation().quaternion();
  // Largest standard deviations of rotation and translation.
  const Matrix6d& p = density.covariance();
  const auto largest = [&](Eigen::Index at) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
        Eigen::Matrix3d(p.block<3, 3>(at, at)), Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
  };
  return {{"translation_m", {t.x(), t.y(), t.z()}},
          {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}},
          {"sd_rotation_deg", degrees(largest(0))},
          {"sd_translation_m", largest(3)}};
}

Json objects_json(const MultiObjectSlam& slam) {
  Json objects = Json::object();
  for (std::size_t j = 0; j < slam.objects().size(); ++j) {
    const auto existence = slam.existence(j);
    objects[slam.objects()[j].id] = {{"detections", slam.detections(j)},
                                     {"hypotheses", slam.hypotheses(j).size()},
                                     {"existence", existence ? Json(*existence) : Json()}};
  }
  return objects;
}

int describe_state(const StateOptions& options) {
  const StateInfo info = read_state_info(options.file);
  SlamState state = load_state(options.file);
  Json found{{"format", info.format}, {"posemix", info.version}, {"bytes", info.payload_bytes}};
  found["kind"] = info.is_stamped ? "stamped" : "frames";
  if (auto* stamped = std::get_if<StampedSlam>(&state)) {
    const auto& estimate = stamped->estimate();
    found["stamp_s"] = estimate ? Json(estimate->stamp_s) : Json();
    found["waiting"] = stamped->waiting();
  }
  found["objects"] = objects_json(tracker_of(std::move(state)));
  return print_found(found, options.json);
}

int relocalise_states(const RelocaliseOptions& options) {
  const MultiObjectSlam before = tracker_of(load_state(options.old_map));
  const MultiObjectSlam now = tracker_of(load_state(options.now));
  const Relocalisation result = relocalise(before, now, options.settings);
  Json found{{"outcome", word_of(result.outcome)},
             {"probability", result.probability},
             {"shared", result.shared}};
  Json agreed = Json::object();
  for (const AgreedObject& one : result.agreed) agreed[one.old_object] = one.new_object;
  found["agreed"] = agreed;
  found["disagreeing"] = result.disagreeing;
  if (result.new_old) found["T_new_old"] = pose_json(*result.new_old);
  Json objects = Json::object();
  for (const RelocatedObject& one : result.objects) {
    objects[one.object] = pose_json(one.world);
    objects[one.object]["probability"] = one.probability;
  }
  if (result.new_old) found["objects"] = objects;
  return print_found(found, options.json);
}

}  // namespace

void add_state_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<StateOptions>();
  CLI::App* command = program.add_subcommand("state", "What a saved state of object SLAM holds");
  command->footer(
      "Of a file that `posemix slam --save-state`, a live run or the Python package wrote: its\n"
      "version, and its objects with their detections, hypotheses and probability to exist.\n"
      "\n"
      "Example: posemix state kitchen.state");
  command->add_option("file", options->file, "File of a saved state")
      ->required()
      ->type_name("FILE");
  command->add_flag("--json", options->json, "Print one line of JSON instead of a table");
  command->callback(
      [options, &action] { action = [options] { return describe_state(*options); }; });
}

void add_relocalise_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<RelocaliseOptions>();
  CLI::App* command =
      program.add_subcommand("relocalise", "The place of an old map in the world of a new run");
  command->footer(
      "From the objects that are in both saved states, by id or class: the outcome, which objects\n"
      "agree, T_new_old, and every object of the old map in the new world (docs/state.md).\n"
      "\n"
      "Example: posemix relocalise yesterday.state today.state --json");
  command->add_option("old", options->old_map, "Saved state of the old map")
      ->required()
      ->type_name("OLD");
  command->add_option("new", options->now, "Saved state of the new run")
      ->required()
      ->type_name("NEW");
  add_count_option(*command, "--least-objects", options->settings.least_objects,
                   "Fewer objects that agree are not enough");
  command
      ->add_option("--moved-probability", options->settings.moved_probability,
                   "Probability that an object is not where it was")
      ->check(number_in({.lowest = 1e-9, .highest = 0.999999}))
      ->type_name("P")
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print one line of JSON instead of a table");
  command->callback(
      [options, &action] { action = [options] { return relocalise_states(*options); }; });
}

}  // namespace posemix
