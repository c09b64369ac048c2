// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

/// The commands of the program as plain data, for manual pages and completion in shells.
namespace posemix {

/// What may stand for the value of an option or argument.
enum class ValueKind { none, file, folder, word, other };

/// An option `--name VALUE`, a flag, or an argument without a name.
struct OptionText {
  std::vector<std::string> names;  ///< with their dashes; of an argument none
  std::string value;               ///< what stands for the value
  std::string description;
  std::string range;          ///< such as "1 - 100"
  std::string default_value;  ///< as it is written on the command line
  ValueKind kind = ValueKind::none;
  std::vector<std::string> words;     ///< of ValueKind::word
  std::vector<std::string> needs;     ///< options that have to be given too
  std::vector<std::string> excludes;  ///< options that cannot be given too
  bool required = false;
  bool several = false;  ///< takes any number of values
};

/// Options, under a title where they belong together.
struct OptionGroupText {
  std::string title;
  bool one_of = false;  ///< exactly one of them is given
  std::vector<OptionText> options;
};

struct CommandText {
  std::string name;  ///< all words, such as "posemix data fetch"
  std::string description;
  std::string footer;
  std::vector<OptionText> arguments;
  std::vector<OptionGroupText> groups;
  std::vector<CommandText> commands;

  /// The last word of the name.
  std::string word() const { return name.substr(name.rfind(' ') + 1); }
  /// The options of all groups.
  std::vector<OptionText> options() const;
};

/// The program or a command, with all commands below it. What the help hides is left out.
CommandText command_tree(const CLI::App& app);

/// The command and all below it, each before its own commands.
std::vector<CommandText> all_commands(const CommandText& command);

}  // namespace posemix
