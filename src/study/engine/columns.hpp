// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace posemix {

/// What a column of a study's table is, by its name, which ends with the unit:
/// "camera_rotation_rmse_deg" is "camera rotation, rms error" in deg.
struct ColumnText {
  std::string title;
  std::string unit;  ///< empty for a number without one, and for texts
};

ColumnText column_text(std::string_view name);

/// The column that has the standard error of another one; empty where there is none.
std::string standard_error_column(std::string_view name, std::span<const std::string> columns);

/// {name: {"title": ..., "unit": ..., "standard_error": name of a column, "unit_column": name},
/// ...}. Where a table has a column "unit", that has the units of the numbers that name none
/// themselves.
nlohmann::ordered_json columns_json(std::span<const std::string> columns);

}  // namespace posemix
