// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "command_options.hpp"
#include "exit_codes.hpp"
#include "interrupt.hpp"
#include "override_option.hpp"
#include "posemix/base/error.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/config/toml_table.hpp"
#include "posemix/io/grasp_outcomes.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/results/results.hpp"
#include "progress.hpp"
#include "run_provenance.hpp"
#include "screen_text.hpp"
#include "study/consistency/study.hpp"
#include "study/divergence/study.hpp"
#include "study/engine/run_study.hpp"
#include "study/fiducials/study.hpp"
#include "study/fuse_views/study.hpp"
#include "study/grasp/study.hpp"
#include "study/monte_carlo/study.hpp"
#include "study/noise/study.hpp"
#include "study/recordings/recordings.hpp"
#include "study/salt_box/study.hpp"
#include "study/tless/study.hpp"
#include "study/ycbv/study.hpp"
#include "summary.hpp"
#include "terminal_text.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

struct StudyOptions {
  std::optional<std::string> settings;
  std::vector<std::string> overrides;
  std::optional<std::string> data;
  std::optional<std::string> train;
  std::string out;
  std::size_t threads = 0;
  bool resume = false;
  bool quiet = false;
  bool json = false;
  bool all_rows = false;
  std::vector<std::string> command;  ///< the words of the command line
};

/// A study of the program.
struct StudyCommand {
  const char* name;
  const char* description;
  const char* example;
  bool reads_data;
  bool learns;  ///< whether it can learn from another folder
  Study (*make)(const TomlTable& settings, const StudyOptions& options);
  void (*rename_keys)(TomlDocument& settings) = nullptr;  ///< where settings have old names
};

fs::path data_folder(const StudyOptions& options) {
  fs::path folder = options.data ? fs::path(*options.data) : default_data_folder();
  require_data_folder(folder);
  return folder;
}

const std::array kStudies{
    StudyCommand{"divergence", "What merging two components on SO(3) loses, by rule and distance",
                 "posemix study divergence --out out/divergence", false, false,
                 [](const TomlTable& table, const StudyOptions&) {
                   return make_divergence_study(read_divergence_settings(table));
                 }},
    StudyCommand{"consistency",
                 "Whether the default filter is as sure as it is right, on simulated recordings",
                 "posemix study consistency --set runs=50 --out out/consistency", false, false,
                 [](const TomlTable& table, const StudyOptions&) {
                   return make_consistency_study(read_consistency_settings(table));
                 }},
    StudyCommand{
        "monte-carlo", "Filters on a simulated recording with odometry of growing noise",
        "posemix study monte-carlo --set runs=400 --set 'methods=[\"midway\",\"iterated\"]' "
        "--out out/mc\n         mpirun -n 4 posemix study monte-carlo --out out/mc",
        false, false,
        [](const TomlTable& table, const StudyOptions&) {
          return make_monte_carlo_study(read_monte_carlo_settings(table));
        }},
    StudyCommand{"ycbv", "Filters on every recording of the data folder",
                 "posemix study ycbv --set 'sequences=[\"0022\"]' --out out/ycbv", true, false,
                 [](const TomlTable& table, const StudyOptions& options) {
                   YcbvStudySettings settings = read_ycbv_settings(table, options.out);
                   settings.data = data_folder(options);
                   settings.command = options.command;
                   return make_ycbv_study(settings);
                 }},
    StudyCommand{"noise", "A detector's errors against ground truth, and a noise model for them",
                 "posemix study noise --out out/noise", true, false,
                 [](const TomlTable& table, const StudyOptions& options) {
                   const NoiseStudySettings settings = read_noise_settings(table);
                   return make_noise_study(read_noise_data(settings, options.data), settings);
                 },
                 rename_noise_keys},
    StudyCommand{"grasp", "Success of grasps, predicted from what several pose estimators say",
                 "posemix study grasp --data scenes --train other-scenes --out out/grasp", true,
                 true,
                 [](const TomlTable& table, const StudyOptions& options) {
                   std::optional<GraspOutcomes> train;
                   if (options.train) train = read_grasp_outcomes(*options.train);
                   return make_grasp_study(read_grasp_outcomes(data_folder(options)), train,
                                           read_grasp_settings(table));
                 }},
    StudyCommand{"salt-box",
                 "The pose of a box from three features, as mixtures of projected Gaussians",
                 "posemix study salt-box --out out/salt-box", false, false,
                 [](const TomlTable& table, const StudyOptions&) {
                   return make_salt_box_study(read_salt_box_settings(table));
                 }},
    StudyCommand{"tless", "Several equal and symmetric objects, by detections that name a class",
                 "posemix study tless --set 'scenes=[2, 4]' --out out/tless", true, false,
                 [](const TomlTable& table, const StudyOptions& options) {
                   TlessStudySettings settings = read_tless_settings(table);
                   settings.data = data_folder(options);
                   return make_tless_study(settings);
                 }},
    StudyCommand{"fuse-views", "Poses fused from several views against those of single views",
                 "posemix study fuse-views --set 'datasets=[\"tless\"]' --out out/fuse-views", true,
                 false,
                 [](const TomlTable& table, const StudyOptions& options) {
                   FuseViewsStudySettings settings = read_fuse_views_settings(table);
                   settings.data = data_folder(options);
                   return make_fuse_views_study(settings);
                 }},
    StudyCommand{"fiducials", "SLAM on recordings of square tags, with both poses of a tag or one",
                 "posemix study fiducials --set 'recordings=[\"test_11\"]' --out out/fiducials",
                 true, false, [](const TomlTable& table, const StudyOptions& options) {
                   FiducialsStudySettings settings = read_fiducials_settings(table);
                   settings.data = data_folder(options);
                   return make_fiducials_study(settings);
                 }}};

