// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "posemix/base/error.hpp"

namespace posemix::testing {

/// The message of the InvalidInput that `action` throws; a note if it throws none.
template <typename Action>
std::string invalid_input_message(Action&& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "(no InvalidInput)";
}

}  // namespace posemix::testing

/// The statement throws InvalidInput whose message is exactly `message`.
#define EXPECT_INVALID(statement, message)                                                    \
  EXPECT_EQ(::posemix::testing::invalid_input_message([&] { static_cast<void>(statement); }), \
            message)

/// The statement throws InvalidInput whose message contains `part`.
#define EXPECT_INVALID_WITH(statement, part)                                              \
  do {                                                                                    \
    const std::string message_ =                                                          \
        ::posemix::testing::invalid_input_message([&] { static_cast<void>(statement); }); \
    EXPECT_NE(message_.find(part), std::string::npos)                                     \
        << "message: " << message_ << "\nlacks: " << part;                                \
  } while (false)
