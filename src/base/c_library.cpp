// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "base/c_library.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

#if defined(__x86_64__) && defined(__GLIBC__)
#define POSEMIX_C_LIBRARY_CHOOSES
#include <gnu/libc-version.h>
#include <sys/auxv.h>
#endif

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace posemix::internal {
namespace {

constexpr const char* kVariable = "GLIBC_TUNABLES";
constexpr std::string_view kHwcaps = "glibc.cpu.hwcaps";
constexpr std::string_view kHwcapsBefore2_29 = "glibc.tune.hwcaps";
/// Features of these names had this ending before glibc 2.33.
constexpr std::string_view kUsable = "_Usable";
constexpr std::array<std::string_view, 2> kFused{"FMA", "FMA4"};

std::vector<std::string_view> split(std::string_view text, char at) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(at), text.size());
    if (end > 0) parts.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

/// The value of a tunable if this is its assignment.
std::optional<std::string_view> value_in(std::string_view assignment, std::string_view name) {
  if (!assignment.starts_with(name) || !assignment.substr(name.size()).starts_with('='))
    return std::nullopt;
  return assignment.substr(name.size() + 1);
}

bool is_before(CLibraryVersion version, int minor) {
  return version.major < 2 || (version.major == 2 && version.minor < minor);
}

#ifdef POSEMIX_C_LIBRARY_CHOOSES
/// What this process was started with; it may have changed its environment since.
std::string tunables_at_start() {
  if (c_library_ignores_tunables()) return {};
  std::ifstream file("/proc/self/environ", std::ios::binary);
  if (file) return tunables_in({std::istreambuf_iterator<char>(file), {}});
  const char* const now = std::getenv(kVariable);
  return now == nullptr ? std::string() : std::string(now);
}

CLibraryVersion version_of_c_library() {
  CLibraryVersion version;
  char* rest = nullptr;
  version.major = static_cast<int>(std::strtol(gnu_get_libc_version(), &rest, 10));
  if (*rest == '.') version.minor = static_cast<int>(std::strtol(rest + 1, nullptr, 10));
  return version;
}

bool fuses_here() {
  const std::string tunables = tunables_at_start();
  const CLibraryVersion version = version_of_c_library();
  // The versions with FMA are for processors that have AVX2, too.
  const bool fma = __builtin_cpu_supports("fma") != 0 && __builtin_cpu_supports("avx2") != 0 &&
                   !is_hidden(tunables, "FMA", version) && !is_hidden(tunables, "AVX2", version);
  return fma || (__builtin_cpu_supports("fma4") != 0 && !is_hidden(tunables, "FMA4", version));
}
#endif

}  // namespace

std::optional<bool> c_library_fuses() {
#ifdef POSEMIX_C_LIBRARY_CHOOSES
  static const bool fuses = fuses_here();
  return fuses;
#else
  return std::nullopt;
#endif
}

bool c_library_ignores_tunables() {
#ifdef POSEMIX_C_LIBRARY_CHOOSES
  return getauxval(AT_SECURE) != 0;
#else
  return true;
#endif
}

std::string tunables_in(const std::string& environment) {
  std::string tunables;
  bool inside = false;
  for (const std::string_view variable : split(environment, '\0')) {
    if (const auto value = value_in(variable, kVariable)) {
      tunables = *value;
      inside = true;
    } else if (inside && variable.starts_with("glibc.")) {
      tunables.append(":").append(variable);
    } else {
      inside = false;
    }
  }
  return tunables;
}

bool is_hidden(std::string_view tunables, std::string_view feature, CLibraryVersion version) {
  const std::string_view name = is_before(version, 29) ? kHwcapsBefore2_29 : kHwcaps;
  const std::string hides = fmt::format("-{}{}", feature, is_before(version, 33) ? kUsable : "");
  bool hidden = false;  // by the last assignment, which takes the place of those before
  for (const std::string_view assignment : split(tunables, ':')) {
    const auto features = value_in(assignment, name);
    if (!features) continue;
    hidden = false;
    for (const std::string_view word : split(*features, ',')) hidden |= word == hides;
  }
  return hidden;
}

std::string tunables_without_fma(std::string_view tunables) {
  std::vector<std::string> others;
  std::vector<std::string> features;
  // Each once, so that a text that hides them already stays as it is.
  const auto add = [&features](std::string word) {
    if (std::find(features.begin(), features.end(), word) == features.end())
      features.push_back(std::move(word));
  };
  for (const std::string_view assignment : split(tunables, ':')) {
    auto value = value_in(assignment, kHwcaps);
    if (!value) value = value_in(assignment, kHwcapsBefore2_29);
    if (!value) {
      others.emplace_back(assignment);
    } else {
      for (const std::string_view word : split(*value, ',')) add(std::string(word));
    }
  }
  for (const std::string_view feature : kFused) {
    add(fmt::format("-{}", feature));
    add(fmt::format("-{}{}", feature, kUsable));
  }
  for (const std::string_view name : {kHwcaps, kHwcapsBefore2_29})
    others.push_back(fmt::format("{}={}", name, fmt::join(features, ",")));
  return fmt::format("{}", fmt::join(others, ":"));
}

}  // namespace posemix::internal