/// Reads the settings and makes the study; only the leading rank prints warnings.
Study read_study(const StudyCommand& command, const StudyOptions& options, bool leads) {
  TomlDocument document = options.settings ? TomlDocument::load(*options.settings)
                                           : TomlDocument::parse("schema = 1\n", command.name);
  if (command.rename_keys != nullptr) command.rename_keys(document);
  for (const std::string& assignment : options.overrides) document.apply_override(assignment);
  if (leads) print_warnings(document.warnings());
  document.root().get_integer_or("schema", 1, {.lowest = 1, .highest = 1});
  Study study = command.make(document.root(), options);
  document.finish();
  return study;
}

/// The path DIR.journal beside the output folder DIR.
fs::path journal_beside(const std::string& out) {
  fs::path path = fs::path(out).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  path += ".journal";
  return path;
}

/// Fails before the study begins if the results cannot be written.
void check_output(const std::string& out, const fs::path& journal) {
  { const OutputFolder writable(out); }
  std::error_code error;
  if (journal.has_parent_path()) fs::create_directories(journal.parent_path(), error);
}

/// The tables, what is found, and where all is.
std::string printed_text(const StudyReport& report, const StudyOptions& options) {
  constexpr std::size_t kScreen = 40;
  constexpr std::size_t kAround = 3;  // blank lines, and where the results are
  std::string notes;
  for (const std::string& note : report.notes) notes += fmt::format("{}\n", note);
  const std::size_t rest = kScreen - std::min(kScreen / 2, kAround + report.notes.size());
  const std::string tables = options.all_rows ? report.summary : screen_text(report.summary, rest);
  const bool is_whole = tables.size() >= report.summary.size();
  return fmt::format("{}{}{}\nResults: {}{}\n", tables, notes.empty() ? "" : "\n", notes,
                     options.out, is_whole ? "" : " (all rows: its tables, or --all-rows here)");
}

/// The files of a study, study.json with where they come from.
std::vector<StudyFile> files_of(const StudyRun& run, const StudyReport& report,
                                const StudyOptions& options) {
  std::vector<StudyFile> files = report.files;
  std::vector<std::string> names;
  names.reserve(files.size());
  for (const StudyFile& file : files) names.push_back(file.name);
  Provenance provenance =
      study_provenance(options.command, run.study.settings, options.settings.value_or(""));
  provenance.finished = utc_now();
  provenance.instructions = run.instructions;
  files.front().content = study_with_provenance(files.front().content, provenance, names);
  return files;
}

