// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "command_tree.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>

#include "posemix/io/text.hpp"

namespace posemix {
namespace {

bool is_word(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return ('a' <= c && c <= 'z') || ('0' <= c && c <= '9') || c == '_' || c == '-';
  });
}

/// Words are separated by bars: `csv|jsonl`. The value of an option is a file if it is called so or
/// has a suffix; an argument is one unless it is a name.
ValueKind kind_of(const OptionText& option, const std::vector<std::string>& words) {
  const std::string& value = option.value;
  if (value.empty()) return ValueKind::none;
  if (std::all_of(words.begin(), words.end(), is_word)) return ValueKind::word;
  if (value == "DIR") return ValueKind::folder;
  if (value == "NAME" || value.find('=') != std::string::npos) return ValueKind::other;
  const bool is_file = option.names.empty() || value.find("FILE") != std::string::npos ||
                       value.find('.') != std::string::npos;
  return is_file ? ValueKind::file : ValueKind::other;
}

std::vector<std::string> names_of(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  names.reserve(options.size());
  for (const CLI::Option* option : options) names.push_back(option->get_name());
  std::sort(names.begin(), names.end());
  return names;
}

/// CLI11 appends what it checks to what stands for the value: `N:UINT in [1 - 100]`.
void read_value(const CLI::Option& option, OptionText& text) {
  const std::string type = option.get_type_name();
  const std::size_t end = std::min(type.find(':'), type.size());
  text.value = type.substr(0, end);
  const std::size_t open = type.find(" in [", end);
  if (open != std::string::npos) {
    text.range = type.substr(open + 5, type.find(']', open) - open - 5);
  }
  std::vector<std::string> words;
  for (const std::string_view word : split_fields(text.value, '|')) words.emplace_back(word);
  text.kind = kind_of(text, words);
  if (text.kind == ValueKind::word) text.words = std::move(words);
}

OptionText option_text(const CLI::Option& option) {
  OptionText text;
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  if (option.get_items_expected_max() != 0) read_value(option, text);
  text.description = option.get_description();
  text.default_value = option.get_default_str();
  text.required = option.get_required();
  text.needs = names_of(option.get_needs());
  text.excludes = names_of(option.get_excludes());
  text.several = option.get_expected_max() > 1;
  return text;
}

/// The command and each group of options has a flag --help, which is listed once.
OptionGroupText group_text(const CLI::App& group) {
  OptionGroupText text;
  const bool is_command = !group.get_name().empty();
  text.one_of = group.get_require_option_min() == 1 && group.get_require_option_max() == 1;
  for (const CLI::Option* option : group.get_options()) {
    const bool is_listed = is_command || option != group.get_help_ptr();
    if (is_listed && option->nonpositional() && !option->get_group().empty()) {
      text.options.push_back(option_text(*option));
    }
  }
  return text;
}

CommandText text_of(const CLI::App& app, const std::string& parents) {
  CommandText text;
  text.name = parents + app.get_name();
  text.description = app.get_description();
  text.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) text.arguments.push_back(option_text(*option));
  }
  text.groups.push_back(group_text(app));
  // To CLI11 a group of options is a command without a name.
  for (const CLI::App* part : app.get_subcommands(nullptr)) {
    if (!part->get_name().empty()) {
      text.commands.push_back(text_of(*part, text.name + " "));
      continue;
    }
    text.groups.push_back(group_text(*part));
    const std::string& title = part->get_description();
    text.groups.back().title = title.empty() ? part->get_group() : title;
  }
  return text;
}

}  // namespace

std::vector<OptionText> CommandText::options() const {
  std::vector<OptionText> all;
  for (const OptionGroupText& group : groups) {
    all.insert(all.end(), group.options.begin(), group.options.end());
  }
  return all;
}

CommandText command_tree(const CLI::App& app) { return text_of(app, ""); }

std::vector<CommandText> all_commands(const CommandText& command) {
  std::vector<CommandText> all{command};
  for (const CommandText& below : command.commands) {
    const std::vector<CommandText> more = all_commands(below);
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

}  // namespace posemix
