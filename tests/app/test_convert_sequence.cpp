// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Sequence files as sequence files with observations.
#include <gtest/gtest.h>

#include "config/small_recording.hpp"
#include "posemix/io/tum.hpp"
#include "run_program.hpp"

namespace posemix {
namespace {

using testing::content_of;
using testing::names_in;
using testing::ProgramResult;
using testing::run_posemix;
using testing::SmallFolder;

/// The small recording by the default filter.
class ConvertSequence : public ::testing::Test {
 protected:
  ProgramResult convert(const std::vector<std::string>& options = {}) {
    std::vector<std::string> arguments{"convert", small_.toml().string(),
                                       "--set",   "filter={}",
                                       "--out",   (small_.folder / "made").string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_posemix(arguments);
  }
  std::filesystem::path estimates(const std::filesystem::path& sequence, const std::string& name,
                                  const std::vector<std::string>& options = {}) {
    std::vector<std::string> arguments{"slam", sequence.string(), "--quiet", "--out",
                                       (small_.folder / name).string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = run_posemix(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return small_.folder / name;
  }

  SmallFolder small_;
};

TEST_F(ConvertSequence, GivesTheSameBytes) {
  const ProgramResult result = convert();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(result.out.starts_with("49 observations in 20 frames: ")) << result.out;
  const auto made = small_.folder / "made";
  EXPECT_EQ(names_in(made),
            (std::vector<std::string>{"observations.jsonl", "sequence.toml", "stamps.txt"}));
  const auto before = estimates(small_.toml(), "before", {"--set", "filter={}"});
  const auto after = estimates(made / "sequence.toml", "after");
  for (const char* name :
       {"camera.tum", "object_mug.tum", "object_box.tum", "object_can.tum", "relative_mug.tum",
        "relative_box.tum", "relative_can.tum", "posterior.json", "mixture_mug.json",
        "mixture_box.json", "mixture_can.json"})
    EXPECT_EQ(content_of(before / name), content_of(after / name)) << name;
}

TEST_F(ConvertSequence, ATableHasTwelveDigits) {
  ASSERT_EQ(convert({"--observations", "csv", "--quiet"}).exit_code, 0);
  const auto made = small_.folder / "made";
  EXPECT_TRUE(content_of(made / "observations.csv").starts_with("stamp_s,camera,detector,id,"));
  const auto before = estimates(small_.toml(), "before", {"--set", "filter={}"});
  const auto after = estimates(made / "sequence.toml", "after");
  const auto expected = read_tum(before / "camera.tum");
  const auto found = read_tum(after / "camera.tum");
  ASSERT_EQ(expected.size(), found.size());
  for (std::size_t k = 0; k < expected.size(); ++k)
    EXPECT_TRUE(found[k].pose->is_approx(*expected[k].pose, 1e-9));
}

TEST_F(ConvertSequence, OptionsOfTheOtherKindAreErrors) {
  const ProgramResult side = convert({"--side", "left"});
  EXPECT_EQ(side.exit_code, 2);
  EXPECT_NE(side.err.find("--side: is for mixture files"), std::string::npos) << side.err;
  const ProgramResult set = run_posemix({"convert", "mug.json", "--set", "a=1"});
  EXPECT_NE(set.err.find("--set: is for sequence files"), std::string::npos) << set.err;
  const ProgramResult no_folder = run_posemix({"convert", small_.toml().string()});
  EXPECT_EQ(no_folder.exit_code, 2);
  EXPECT_NE(no_folder.err.find("--out: is required for a sequence file"), std::string::npos)
      << no_folder.err;
  EXPECT_FALSE(std::filesystem::exists(small_.folder / "made"));
}

}  // namespace
}  // namespace posemix
