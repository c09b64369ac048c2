// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include "posemix/slam/consistency.hpp"

/// Words for what a series of errors says.
namespace posemix::internal {

/// The axes that a direction is most of, by its correlations with them.
std::string direction_name(const Vector6d& correlation);

/// The verdict in words, from the numbers of the report.
std::vector<std::string> findings_of(const ConsistencyReport& report);

}  // namespace posemix::internal
