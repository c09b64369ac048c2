// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/vector_instructions.hpp"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "base/vector_targets.hpp"
//
#include "base/vector_dispatch.hpp"
#include "posemix/base/error.hpp"

namespace posemix {
namespace {

constexpr const char* kVariable = "POSEMIX_SIMD";

/// From the widest to the narrowest.
constexpr std::array<std::pair<std::string_view, std::int64_t>, 3> kSets{{
    {"avx512", HWY_AVX3 | HWY_AVX3_DL},
    {"avx2", HWY_AVX2},
    {"neon", HWY_NEON},
}};
constexpr std::string_view kPortable = "portable";

/// What all sets but the named one and narrower ones have.
std::int64_t wider_than(std::string_view name) {
  std::int64_t wider = 0;
  for (const auto& [set, targets] : kSets) {
    if (set == name) break;
    wider |= targets;
  }
  return wider;
}

void restrict_to(std::string_view name) {
  if (name == "auto") return;
  if (name == kPortable) {
    hwy::DisableTargets(wider_than(name));
    return;
  }
  for (const auto& [set, targets] : kSets) {
    if (set != name) continue;
    if ((hwy::SupportedTargets() & targets) == 0)
      throw InvalidInput(
          fmt::format("{} is \"{}\", which this machine does not have", kVariable, name));
    hwy::DisableTargets(wider_than(name));
    return;
  }
  throw InvalidInput(
      fmt::format("{} is \"{}\"; expected auto, portable, avx2, avx512 or neon", kVariable, name));
}

}  // namespace

void internal::choose_vector_instructions() {
  static const bool chosen = [] {
    if (const char* value = std::getenv(kVariable)) restrict_to(*value == '\0' ? "auto" : value);
    return true;
  }();
  static_cast<void>(chosen);
}

std::string_view vector_instructions() {
  internal::choose_vector_instructions();
  const std::int64_t supported = hwy::SupportedTargets();
  for (const auto& [set, targets] : kSets) {
    if ((supported & targets) != 0) return set;
  }
  return kPortable;
}

}  // namespace posemix
