// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/output_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "temporary_folder.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;
using testing::content_of;
using testing::TemporaryFolder;

std::set<std::string> everything_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    names.insert(entry.path().lexically_relative(folder).string());
  }
  return names;
}

template <typename Action>
std::string output_error(Action&& action) {
  try {
    action();
  } catch (const OutputError& error) {
    return error.what();
  }
  return "(no OutputError)";
}

TEST(OutputFolder, AppearsOnCommit) {
  const TemporaryFolder folder;
  OutputFolder out(folder / "results");
  EXPECT_EQ(out.target(), folder / "results");
  out.write("metrics.json", "{}");
  out.write("more/camera.tum", std::string_view("a\0b", 3));
  EXPECT_FALSE(fs::exists(folder / "results"));
  out.commit();
  EXPECT_EQ(everything_in(folder.path()),
            (std::set<std::string>{"results", "results/metrics.json", "results/more",
                                   "results/more/camera.tum"}));
  EXPECT_EQ(content_of(folder / "results/more/camera.tum"), std::string("a\0b", 3));
}

TEST(OutputFolder, LeavesNothingWithoutCommit) {
  const TemporaryFolder folder;
  {
    OutputFolder out(folder / "a/b/results/");
    out.write("metrics.json", "{}");
    EXPECT_TRUE(fs::exists(folder / "a/b"));
  }
  EXPECT_EQ(everything_in(folder.path()), std::set<std::string>{});
}

TEST(OutputFolder, CreatesParents) {
  const TemporaryFolder folder;
  OutputFolder out(folder / "a/b/results");
  out.write("x", "1");
  out.commit();
  EXPECT_EQ(content_of(folder / "a/b/results/x"), "1");
}

TEST(OutputFolder, ReplacesAnEmptyFolder) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "results");
  OutputFolder out(folder / "results");
  out.write("x", "1");
  out.commit();
  EXPECT_EQ(everything_in(folder.path()), (std::set<std::string>{"results", "results/x"}));
}

TEST(OutputFolder, ReplacesFilesAndKeepsOthers) {
  const TemporaryFolder folder;
  folder.put("results/x", "old");
  folder.put("results/mine", "kept");
  {
    OutputFolder out(folder / "results");
    out.write("x", "lost");
  }
  EXPECT_EQ(content_of(folder / "results/x"), "old");
  OutputFolder out(folder / "results");
  out.write("x", "new");
  out.write("sub/y", "1");
  out.commit();
  EXPECT_EQ(content_of(folder / "results/x"), "new");
  EXPECT_EQ(content_of(folder / "results/mine"), "kept");
  EXPECT_EQ(everything_in(folder.path()),
            (std::set<std::string>{"results", "results/x", "results/mine", "results/sub",
                                   "results/sub/y"}));
}

TEST(OutputFolder, RemovesEarlierFilesThatAreNotWrittenAnew) {
  const TemporaryFolder folder;
  for (const char* name : {"results/x", "results/old", "results/mine", "results/sub/old"})
    folder.put(name, "old");
  folder.put("elsewhere", "kept");
  fs::create_symlink(folder / "elsewhere", folder / "results/link");
  {
    OutputFolder out(folder / "results");
    out.write("x", "lost");
    out.remove_earlier({"x", "old"});
  }
  EXPECT_EQ(content_of(folder / "results/old"), "old") << "without commit nothing changes";
  OutputFolder out(folder / "results");
  out.write("x", "new");
  out.remove_earlier({"x", "old", "sub", "link", "not there"});
  out.commit();
  EXPECT_EQ(content_of(folder / "results/x"), "new");
  EXPECT_EQ(content_of(folder / "elsewhere"), "kept") << "a link goes, not its target";
  EXPECT_EQ(everything_in(folder / "results"),
            (std::set<std::string>{"x", "mine", "sub", "sub/old"}));
  OutputFolder again(folder / "results");
  EXPECT_NE(output_error([&] {
              again.remove_earlier({"../elsewhere"});
            }).find("not a file name within the folder"),
            std::string::npos);
}

TEST(OutputFolder, WritesInPieces) {
  const TemporaryFolder folder;
  OutputFolder out(folder / "results");
  out.write("x", [](const TextSink& sink) {
    for (int i = 0; i < 3; ++i) sink(std::to_string(i));
  });
  out.commit();
  EXPECT_EQ(content_of(folder / "results/x"), "012");
}

TEST(OutputFolder, FollowsALink) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "real");
  fs::create_directory_symlink(folder / "real", folder / "link");
  OutputFolder out(folder / "link");
  out.write("x", "1");
  out.commit();
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(content_of(folder / "real/x"), "1");
}

TEST(OutputFolder, WritesInsideAMountPoint) {
  const fs::path mount = "/dev/shm";
  struct stat of_mount {};
  struct stat of_parent {};
  if (::stat(mount.c_str(), &of_mount) != 0 || ::stat("/dev", &of_parent) != 0 ||
      of_mount.st_dev == of_parent.st_dev || ::access(mount.c_str(), W_OK) != 0) {
    GTEST_SKIP() << "no mount point to write into";
  }
  const std::string name = "posemix-test-" + std::to_string(::getpid());
  OutputFolder out(mount);
  out.write(name, "1");
  EXPECT_FALSE(fs::exists(mount / name));
  out.commit();
  EXPECT_EQ(content_of(mount / name), "1");
  fs::remove(mount / name);
  EXPECT_FALSE(fs::exists(mount / (".shm.partial-" + std::to_string(::getpid()))));
}

