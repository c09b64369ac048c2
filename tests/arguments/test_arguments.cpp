// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Everything public is called with numbers that are none, sizes that do not fit, and indices that
// nothing has: each call is refused as invalid input, or does its work. None ends the process.
#include <gtest/gtest.h>

#include <algorithm>

#include "attack.hpp"
#include "io/temporary_folder.hpp"

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
    Listed{"posemix::fit_error_mixture(", "any number of starts"},
    Listed{"posemix::fit_tolerance_region(", "any number of starts"},
    Listed{"posemix::fit_noise(", "any number of starts"},
    Listed{"posemix::fit_odometry_noise(", "any number of replicates"},
    Listed{"SlamRun posemix::run(const SlamJob", "any number of passes of smoothing"},
    Listed{"SlamRun posemix::run_smoothed(", "any number of passes"},
};
/// Functions whose arguments are the caller's to keep in order, and why.
constexpr std::array kNotChecked{
    Listed{"posemix::offset(", "the place of a pose in a vector, as Eigen's blocks"},
    Listed{"PairSelector::", "a part of reduce, which gives it its own indices"},
};
/// Functions that refuse all that is tried, so that no argument is bad beside others that are fine;
/// and who attacks them.
constexpr std::array kWantsMore{
    Listed{"posemix::parse_", "tests/fuzz has texts for them"},
    Listed{"posemix::read_", "as parse_, which they call"},
    Listed{"posemix::state_info(", "tests/fuzz"},
    Listed{"posemix::slam_of_state(", "tests/fuzz"},
    Listed{"posemix::load_state(", "as slam_of_state"},
    Listed{"posemix::study_with_provenance(", "tests/fuzz"},
    Listed{"posemix::TomlDocument::", "tests/fuzz"},
    Listed{"posemix::TomlTable::", "tests/fuzz"},
    Listed{"posemix::LineReader::", "tests/fuzz"},
    Listed{"_report(const std::filesystem::path", "reads a folder of results; tests/report"},
    Listed{"_comparison(const std::vector", "reads folders of results; tests/report"},
    Listed{"posemix::format_dataset_sequence(", "reads a dataset; tests/io"},
    Listed{"posemix::find_slam_method(", "one word"},
    Listed{"posemix::SlamMethod::smoother(", "of one method; FixedLagSmoother is called"},
    Listed{"posemix::StampedSlam::add_frame(", "names a frame; tests/slam"},
    Listed{"posemix::ParticleSlam::step(", "detections that name no object are fine elsewhere"},
    Listed{"posemix::GaussianSumSlam::step(", "as ParticleSlam"},
    Listed{"posemix::MovingObjects::report(", "into a frame of as many objects"},
    Listed{"posemix::SymmetryGroup::from_stored(", "elements that begin with the identity"},
    Listed{"posemix::MultiObjectSlam::add(", "names are used already"},
    Listed{"posemix::MultiObjectFilter::add_camera(", "only before the first detection"},
    Listed{"posemix::add_noise_modes(", "only of a fit with clutter; tests/detector"},
    Listed{"posemix::MultiObjectFilter::extrinsic(", "only of cameras that were added"},
};
constexpr unsigned kSeconds = 60;
constexpr unsigned kSecondsOfEndless = 2;

bool is_listed(const auto& list, std::string_view signature) {
  return std::any_of(list.begin(), list.end(), [&](const auto& entry) {
    return signature.find(entry.first) != std::string_view::npos;
  });
}

class Arguments : public ::testing::TestWithParam<std::size_t> {};

TEST_P(Arguments, BadOnesAreRefused) {
  const testing::TemporaryFolder folder;
  int called = 0;
  int attacked_no_deeper = 0;
  for (std::size_t i = GetParam(); i < callees().size(); i += kShares) {
    const Callee& callee = *callees()[i];
    if (is_listed(kNotChecked, callee.signature)) continue;
    const bool is_endless = is_listed(kEndless, callee.signature);
    const Outcome outcome =
        outcome_of(callee, folder.path(), is_endless ? kSecondsOfEndless : kSeconds, is_endless);
    EXPECT_TRUE(outcome.is_called || is_listed(kNotCalled, callee.signature)) << callee.signature;
    called += outcome.is_called ? 1 : 0;
    attacked_no_deeper += outcome.refuses_what_is_fine.empty() ? 0 : 1;
    for (const std::string& error : outcome.errors)
      ADD_FAILURE() << callee.signature << "\n  " << error;
    EXPECT_TRUE(outcome.refuses_what_is_fine.empty() || is_listed(kWantsMore, callee.signature))
        << callee.signature << "\n  " << outcome.refuses_what_is_fine;
  }
  RecordProperty("called", called);
  RecordProperty("attacked_no_deeper", attacked_no_deeper);
}

INSTANTIATE_TEST_SUITE_P(Share, Arguments, ::testing::Range<std::size_t>(0, kShares));

}  // namespace
}  // namespace posemix::arguments
