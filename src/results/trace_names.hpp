// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string_view>

namespace posemix::internal {

/// The names of the release before, which traces are still read by.
inline constexpr std::string_view kOldStatusKey = "fate";
inline constexpr std::string_view kOldBirthName = "born";

}  // namespace posemix::internal
