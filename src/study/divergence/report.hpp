// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>

#include "study.hpp"

namespace posemix {

StudyReport report_divergence(const DivergenceStudySettings& settings,
                              std::span<const std::string> results);

}  // namespace posemix
