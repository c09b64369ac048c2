// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <functional>
#include <map>
#include <ostream>

#include <gtest/gtest.h>

#include "config/small_recording.hpp"
#include "run_program.hpp"

/// The program on recordings with a damaged input file: an error that names the file, and no
/// output.
namespace posemix {
namespace {

using testing::content_of;
using testing::names_in;
using testing::run_posemix;

struct Damage {
  const char* name;
  std::function<std::string(const std::string&)> apply;
};

std::string binary(const std::string& text) {
  std::string bytes(
      "\x7f"
      "ELF\x02\x01\x01\0\0\xff\xfe",
      11);
  return bytes + text.substr(0, text.size() / 2) + bytes;
}

/// The text with the last number of its second half replaced.
std::string with_nan(std::string text) {
  const std::size_t line = text.find('\n', text.size() / 2) + 1;
  const std::size_t end = std::min(text.find('\n', line), text.size());
  const std::size_t begin = text.find_last_of(" ,", end - 1) + 1;
  return text.replace(begin, end - begin, "nan");
}

/// The text with the first and the last line exchanged.
std::string wrong_order(const std::string& text) {
  const std::size_t first = text.find('\n') + 1;
  const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
  return text.substr(last) + text.substr(first, last - first) + text.substr(0, first);
}

/// The text without the second half of the last line.
std::string cut(const std::string& text) {
  const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
  return text.substr(0, (last + text.size()) / 2);
}

struct Case {
  std::string file;
  Damage damage;
};

/// In the name of the test, in place of its bytes with their addresses.
void PrintTo(const Case& one, std::ostream* out) { *out << one.damage.name << " " << one.file; }

class DamagedFile : public ::testing::TestWithParam<Case> {};

TEST_P(DamagedFile, IsAClearErrorWithoutOutput) {
  const testing::SmallFolder small;
  const testing::TemporaryFolder results;
  const auto& [file, damage] = GetParam();
  const std::filesystem::path path = small.folder / file;
  small.folder.put(file, damage.apply(content_of(path)));
  const auto result =
      run_posemix({"slam", small.toml().string(), "--out", (results / "new/run").string()});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_TRUE(result.err.starts_with("posemix: error: ")) << result.err;
  EXPECT_NE(result.err.find(path.filename().string()), std::string::npos) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(names_in(results.path()), std::vector<std::string>{});
}

std::vector<Case> cases() {
  const std::vector<std::string> all{"odometry.txt",
                                     "truth/0001.txt",
                                     "mug.txt",
                                     "mug_truth.txt",
                                     "can.csv",
                                     "objects.txt",
                                     "box/obj_000006_000004.npy",
                                     "sequence.toml"};
  const std::vector<std::string> numbers{"odometry.txt", "truth/0001.txt", "mug.txt",
                                         "mug_truth.txt"};
  std::vector<Case> result;
  for (const std::string& file : all) {
    result.push_back({file, {"Empty", [](const std::string&) { return std::string(); }}});
    result.push_back({file, {"Binary", binary}});
    result.push_back({file, {"Truncated", cut}});
  }
  for (const std::string& file : numbers) {
    result.push_back({file, {"Nan", with_nan}});
    result.push_back({file, {"WrongOrder", wrong_order}});
  }
  result.push_back({"can.csv", {"Nan", with_nan}});
  result.push_back({"objects.txt", {"Nan", [](const std::string&) {
                                      return std::string("box 0 nan 0 0 0 0 1\n");
                                    }}});
  const Eigen::Matrix4d nan = Eigen::Matrix4d::Constant(std::nan(""));
  result.push_back({"box/obj_000006_000004.npy",
                    {"Nan", [nan](const std::string&) { return testing::npy_bytes(nan, {}); }}});
  return result;
}

std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  std::string name = info.param.damage.name + ("_" + info.param.file);
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, DamagedFile, ::testing::ValuesIn(cases()), case_name);

TEST(MissingFile, IsAClearError) {
  for (const std::string file :
       {"odometry.txt", "truth/0001.txt", "mug.txt", "can.csv", "objects.txt"}) {
    const testing::SmallFolder small;
    const testing::TemporaryFolder results;
    std::filesystem::remove(small.folder / file);
    const auto result =
        run_posemix({"slam", small.toml().string(), "--out", (results / "run").string()});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_NE(result.err.find("which is not there; looked for"), std::string::npos) << result.err;
    EXPECT_EQ(names_in(results.path()), std::vector<std::string>{});
  }
}

TEST(UnreadableFolder, IsAClearError) {
  const testing::SmallFolder small;
  const testing::TemporaryFolder results;
  std::filesystem::remove(small.folder / "mug.txt");
  std::filesystem::create_directory(small.folder / "mug.txt");
  const auto result =
      run_posemix({"slam", small.toml().string(), "--out", (results / "run").string()});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_NE(result.err.find("mug.txt"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace posemix
