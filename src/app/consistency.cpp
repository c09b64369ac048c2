// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <filesystem>
#include <memory>
#include <random>

#include "command_files.hpp"
#include "consistency_input.hpp"
#include "exit_codes.hpp"
#include "interrupt.hpp"
#include "mixture_commands.hpp"
#include "posemix/io/output_file.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/results/consistency_files.hpp"
#include "posemix/results/report.hpp"
#include "report.hpp"
#include "result_paths.hpp"
#include "results/result_names.hpp"
#include "summary.hpp"
#include "terminal_text.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

enum class Preset { ros };

/// The words of a preset in options.
const std::vector<std::pair<std::string, Preset>> kPresets{{"ros", Preset::ros}};

struct ConsistencyOptions {
  ConsistencyInput input;
  std::optional<Preset> convention;
  MatchSettings match;
  ErrorAxes axes = ErrorAxes::body;
  std::optional<std::string> json;
  std::optional<std::string> svg;
  std::optional<std::string> report;
  std::optional<std::string> out;
  bool quiet = false;
};

std::string title_of(const ConsistencyInput& input) {
  const std::string name = input_name(input.estimate);
  return input.truth ? fmt::format("{} against {}", name, input_name(*input.truth)) : name;
}

ConsistencyResults compare(const ConsistencyOptions& options) {
  ConsistencyResults results{title_of(options.input), options.match.alignment, options.axes, {}};
  for (const TraceTrack& track : read_consistency_input(options.input)) {
    try {
      const auto pairs = match_to_truth(track.estimates, track.truth, options.match);
      results.poses.push_back({track.name, consistency_of(pairs, {.symmetries = track.symmetries,
                                                                  .axes = options.axes})});
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("{}: {}: {}", results.title, track.name, error.what()));
    }
  }
  return results;
}

/// A folder that is there as long as the object.
class ScratchFolder {
 public:
  ScratchFolder() : path_(fs::temp_directory_path() / fmt::format("posemix-{:016x}", number())) {}
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  static std::uint64_t number() {
    std::random_device device;
    return (std::uint64_t{device()} << 32U) | device();
  }
  fs::path path_;
};

void write_folder(const fs::path& path, const ConsistencyResults& results) {
  OutputFolder folder(path);
  folder.remove_earlier(earlier_consistency(folder.target()));
  folder.put_last("consistency.json");
  for (const auto& [name, content] : format_consistency_files(results)) folder.write(name, content);
  folder.commit();
}

void write_page(const ConsistencyOptions& options, const ConsistencyResults& results) {
  const InterruptGuard guard;
  const ScratchFolder folder;
  write_folder(folder.path(), results);
  write_report_shown({folder.path()}, {.out = *options.report}, false, guard);
}

int consistency_command(ConsistencyOptions options) {
  if (options.convention) options.input.convention = CovarianceConvention::ros();
  if (options.input.truth)
    require_one_standard_input(std::array{options.input.estimate, *options.input.truth});
  if (options.report) require_report_page();
  const ConsistencyResults results = compare(options);
  if (options.json) write_output(*options.json, format_consistency(results));
  if (options.svg) write_output(*options.svg, draw_consistency(results.title, results.poses));
  if (options.out) write_folder(*options.out, results);
  if (options.report) write_page(options, results);
  const bool printed = options.json == "-" || options.svg == "-";
  if (!options.quiet && !printed) print_text(terminal_text(format_consistency_text(results)));
  return kExitDone;
}

/// Refuses options that would have no effect, and two results on one standard output.
void check_options(const CLI::App& command, const ConsistencyOptions& options) {
  const ConsistencyInput& input = options.input;
  if (options.json == "-" && options.svg == "-") {
    throw CLI::ValidationError(
        "--svg", "got - beside --json -, expected the name of a file for one of them");
  }
  const std::array files{NamedResult{"--json", options.json}, NamedResult{"--svg", options.svg},
                         NamedResult{"--report", options.report}};
  require_different_files(files);
  require_beside_folder(files, {"--out", options.out}, internal::is_consistency_name);
  // A report may be the folder's own; what else has its name would be removed by the next run.
  require_beside_folder(std::span(files).first(2), {"--out", options.out},
                        internal::is_report_name);
  if (input.data && !(input.truth && is_sequence_file(*input.truth)))
    throw CLI::ValidationError("--data", "is for --truth with a sequence file");
  if (!is_slam_result(input.estimate)) return;
  for (const char* name : {"--side", "--order", "--convention"}) {
    if (command.count(name) > 0)
      throw CLI::ValidationError(
          name, "is for TUM files; the covariances of posemix slam have a convention of their own");
  }
}

