// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace posemix::internal {

/// The page without data as a zlib stream; empty where the library was built without it.
struct ReportPage {
  std::string_view stream;
  std::size_t size = 0;  ///< size of the uncompressed page
};

/// Defined by a source that the build generates, or by report_no_page.cpp.
ReportPage report_page();

/// The page with data in the place of its mark. Every '<' of the JSON is escaped, because it could
/// end the element around the data.
/// @throws std::runtime_error unless the page has exactly one mark
std::string filled_page(const std::string& page, std::string_view json);

}  // namespace posemix::internal
