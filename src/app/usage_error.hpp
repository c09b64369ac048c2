// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <stdexcept>

namespace posemix {

/// A command line that is wrong, found after it was parsed.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace posemix
