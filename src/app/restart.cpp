// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "restart.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>

#include "base/c_library.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/vector_instructions.hpp"
#include "posemix/io/text.hpp"
#include "usage_error.hpp"

namespace posemix {
namespace {

constexpr const char* kTunables = "GLIBC_TUNABLES";

bool asks_for_portable() {
  const char* const value = std::getenv("POSEMIX_SIMD");
  return value != nullptr && std::string_view(value) == "portable";
}

/// The command line that this process was started with: a script's is that of its interpreter.
std::vector<std::string> own_command_line() {
  const std::string text = read_file("/proc/self/cmdline");
  const std::vector<std::string_view> fields = split_fields(text, '\0');
  return {fields.begin(), fields.end() - 1};  // every word ends with the separator
}

/// Returns only when it fails, with the reason.
std::string start_again() {
  try {
    // By its path: /proc/self/exe would be the name of the process in lists of them.
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    std::vector<std::string> words = own_command_line();
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execv(program.c_str(), arguments.data());
    return fmt::format("{}: {}", program, std::strerror(errno));
  } catch (const std::exception& error) {  // there is no /proc
    return error.what();
  }
}

[[noreturn]] void refuse(const std::string& tunables, std::string_view reason) {
  throw UsageError(
      fmt::format("POSEMIX_SIMD is \"portable\", which needs {}={} before the program starts ({})",
                  kTunables, tunables, reason));
}

}  // namespace

void restart_where_portable() {
  try {
    vector_instructions();
  } catch (const InvalidInput& error) {
    throw UsageError(error.what());
  }
  if (!asks_for_portable() || !internal::c_library_fuses().value_or(false)) return;
  const char* const before = std::getenv(kTunables);
  const std::string wanted = internal::tunables_without_fma(before == nullptr ? "" : before);
  if (internal::c_library_ignores_tunables() || (before != nullptr && wanted == before))
    refuse(wanted, "the C library ignores it in this process");
  ::setenv(kTunables, wanted.c_str(), 1);
  refuse(wanted, start_again());
}

}  // namespace posemix
