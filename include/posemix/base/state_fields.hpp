// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

namespace posemix::internal {

/// The members of a class as a saved state has them (docs/state.md). It is specialised in private
/// headers for every class that is a part of one, which makes it a friend.
template <class T>
struct StateFields;

}  // namespace posemix::internal
