// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "io/json_numbers.hpp"
#include "posemix/results/provenance.hpp"

namespace posemix::internal {

/// The key `provenance`.
/// @throws InvalidInput for settings that are not JSON
Json provenance_json(const Provenance& provenance);

}  // namespace posemix::internal
