// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "live.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "command_options.hpp"
#include "exit_codes.hpp"
#include "fetch/download.hpp"
#include "interrupt.hpp"
#include "live/live.hpp"
#include "live/ros_graph.hpp"
#include "override_option.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/results/report.hpp"
#include "posemix/results/results.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "results/readable_run.hpp"
#include "summary.hpp"
#include "terminal_text.hpp"

namespace posemix {
namespace {

struct LiveCommandOptions {
  std::string config;
  std::optional<std::string> data;
  std::vector<std::string> overrides;
  std::string out;
  bool report = false;
  bool quiet = false;
};

internal::LiveSettings read_settings(const LiveCommandOptions& options) {
  const std::string defaults = fmt::format("schema = {}\n", internal::kLiveSchema);
  TomlDocument document = options.config.empty() ? TomlDocument::parse(defaults, "the defaults")
                                                 : TomlDocument::load(options.config);
  for (const std::string& assignment : options.overrides) document.apply_override(assignment);
  auto settings =
      internal::read_live_settings(document, data_folders(options.config, options.data));
  print_warnings(document.warnings());
  return settings;
}

/// Runs until SIGINT or SIGTERM, which is how it ends.
std::optional<internal::LiveResult> run_until_interrupted(const internal::LiveSettings& settings,
                                                          const LiveCommandOptions& options) {
  const InterruptGuard guard;
  const auto tell = [&](const std::string& line) {
    if (!options.quiet) print_text(fmt::format("posemix live: {}\n", terminal_line(line)));
  };
  try {
    return internal::run_live(settings,
                              {.stop = [&guard] { return guard.interrupted(); },
                               .log = [](const std::string& line) { print_warnings({line}); },
                               .tell = tell,
                               .records = !options.out.empty()});
  } catch (const internal::GraphError& error) {
    throw NetworkError(error.what(), false);
  }
}

/// Runs the filter again over what was taken in, and writes what it says.
void write_live_results(internal::LiveResult result, OutputFolder& folder,
                        const LiveCommandOptions& options) {
  const InterruptGuard guard;
  SlamJob& job = result.job;
  ProgressReport progress_report(!options.quiet, "frames");
  const auto progress = [&](std::size_t done, std::size_t total) {
    progress_report.update(done, total);
    return !guard.interrupted();
  };
  HypothesisRecord record(job, folder.scratch());
  const SlamRun run =
      posemix::run(job, {.record_hypotheses = job.trace_hypotheses > 0,
                         .progress = progress,
                         .estimated = [&](FrameEstimate& frame) { record.take(frame); }});
  guard.check();
  for (double& stamp : job.sequence.stamps) stamp += result.start_s;
  internal::require_readable(job, run);
  write_results(folder, job, run, evaluate(job, run), {.hypotheses = &record});
  folder.commit();
  if (options.report) write_report_shown({options.out}, {}, !options.quiet, guard);
}

int live_command(const LiveCommandOptions& options) {
  if (options.report) require_report_page();
  const internal::LiveSettings settings = read_settings(options);
  std::optional<OutputFolder> folder;
  if (!options.out.empty()) folder.emplace(options.out);
  auto result = run_until_interrupted(settings, options);
  if (!folder) return kExitDone;
  if (result) {
    write_live_results(std::move(*result), *folder, options);
  } else {
    print_warnings({fmt::format("no image came, so that there is nothing in {}", options.out)});
  }
  return kExitDone;
}

}  // namespace

void add_live_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<LiveCommandOptions>();
  CLI::App* command =
      program.add_subcommand("live", "Objects from the detections of a robot, live");
  command->footer(
      "Joins the graph of ROS 2 (docs/live.md), without ROS: takes vision_msgs/Detection3DArray\n"
      "and odometry, publishes objects. Without CONFIG.toml it takes /posemix/detections and the\n"
      "odometry in /tf. It runs until SIGINT or SIGTERM, and then exits with 0.\n"
      "\n"
      "Environment: ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE,\n"
      "CYCLONEDDS_URI (network and peers of Cyclone DDS).\n"
      "\n"
      "Example: posemix live examples/ros/live.toml --out out/run --report");
  command->add_option("config", options->config, "Detectors, frames and settings (TOML)")
      ->check(not_empty)
      ->type_name("CONFIG.toml");
  command->add_option("--data", options->data, "Folder below which files that it names lie")
      ->type_name("DIR");
  add_override_option(*command, options->overrides, "Override a key of the file; repeatable");
  CLI::Option* const out = command
                               ->add_option("--out", options->out,
                                            "Folder for the results of the run, as of posemix slam")
                               ->check(not_empty)
                               ->type_name("DIR");
  command->add_flag("--report", options->report, "Write DIR/report.html too")->needs(out);
  command->add_flag("--quiet", options->quiet, "Print warnings alone");
  command->callback([options, &action] { action = [options] { return live_command(*options); }; });
}

}  // namespace posemix
