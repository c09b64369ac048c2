// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "run.hpp"
#include "study/engine/study.hpp"

namespace posemix {

/// Columns of study.json. The first four are texts; the last names the source of an object's truth.
const std::vector<std::string>& ycbv_columns();
/// Columns of timing.csv; the first four are texts.
const std::vector<std::string>& ycbv_timing_columns();
inline constexpr std::size_t kYcbvTexts = 4;

/// The rows of an item as one line of JSON.
std::string format_ycbv_rows(const YcbvRows& rows);
/// The inverse of format_ycbv_rows.
YcbvRows parse_ycbv_rows(const std::string& text);

StudyReport report_ycbv(std::span<const std::string> items);

}  // namespace posemix
