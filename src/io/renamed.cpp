// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "renamed.hpp"

#include <fmt/format.h>

namespace posemix::internal {

std::string renamed_warning(std::string_view place, std::string_view kind,
                            std::string_view old_name, std::string_view new_name,
                            std::string_view refused_in) {
  return fmt::format("{}: {} '{}' is now '{}'; the old name will be refused in {}", place, kind,
                     old_name, new_name, refused_in);
}

}  // namespace posemix::internal
