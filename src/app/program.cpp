// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "program.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "completion.hpp"
#include "config/toml_node.hpp"
#include "data.hpp"
#include "exit_codes.hpp"
#include "fetch/download.hpp"
#include "fiducials.hpp"
#include "interrupt.hpp"
#include "io/input_files.hpp"
#include "live.hpp"
#include "manual.hpp"
#include "mixture_commands.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "posemix/io/output_folder.hpp"
#include "report.hpp"
#include "restart.hpp"
#include "run_provenance.hpp"
#include "simulate.hpp"
#include "slam.hpp"
#include "standard_streams.hpp"
#include "study.hpp"
#include "summary.hpp"
#include "terminal_text.hpp"
#include "usage_error.hpp"

namespace posemix {
namespace {

constexpr std::array kMixtureCommands{
    add_fit_command,       add_fuse_command,        add_compose_command,    add_reduce_command,
    add_sample_command,    add_density_command,     add_divergence_command, add_convert_command,
    add_grasp_command,     add_consistency_command, add_fuse_views_command, add_state_command,
    add_relocalise_command};

int fail(std::string_view message, int exit_code) {
  const std::string line = fmt::format("posemix: error: {}\n", terminal_line(message));
  std::fputs(line.c_str(), stderr);
  return exit_code;
}

/// Whether a signal that a guard recorded ended a call that waited, as for a pipe.
bool was_interrupted(const std::system_error& error) {
  return error.code() == std::errc::interrupted && recorded_signal() != 0;
}

/// Runs a command and turns its errors into messages and exit codes.
int guarded(const std::function<int()>& action) {
  try {
    return action();
  } catch (const UsageError& error) {
    return fail(error.what(), kExitUsage);
  } catch (const InvalidInput& error) {
    return fail(error.what(), kExitInput);
  } catch (const BrokenPipe&) {
    return kExitSignal + SIGPIPE;
  } catch (const OutputError& error) {
    return fail(error.what(), kExitOutput);
  } catch (const NetworkError& error) {
    return fail(error.what(), kExitNetwork);
  } catch (const Interrupted& error) {
    return fail(error.what(), kExitSignal + error.signal());
  } catch (const std::bad_alloc&) {
    return fail("out of memory", kExitInternal);
  } catch (const std::filesystem::filesystem_error& error) {
    if (was_interrupted(error)) return fail("interrupted", kExitSignal + recorded_signal());
    return fail(fmt::format("{}: {}", error.path1().string(), error.code().message()), kExitInput);
  } catch (const std::system_error& error) {
    if (was_interrupted(error)) return fail("interrupted", kExitSignal + recorded_signal());
    const bool lacks = error.code() == std::errc::resource_unavailable_try_again ||
                       error.code() == std::errc::not_enough_memory;
    if (!lacks) return fail(fmt::format("internal error: {}", error.what()), kExitInternal);
    return fail("out of memory, or of threads", kExitInternal);
  } catch (const std::exception& error) {
    return fail(fmt::format("internal error: {}", error.what()), kExitInternal);
  }
}

void describe(CLI::App& program) {
  program.name("posemix");
  program.require_subcommand(1);
  program.get_formatter()->label("SUBCOMMAND", "COMMAND");
  program.get_formatter()->label("Subcommands", "Commands");
  program.set_version_flag("--version", fmt::format("posemix {}\nvector instructions: {}",
                                                    POSEMIX_VERSION, vector_instructions()));
  program.footer(
      "Exit codes: 0 done, 1 internal error or out of memory, 2 wrong usage, 3 bad input file or\n"
      "value, 4 output cannot be written, 5 network, 130 interrupted (143 by SIGTERM), 141 nobody\n"
      "reads the standard output any more.\n"
      "\n"
      "Example: posemix simulate configs/demo.toml --seed 1 --out out/sequence\n"
      "         posemix slam out/sequence/sequence.toml --out out/results\n"
      "         posemix report out/results --open\n"
      "         posemix compose a.json b.json | posemix reduce - --to 5 | posemix sample - -n 100\n"
      "\n"
      "`posemix COMMAND --help` describes a command.");
}

/// What is wrong with the words after a command that needs another one.
std::string missing_command_text(const CLI::App& command, const std::vector<std::string>& words) {
  const char* const label = command.get_name() == "study" ? "study" : "command";
  if (words.empty()) return fmt::format("got no {}", label);
  if (words.front().starts_with('-')) return fmt::format("unknown option '{}'", words.front());
  std::vector<std::string_view> known;
  for (const CLI::App* each : command.get_subcommands(nullptr)) {
    if (!each->get_name().empty()) known.push_back(each->get_name());
  }
  std::string_view near = internal::nearest_name(words.front(), known);
  // The only one that begins so.
  const auto begins = [&](std::string_view name) { return name.starts_with(words.front()); };
  if (near.empty() && std::count_if(known.begin(), known.end(), begins) == 1)
    near = *std::find_if(known.begin(), known.end(), begins);
  if (!near.empty())
    return fmt::format("unknown {} '{}', did you mean '{}'?", label, words.front(), near);
  return fmt::format("unknown {} '{}', expected one of {}", label, words.front(),
                     fmt::join(known, ", "));
}

/// Prints the text of --help or --version, or reports an error in the command line.
int answer(const CLI::App& program, const CLI::ParseError& reason) {
  if (reason.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
    return guarded([&] {
      std::ostringstream text;
      program.exit(reason, text, text);
      print_text(text.str());
      return kExitDone;
    });
  }
  const CLI::App* command = &program;
  std::string name = program.get_name();
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    name += " " + command->get_name();
  }
  if (command->get_require_subcommand_min() == 0)
    return fail(fmt::format("{}; see `{} --help`", reason.what(), name), kExitUsage);
  const std::vector<std::string> words = command->remaining();
  if (words.empty()) std::fputs((program.help() + "\n").c_str(), stderr);
  return fail(missing_command_text(*command, words) + fmt::format("; see `{} --help`", name),
              kExitUsage);
}

}  // namespace

int run_program(int argc, const char* const* argv) {
  // A closed pipe and a limit on the size of files are errors of the call, with a message.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  fill_closed_streams();
  const int started = guarded([] {
    restart_where_portable();
    return kExitDone;
  });
  if (started != kExitDone) return started;
  CLI::App program(
      "Poses of a camera and of objects from noisy detections, with calibrated multi-modal "
      "uncertainty");
  std::function<int()> action;
  try {
    describe(program);
    const std::vector<std::string> command = command_words(argc, argv);
    add_slam_command(program, action, command);
    add_live_command(program, action);
    add_simulate_command(program, action);
    add_study_command(program, action, command);
    add_report_command(program, action);
    add_data_command(program, action);
    add_fiducials_command(program, action);
    for (const auto& add : kMixtureCommands) add(program, action);
    add_completion_command(program, action);
    add_manual_command(program, action);
    program.parse(argc, argv);
  } catch (const CLI::ParseError& reason) {
    return answer(program, reason);
  }
  const internal::InputGuard inputs;
  return guarded(action);
}

}  // namespace posemix
