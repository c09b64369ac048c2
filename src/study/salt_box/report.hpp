// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>

#include "study.hpp"

namespace posemix {

/// The report from the results of all items: the example first, then the trials.
StudyReport report_salt_box(const SaltBoxSettings& settings, std::span<const std::string> results);

}  // namespace posemix
