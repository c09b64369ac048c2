// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

/// The verbs on mixture files. Each adds itself to the program; when it is on the command line,
/// parsing sets `action` to what it does, whose result is the exit code.
namespace posemix {

void add_compose_verb(CLI::App& program, std::function<int()>& action);
void add_convert_verb(CLI::App& program, std::function<int()>& action);
void add_density_verb(CLI::App& program, std::function<int()>& action);
void add_divergence_verb(CLI::App& program, std::function<int()>& action);
void add_fit_verb(CLI::App& program, std::function<int()>& action);
void add_fuse_verb(CLI::App& program, std::function<int()>& action);
void add_grasp_verb(CLI::App& program, std::function<int()>& action);
void add_reduce_verb(CLI::App& program, std::function<int()>& action);
void add_sample_verb(CLI::App& program, std::function<int()>& action);

}  // namespace posemix
