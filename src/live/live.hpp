// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "recording.hpp"
#include "settings.hpp"

/// `posemix live`: object SLAM in the graph of ROS 2, without ROS.
namespace posemix::internal {

struct LiveOptions {
  std::function<bool()> stop;                    ///< asked ten times a second at least
  std::function<void(const std::string&)> log;   ///< what is wrong
  std::function<void(const std::string&)> tell;  ///< what goes on
  bool records = false;                          ///< keeps images for results
};

/// Takes and publishes messages until it shall stop; the result is empty where nothing came, or
/// nothing is recorded.
/// @throws InvalidInput, GraphError
std::optional<LiveResult> run_live(const LiveSettings& settings, const LiveOptions& options);

}  // namespace posemix::internal
