// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report.hpp"

#include <array>
#include <cctype>
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
  std::string results;
  std::optional<std::string> out;
  std::optional<std::string> title;
  std::vector<std::string> meshes;
  std::string mesh_unit;
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

int report_command(const ReportCommandOptions& options) {
  const InterruptGuard guard;
  ReportOptions report{.out = options.out, .title = options.title};
  const double unit_m = options.mesh_unit == "mm" ? 1e-3 : 1.0;
  for (const std::string& mesh : options.meshes) add_mesh(report, mesh, unit_m);
  const fs::path path = write_report_shown(options.results, report, !options.quiet, guard);
  if (!options.quiet) print_text(fmt::format("Report: {}\n", file_url(path)));
  if (options.open) open_in_browser(fs::absolute(path));
  return kExitDone;
}

}  // namespace

fs::path write_report_shown(const fs::path& results, ReportOptions options, bool shown,
                            const InterruptGuard& guard) {
  constexpr std::size_t kMegabyte = 1000000;
  ProgressReport progress(shown, "MB");
  options.warn = [](const std::string& warning) { print_warnings({warning}); };
  options.progress = [&](std::size_t done, std::size_t total) {
    progress.update(done / kMegabyte, total / kMegabyte);
    guard.check();
  };
  return write_report(results, options);
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

void add_report_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<ReportCommandOptions>();
  CLI::App* command = program.add_subcommand("report", "Results as one HTML page for a browser");
  command->footer(
      "RESULTS is a folder that posemix slam, study or consistency wrote, a folder of mixture "
      "files,\n"
      "or one mixture file. The page is one file that needs neither a network nor a server.\n"
      "\n"
      "Example: posemix report out/0036 --mesh mug=models/obj_000014.ply --mesh-unit mm --open");
  command->add_option("results", options->results, "What to show")
      ->required()
      ->type_name("RESULTS");
  command
      ->add_option("--out", options->out, "Where to write it; without it report.html in the folder")
      ->type_name("FILE.html");
  CLI::Option* const unit =
      command->add_option("--mesh-unit", options->mesh_unit, "Unit of all meshes (BOP: mm)")
          ->check(CLI::IsMember({"m", "mm"}))
          ->type_name("m|mm");
  command->add_option("--mesh", options->meshes, "Mesh of an object, with --mesh-unit; repeatable")
      ->type_name("ID=FILE.ply")
      ->allow_extra_args(false)
      ->needs(unit);
  command->add_option("--title", options->title, "Title of the page")->type_name("TEXT");
  command->add_flag("--open", options->open, "Open it with xdg-open");
  command->add_flag("--quiet", options->quiet, "Print nothing");
  command->callback(
      [options, &action] { action = [options] { return report_command(*options); }; });
}

}  // namespace posemix
