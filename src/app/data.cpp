// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "data.hpp"

#include <array>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "data_parts.hpp"
#include "exit_codes.hpp"
#include "posemix/base/error.hpp"
#include "summary.hpp"
#include "terminal_text.hpp"

namespace posemix {
namespace {

struct DataListOptions {
  std::optional<std::string> source;
  std::optional<std::string> registry;
};

std::string_view checked_by(const SourceFile& file) {
  if (!file.sha256.empty()) return "pinned";
  return file.published ? "published by the host" : "none";
}

std::string describe_source(const DataSource& source) {
  std::string text = fmt::format("{}: {}\n", source.name, source.title);
  const auto add = [&](std::string_view label, const std::string& value) {
    if (!value.empty()) text += fmt::format("  {:<10} {}\n", label, value);
  };
  add("home", source.homepage);
  add("revision", source.revision);
  add("licence", source.licence);
  add("", source.copyright);
  add("", source.licence_url);
  add("files", format_amount(source.files));
  add("SHA-256", source.hashes);
  add("use", source.use);
  return text;
}

std::string list_files(const DataSource& source) {
  std::string text = fmt::format("\n  {:>9}  {:<21}  file\n", "size", "SHA-256");
  for (const SourceFile& file : source.files) {
    text += fmt::format("  {:>9}  {:<21}  {}{}\n", file.size ? format_bytes(*file.size) : "-",
                        checked_by(file), file.path, file.optional ? "  (only with --file)" : "");
  }
  return text;
}

int list_data(const DataListOptions& options) {
  const std::vector<DataSource> sources = known_sources(options.registry);
  if (options.source) {
    const DataSource& source = find_source(sources, *options.source);
    print_text(terminal_text(describe_source(source) + list_files(source)));
    return kExitDone;
  }
  std::string text;
  for (const DataSource& source : sources) text += describe_source(source) + "\n";
  print_text(terminal_text(text) +
             "`posemix data list NAME` lists the files, `posemix data fetch NAME` gets "
             "them.\n");
  return kExitDone;
}

}  // namespace

void add_registry_option(CLI::App& command, std::optional<std::string>& registry) {
  command
      .add_option("--registry", registry,
                  "Sources of your own, beside the program's (docs/data.md)")
      ->type_name("FILE.toml");
}

std::vector<DataSource> known_sources(const std::optional<std::string>& registry) {
  std::vector<DataSource> sources;
  if (registry) sources = read_sources(*registry);
  for (DataSource& source : built_in_sources()) sources.push_back(std::move(source));
  return sources;
}

std::string format_bytes(std::uint64_t bytes) {
  constexpr std::array<std::string_view, 4> kUnits{"kB", "MB", "GB", "TB"};
  if (bytes < 1000) return fmt::format("{} B", bytes);
  double amount = static_cast<double>(bytes) / 1000.0;
  std::size_t unit = 0;
  for (; amount >= 999.5 && unit + 1 < kUnits.size(); ++unit) amount /= 1000.0;
  return fmt::format("{:.{}f} {}", amount, amount < 99.95 ? 1 : 0, kUnits[unit]);
}

std::string format_amount(const std::vector<SourceFile>& files) {
  std::uint64_t bytes = 0;
  bool known = true;
  for (const SourceFile& file : files) {
    known = known && file.size.has_value();
    bytes += file.size.value_or(0);
  }
  const std::string count = fmt::format("{} file{}", files.size(), files.size() == 1 ? "" : "s");
  return known ? fmt::format("{}, {}", count, format_bytes(bytes)) : count;
}

void add_data_list_command(CLI::App& data, std::function<int()>& action) {
  const auto options = std::make_shared<DataListOptions>();
  CLI::App* command = data.add_subcommand("list", "The sources, or the files of one");
  command->footer("Example: posemix data list ycbv");
  command->add_option("source", options->source, "Name of a source")->type_name("NAME");
  add_registry_option(*command, options->registry);
  command->callback([options, &action] { action = [options] { return list_data(*options); }; });
}

void add_data_command(CLI::App& program, std::function<int()>& action) {
  CLI::App* command = program.add_subcommand("data", "Fetch public data, check it, and use it");
  command->require_subcommand(1);
  command->get_formatter()->label("SUBCOMMAND", "COMMAND");
  command->get_formatter()->label("Subcommands", "Commands");
  command->footer(
      "Example: posemix data fetch slam-super-6d --yes\n"
      "         posemix slam configs/ycbv-dope.toml --out out/0001");
  add_data_list_command(*command, action);
  add_data_fetch_command(*command, action);
  add_data_verify_command(*command, action);
  add_data_sequence_command(*command, action);
}

}  // namespace posemix
