// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>

#include "study/engine/study.hpp"

namespace posemix {

/// The report from the results of all items, each the text of what run_tless returns.
StudyReport report_tless(std::span<const std::string> results);

}  // namespace posemix