/// Returns what is to be printed.
std::string write_files(const StudyRun& run, const StudyOptions& options) {
  const StudyReport report = run.study.report(run.results);
  const std::vector<StudyFile> files = files_of(run, report, options);
  OutputFolder folder(options.out);
  const std::vector<fs::path> earlier = earlier_study(folder.target());
  folder.remove_earlier(earlier);
  folder.put_last(files.front().name);
  for (const StudyFile& file : files) folder.write(file.name, file.content);
  folder.commit();
  const std::string replaced =
      earlier.empty()
          ? ""
          : fmt::format("Replaced: the results of an earlier study, {} files\n", earlier.size());
  if (options.json) return files.front().content;
  return options.quiet ? "" : terminal_text(printed_text(report, options) + replaced);
}

int run_command(const StudyCommand& command, const StudyOptions& options) {
  const InterruptGuard guard;
  Ranks ranks;
  const bool leads = ranks.rank() == 0;
  const fs::path journal = journal_beside(options.out);
  ProgressReport progress(leads && !options.quiet, "items", ranks.size() > 1);
  const auto make = [&] {
    if (leads) check_output(options.out, journal);
    return read_study(command, options, leads);
  };
  const auto go_on = [&](std::size_t done, std::size_t items) {
    progress.update(done, items);
    return !guard.interrupted();
  };
  const auto run = run_study(ranks, make,
                             {.threads = options.threads,
                              .journal = journal,
                              .resume = options.resume,
                              .progress = go_on});
  if (!run) return kExitDone;
  guard.check();
  const std::string text = write_files(*run, options);
  // The results are there, also where they cannot be printed.
  std::error_code error;
  if (!fs::remove(journal, error) && error) {
    throw OutputError(fmt::format("{}: cannot be removed: {}", journal.string(), error.message()));
  }
  if (!text.empty()) print_text(text);
  return kExitDone;
}

void add_options(CLI::App& command, const std::shared_ptr<StudyOptions>& options,
                 const StudyCommand& known) {
  command.add_option("settings", options->settings, "Settings (TOML; see docs/studies.md)")
      ->type_name("SETTINGS.toml");
  add_override_option(command, options->overrides, "Override a key of the settings; repeatable");
  if (known.reads_data) {
    command
        .add_option(
            "--data", options->data,
            "Folder of the recordings; without it $POSEMIX_DATA, or the cache of `posemix data`")
        ->type_name("DIR");
  }
  if (known.learns) {
    command
        .add_option("--train", options->train,
                    "Learn from this folder and predict all of --data; without it, from the rest "
                    "of --data")
        ->type_name("DIR");
  }
  command.add_option("--out", options->out, "Folder for the results")->required()->type_name("DIR");
  add_integer_option(
      command, "--threads", options->threads, {1, 4096},
      "Threads of this process; without it the cores, shared among the host's ranks");
  command.add_flag("--resume", options->resume, "Continue an interrupted study from DIR.journal");
  command.add_flag("--json", options->json, "Print study.json instead of a table");
  command.add_flag("--all-rows", options->all_rows, "Print all rows, not only what fits a screen");
  command.add_flag("--quiet", options->quiet, "Print neither progress nor table");
}

}  // namespace

void add_study_command(CLI::App& program, std::function<int()>& action,
                       const std::vector<std::string>& words) {
  CLI::App* study = program.add_subcommand("study", "Experiments, on all cores or over MPI");
  study->require_subcommand(1);
  study->footer(
      "Example: posemix study divergence --out out/divergence\n"
      "\n"
      "`posemix study STUDY --help` describes a study.");
  study->get_formatter()->label("SUBCOMMAND", "STUDY");
  study->get_formatter()->label("Subcommands", "Studies");
  for (const StudyCommand& known : kStudies) {
    const auto options = std::make_shared<StudyOptions>();
    options->command = words;
    CLI::App* command = study->add_subcommand(known.name, known.description);
    command->footer(fmt::format(
        "Writes study.json, tables (CSV) and figures (SVG) into DIR when all is done. What is\n"
        "finished is kept in DIR.journal until then.\n"
        "\n"
        "Example: {}",
        known.example));
    add_options(*command, options, known);
    command->callback([options, &action, &known] {
      action = [options, &known] { return run_command(known, *options); };
    });
  }
}

}  // namespace posemix
