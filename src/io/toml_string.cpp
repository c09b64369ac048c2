// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "io/toml_string.hpp"

#include <fmt/format.h>

#include "json_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {

/// It has the same form in JSON.
std::string toml_string(const std::string& text) {
  if (text.find("${") != std::string::npos)
    throw InvalidInput(
        fmt::format("{}: got a text with '${{', expected one without: a sequence "
                    "file reads it as a variable",
                    in_quotes(text, 200)));
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace posemix::internal
