// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <string_view>

namespace posemix::internal {

/// The warning about a key, word or option that is read under its old name:
///   `PLACE: key 'OLD' is now 'NEW'; the old name will be refused in VERSION`.
/// `kind` is the kind of the names, such as "key", and `refused_in` the version after the next one.
std::string renamed_warning(std::string_view place, std::string_view kind,
                            std::string_view old_name, std::string_view new_name,
                            std::string_view refused_in = "0.3");

}  // namespace posemix::internal
