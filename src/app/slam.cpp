// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "command_options.hpp"
#include "exit_codes.hpp"
#include "interrupt.hpp"
#include "io/input_files.hpp"
#include "override_option.hpp"
#include "posemix/base/error.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/output_file.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/results/report.hpp"
#include "posemix/results/results.hpp"
#include "posemix/slam/state.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "result_paths.hpp"
#include "results/readable_run.hpp"
#include "results/result_names.hpp"
#include "run_provenance.hpp"
#include "summary.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

/// The largest lag, as of the key filter.smooth_lag.
constexpr std::uint64_t kLongestLag = 1'000'000;

struct SlamOptions {
  std::string sequence;
  std::optional<std::string> data;
  std::string out;
  std::vector<std::string> overrides;
  bool smooth = false;
  std::optional<std::size_t> smooth_lag;
  std::optional<std::string> save_state;
  bool report = false;
  bool quiet = false;
  bool json = false;
  std::vector<std::string> command;  ///< the words of the command line
};

/// What is to be done, and where it comes from.
struct KnownJob {
  SlamJob job;
  Provenance provenance;
};

/// The overrides that --smooth and --smooth-lag stand for.
std::vector<std::string> smoothing_overrides(const SlamOptions& options) {
  if (options.smooth) return {"filter.smooth=full"};
  if (!options.smooth_lag) return {};
  return {"filter.smooth=fixed_lag", fmt::format("filter.smooth_lag={}", *options.smooth_lag)};
}

/// --smooth or --smooth-lag N, as it was given.
std::string smoothing_option(const SlamOptions& options) {
  return options.smooth_lag ? fmt::format("--smooth-lag {}", *options.smooth_lag) : "--smooth";
}

/// Reads the job; errors name the option that was given and not the override that it stands for.
SlamJob read_job(TomlDocument& document, const SlamOptions& options) {
  const std::vector<std::string> smoothing = smoothing_overrides(options);
  try {
    for (const std::string& assignment : smoothing) document.apply_override(assignment);
    return read_slam_job(document, data_folders(options.sequence, options.data));
  } catch (const InvalidInput& error) {
    const std::string_view message = error.what();
    for (const std::string& assignment : smoothing) {
      const std::string origin = fmt::format("--set {}:", assignment);
      if (message.starts_with(origin))
        throw InvalidInput(
            fmt::format("{}:{}", smoothing_option(options), message.substr(origin.size())));
    }
    throw;
  }
}

KnownJob read_job(const SlamOptions& options) {
  TomlDocument document = TomlDocument::load(options.sequence);
  for (const std::string& assignment : options.overrides) document.apply_override(assignment);
  SlamJob job = read_job(document, options);
  print_warnings(document.warnings());
  Provenance provenance =
      run_provenance(options.command, options.sequence, options.overrides, document, job);
  return {std::move(job), std::move(provenance)};
}

/// What would be lost at the end.
void require_state(const SlamJob& job, const SlamOptions& options) {
  if (!options.save_state) return;
  if (job.smoothing)
    throw InvalidInput("a smoothed run has no state to be saved, expected --save-state alone");
  if (!std::holds_alternative<MultiObjectSlamSettings>(job.settings.tracker))
    throw InvalidInput(
        "--save-state: the tracker has no state that can be saved, expected the multi-object "
        "filter");
  internal::refuse_input(*options.save_state);
  std::error_code error;
  if (fs::is_directory(*options.save_state, error))
    throw InvalidInput(
        fmt::format("--save-state {}: is a folder, expected a file", *options.save_state));
  const fs::path folder = fs::absolute(*options.save_state, error).parent_path();
  if (fs::is_directory(folder, error)) return;
  throw InvalidInput(fmt::format("--save-state {}: there is no folder '{}'", *options.save_state,
                                 folder.string()));
}

SlamRun filter(const SlamJob& job, const SlamOptions& options, HypothesisRecord& record,
               std::string& state, const InterruptGuard& guard) {
  const auto finished = [&](const ObjectSlam& slam) {
    if (options.save_state) state = state_bytes(slam);
  };
  ProgressReport progress_report(!options.quiet, "frames");
  const auto progress = [&](std::size_t done, std::size_t total) {
    progress_report.update(done, total);
    return !guard.interrupted();
  };
  require_state(job, options);
  try {
    return run(job, {.record_hypotheses = job.trace_hypotheses > 0,
                     .progress = progress,
                     .finished = finished,
                     .estimated = [&](FrameEstimate& frame) { record.take(frame); }});
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", options.sequence, error.what()));
  }
}

/// Writes the report of the results and returns a line with its URL.
std::string report_of(const SlamOptions& options, const InterruptGuard& guard) {
  const fs::path path = write_report_shown({options.out}, {}, !options.quiet, guard);
  return fmt::format("Report:  {}\n", file_url(path));
}

