// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string_view>
#include <vector>

#include "posemix/config/toml_table.hpp"

namespace posemix {

/// An array of at least one number under the key, or the default.
/// @throws InvalidInput naming file, line and key
inline std::vector<double> read_numbers(const TomlTable& table, std::string_view key,
                                        const std::vector<double>& otherwise,
                                        const NumberRange& range) {
  if (!table.has(key)) return otherwise;
  const Eigen::VectorXd numbers = table.get_vector(key, {}, range);
  if (numbers.size() == 0) table.fail(key, "is empty, expected at least one number");
  return {numbers.begin(), numbers.end()};
}

}  // namespace posemix
