// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/output_file.hpp"

#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "temporary_folder.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;
using testing::content_of;
using testing::TemporaryFolder;

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

std::string message_of(const fs::path& path) {
  try {
    write_output_file(path, "x");
  } catch (const OutputError& error) {
    return error.what();
  }
  return "(no OutputError)";
}

TEST(OutputFile, AppearsAndIsReplaced) {
  const TemporaryFolder folder;
  write_output_file(folder / "a.json", "one");
  EXPECT_EQ(content_of(folder / "a.json"), "one");
  write_output_file(folder / "a.json", "two, longer");
  EXPECT_EQ(content_of(folder / "a.json"), "two, longer");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(OutputFile, ALinkStays) {
  const TemporaryFolder folder;
  folder.put("target", "old");
  fs::create_symlink("target", folder / "link");
  write_output_file(folder / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(content_of(folder / "target"), "new");
}

TEST(OutputFile, APipeIsWrittenTo) {
  const TemporaryFolder folder;
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string got;
  std::thread reader([&] { got = content_of(pipe); });
  write_output_file(pipe, "through");
  reader.join();
  EXPECT_EQ(got, "through");
  EXPECT_TRUE(fs::is_fifo(pipe));
  write_output_file("/dev/null", "gone");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(OutputFile, WhatCannotBeWritten) {
  const TemporaryFolder folder;
  const std::string none = (folder / "none/a.json").string();
  EXPECT_EQ(message_of(none), none + ": cannot be written: No such file or directory");
  EXPECT_EQ(message_of(folder.path()), folder.path().string() + ": cannot be written: is a folder");
  EXPECT_NE(message_of("").find("cannot be written"), std::string::npos);
  EXPECT_EQ(message_of("/dev/full"), "/dev/full: cannot be written: No space left on device");
  EXPECT_EQ(files_in(folder.path()), 0U);
}

}  // namespace
}  // namespace posemix
