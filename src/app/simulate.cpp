// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "simulate.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "command_options.hpp"
#include "exit_codes.hpp"
#include "interrupt.hpp"
#include "override_option.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/results/simulation_folder.hpp"
#include "summary.hpp"

namespace posemix {
namespace {

struct SimulateOptions {
  std::string config;
  std::string out;
  std::uint64_t seed = 1;
  std::vector<std::string> overrides;
  bool quiet = false;
};

int simulate_to_folder(const SimulateOptions& options) {
  const InterruptGuard guard;
  TomlDocument document = TomlDocument::load(options.config);
  for (const std::string& assignment : options.overrides) document.apply_override(assignment);
  print_warnings(document.warnings());
  const SimulationFile file = read_simulation(document);
  const SimulatedSequence simulated = simulate(file.config, options.seed);
  guard.check();
  OutputFolder folder(options.out);
  folder.put_last("sequence.toml");
  for (const auto& [name, content] : format_simulation(file, simulated, options.seed)) {
    folder.write(name, content);
    guard.check();
  }
  folder.commit();
  if (!options.quiet) {
    print_text(fmt::format("{} simulated frames, {} objects: {}/sequence.toml\n",
                           simulated.stamps_ns.size(), simulated.objects.size(), options.out));
  }
  return kExitDone;
}

}  // namespace

void add_simulate_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = program.add_subcommand("simulate", "Write a simulated recording");
  command->footer(
      "Writes DIR/sequence.toml, which `posemix slam` reads, and the files that it names.\n"
      "The same seed gives the same bytes on any machine.\n"
      "\n"
      "Example: posemix simulate configs/demo.toml --seed 1 --out build/sequence");
  command->add_option("config", options->config, "What to simulate (TOML; see docs/simulation.md)")
      ->required()
      ->type_name("CONFIG.toml");
  add_seed_option(*command, options->seed);
  command->add_option("--out", options->out, "Folder for the recording")
      ->required()
      ->type_name("DIR");
  add_override_option(*command, options->overrides,
                      "Override a key of the configuration; repeatable");
  command->add_flag("--quiet", options->quiet, "Print nothing");
  command->callback(
      [options, &action] { action = [options] { return simulate_to_folder(*options); }; });
}

}  // namespace posemix
