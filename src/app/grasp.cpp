// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <memory>

#include <Eigen/Geometry>

#include "command_files.hpp"
#include "exit_codes.hpp"
#include "mixture_commands.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/grasp/success_probability.hpp"
#include "posemix/lie/pose_checks.hpp"
#include "usage_error.hpp"

namespace posemix {
namespace {

constexpr std::size_t kPoseNumbers = 7;
constexpr double kNormTolerance = 1e-2;

struct GraspOptions {
  std::string file;
  std::vector<double> rotation_deg;
  std::vector<double> translation;
  std::vector<double> pose;
  bool best = false;
  std::size_t starts = BestGraspSettings{}.starts;
  std::size_t points = SuccessSettings{}.points;
  std::uint64_t seed = 1;
  bool json = false;
  OutputOptions output;
};

/// A vector from three numbers, or from one number for all axes.
Eigen::Vector3d three(const std::vector<double>& numbers) {
  if (numbers.size() == 1) return Eigen::Vector3d::Constant(numbers[0]);
  return {numbers[0], numbers[1], numbers[2]};
}

void check_numbers(const std::vector<double>& numbers, const char* option) {
  if (numbers.size() == 2) {
    throw CLI::ValidationError(option, "got two numbers, expected one or three");
  }
}

SE3d grasp_pose(const std::vector<double>& numbers) {
  const Eigen::Quaterniond q(numbers[6], numbers[3], numbers[4], numbers[5]);
  const double norm = q.coeffs().stableNorm();
  if (!(std::abs(norm - 1.0) <= kNormTolerance)) {
    throw UsageError(fmt::format("--pose: got a quaternion of norm {:.6g}, expected 1 within {:g}",
                                 norm, kNormTolerance));
  }
  SE3d pose(SO3d::from_quaternion(q), Eigen::Vector3d(numbers[0], numbers[1], numbers[2]));
  try {
    check_pose(pose, "the grasp");
  } catch (const InvalidInput& error) {
    throw UsageError(fmt::format("--pose: {}", error.what()));
  }
  return pose;
}

Json pose_json(const SE3d& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation().quaternion();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

Json success_json(const SuccessEstimate& success, const SE3d& pose) {
  return {{"probability", success.probability},
          {"standard_error", success.error},
          {"pose_tx_ty_tz_qx_qy_qz_qw", pose_json(pose)}};
}

template <class D>
Json found_for(const Mixture<D>& mixture, const ToleranceBox& box, const GraspOptions& options) {
  RandomStream stream(options.seed);
  const SuccessSettings settings{.points = options.points};
  if (!options.best) {
    const SE3d m = grasp_pose(options.pose);
    return success_json(success_probability(mixture, box, m, stream, settings), m);
  }
  const BestGrasp best =
      best_grasp(mixture, box, stream, {.starts = options.starts, .final = settings});
  Json found = success_json(best.success, best.pose);
  for (const GraspCandidate& candidate : best.candidates) {
    found["probability_of_starts"].push_back(candidate.success.probability);
  }
  found["evaluations"] = best.evaluations;
  return found;
}

int grasp_in_box(const GraspOptions& options) {
  const ToleranceBox box{three(options.rotation_deg) * kRadPerDeg, three(options.translation)};
  const NamedMixture input = read_mixture_input(options.file);
  const Json found = std::visit(
      [&](const auto& mixture) { return found_for(mixture, box, options); }, input.file.mixture);
  write_output(options.output.out, options.json ? found.dump() + "\n" : format_table(found));
  return kExitDone;
}

void add_box_options(CLI::App& command, GraspOptions& options) {
  command
      .add_option("--rotation-deg", options.rotation_deg,
                  "Largest rotation about the axes of the grasp: one number, or x y z")
      ->required()
      ->expected(1, 3)
      ->check(number_in({.lowest = 0, .highest = 180, .without_lowest = true}, "in degrees"))
      ->type_name("DEG");
  command
      .add_option("--translation", options.translation,
                  "Largest translation along the axes of the grasp [m]: one number, or x y z")
      ->required()
      ->expected(1, 3)
      ->check(number_in(kPositive, "in metres"))
      ->type_name("M");
  CLI::Option_group* where = command.add_option_group("Pose of the grasp");
  where->add_option("--pose", options.pose, "tx ty tz qx qy qz qw in the frame of the mixture")
      ->expected(kPoseNumbers)
      ->check(number_in(kAnyNumber))
      ->type_name("NUMBER");
  where->add_flag("--best", options.best, "Look for the pose of the largest probability");
  where->require_option(1);
}

}  // namespace

void add_grasp_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<GraspOptions>();
  CLI::App* command =
      program.add_subcommand("grasp", "How likely a grasp succeeds, or the best one");
  command->footer(
      "The probability that the pose lies in the box of poses that a grasp tolerates: rotations "
      "by\n"
      "up to so much about every axis of the grasp, translations by up to so much along it.\n"
      "\n"
      "Example: posemix grasp mug.json --rotation-deg 5 --translation 0.005 --best\n"
      "         posemix grasp mug.json --rotation-deg 5 5 20 --translation 0.01 \\\n"
      "           --pose 0 0 0.8 0 0 0 1 --json");
  command->add_option("file", options->file, "Mixture file; - is the standard input")
      ->required()
      ->type_name("MIXTURE.json");
  add_box_options(*command, *options);
  add_count_option(*command, "--starts", options->starts,
                   "Components from whose modes --best starts")
      ->needs(command->get_option("--best"))
      ->capture_default_str();
  add_count_option(*command, "--points", options->points, "Points per component and replicate")
      ->capture_default_str();
  add_seed_option(*command, options->seed);
  command->add_flag("--json", options->json, "One line of JSON instead of a table");
  add_out_option(*command, options->output);
  command->callback([options, &action] {
    check_numbers(options->rotation_deg, "--rotation-deg");
    check_numbers(options->translation, "--translation");
    action = [options] { return grasp_in_box(*options); };
  });
}

}  // namespace posemix
