// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string_view>

/// Sequence files of configs/, part of the library.
namespace posemix {

extern const std::string_view kDopeProfile;
extern const std::string_view kCosyposeProfile;
extern const std::string_view kPublishedProfile;
extern const std::string_view kTlessSymmetries;

}  // namespace posemix
