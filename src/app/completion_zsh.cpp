// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include <fmt/format.h>

#include "completion.hpp"

namespace posemix {
namespace {

/// The text within single quotes; what a specification of _arguments reads otherwise has a
/// backslash.
std::string zsh_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') escaped += '\\';
    if (c == '\'') {
      escaped += "'\\''";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string zsh_action(const OptionText& option) {
  switch (option.kind) {
    case ValueKind::file:
      return "_files";
    case ValueKind::folder:
      return "_files -/";
    case ValueKind::word:
      return fmt::format("({})", fmt::join(option.words, " "));
    default:
      return " ";
  }
}

/// One specification for every name of an option. An option that may be given again has a star.
std::string zsh_option(const OptionText& option) {
  std::string specifications;
  std::vector<std::string> others = option.names;
  others.insert(others.end(), option.excludes.begin(), option.excludes.end());
  const std::string exclusion = option.several ? "*" : fmt::format("({})", fmt::join(others, " "));
  for (const std::string& name : option.names) {
    const bool is_long = name.starts_with("--") && option.kind != ValueKind::none;
    std::string value;
    if (option.kind != ValueKind::none) {
      value = fmt::format(":{}:{}", zsh_text(option.value), zsh_action(option));
    }
    specifications += fmt::format("    '{}{}{}[{}]{}' \\\n", exclusion, name, is_long ? "=" : "",
                                  zsh_text(option.description), value);
  }
  return specifications;
}

std::string zsh_function(const CommandText& command) {
  std::string name = "_" + command.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

std::string zsh_arguments(const CommandText& command) {
  std::string specifications;
  for (std::size_t i = 0; i < command.arguments.size(); ++i) {
    const OptionText& argument = command.arguments[i];
    const std::string place = argument.several ? "*" : std::to_string(i + 1);
    specifications +=
        fmt::format("    '{}:{}:{}' \\\n", place, zsh_text(argument.value), zsh_action(argument));
  }
  return specifications;
}

/// The commands below one, and a call of the function of the one that is on the command line.
std::string zsh_commands(const CommandText& command) {
  std::string words;
  std::string calls;
  for (const CommandText& below : command.commands) {
    words += fmt::format(" {}\\:\"{}\"", below.word(), zsh_text(below.description));
    calls += fmt::format("    {}) {} ;;\n", below.word(), zsh_function(below));
  }
  return fmt::format(
      "    '1:command:(({}))' \\\n    '*:: :->rest' && return\n"
      "  [[ $state == rest ]] || return\n  case $words[1] in\n{}  esac\n",
      words.substr(1), calls);
}

std::string zsh_definition(const CommandText& command) {
  std::string text = fmt::format(
      "{}() {{\n  local context curcontext=\"$curcontext\" state line\n"
      "  typeset -A opt_args\n  _arguments -s -C \\\n",
      zsh_function(command));
  for (const OptionText& option : command.options()) text += zsh_option(option);
  if (!command.commands.empty()) return text + zsh_commands(command) + "}\n\n";
  text += zsh_arguments(command);
  return text.substr(0, text.rfind(" \\\n")) + "\n}\n\n";
}

}  // namespace

std::string zsh_completion(const CommandText& program) {
  std::string script =
      "#compdef posemix\n# Completion of posemix in zsh, as `posemix completion zsh` prints "
      "it.\n\n";
  for (const CommandText& command : all_commands(program)) script += zsh_definition(command);
  return script +
         "if [[ $funcstack[1] == _posemix ]]; then\n"
         "  _posemix \"$@\"\n"
         "else\n"
         "  compdef _posemix posemix\n"
         "fi\n";
}

}  // namespace posemix
