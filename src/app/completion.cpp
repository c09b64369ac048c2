// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "completion.hpp"

#include <memory>

#include "command_options.hpp"
#include "exit_codes.hpp"
#include "summary.hpp"

namespace posemix {

/// The shells that there is a script for.
enum class Shell { bash, zsh, fish };

template <>
inline constexpr WordTable<Shell, 3> words<Shell>{{
    {"bash", Shell::bash},
    {"zsh", Shell::zsh},
    {"fish", Shell::fish},
}};

namespace {

int print_completion(const CLI::App& program, Shell shell) {
  const CommandText tree = command_tree(program);
  switch (shell) {
    case Shell::bash:
      print_text(bash_completion(tree));
      break;
    case Shell::zsh:
      print_text(zsh_completion(tree));
      break;
    case Shell::fish:
      print_text(fish_completion(tree));
      break;
  }
  return kExitDone;
}

}  // namespace

void add_completion_command(CLI::App& program, std::function<int()>& action) {
  const auto shell = std::make_shared<Shell>(Shell::bash);
  CLI::App* command =
      program.add_subcommand("completion", "Print a script for completion in a shell");
  command->footer(
      "The script completes commands, options, and values that are words, files or folders. It\n"
      "belongs into ~/.local/share/bash-completion/completions/posemix for bash, into a file\n"
      "_posemix in a folder of $fpath for zsh, and into ~/.config/fish/completions/posemix.fish.\n"
      "The Debian package has installed it already.\n"
      "\n"
      "Example: posemix completion bash > posemix.bash && . ./posemix.bash");
  add_choice<Shell>(*command, "shell", *shell, "The shell")->required();
  command->callback([shell, &program, &action] {
    action = [shell, &program] { return print_completion(program, *shell); };
  });
}

}  // namespace posemix
