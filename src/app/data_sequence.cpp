// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "command_files.hpp"
#include "command_options.hpp"
#include "data.hpp"
#include "exit_codes.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/dataset_sequence.hpp"
#include "terminal_text.hpp"
#include "usage_error.hpp"

namespace posemix {
namespace {

struct DataSequenceOptions {
  DatasetSequence request;
  std::vector<double> lever_arm_m;
  std::string out = "-";
  bool quiet = false;
};

int write_sequence(DataSequenceOptions options) {
  for (const double number : options.lever_arm_m) {
    if (!std::isfinite(number))
      throw UsageError(fmt::format("--lever-arm: got {}, expected metres", number));
  }
  if (!options.lever_arm_m.empty())
    options.request.lever_arm_m = Eigen::Vector3d(options.lever_arm_m.data());
  const DatasetSequenceText text = format_dataset_sequence(options.request);
  write_output(options.out, text.toml);
  if (options.quiet) return kExitDone;
  for (const std::string& note : text.notes)
    std::fputs(fmt::format("note: {}\n", terminal_line(note)).c_str(), stderr);
  return kExitDone;
}

void add_sequence_inputs(CLI::App& command, DataSequenceOptions& options) {
  DatasetSequence& request = options.request;
  command.add_option("dataset", request.dataset, "Folder of a BOP dataset or of YCB-Video")
      ->required()
      ->type_name("DIR");
  add_integer_option(command, "--scene", request.scene, {0, 999'999},
                     "Number of the scene, or of the YCB-Video sequence")
      ->required();
  command.add_option("--results", request.results, "The detector's estimates (BOP results, CSV)")
      ->required()
      ->type_name("FILE.csv");
  command.add_option("--split", request.split, "Folder of the scene in a BOP dataset")
      ->type_name("NAME")
      ->capture_default_str();
  add_integer_option(command, "--object", request.objects, {}, "Only this object; repeatable")
      ->type_name("ID")
      ->allow_extra_args(false);
  command.add_option("--min-score", request.min_score, "Leave estimates of a lower score out")
      ->check(number_in(kAnyNumber))
      ->type_name("X");
}

}  // namespace

void add_data_sequence_command(CLI::App& data, std::function<int()>& action) {
  const auto options = std::make_shared<DataSequenceOptions>();
  CLI::App* command =
      data.add_subcommand("sequence", "Write the sequence file of a dataset's scene");
  command->footer(
      "Example: posemix data fetch ycbv --out data --unpack --yes\n"
      "         posemix data sequence data/ycbv --scene 48 --results RESULTS.csv --out scene.toml\n"
      "         posemix slam scene.toml --out out/48");
  add_sequence_inputs(*command, *options);
  command->add_option("--odometry", options->request.odometry, "Odometry of the camera (TUM)")
      ->type_name("FILE");
  command
      ->add_option("--lever-arm", options->lever_arm_m,
                   "From the annotated camera to that of the images, metres")
      ->expected(3)
      ->check(number_in(kAnyNumber, "in metres"))
      ->type_name("X Y Z");
  command
      ->add_option("--frame-period", options->request.frame_period_s,
                   "Time between two image numbers, seconds")
      ->check(number_in(kPositive))
      ->type_name("S");
  command->add_option("--out", options->out, "File for the result; - is the standard output")
      ->type_name("FILE.toml")
      ->capture_default_str();
  command->add_flag("--quiet", options->quiet, "Print no notes");
  command->callback(
      [options, &action] { action = [options] { return write_sequence(*options); }; });
}

}  // namespace posemix
