// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "method.hpp"
#include "study/engine/table.hpp"

namespace posemix {

/// The rows of one item, by the table that they belong to.
struct YcbvRows {
  std::vector<std::vector<Cell>> results;         ///< study.json
  std::vector<std::vector<Cell>> timing;          ///< timing.csv
  std::vector<std::vector<Cell>> forecasts = {};  ///< reliability.csv, by bins of the probability
};

/// Runs one method on one recording.
YcbvRows run_ycbv(const YcbvStudySettings& settings, const Recording& recording,
                  const YcbvMethod& method);

}  // namespace posemix
