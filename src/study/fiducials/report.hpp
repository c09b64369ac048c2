// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>

#include "study/engine/study.hpp"

namespace posemix {

/// The report of `study fiducials` from its items' results: see make_fiducials_study.
StudyReport report_fiducials(std::span<const std::string> results);

}  // namespace posemix
