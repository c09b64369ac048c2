// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/output_file.hpp"

#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

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

TEST(OutputFile, ThreadsThatWriteOneFile) {
  const TemporaryFolder folder;
  const auto content = [](int i) { return std::string(1 << 20, static_cast<char>('a' + i)); };
  std::vector<std::thread> threads;
  threads.reserve(4);
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      for (int k = 0; k < 10; ++k) write_output_file(folder / "a", content(i));
    });
  }
  for (std::thread& thread : threads) thread.join();
  const std::string found = content_of(folder / "a");
  EXPECT_EQ(found, content(found.at(0) - 'a'));
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(OutputFile, PermissionsStay) {
  const TemporaryFolder folder;
  folder.put("secret", "old");
  fs::permissions(folder / "secret", fs::perms::owner_read | fs::perms::owner_write);
  write_output_file(folder / "secret", "new");
  EXPECT_EQ(content_of(folder / "secret"), "new");
  EXPECT_EQ(fs::status(folder / "secret").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST(OutputFile, ALinkInPlaceOfThePartialFileIsNotFollowed) {
  const TemporaryFolder folder;
  folder.put("precious", "kept");
  for (int i = 1; i < 2000; ++i) {
    fs::create_symlink("precious", folder / (".a.partial-" + std::to_string(::getpid()) + "-" +
                                             std::to_string(i)));
  }
  try {
    write_output_file(folder / "a", "new");
    EXPECT_EQ(content_of(folder / "a"), "new");
  } catch (const OutputError&) {
    EXPECT_FALSE(fs::exists(folder / "a"));
  }
  EXPECT_EQ(content_of(folder / "precious"), "kept");
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
