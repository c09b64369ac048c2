// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <chrono>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "posemix/base/random.hpp"
#include "study/engine/study.hpp"

namespace posemix::testing {

/// A study whose items draw from their own random streams and take about a millisecond.
inline Study counting_study(std::size_t items, std::uint64_t seed = 1) {
  Study study;
  study.name = "counting";
  study.settings = fmt::format(R"({{"seed":{},"distribution":{{"sd":0.1}}}})", seed);
  study.items = items;
  study.run_item = [seed](std::size_t item) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    RandomStream stream(seed, item);
    double sum = 0.0;
    for (int i = 0; i < 100; ++i) sum += 0.1 * stream.normal();
    return fmt::format("{} \"{}\"", item, sum);
  };
  study.report = [](std::span<const std::string> results) {
    StudyReport report;
    for (const std::string& result : results) report.summary += result + "\n";
    return report;
  };
  return study;
}

}  // namespace posemix::testing
