// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report_page.hpp"

#include <stdexcept>

namespace posemix::internal {

std::string filled_page(const std::string& page, std::string_view json) {
  constexpr std::string_view kMark = "@POSEMIX_REPORT@";
  const std::size_t at = page.find(kMark);
  if (at == std::string::npos || page.find(kMark, at + 1) != std::string::npos) {
    throw std::runtime_error("the report page has not exactly one place for data");
  }
  std::string filled = page.substr(0, at);
  filled.reserve(page.size() + json.size() + json.size() / 16);
  while (true) {
    const std::size_t end = json.find('<');
    filled += json.substr(0, end);
    if (end == std::string_view::npos) break;
    filled += "\\u003c";
    json.remove_prefix(end + 1);
  }
  return filled.append(page, at + kMark.size());
}

}  // namespace posemix::internal
