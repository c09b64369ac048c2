// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// The real program, disturbed at one call after the other by which it changes files. An undisturbed
// run is the oracle.
#include <cerrno>
#include <iostream>
#include <string>
#include <string_view>
#include <tuple>

#include <gtest/gtest.h>

#include "subjects.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

using testing::Contents;
using testing::FaultyRun;
using testing::Part;
using testing::result_in;
using testing::run_with_fault;
using testing::Subject;
using testing::TemporaryFolder;

/// What happens at a point; `%` stands for its number.
struct Disturbance {
  const char* name;
  const char* fault;
  bool kills;
};

void PrintTo(const Disturbance& disturbance, std::ostream* out) { *out << disturbance.name; }

constexpr Disturbance kDisturbances[] = {
    {"killed_before", "kill {}", true},    {"killed_within_a_write", "torn {}", true},
    {"no_room_once", "fail {} 28", false}, {"fault_of_the_disk", "fail {} 5", false},
    {"full_disk", "full {}", false},       {"read_only", "fail {} 30", false},
    {"over_quota", "fail {} 122", false}};
static_assert(ENOSPC == 28 && EIO == 5 && EROFS == 30 && EDQUOT == 122);

/// The results of an undisturbed run of a command, and of one with other settings before it.
class Undisturbed : public ::testing::Test {
 protected:
  void SetUp() override {
    subject().prepare(inputs_.path());
    const TemporaryFolder folder;
    const FaultyRun whole = run_in(folder, "");
    ASSERT_EQ(whole.result.exit_code, 0) << whole.result.err;
    for (const Part& part : subject().parts) after_.push_back(*result_in(folder.path(), part));
    names_ = testing::names_in(folder.path());
    const FaultyRun earlier =
        run_with_fault(subject().command(inputs_.path(), earlier_.path(), true), "", {});
    ASSERT_EQ(earlier.result.exit_code, 0) << earlier.result.err;
  }

  virtual const Subject& subject() const = 0;

  FaultyRun run_in(const TemporaryFolder& folder, const std::string& fault,
                   bool again = false) const {
    auto words = subject().command(inputs_.path(), folder.path(), false);
    if (again) words.insert(words.end(), subject().again.begin(), subject().again.end());
    return run_with_fault(words, fault, folder.path());
  }

  /// A folder before the run: empty, or with an earlier result.
  void fill(const TemporaryFolder& folder, bool replaces) const {
    if (replaces) fs::copy(earlier_.path(), folder.path(), fs::copy_options::recursive);
  }

  void expect_whole(const TemporaryFolder& folder, const FaultyRun& run) const {
    EXPECT_EQ(run.result.exit_code, 0) << run.result.err;
    for (std::size_t i = 0; i < after_.size(); ++i)
      EXPECT_EQ(result_in(folder.path(), subject().parts[i]), after_[i]) << subject().parts[i].name;
  }

  /// Of folders that are not used any more nothing is left; a single file that was being written
  /// when the program was killed stays, hidden.
  void expect_tidy(const TemporaryFolder& folder) const {
    for (const std::string& name : testing::names_in(folder.path())) {
      EXPECT_TRUE(std::find(names_.begin(), names_.end(), name) != names_.end() ||
                  (name.find(".partial-") != std::string::npos && !fs::is_directory(folder / name)))
          << name;
    }
    for (const Part& part : subject().parts) {
      if (part.key.empty()) continue;
      for (const std::string& name : testing::names_in(folder / part.name))
        EXPECT_FALSE(name.starts_with('.')) << name;
    }
  }

  TemporaryFolder inputs_;
  TemporaryFolder earlier_;
  std::vector<Contents> after_;
  std::vector<std::string> names_;
};

class ShortWrites : public Undisturbed, public ::testing::WithParamInterface<Subject> {
  const Subject& subject() const override { return GetParam(); }
};

TEST_P(ShortWrites, AndInterruptedCallsChangeNothing) {
  for (const bool replaces : {false, true}) {
    const TemporaryFolder folder;
    fill(folder, replaces);
    expect_whole(folder, run_in(folder, "rough"));
    expect_tidy(folder);
  }
}

