// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "items.hpp"

/// The texts of messages between ranks, in the byte order of the machine.
namespace posemix {

std::string ranges_message(std::span<const ItemRange> ranges);
/// @throws std::runtime_error for what ranges_message does not write
std::vector<ItemRange> ranges_in(std::string_view message);

std::string results_message(std::span<const FinishedItem> items, double seconds);
/// @throws std::runtime_error for what results_message does not write
FinishedBatch results_in(std::string_view message);

}  // namespace posemix
