// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <string_view>

#include <fmt/format.h>

#include "completion.hpp"

namespace posemix {
namespace {

// Words before the cursor that are no command, such as the values of options, are left out.
constexpr std::string_view kFishHead =
    R"(# Completion of posemix in fish, as `posemix completion fish` prints it.

set -g __posemix_commands COMMANDS

function __posemix_at --description 'Whether this command is on the command line, and none below it'
  set -l command posemix
  for word in (commandline -opc)[2..-1]
    if contains -- "$command $word" $__posemix_commands
      set command "$command $word"
    end
  end
  test "$command" = "$argv"
end

complete -c posemix -f
)";

std::string fish_text(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\'' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return "'" + escaped + "'";
}

/// Files are complete's default, which the first line of the script has switched off.
std::string fish_values(const OptionText& option) {
  switch (option.kind) {
    case ValueKind::none:
      return "";
    case ValueKind::file:
      return " -r -F";
    case ValueKind::folder:
      return " -x -a '(__fish_complete_directories)'";
    case ValueKind::word:
      return fmt::format(" -x -a '{}'", fmt::join(option.words, " "));
    default:
      return " -x";
  }
}

std::string fish_lines(const CommandText& command) {
  const std::string condition =
      fmt::format("complete -c posemix -n '__posemix_at {}'", command.name);
  std::string lines;
  for (const CommandText& below : command.commands) {
    lines += fmt::format("{} -a {} -d {}\n", condition, below.word(), fish_text(below.description));
  }
  for (const OptionText& argument : command.arguments) {
    if (argument.kind == ValueKind::file) lines += condition + " -F\n";
    if (argument.kind == ValueKind::word) {
      lines += fmt::format("{} -a '{}'\n", condition, fmt::join(argument.words, " "));
    }
  }
  for (const OptionText& option : command.options()) {
    std::string names;
    for (const std::string& name : option.names) {
      const bool is_long = name.starts_with("--");
      names += (is_long ? " -l " : " -s ") + name.substr(is_long ? 2 : 1);
    }
    lines +=
        condition + names + fish_values(option) + " -d " + fish_text(option.description) + "\n";
  }
  return lines;
}

}  // namespace

std::string fish_completion(const CommandText& program) {
  const std::vector<CommandText> commands = all_commands(program);
  std::string names;
  for (const CommandText& command : commands) {
    if (&command != &commands.front()) names += " " + fish_text(command.name);
  }
  std::string script(kFishHead);
  const std::string_view mark = " COMMANDS";
  script.replace(script.find(mark), mark.size(), names);
  for (const CommandText& command : commands) script += fish_lines(command);
  return script;
}

}  // namespace posemix
