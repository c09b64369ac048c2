// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "posemix/draw/consistency_chart.hpp"
#include "posemix/results/results.hpp"
#include "posemix/slam/truth_match.hpp"

/// The files that `posemix consistency` writes. docs/formats.md describes them.
namespace posemix {

/// Version of consistency.json that this library writes.
inline constexpr std::int64_t kConsistencySchema = 1;

/// The consistency of some poses, and how they were compared.
struct ConsistencyResults {
  std::string title;  ///< names estimates and truth
  Alignment alignment = Alignment::none;
  ErrorAxes axes = ErrorAxes::body;
  std::vector<NamedConsistency> poses;
};

/// consistency.json.
std::string format_consistency(const ConsistencyResults& results);

/// The results as a text of tables and sentences.
std::string format_consistency_text(const ConsistencyResults& results);

/// One line per pose and frame: NEES per degree of freedom.
std::string format_consistency_table(const ConsistencyResults& results);

/// All of it: consistency.json, consistency.csv, consistency.svg, consistency.md.
std::vector<NamedText> format_consistency_files(const ConsistencyResults& results);

}  // namespace posemix
