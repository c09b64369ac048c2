// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string_view>

/// Texts of sequence files of configs/, compiled into the program.
namespace posemix {

extern const std::string_view kDopeProfile;
extern const std::string_view kCosyposeProfile;
extern const std::string_view kPublishedProfile;
extern const std::string_view kTlessSymmetries;

}  // namespace posemix
