// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Everything public is called with numbers that are none, sizes that do not fit, and indices that
// nothing has: each call is refused as invalid input, or does its work. None ends the process.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "attack.hpp"

namespace posemix::arguments {
namespace {

constexpr std::size_t kShares = 8;

using Listed = std::pair<std::string_view, std::string_view>;

/// Functions without a call, and why.
constexpr std::array kNotCalled{
    Listed{"HypothesisRecord::", "has a file of its own, and is not moved"},
    Listed{"OutputFolder::", "is not moved; Faults have it"},
    Listed{"posemix::write_results(", "has an OutputFolder"},
    Listed{"::Evaluator::log_density", "BatchEvaluator and log_density are called"},
    Listed{"posemix::batch::inverse(const UncertainPoses", "has views; Python calls it"},
    Listed{"posemix::batch::compose(const UncertainPoses", "has views; Python calls it"},
    Listed{"posemix::batch::between(const UncertainPoses", "has views; Python calls it"},
    Listed{"jacobian_coefficient_slopes(", "has values of another function"},
    Listed{"TomlTable::get_word(", "has views of words"},
    Listed{"TomlTable::ignore_removed(", "has a list of words"},
    Listed{"ShiftedSobol::next(", "is not copied"},
    Listed{"*const > components, const MergeSettings",
           "has pointers; the other overload is called"},
};

/// Functions that take as long as they are asked to.
constexpr std::array kEndless{
    Listed{"posemix::best_assignments(",
           "all assignments of twelve rows, if so many are asked for"},
    Listed{"posemix::bootstrap_regions(", "any number of starts"},
    Listed{"posemix::fit_tolerance_region(", "any number of starts"},
    Listed{"SlamRun posemix::run(const SlamJob", "any number of passes of smoothing"},
};
/// Functions whose arguments are the caller's to keep in order, and why.
constexpr std::array kNotChecked{
    Listed{"posemix::offset(", "the place of a pose in a vector, as Eigen's blocks"},
    Listed{"PairSelector::", "a part of reduce, which gives it its own indices"},
};
constexpr unsigned kSeconds = 60;
constexpr unsigned kSecondsOfEndless = 2;

bool is_listed(const auto& list, std::string_view signature) {
  return std::any_of(list.begin(), list.end(), [&](const auto& entry) {
    return signature.find(entry.first) != std::string_view::npos;
  });
}

std::string new_folder(std::size_t share) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / fmt::format("arguments_{}", share);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder.string();
}

class Arguments : public testing::TestWithParam<std::size_t> {};

TEST_P(Arguments, BadOnesAreRefused) {
  const std::string folder = new_folder(GetParam());
  for (std::size_t i = GetParam(); i < callees().size(); i += kShares) {
    const Callee& callee = *callees()[i];
    if (is_listed(kNotChecked, callee.signature)) continue;
    const bool is_endless = is_listed(kEndless, callee.signature);
    const Outcome outcome =
        outcome_of(callee, folder, is_endless ? kSecondsOfEndless : kSeconds, is_endless);
    EXPECT_TRUE(outcome.is_called || is_listed(kNotCalled, callee.signature)) << callee.signature;
    for (const std::string& error : outcome.errors)
      ADD_FAILURE() << callee.signature << "\n  " << error;
    if (std::getenv("POSEMIX_ARGUMENTS_SHOW") != nullptr && !outcome.refuses_what_is_fine.empty())
      std::printf("FINE %s: %s\n", std::string(callee.signature).c_str(),
                  outcome.refuses_what_is_fine.c_str());
  }
  std::filesystem::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Share, Arguments, testing::Range<std::size_t>(0, kShares));

}  // namespace
}  // namespace posemix::arguments
