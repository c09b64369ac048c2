// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <functional>
#include <istream>
#include <string>
#include <vector>

#include "io/json_numbers.hpp"

namespace posemix {

struct PackedTrace {
  Json columns;
  std::vector<std::string> warnings;  ///< about keys under the names of the release before
};

/// The key `trace` of a report: trace.json as compressed columns.
///
/// The text is read once, piece by piece; in memory is what is compressed and the columns of one
/// object (or, of joint hypotheses, those of all objects). `name` stands for the file in messages;
/// `progress` is told now and then how many bytes have been read.
/// @throws InvalidInput naming the file and the place in it
PackedTrace pack_trace(std::istream& text, const std::string& name,
                       const std::function<void(std::size_t)>& progress);

}  // namespace posemix