TEST(OutputFolder, TwoAtOnce) {
  const TemporaryFolder folder;
  OutputFolder first(folder / "results");
  OutputFolder second(folder / "results");
  first.write("x", "1");
  second.write("x", "2");
  first.commit();
  second.commit();
  EXPECT_EQ(everything_in(folder.path()), (std::set<std::string>{"results", "results/x"}));
  EXPECT_EQ(content_of(folder / "results/x"), "2");
}

TEST(OutputFolder, ErrorsNamePathAndReason) {
  const TemporaryFolder folder;
  const std::string file = folder.put("file", "x").string();
  EXPECT_EQ(output_error([&] { OutputFolder out(file); }),
            file + ": cannot be written: not a folder");
  EXPECT_EQ(output_error([&] { OutputFolder out(file + "/results"); }),
            file + "/results: cannot be created: Not a directory");
  EXPECT_EQ(output_error([&] { OutputFolder out(file + "/a/results"); }),
            file + "/a: cannot be created: Not a directory");
  EXPECT_EQ(output_error([] { OutputFolder out(""); }), ": cannot be written: not a folder name");
  EXPECT_EQ(output_error([] { OutputFolder out("/"); }), "/: cannot be written: not a folder name");
  EXPECT_EQ(output_error([] {
              OutputFolder out("/proc/results");
            }).rfind("/proc/results: cannot be created: ", 0),
            0U);
  EXPECT_EQ(everything_in(folder.path()), std::set<std::string>{"file"});
}

TEST(OutputFolder, NamesStayInside) {
  const TemporaryFolder folder;
  OutputFolder out(folder / "results");
  for (const char* name : {"", "../x", "a/../../x", "/etc/x", "a/", "."}) {
    EXPECT_NE(output_error([&] { out.write(name, "x"); }).find("not a file name within the folder"),
              std::string::npos)
        << name;
  }
  out.write("x", "1");
  EXPECT_NE(output_error([&] { out.write("x", "2"); }).find("File exists"), std::string::npos);
  EXPECT_NE(output_error([&] { out.write("x/y", "2"); }).find("Not a directory"),
            std::string::npos);
}

TEST(OutputFolder, ClosedAfterCommit) {
  const TemporaryFolder folder;
  OutputFolder out(folder / "results");
  out.commit();
  EXPECT_NE(output_error([&] { out.write("x", "1"); }).find("already in place"), std::string::npos);
  EXPECT_NE(output_error([&] { out.commit(); }).find("already in place"), std::string::npos);
}

TEST(OutputFolder, AFolderInTheWayChangesNothing) {
  const TemporaryFolder folder;
  folder.put("results/a", "old");
  folder.put("results/b/c", "old");
  {
    OutputFolder out(folder / "results");
    out.write("a", "new");
    out.write("b", "new");
    EXPECT_EQ(output_error([&] { out.commit(); }),
              (folder / "results/b").string() + ": cannot be replaced: is a folder");
  }
  EXPECT_EQ(content_of(folder / "results/a"), "old");
  EXPECT_EQ(everything_in(folder.path()),
            (std::set<std::string>{"results", "results/a", "results/b", "results/b/c"}));
}

TEST(OutputFolder, AFileThatCannotBeReplacedPutsAllBack) {
  const TemporaryFolder folder;
  for (const char* name : {"results/key", "results/a", "results/old"}) folder.put(name, "old");
  {
    OutputFolder out(folder / "results");
    for (const char* name : {"key", "a", "b", "c"}) out.write(name, "new");
    out.put_last("key");
    out.remove_earlier({"key", "a", "old"});
    // Somebody removes a file that is to be moved.
    fs::remove(out.scratch() / "c");
    EXPECT_EQ(output_error([&] { out.commit(); }),
              (folder / "results/c").string() + ": cannot be replaced: No such file or directory");
  }
  EXPECT_EQ(everything_in(folder.path()),
            (std::set<std::string>{"results", "results/key", "results/a", "results/old"}));
  for (const char* name : {"results/key", "results/a", "results/old"})
    EXPECT_EQ(content_of(folder / name), "old") << name;
}

TEST(OutputFolder, WhatADeadProcessLeftBehindIsRemovedAndNothingElse) {
  const TemporaryFolder folder;
  const pid_t dead = ::fork();
  if (dead == 0) ::_exit(0);
  ::waitpid(dead, nullptr, 0);
  const std::string left = ".results.partial-" + std::to_string(dead);
  const std::set<std::string> others{".results.partial-1", ".results.partial-mine", left + "-x",
                                     ".other.partial-" + std::to_string(dead)};
  for (const std::string& name : {left, left + "-3"}) folder.put(name + "/big", "x");
  for (const std::string& name : others) fs::create_directory(folder / name);
  folder.put(left + "-4", "a file");
  { const OutputFolder out(folder / "results"); }
  std::set<std::string> expected = others;
  expected.insert(left + "-4");
  EXPECT_EQ(everything_in(folder.path()), expected);
}

TEST(OutputFolder, WhatIsLockedIsInUseThoughItsProcessIsNotOfThisMachine) {
  const TemporaryFolder folder;
  const pid_t dead = ::fork();
  if (dead == 0) ::_exit(0);
  ::waitpid(dead, nullptr, 0);
  const fs::path used = folder / (".results.partial-" + std::to_string(dead));
  fs::create_directory(used);
  const int lock = ::open(used.c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(::flock(lock, LOCK_EX), 0);
  { const OutputFolder out(folder / "results"); }
  EXPECT_TRUE(fs::exists(used));
  ::close(lock);
}

}  // namespace
}  // namespace posemix
