// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "completion.hpp"

namespace posemix {
namespace {

// The words before the cursor name the command, as far as they are commands; what stands before
// and after `=` are words of their own to bash.
constexpr std::string_view kBashHead =
    R"(# Completion of posemix in bash, as `posemix completion bash` prints it.

_posemix_values() {
  case $1 in
    files) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- "$2") ;;
    folders) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- "$2") ;;
    *) mapfile -t COMPREPLY < <(compgen -W "$1" -- "$2") ;;
  esac
}

_posemix() {
  local command=posemix current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} i
  if [[ $current == = ]]; then
    current=''
  elif [[ $previous == = ]]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command ${COMP_WORDS[i]}" in
      COMMANDS) command+=" ${COMP_WORDS[i]}" ;;
    esac
  done
  case "$command $previous" in
)";

/// What the function _posemix_values takes.
std::string bash_values(const OptionText& option) {
  switch (option.kind) {
    case ValueKind::file:
      return "files";
    case ValueKind::folder:
      return "folders";
    case ValueKind::word:
      return fmt::format("{}", fmt::join(option.words, " "));
    default:
      return "";
  }
}

/// The names of options with a value, by what completes it.
std::map<std::string, std::string> bash_value_cases(const std::vector<CommandText>& commands) {
  std::map<std::string, std::string> cases;
  for (const CommandText& command : commands) {
    for (const OptionText& option : command.options()) {
      if (option.kind == ValueKind::none) continue;
      std::string& names = cases[bash_values(option)];
      for (const std::string& name : option.names) {
        names += fmt::format("{}'{} {}'", names.empty() ? "" : " | ", command.name, name);
      }
    }
  }
  return cases;
}

std::string bash_command_case(const CommandText& command) {
  std::string options;
  for (const OptionText& option : command.options()) {
    for (const std::string& name : option.names) options += (options.empty() ? "" : " ") + name;
  }
  std::string words;
  std::set<std::string> arguments;
  for (const CommandText& below : command.commands)
    words += (words.empty() ? "" : " ") + below.word();
  for (const OptionText& argument : command.arguments) arguments.insert(bash_values(argument));
  if (words.empty() && arguments.size() == 1) words = *arguments.begin();
  return fmt::format("    '{}') options='{}' values='{}' ;;\n", command.name, options, words);
}

}  // namespace

std::string bash_completion(const CommandText& program) {
  const std::vector<CommandText> commands = all_commands(program);
  std::string names;
  for (const CommandText& command : commands) {
    if (&command != &commands.front()) {
      names += fmt::format("{}'{}'", names.empty() ? "" : " | ", command.name);
    }
  }
  std::string script(kBashHead);
  const std::string_view mark = "COMMANDS)";
  script.replace(script.find(mark), mark.size(), names + ")");
  for (const auto& [values, options] : bash_value_cases(commands)) {
    const std::string complete =
        values.empty() ? "" : fmt::format("_posemix_values '{}' \"$current\"; ", values);
    script += fmt::format("    {}) {}return ;;\n", options, complete);
  }
  script += "  esac\n  local options='' values=''\n  case $command in\n";
  for (const CommandText& command : commands) script += bash_command_case(command);
  return script +
         "  esac\n"
         "  if [[ $current == -* ]]; then values=$options; fi\n"
         "  _posemix_values \"$values\" \"$current\"\n"
         "}\n"
         "\n"
         "complete -F _posemix posemix\n";
}

}  // namespace posemix
