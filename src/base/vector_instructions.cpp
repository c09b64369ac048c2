// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/vector_instructions.hpp"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/vector_targets.hpp"
//
#include "base/c_library.hpp"
#include "base/vector_dispatch.hpp"
#include "posemix/base/error.hpp"

namespace posemix {
namespace {

constexpr const char* kVariable = "POSEMIX_SIMD";

/// From the widest to the narrowest.
constexpr std::array<std::pair<std::string_view, std::int64_t>, 3> kSets{{
    {"avx512", HWY_AVX3},
    {"avx2", HWY_AVX2},
    {"neon", HWY_NEON},
}};
constexpr std::string_view kPortable = "portable";

void restrict_to(std::string_view name) {
  if (name == "auto") return;
  // Highway keeps the baseline, whatever is disabled; a better target of one architecture has a
  // lower bit.
  if (name == kPortable) return hwy::DisableTargets(~std::int64_t{0});
  for (const auto& [set, target] : kSets) {
    if (set != name) continue;
    if ((hwy::SupportedTargets() & target) == 0)
      throw InvalidInput(
          fmt::format("{} is \"{}\", which this machine does not have", kVariable, name));
    return hwy::DisableTargets(target - 1);
  }
  throw InvalidInput(
      fmt::format("{} is \"{}\"; expected auto, portable, avx2, avx512 or neon", kVariable, name));
}

std::string_view name_of(std::int64_t targets) {
  for (const auto& [set, target] : kSets) {
    if ((targets & target) != 0) return set;
  }
  return kPortable;
}

/// Takes the environment into account, once. Highway's SupportedTargets() has the loops use all
/// that the machine has, whatever is disabled, until they are told what it returned.
std::string_view chosen_set() {
  static const std::string_view set = [] {
    if (const char* value = std::getenv(kVariable)) restrict_to(*value == '\0' ? "auto" : value);
    const std::int64_t targets = hwy::SupportedTargets();
    hwy::GetChosenTarget().Update(targets);
    return name_of(targets);
  }();
  return set;
}

}  // namespace

void internal::choose_vector_instructions() { chosen_set(); }

std::string_view vector_instructions() {
  static const std::string text = [] {
    const std::string_view set = chosen_set();
    const bool fused = set != kPortable;
    const bool same = internal::c_library_fuses().value_or(fused) == fused;
    return fmt::format("{}{}", set, same ? "" : fused ? " without FMA" : " with FMA");
  }();
  return text;
}

}  // namespace posemix