void add_input_options(CLI::App& command, ConsistencyOptions& options) {
  ConsistencyInput& input = options.input;
  command
      .add_option("estimate", input.estimate,
                  "Poses with covariances: TUM with 21 columns more, or a folder of posemix slam")
      ->required()
      ->type_name("ESTIMATE");
  command
      .add_option("--truth", input.truth,
                  "True poses: TUM, or a sequence file (.toml); a folder of posemix slam has them")
      ->type_name("TRUTH");
  command
      .add_option("--track", input.tracks,
                  "Which pose of a folder or a sequence file: camera, objects/ID/world, "
                  "objects/ID/relative; repeatable")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command.add_option("--data", input.data, "Folder below which a sequence file's files lie")
      ->type_name("DIR");
  CLI::Option* const symmetries =
      command
          .add_option("--symmetries", input.symmetries,
                      "Symmetries by object: TOML, or models_info.json of BOP")
          ->type_name("FILE");
  CLI::Option* const object =
      add_integer_option(command, "--object", input.object, {}, "The object in --symmetries")
          ->type_name("ID");
  symmetries->needs(object);
  object->needs(symmetries);
}

void add_convention_options(CLI::App& command, ConsistencyOptions& options) {
  CovarianceConvention& convention = options.input.convention;
  CLI::Option* const order =
      add_choice<TangentOrder>(command, "--order", convention.order, "Order of the covariance")
          ->default_str("rotation_translation");
  CLI::Option* const side =
      add_choice<ErrorSide>(command, "--side", convention.side,
                            "Error of the covariance: left in the frame of the poses, right in "
                            "that of the body, fixed about fixed axes at the body")
          ->default_str("left");
  add_choice(command, "--convention", options.convention, kPresets,
             "Both at once: ros is --side fixed --order translation_rotation")
      ->excludes(order)
      ->excludes(side);
}

void add_comparison_options(CLI::App& command, ConsistencyOptions& options) {
  command
      .add_option("--max-difference", options.match.max_difference_s,
                  "Largest difference of the stamps of a pair; 0: the same stamps")
      ->check(number_in(kNotNegative))
      ->type_name("SECONDS")
      ->capture_default_str();
  add_choice<Alignment>(command, "--align", options.match.alignment,
                        "Move the estimates onto the truth first")
      ->default_str("none");
  add_choice<ErrorAxes>(command, "--axes", options.axes, "Axes along which errors are listed")
      ->default_str("body");
  command.add_option("--json", options.json, "Write consistency.json; - is the standard output")
      ->type_name("FILE");
  command.add_option("--svg", options.svg, "Draw NEES over time; - is the standard output")
      ->type_name("FILE");
  command.add_option("--report", options.report, "Write a page for a browser")
      ->type_name("FILE.html");
  command.add_option("--out", options.out, "Write all into a folder, for posemix report")
      ->type_name("DIR");
  command.add_flag("--quiet", options.quiet, "Print nothing");
}

}  // namespace

void add_consistency_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<ConsistencyOptions>();
  CLI::App* command =
      program.add_subcommand("consistency", "Whether errors are as large as their covariances say");
  command->footer(
      "Compares poses that have covariances with true poses: NEES with its chi-square band, ANEES\n"
      "with an interval that allows for errors that are alike from frame to frame, coverage, and\n"
      "the direction that is most at fault.\n"
      "\n"
      "ESTIMATE has lines `stamp tx ty tz qx qy qz qw` and the upper triangle of the covariance,\n"
      "row by row. Unless told otherwise its error is xi in X = Exp(xi) X0, rotation first (rad,\n"
      "m). Aligning takes a part of the error away that the covariances count.\n"
      "\n"
      "Example: posemix consistency odometry.tum --truth truth.tum --convention ros --align first\n"
      "         posemix consistency out/0036 --track camera --svg nees.svg");
  add_input_options(*command, *options);
  add_convention_options(*command, *options);
  add_comparison_options(*command, *options);
  command->callback([options, command, &action] {
    check_options(*command, *options);
    action = [options] { return consistency_command(*options); };
  });
}

}  // namespace posemix
