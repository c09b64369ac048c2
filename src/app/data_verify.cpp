// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "data.hpp"
#include "data_parts.hpp"
#include "exit_codes.hpp"
#include "fetch/download.hpp"
#include "fetch/verify.hpp"
#include "interrupt.hpp"
#include "posemix/base/error.hpp"
#include "summary.hpp"
#include "terminal_text.hpp"

namespace posemix {
namespace {

struct DataVerifyOptions {
  std::string folder;
  std::optional<std::string> registry;
};

std::string describe_verification(const Verification& found) {
  std::string text;
  for (const std::string& problem : found.problems)
    text += fmt::format("{}: {}\n", found.folder.string(), problem);
  text += fmt::format("{}: {} files are as fetched, {} are not", found.folder.string(), found.right,
                      found.problems.size());
  if (found.unchecked > 0)
    text += fmt::format("; of {} no SHA-256 was known when they were fetched", found.unchecked);
  return text + "\n";
}

int verify_data(const DataVerifyOptions& options) {
  check_can_fetch();
  const std::vector<DataSource> sources = known_sources(options.registry);
  const InterruptGuard guard;
  std::size_t problems = 0;
  for (const auto& folder : fetched_folders(options.folder)) {
    const Verification found =
        verify_folder(folder, sources, [&](std::uint64_t) { return !guard.interrupted(); });
    guard.check();
    print_text(terminal_text(describe_verification(found)));
    problems += found.problems.size();
  }
  if (problems == 0) return kExitDone;
  throw InvalidInput(
      fmt::format("{}: got {} files that are not as fetched, expected none; remove "
                  "them and fetch again",
                  options.folder, problems));
}

}  // namespace

void add_data_verify_command(CLI::App& data, std::function<int()>& action) {
  const auto options = std::make_shared<DataVerifyOptions>();
  CLI::App* command = data.add_subcommand("verify", "Compare fetched files with their lock file");
  command->footer("Example: posemix data verify data");
  command->add_option("folder", options->folder, "A source's folder, or the one with all of them")
      ->required()
      ->type_name("DIR");
  add_registry_option(*command, options->registry);
  command->callback([options, &action] { action = [options] { return verify_data(*options); }; });
}

}  // namespace posemix