/// What is said of the results of an earlier run in the folder.
std::string replaced_line(const fs::path& folder) {
  const std::size_t files = earlier_results(folder).size();
  if (files == 0) return "";
  return fmt::format("Replaced: the results of an earlier run, {} files\n", files);
}

/// Writes the files of a run into the folder; returns what they say, and metrics.json.
std::pair<Metrics, std::string> write_run(OutputFolder& folder, const SlamJob& job,
                                          const SlamRun& result, ResultOptions written,
                                          const std::string& sequence) {
  try {
    internal::require_readable(job, result);
    Metrics metrics = evaluate(job, result);
    if (written.provenance) written.provenance->finished = utc_now();
    std::string text = write_results(folder, job, result, metrics, written);
    return {std::move(metrics), std::move(text)};
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", sequence, error.what()));
  }
}

int slam_to_folder(const SlamOptions& options) {
  const InterruptGuard guard;
  if (options.report) require_report_page();
  auto [job, provenance] = read_job(options);
  OutputFolder folder(options.out);
  guard.check();
  std::string state;
  HypothesisRecord record(job, folder.scratch());
  const SlamRun result = filter(job, options, record, state, guard);
  guard.check();
  const std::string replaced = replaced_line(folder.target());
  const auto [metrics, text] =
      write_run(folder, job, result, {.provenance = std::move(provenance), .hypotheses = &record},
                options.sequence);
  guard.check();
  folder.commit();
  if (options.save_state) write_output_file(*options.save_state, state);
  const std::string report = options.report ? report_of(options, guard) : "";
  if (options.json) {
    print_text(text);
  } else if (!options.quiet) {
    print_text(format_summary(job, result, metrics, colours_fit_output()) +
               fmt::format("\nResults: {}\n", options.out) + replaced + report);
  }
  return kExitDone;
}

/// Refuses --smooth and --smooth-lag beside --set of what they set.
void check_smoothing(const SlamOptions& options) {
  if (!options.smooth && !options.smooth_lag) return;
  for (const char* key : {"filter.smooth", "filter.smooth_lag"}) {
    if (const std::string* const other = find_override(options.overrides, key)) {
      throw CLI::ValidationError(smoothing_option(options),
                                 fmt::format("got --set {} too, expected one of them", *other));
    }
  }
}

/// Refuses to save the state where a result is written.
void check_state_file(const SlamOptions& options) {
  const NamedResult state{"--save-state", options.save_state};
  require_beside_folder({&state, 1}, {"--out", options.out}, internal::is_run_name);
}

void add_input_options(CLI::App& command, SlamOptions& options) {
  command
      .add_option("sequence", options.sequence,
                  "The recording and the settings (TOML; see docs/formats.md)")
      ->required()
      ->type_name("SEQUENCE.toml");
  command.add_option("--data", options.data, "Folder below which the recording's files lie")
      ->type_name("DIR");
  add_override_option(command, options.overrides,
                      "Override a key of the sequence file; repeatable");
  CLI::Option* const smooth = command.add_flag(
      "--smooth", options.smooth, "Estimates from the whole recording (filter.smooth = \"full\")");
  add_integer_option(command, "--smooth-lag", options.smooth_lag, {1, kLongestLag},
                     "Estimates from N frames more (filter.smooth = \"fixed_lag\")")
      ->excludes(smooth);
}

}  // namespace

void add_slam_command(CLI::App& program, std::function<int()>& action,
                      const std::vector<std::string>& words) {
  const auto options = std::make_shared<SlamOptions>();
  options->command = words;
  CLI::App* command = program.add_subcommand("slam", "Camera and objects from recorded detections");
  command->footer(
      "Writes into DIR: camera.tum, object_<id>.tum, relative_<id>.tum, metrics.json,\n"
      "posterior.json, trace.json and picture.svg; by the multi-object filter mixture_<id>.json\n"
      "too. The folder appears when all is done, and files of an earlier run in it are removed.\n"
      "\n"
      "Relative paths in SEQUENCE.toml are looked up below --data; without it, beside the\n"
      "sequence file, then below $POSEMIX_DATA, or in the cache of `posemix data`.\n"
      "\n"
      "Example: posemix slam configs/ycbv-dope.toml --set object=004_sugar_box_16k \\\n"
      "           --set sequence=0036 --set filter.max_hypotheses=6 --out out/0036");
  add_input_options(*command, *options);
  command
      ->add_option("--save-state", options->save_state,
                   "Save the whole posterior after the last frame to FILE too (see posemix state)")
      ->type_name("FILE");
  command->add_option("--out", options->out, "Folder for the results")
      ->required()
      ->type_name("DIR");
  command->add_flag("--report", options->report, "Write DIR/report.html too (see posemix report)");
  command->add_flag("--json", options->json, "Print metrics.json instead of a table");
  command->add_flag("--quiet", options->quiet, "Print neither progress nor table");
  command->callback([options, &action] {
    check_smoothing(*options);
    check_state_file(*options);
    action = [options] { return slam_to_folder(*options); };
  });
}

}  // namespace posemix
