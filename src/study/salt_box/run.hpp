// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <string>

#include "study.hpp"

namespace posemix {

/// The example as one-line JSON: rows of stages and of reductions.
std::string salt_box_example(const SaltBoxSettings& settings);
/// One trial as one-line JSON.
std::string salt_box_trial(const SaltBoxSettings& settings, std::size_t trial);

}  // namespace posemix
