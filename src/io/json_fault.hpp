// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <string_view>

#include "json_numbers.hpp"

namespace posemix::internal {

/// What is wrong with a text that is not JSON, with its place and without the parser's own words:
/// "line 3, column 14: got ',', expected ':'".
std::string json_fault(const Json::exception& error);

/// Throws InvalidInput `name: got a text that is not JSON (...), expected ...`.
[[noreturn]] void refuse_json(const Json::exception& error, const std::string& name,
                              std::string_view expected);

/// Refuses a value that lies in more than 100 arrays and objects: what walks through a document
/// does so with a function call for each of them.
/// @throws InvalidInput
void check_json_depth(int depth, const std::string& name);

/// Parses a document in which a key may occur twice; `expected` says of what. What others wrote is
/// read by parse_json().
/// @throws InvalidInput as refuse_json
Json json_of(std::string_view text, const std::string& name, std::string_view expected);

}  // namespace posemix::internal
