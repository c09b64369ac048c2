// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <csignal>
#include <cstring>
#include <memory>
#include <optional>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "exit_codes.hpp"
#include "interrupt.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/io/text.hpp"
#include "progress.hpp"
#include "summary.hpp"
#include "usage_error.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

struct ReportCommandOptions {
  std::vector<std::string> results;
  std::optional<std::string> out;
  std::optional<std::string> title;
  std::vector<std::string> meshes;
  std::string mesh_unit;
  std::optional<std::string> camera;
  std::optional<std::string> images;
  bool open = false;
  bool quiet = false;
};

/// Adds a mesh from an option of the form ID=FILE.ply.
void add_mesh(ReportOptions& options, const std::string& text, double unit_m) {
  const std::size_t at = text.find('=');
  if (at == 0 || at == std::string::npos || at + 1 == text.size()) {
    throw UsageError(fmt::format("--mesh: got {}, expected ID=FILE.ply", in_quotes(text)));
  }
  const std::string id = text.substr(0, at);
  if (!options.meshes.try_emplace(id, ReportMesh{text.substr(at + 1), unit_m}).second) {
    throw UsageError(fmt::format("--mesh: got {} again, expected it once", in_quotes(id)));
  }
}

/// The camera of an option fx,fy,cx,cy,width,height.
ReportCamera camera_of(const std::string& text) {
  const auto fail = [&] {
    throw UsageError(
        fmt::format("--camera: got {}, expected fx,fy,cx,cy,width,height", in_quotes(text, 80)));
  };
  std::vector<double> numbers;
  for (const std::string_view field : split_fields(text, ',')) {
    const auto number = parse_number(trimmed(field));
    if (!number) fail();
    numbers.push_back(*number);
  }
  if (numbers.size() != 6) fail();
  const auto pixels = [&](double number) {
    if (!(number >= 1.0 && number <= 1e6 && number == std::floor(number))) fail();
    return static_cast<std::uint32_t>(number);
  };
  return {numbers[0], numbers[1], numbers[2], numbers[3], pixels(numbers[4]), pixels(numbers[5])};
}

ReportOptions report_options(const ReportCommandOptions& options) {
  ReportOptions report{.out = options.out, .title = options.title};
  const double unit_m = options.mesh_unit == "mm" ? 1e-3 : 1.0;
  for (const std::string& mesh : options.meshes) add_mesh(report, mesh, unit_m);
  if (options.camera) report.camera = camera_of(*options.camera);
  if (options.images) report.images = ReportImages{*options.images};
  return report;
}

/// Opens the page in the browser of the desktop and returns at once.
void open_in_browser(const fs::path& path) {
  std::string program = "xdg-open";
  std::string file = path.string();
  const std::array<char*, 3> arguments{program.data(), file.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  sigset_t ignored_here;
  sigemptyset(&ignored_here);
  sigaddset(&ignored_here, SIGPIPE);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigdefault(&attributes, &ignored_here);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  pid_t child = 0;
  const int error =
      posix_spawnp(&child, program.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw OutputError(fmt::format("{}: is written but cannot be opened: xdg-open: {}", file,
                                  std::strerror(error)));
  }
}

/// `--mesh a=1.ply b=2.ply`: words that follow the first mesh could be results, too, and are meshes
/// where they look like one and are no path.
void take_meshes(ReportCommandOptions& options) {
  if (options.meshes.empty()) return;
  const auto is_mesh = [](const std::string& word) {
    std::error_code ignored;
    return word.find('=') != std::string::npos && !fs::exists(word, ignored);
  };
  const auto rest = std::stable_partition(options.results.begin(), options.results.end(),
                                          [&](const std::string& word) { return !is_mesh(word); });
  options.meshes.insert(options.meshes.end(), rest, options.results.end());
  options.results.erase(rest, options.results.end());
  if (options.results.empty()) throw UsageError("results is required");
}

int report_command(ReportCommandOptions options) {
  const InterruptGuard guard;
  take_meshes(options);
  const std::vector<fs::path> results(options.results.begin(), options.results.end());
  const fs::path path = write_report_shown(results, report_options(options), !options.quiet, guard);
  if (!options.quiet) print_text(fmt::format("Report: {}\n", file_url(path)));
  if (options.open) open_in_browser(fs::absolute(path));
  return kExitDone;
}

}  // namespace

fs::path write_report_shown(const std::vector<fs::path>& results, ReportOptions options, bool shown,
                            const InterruptGuard& guard) {
  constexpr std::size_t kBytesPerMegabyte = 1000000;
  ProgressReport progress(shown, "MB");
  options.warn = [](const std::string& warning) { print_warnings({warning}); };
  options.progress = [&](std::size_t done, std::size_t total) {
    progress.update(done / kBytesPerMegabyte, total / kBytesPerMegabyte);
    guard.check();
  };
  return results.size() == 1 ? write_report(results.front(), options)
                             : write_comparison(results, options);
}

std::string file_url(const fs::path& path) {
  std::string url = "file://";
  for (const char c : fs::absolute(path).lexically_normal().string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain =
        byte < 128 && (std::isalnum(byte) != 0 || std::strchr("/-._~", c) != nullptr);
    url += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
  }
  return url;
}

namespace {

void add_page_options(CLI::App& command, ReportCommandOptions& options) {
  CLI::Option* const unit =
      command.add_option("--mesh-unit", options.mesh_unit, "Unit of all meshes (BOP: mm)")
          ->check(CLI::IsMember({"m", "mm"}))
          ->type_name("m|mm");
  command
      .add_option("--mesh", options.meshes,
                  "Meshes of objects, with --mesh-unit: one or more, repeatable")
      ->type_name("ID=FILE.ply")
      ->allow_extra_args(false)
      ->needs(unit);
  command
      .add_option("--camera", options.camera,
                  "Intrinsics of the camera in pixels, without distortion")
      ->type_name("fx,fy,cx,cy,width,height");
  command
      .add_option("--images", options.images,
                  "JPEG and PNG files of the camera, with stamps in their names [s or ns] or in a "
                  "file stamps.csv (name,stamp_s)")
      ->type_name("DIR");
  command.add_option("--title", options.title, "Title of the page")->type_name("TEXT");
}

}  // namespace

void add_report_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<ReportCommandOptions>();
  CLI::App* command = program.add_subcommand("report", "Results as one HTML page for a browser");
  command->footer(
      "RESULTS is a folder that posemix slam, study or consistency wrote, a folder of mixture "
      "files,\n"
      "or one mixture file. Several runs of posemix slam over one recording, or a folder with\n"
      "several, are compared. The page is one file that needs neither a network nor a server.\n"
      "\n"
      "Example: posemix report out/0036 --mesh mug=models/obj_000014.ply --mesh-unit mm --open\n"
      "         posemix report out/riekf out/gm-iekf --out comparison.html");
  command->add_option("results", options->results, "What to show, or runs to compare")
      ->required()
      ->type_name("RESULTS");
  command
      ->add_option(
          "--out", options->out,
          "Where to write it; without it report.html in the folder, or comparison.html in that "
          "of all runs")
      ->type_name("FILE.html");
  add_page_options(*command, *options);
  command->add_flag("--open", options->open, "Open it with xdg-open");
  command->add_flag("--quiet", options->quiet, "Print nothing");
  command->callback(
      [options, &action] { action = [options] { return report_command(*options); }; });
}

}  // namespace posemix
