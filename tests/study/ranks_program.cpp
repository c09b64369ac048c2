// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// usage: ranks_program JOURNAL [--resume] [--die-at ITEM]
// A study over all ranks; rank 0 prints the report. With --die-at the rank that works on the item
// leaves without a word.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "counting_study.hpp"
#include "study/engine/run_study.hpp"

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  posemix::StudyRunOptions options{.threads = 1, .journal = arguments.at(0)};
  std::size_t die_at = 1000;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    if (arguments[i] == "--resume") options.resume = true;
    if (arguments[i] == "--die-at") die_at = std::stoul(arguments.at(i + 1));
  }
  posemix::Ranks ranks;
  const auto make = [die_at] {
    posemix::Study study = posemix::testing::counting_study(200);
    study.run_item = [die_at, work = study.run_item](std::size_t item) {
      if (item == die_at) std::_Exit(9);
      return work(item);
    };
    return study;
  };
  try {
    const auto run = posemix::run_study(ranks, make, options);
    if (run && run->complete) std::fputs(run->study.report(run->results).summary.c_str(), stdout);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
