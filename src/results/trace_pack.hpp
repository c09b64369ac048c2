// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <functional>
#include <istream>
#include <string>
#include <vector>

#include "io/json_numbers.hpp"

namespace posemix::internal {

struct PackedTrace {
  Json columns;
  std::vector<std::string> warnings;  ///< about keys under the names of the release before
};

/// The key `trace` of a report: trace.json as compressed columns.
///
/// The text is read once, piece by piece. Memory holds the compressed data and the columns of one
/// object (for joint hypotheses, the columns of all objects). `name` is the file's name in error
/// messages; `progress` is called now and then with the number of bytes read.
/// @throws InvalidInput naming the file and the place in it
PackedTrace pack_trace(std::istream& text, const std::string& name,
                       const std::function<void(std::size_t)>& progress);

}  // namespace posemix::internal
