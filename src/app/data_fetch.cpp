// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cstdio>
#include <iostream>
#include <memory>

#include <unistd.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "command_options.hpp"
#include "data.hpp"
#include "data_parts.hpp"
#include "exit_codes.hpp"
#include "fetch/fetch.hpp"
#include "fetch/unpack.hpp"
#include "interrupt.hpp"
#include "posemix/base/error.hpp"
#include "posemix/config/data_folder.hpp"
#include "progress.hpp"
#include "summary.hpp"
#include "terminal_text.hpp"

namespace posemix {
namespace {

struct DataFetchOptions {
  std::string source;
  std::optional<std::string> registry;
  std::optional<std::string> out;
  std::vector<std::string> patterns;
  bool yes = false;
  bool unpack = false;
  bool quiet = false;
  ConnectionSettings connection;
};

constexpr std::uint64_t kMegabyte = 1'000'000;

std::filesystem::path fetch_folder(const DataFetchOptions& options) {
  return options.out ? std::filesystem::path(*options.out) : default_data_folder();
}

std::string licence_notice(const DataSource& source, const std::vector<SourceFile>& files,
                           const std::filesystem::path& folder) {
  std::string text = fmt::format("{}: {}\n  from {}\n  licence: {}\n", source.name, source.title,
                                 source.base_url, source.licence);
  for (const std::string& line : {source.copyright, source.licence_url})
    if (!line.empty()) text += fmt::format("           {}\n", line);
  return text + fmt::format("  {} into {}\n", format_amount(files), folder.string());
}

/// Shows the licence and, if a person can answer, asks whether to continue.
void agree(const DataFetchOptions& options, const std::string& notice) {
  std::fputs(terminal_text(notice).c_str(), stderr);
  if (options.yes) return;
  if (isatty(STDIN_FILENO) != 1 || !on_terminal()) {
    throw InvalidInput("got nobody to ask whether the licence above is accepted, expected --yes");
  }
  std::fputs("Fetch under this licence? [y/N] ", stderr);
  std::string answer;
  std::getline(std::cin, answer);
  if (answer != "y" && answer != "Y" && answer != "yes")
    throw InvalidInput("the licence was not accepted; nothing is fetched");
}

FetchReport fetch_watched(const DataSource& source, const std::vector<SourceFile>& files,
                          const std::filesystem::path& folder, const DataFetchOptions& options,
                          const InterruptGuard& guard) {
  const bool by_bytes = !format_amount(files).ends_with("files") && files.size() < 100;
  ProgressReport shown(!options.quiet, by_bytes ? "MB" : "files", true);
  return fetch_files(source, files, folder, options.connection, [&](const FetchProgress& now) {
    if (by_bytes)
      shown.update(now.bytes_done / kMegabyte, now.bytes.value_or(0) / kMegabyte);
    else
      shown.update(now.files_done, now.files);
    return !guard.interrupted();
  });
}

std::string what_was_checked(const FetchReport& report) {
  std::string text;
  const auto add = [&](std::size_t count, std::string_view how) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, how);
  };
  add(report.pinned, "checked against pinned SHA-256");
  add(report.published, "checked against the SHA-256 that its host publishes");
  add(report.unchecked, "not checked: no SHA-256 is known; what came is noted for later");
  return text;
}

[[noreturn]] void tell_interrupt(const FetchReport& report, const InterruptGuard& guard) {
  std::string text =
      fmt::format("interrupted; {} files are complete", report.fetched + report.there_already);
  if (report.part) {
    std::error_code ignored;
    text += fmt::format(", {} holds {}", report.part->string(),
                        format_bytes(std::filesystem::file_size(*report.part, ignored)));
  }
  throw Interrupted(guard.signal(), text + "; the next run resumes");
}

/// Unpacks all archives and returns the number of files.
std::size_t unpack_all(const std::vector<SourceFile>& files, const std::filesystem::path& folder,
                       const DataFetchOptions& options, const InterruptGuard& guard) {
  std::size_t count = 0;
  for (const SourceFile& file : files) {
    if (!is_archive_name(file.path)) continue;
    if (!options.quiet)
      std::fputs(fmt::format("unpacking {}\n", terminal_line(file.path)).c_str(), stderr);
    const auto unpacked = unpack_archive(folder / file.path, folder, file.strip,
                                         [&](std::size_t) { return !guard.interrupted(); });
    if (!unpacked)
      throw Interrupted(guard.signal(), fmt::format("interrupted while unpacking {}; the next run "
                                                    "unpacks it again",
                                                    file.path));
    count += *unpacked;
  }
  return count;
}

/// @throws OutputError for a path that the system refuses, such as a loop of links
void require_writable_path(const std::filesystem::path& folder) {
  std::error_code error;
  const bool is_there = std::filesystem::exists(folder, error);
  if (!is_there && error)
    throw OutputError(fmt::format("{}: cannot be written: {}", folder.string(), error.message()));
}

int fetch_data(const DataFetchOptions& options) {
  check_can_fetch();
  const std::vector<DataSource> sources = known_sources(options.registry);
  const DataSource& source = find_source(sources, options.source);
  const std::vector<SourceFile> files = selected_files(source, options.patterns);
  check_url(source.base_url, options.connection.allow_http);
  const std::filesystem::path folder = fetch_folder(options) / source.name;
  require_writable_path(folder);
  agree(options, licence_notice(source, files, folder));
  const InterruptGuard guard;
  const FetchReport report = fetch_watched(source, files, folder, options, guard);
  if (report.stopped) tell_interrupt(report, guard);
  std::string text = fmt::format("{} files fetched, {} were there: {} in {}\n{}\n", report.fetched,
                                 report.there_already, format_bytes(report.bytes), folder.string(),
                                 what_was_checked(report));
  if (options.unpack)
    text += fmt::format("{} files unpacked\n", unpack_all(files, folder, options, guard));
  if (!options.quiet) {
    if (!source.use.empty()) text += fmt::format("use: {}\n", source.use);
    print_text(text);
  }
  return kExitDone;
}

}  // namespace

void add_data_fetch_command(CLI::App& data, std::function<int()>& action) {
  const auto options = std::make_shared<DataFetchOptions>();
  CLI::App* command = data.add_subcommand("fetch", "Get the files of a source");
  command->footer(
      "The files go to DIR/NAME, with a lock file that notes size and SHA-256 of each. A file "
      "that\n"
      "is not complete is kept as FILE.part, and the next run fetches the rest of it.\n"
      "\n"
      "Example: posemix data fetch ycbv --unpack --yes");
  command->add_option("source", options->source, "Name of a source (posemix data list)")
      ->required()
      ->type_name("NAME");
  command
      ->add_option("--out", options->out,
                   "Folder for the source's folder; $POSEMIX_DATA or the cache unless given")
      ->check(not_empty)
      ->type_name("DIR");
  command
      ->add_option("--file", options->patterns,
                   "Only this file; * stands for any characters; repeatable")
      ->type_name("PATTERN")
      ->allow_extra_args(false);
  command->add_flag("--yes", options->yes, "Accept the licence that is shown");
  command->add_flag("--unpack", options->unpack, "Unpack archives too");
  add_integer_option(*command, "--retries", options->connection.retries, {0, 100},
                     "Tries after an error that may pass, before giving up")
      ->capture_default_str();
  command->add_flag("--allow-http", options->connection.allow_http,
                    "Also addresses of other machines without encryption");
  add_registry_option(*command, options->registry);
  command->add_flag("--quiet", options->quiet, "Print neither progress nor what was done");
  command->callback([options, &action] { action = [options] { return fetch_data(*options); }; });
}

}  // namespace posemix
