// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>

namespace posemix {

/// The methods that are compared, in the order of the report.
inline constexpr std::array<const char*, 6> kGraspMethods{
    "base_rate", "logistic", "gaussian", "trimmed_gaussian", "mixture", "region_at_true_error"};
inline constexpr std::size_t kFirstConsensus = 2;  ///< gaussian
inline constexpr std::size_t kConsensusMethods = 3;

}  // namespace posemix
