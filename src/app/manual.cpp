// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "manual.hpp"

#include <algorithm>
#include <cctype>
#include <memory>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "exit_codes.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

constexpr std::string_view kExample = "Example: ";
constexpr std::string_view kExitCodes = "Exit codes: ";

/// The page of the command `posemix data fetch` is posemix-data-fetch.
std::string page_name(std::string command) {
  std::replace(command.begin(), command.end(), ' ', '-');
  return command;
}

/// The text with every character as it stands: to troff a backslash, a hyphen, and a dot or an
/// apostrophe at the begin of a line are more than themselves.
std::string plain(std::string_view text) {
  std::string escaped;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) escaped += "\\&";
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
    begins = c == '\n';
  }
  return escaped;
}

/// In bold, of which a part of a line may be.
std::string bold(std::string_view text) { return "\\fB" + plain(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + plain(text) + "\\fR"; }

std::string joined(const std::vector<std::string>& texts, std::string_view separator) {
  return fmt::format("{}", fmt::join(texts, separator));
}

std::vector<std::string> paragraphs_of(const std::string& footer) {
  std::vector<std::string> paragraphs(1);
  std::istringstream lines(footer);
  for (std::string line; std::getline(lines, line);) {
    if (!trimmed(line).empty()) {
      paragraphs.back() += line + "\n";
    } else if (!paragraphs.back().empty()) {
      paragraphs.emplace_back();
    }
  }
  if (paragraphs.back().empty()) paragraphs.pop_back();
  return paragraphs;
}

/// Lines as they are, without the indentation that all have.
std::string example(std::string text) {
  text.replace(0, kExample.size(), std::string(kExample.size(), ' '));
  std::string lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    lines += line.substr(std::min(kExample.size(), line.find_first_not_of(' '))) + "\n";
  }
  return ".SH EXAMPLES\n.nf\n" + plain(lines) + ".fi\n";
}

/// The parts of a command's footer, as sections.
struct FooterSections {
  std::string description;
  std::string exit_codes;
  std::string examples;
};

FooterSections footer_sections(const std::string& footer) {
  FooterSections sections;
  for (const std::string& paragraph : paragraphs_of(footer)) {
    if (paragraph.starts_with(kExample)) {
      sections.examples = example(paragraph);
    } else if (paragraph.starts_with(kExitCodes)) {
      sections.exit_codes = ".SH EXIT STATUS\n" + plain(paragraph.substr(kExitCodes.size()));
    } else {
      sections.description += sections.description.empty() ? ".SH DESCRIPTION\n" : ".PP\n";
      sections.description += plain(paragraph);
    }
  }
  return sections;
}

/// What follows a description: default, range, and what else has to be or cannot be given.
std::string conditions(const OptionText& option) {
  std::vector<std::string> all;
  if (!option.default_value.empty()) all.push_back("Default: " + plain(option.default_value) + ".");
  if (!option.range.empty()) all.push_back("Range: " + plain(option.range) + ".");
  if (option.required && !option.names.empty()) all.emplace_back("Required.");
  if (!option.needs.empty()) all.push_back("Only with " + plain(joined(option.needs, ", ")) + ".");
  if (!option.excludes.empty()) {
    all.push_back("Not with " + plain(joined(option.excludes, ", ")) + ".");
  }
  return joined(all, " ");
}

std::string option_entry(const OptionText& option) {
  std::vector<std::string> names;
  names.reserve(option.names.size());
  for (const std::string& name : option.names) names.push_back(bold(name));
  std::string head = joined(names, ", ");
  if (!option.value.empty()) head += (head.empty() ? "" : " ") + italic(option.value);
  std::string text = plain(option.description);
  if (!text.empty() && text.back() != '.') text += '.';
  const std::string more = conditions(option);
  return fmt::format(".TP\n{}\n{}{}{}\n", head, text, more.empty() ? "" : "\n", more);
}

std::string options_section(const CommandText& command) {
  std::string text;
  if (!command.arguments.empty()) text += ".SH ARGUMENTS\n";
  for (const OptionText& argument : command.arguments) text += option_entry(argument);
  text += ".SH OPTIONS\n";
  for (const OptionGroupText& group : command.groups) {
    if (!group.title.empty()) text += fmt::format(".SS {}\n", plain(group.title));
    if (group.one_of) text += "Exactly one of these is given.\n";
    for (const OptionText& option : group.options) text += option_entry(option);
  }
  if (!command.commands.empty()) text += ".SH COMMANDS\n";
  for (const CommandText& below : command.commands) {
    text += fmt::format(".TP\n{}\n{}.\n", bold(below.word()), plain(below.description));
  }
  return text;
}

std::string synopsis(const CommandText& command) {
  std::string line = ".SH SYNOPSIS\n" + bold(command.name) + " [" + italic("OPTIONS") + "]";
  for (const OptionText& argument : command.arguments) {
    const std::string value = italic(argument.value) + (argument.several ? " ..." : "");
    line += argument.required ? " " + value : " [" + value + "]";
  }
  if (!command.commands.empty()) line += " " + italic("COMMAND");
  return line + "\n";
}

/// The commands above and below this one.
std::string see_also(const CommandText& command) {
  const auto reference = [](const std::string& name) { return bold(page_name(name)) + "(1)"; };
  std::vector<std::string> pages;
  for (std::size_t end = command.name.find(' '); end != std::string::npos;
       end = command.name.find(' ', end + 1)) {
    pages.push_back(reference(command.name.substr(0, end)));
  }
  for (const CommandText& below : command.commands) pages.push_back(reference(below.name));
  return pages.empty() ? "" : ".SH SEE ALSO\n" + joined(pages, ",\n") + "\n";
}

struct ManualOptions {
  std::string out;
};

int write_manual(const CLI::App& program, const ManualOptions& options) {
  OutputFolder folder(options.out);
  for (const CommandText& command : all_commands(command_tree(program))) {
    folder.write(page_name(command.name) + ".1", manual_page(command, POSEMIX_VERSION));
  }
  folder.commit();
  return kExitDone;
}

}  // namespace

std::string manual_page(const CommandText& command, const std::string& version) {
  const std::string name = page_name(command.name);
  std::string title = name;
  std::transform(title.begin(), title.end(), title.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  const FooterSections footer = footer_sections(command.footer);
  return fmt::format(".TH {} 1 \"\" \"posemix {}\" \"posemix\"\n.SH NAME\n{} \\- {}\n{}{}{}{}{}{}",
                     plain(title), version, plain(name), plain(command.description),
                     synopsis(command), footer.description, options_section(command),
                     footer.exit_codes, footer.examples, see_also(command));
}

void add_manual_command(CLI::App& program, std::function<int()>& action) {
  const auto options = std::make_shared<ManualOptions>();
  CLI::App* command = program.add_subcommand("manual", "Write the manual pages of all commands");
  command->footer(
      "Writes posemix.1 and one page for every command, posemix-slam.1 and so on, for man(1).\n"
      "\n"
      "Example: posemix manual --out man/man1");
  command->add_option("--out", options->out, "Folder for the pages")->required()->type_name("DIR");
  command->callback([options, &program, &action] {
    action = [options, &program] { return write_manual(program, *options); };
  });
}

}  // namespace posemix
