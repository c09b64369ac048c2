// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "study/engine/study.hpp"

namespace posemix {

/// The report of `study grasp` from the results of its work items; `bins` are those of the
/// reliability diagram.
StudyReport report_grasp(std::span<const std::string> results, std::size_t bins);

}  // namespace posemix
