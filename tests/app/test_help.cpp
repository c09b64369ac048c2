// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fstream>
#include <regex>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "posemix/io/text.hpp"
#include "posemix/testing/data.hpp"
#include "run_program.hpp"

/// What the program's help says is so.
namespace posemix {
namespace {

using testing::contains;
using testing::content_of;
using testing::ProgramResult;
using testing::run_posemix;
using testing::TemporaryFolder;

/// The examples of a help text, with their continuation lines, one string each.
std::vector<std::string> examples_of(const std::string& help) {
  std::vector<std::string> examples;
  const std::size_t begin = help.find("Example: ");
  if (begin == std::string::npos) return examples;
  std::istringstream lines(help.substr(begin + 9));
  bool goes_on = false;
  for (std::string line; std::getline(lines, line) && !trimmed(line).empty();) {
    const std::string text(trimmed(line));
    if (goes_on) {
      examples.back().pop_back();
      examples.back() += text;
    } else {
      examples.push_back(text);
    }
    goes_on = text.ends_with('\\');
  }
  return examples;
}

/// Examples run where they need no other files than the configurations and the recordings; the
/// command line of all others is right.
TEST(Help, ExamplesOfEveryCommandWork) {
  const TemporaryFolder folder;
  std::filesystem::create_directory_symlink(POSEMIX_SOURCE_DIR "/configs", folder / "configs");
  std::ofstream(folder / "posemix") << "#!/bin/sh\nexec '" << POSEMIX_PROGRAM << "' \"$@\"\n";
  std::filesystem::permissions(folder / "posemix", std::filesystem::perms::owner_all);
  const auto shell = [&](const std::string& command) {
    const std::string path = folder.path().string();
    testing::RunningProgram program(
        {"/bin/bash", "-o", "pipefail", "-c",
         "cd '" + path + "' && PATH='" + path + "':\"$PATH\" && { " + command + "; } </dev/null"});
    return program.wait();
  };
  constexpr std::string_view kCommands =
      ",slam,live,simulate,study,report,consistency,data,fit,fuse,fuse-views,compose,reduce,sample,"
      "density,"
      "divergence,convert,"
      "grasp,completion,manual,data list,data fetch,data verify,data sequence,study "
      "divergence,study monte-carlo,"
      "study ycbv,study noise,study grasp,study salt-box,study tless,study fuse-views,study "
      "fiducials";
  std::size_t count = 0;
  for (const std::string_view command : split_fields(kCommands, ',')) {
    const ProgramResult help = shell(fmt::format("posemix {} --help", command));
    ASSERT_EQ(help.exit_code, 0) << command << help.err;
    const std::vector<std::string> examples = examples_of(help.out);
    EXPECT_FALSE(examples.empty()) << help.out;
    for (const std::string& example : examples) {
      ++count;
      SCOPED_TRACE(example);
      std::string line = example.substr(example.find("posemix "));  // without mpirun
      if (const std::size_t open = line.find(" --open"); open != std::string::npos)
        line.erase(open, 7);
      // What takes long or a network stops at the folder, after the command line has been read.
      const bool stops = contains(line, "posemix study") || contains(line, "data fetch");
      if (stops && !contains(line, " --out ")) line += " --out DIR";
      if (stops) line = std::regex_replace(line, std::regex("--out \\S+"), "--out /dev/null");
      const ProgramResult result = shell(line);
      EXPECT_NE(result.exit_code, 2) << result.err;
      EXPECT_FALSE(contains(result.err, "unknown key")) << result.err;
      const bool has_files = line.starts_with("posemix slam configs") && testing::data_dir();
      const bool stands_alone = line.starts_with("posemix simulate") ||
                                line.starts_with("posemix data list") || has_files;
      if (stops) {
        EXPECT_EQ(result.exit_code, 4) << result.err;
      }
      if (stands_alone) {
        EXPECT_EQ(result.exit_code, 0) << result.err;
      }
    }
  }
  EXPECT_GT(count, 35U);
}

TEST(Help, ExitCodesAreTheSameInTheHelpAndInTheGuide) {
  const std::string help = run_posemix({"--help"}).out;
  const std::string guide = content_of(POSEMIX_SOURCE_DIR "/docs/formats.md");
  const std::size_t begin = guide.find("## Exit codes");
  const std::string table = guide.substr(begin, guide.find("Every error is", begin) - begin);
  for (const std::string code : {"130", "141", "143"}) {
    EXPECT_TRUE(contains(help, code)) << help;
    EXPECT_TRUE(contains(table, code)) << table;
  }
}

}  // namespace
}  // namespace posemix