class Faults : public Undisturbed,
               public ::testing::WithParamInterface<std::tuple<Subject, Disturbance>> {
 protected:
  const Subject& subject() const override { return std::get<0>(GetParam()); }
  const Disturbance& disturbance() const { return std::get<1>(GetParam()); }

  /// What was there before, for every part.
  std::vector<std::optional<Contents>> before_in(const TemporaryFolder& folder) const {
    std::vector<std::optional<Contents>> before;
    for (const Part& part : subject().parts) before.push_back(result_in(folder.path(), part));
    return before;
  }

  void expect_no_mixture(const TemporaryFolder& folder,
                         const std::vector<std::optional<Contents>>& before) const {
    for (std::size_t i = 0; i < after_.size(); ++i) {
      const Part& part = subject().parts[i];
      const auto now = result_in(folder.path(), part);
      const bool none = !now && (disturbance().kills || !before[i]);
      EXPECT_TRUE(none || now == before[i] || now == after_[i])
          << part.name << (now ? " is a part of one, or of two" : " is lost");
    }
  }

  void expect_message(const FaultyRun& run) const {
    const std::string& text = run.result.err;
    if (disturbance().kills) {
      EXPECT_EQ(run.result.exit_code, 128 + SIGKILL);
    } else if (run.result.exit_code != 0) {
      EXPECT_EQ(run.result.exit_code, 4) << text;
      // One line, behind the warnings about what was read.
      ASSERT_TRUE(text.ends_with('\n')) << text;
      const std::string_view all = std::string_view(text).substr(0, text.size() - 1);
      const std::string_view last = all.substr(all.rfind('\n') + 1);
      EXPECT_TRUE(last.starts_with("posemix: error: ")) << text;
      std::size_t line = 0;
      for (std::string_view rest = all.substr(0, all.size() - last.size()); !rest.empty();
           rest.remove_prefix(rest.find('\n') + 1)) {
        EXPECT_TRUE(line++ < subject().lines_first || rest.starts_with("posemix: warning: "))
            << text;
      }
    }
  }

  void visit(std::size_t point, bool replaces) const {
    SCOPED_TRACE(fmt::format("call {}{}", point, replaces ? ", over an earlier result" : ""));
    const TemporaryFolder folder;
    fill(folder, replaces);
    const auto before = before_in(folder);
    const FaultyRun run = run_in(folder, fmt::format(fmt::runtime(disturbance().fault), point));
    if (run.calls.size() < point) return expect_whole(folder, run);
    expect_message(run);
    expect_no_mixture(folder, before);
    if (run.result.exit_code == 0) expect_whole(folder, run);
    expect_whole(folder, run_in(folder, "", true));
    expect_tidy(folder);
  }
};

TEST_P(Faults, LeaveAWholeResultOrNoneAndASecondTryMakesItAsIfNothingHadHappened) {
  for (const bool replaces : {false, true}) {
    const TemporaryFolder folder;
    fill(folder, replaces);
    const FaultyRun counted = run_in(folder, "");
    expect_whole(folder, counted);
    expect_tidy(folder);
    const auto points = testing::points(counted.calls);
    ASSERT_GE(points.size(), 4U);
    for (const std::size_t point : points) {
      visit(point, replaces);
      if (HasFailure()) return;
    }
    std::cout << fmt::format("{} {}{}: {} of {} calls\n", subject().name, disturbance().name,
                             replaces ? ", over an earlier result" : "", points.size(),
                             counted.calls.size());
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShortWrites, ::testing::ValuesIn(testing::subjects()),
                         [](const auto& each) { return std::string(each.param.name); });

INSTANTIATE_TEST_SUITE_P(All, Faults,
                         ::testing::Combine(::testing::ValuesIn(testing::subjects()),
                                            ::testing::ValuesIn(kDisturbances)),
                         [](const auto& each) {
                           return fmt::format("{}_{}", std::get<0>(each.param).name,
                                              std::get<1>(each.param).name);
                         });

}  // namespace
}  // namespace posemix
