// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

namespace posemix::internal {

/// The largest probability of clutter of an observation: one that is surely of no object is none,
/// and a filter would be left without a hypothesis.
inline constexpr double kMostClutter = 1.0 - 1e-9;

}  // namespace posemix::internal
