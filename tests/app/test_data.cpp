// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "data_fixture.hpp"

namespace posemix {
namespace {

using nlohmann::json;
using testing::content_of;
using testing::Data;
using testing::has;
using testing::names_in;
using testing::ProgramResult;
using testing::run_posemix;

TEST_F(Data, ListNamesSourcesLicencesAndWhereHashesAreFrom) {
  const ProgramResult all = run_posemix({"data", "list"});
  EXPECT_EQ(all.exit_code, 0) << all.err;
  for (const char* part :
       {"midway: ", "slam-super-6d: ", "ycbv: ", "tless: ", "CC BY 4.0", "4600 files",
        "28e12183e84bd54cbdfa261daae88d8190862706", "only the files whose hash is known"})
    EXPECT_TRUE(has(all.out, part)) << part << "\n" << all.out;
  const ProgramResult one = run_posemix({"data", "list", "ycbv"});
  EXPECT_TRUE(has(one.out, "published by the host  ycbv_models.zip")) << one.out;
  EXPECT_TRUE(has(one.out, "660 MB  pinned")) << one.out;
  const ProgramResult none = run_posemix({"data", "list", "atlantis"});
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_TRUE(has(none.err, "expected one of midway, slam-super-6d, ycbv, tless")) << none.err;
}

/// Without --out the files go to $POSEMIX_DATA or the cache, where every command looks for them.
TEST_F(Data, ExamplesUseTheFolderThatTheyFetchInto) {
  const std::string guide = content_of(POSEMIX_SOURCE_DIR "/docs/data.md");
  std::vector<std::string> snippets{run_posemix({"data", "--help"}).out,
                                    run_posemix({"data", "sequence", "--help"}).out};
  for (std::size_t at = guide.find("```sh"); at != std::string::npos;) {
    const std::size_t end = guide.find("```", at + 5);
    snippets.push_back(guide.substr(at, end - at));
    at = guide.find("```sh", end + 3);
  }
  EXPECT_EQ(snippets.size(), 5U);
  for (const std::string& text : snippets) {
    EXPECT_TRUE(has(text, "data fetch")) << text;
    const bool uses_folder = has(text, "--data data") || has(text, " data/ycbv ");
    EXPECT_EQ(uses_folder, has(text, "--out data ")) << text;
  }
  // The configuration of 0022 has files of two sources.
  EXPECT_TRUE(has(snippets.back(), "fetch midway ")) << snippets.back();
  EXPECT_TRUE(has(snippets.back(), "fetch slam-super-6d ")) << snippets.back();
}

TEST_F(Data, FetchesShowsTheLicenceAndNotesWhatCame) {
  use("plain", pin());
  const ProgramResult result = fetch();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(has(result.err, "licence: CC0")) << result.err;
  EXPECT_TRUE(has(result.out, "1 checked against pinned SHA-256")) << result.out;
  EXPECT_TRUE(content_of(target()) == content_);
  EXPECT_FALSE(std::filesystem::exists(part()));
  const json entry = lock()["files"]["a b/file.txt"];
  EXPECT_EQ(entry["sha256"], sha256_);
  EXPECT_EQ(entry["size"], content_.size());
  EXPECT_EQ(entry["check"], "pinned");
  EXPECT_EQ(entry["url"], server_.url("plain") + "a%20b/file.txt");
  const std::string before = server_.requests();
  const ProgramResult again = fetch();
  EXPECT_TRUE(has(again.out, "0 files fetched, 1 were there")) << again.out;
  EXPECT_EQ(server_.requests(), before) << "nothing is asked for that is there";
  EXPECT_EQ(lock()["files"]["a b/file.txt"], entry);
}

TEST_F(Data, WithoutAPersonTheLicenceMustBeAcceptedOnTheCommandLine) {
  use("plain", pin());
  const ProgramResult result = fetch({"--quiet"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(has(result.err, "expected --yes")) << result.err;
  EXPECT_EQ(server_.requests(), "");
}

TEST_F(Data, ATruncatedFileIsKeptAndTheNextRunFetchesTheRest) {
  use("truncated", pin());
  const ProgramResult first = fetch();
  EXPECT_EQ(first.exit_code, 5) << first.err;
  EXPECT_TRUE(has(first.err,
                  fmt::format("ended after {} of {} bytes", content_.size() / 2, content_.size())))
      << first.err;
  EXPECT_TRUE(content_of(part()) == content_.substr(0, content_.size() / 2));
  EXPECT_FALSE(std::filesystem::exists(target()));
  const ProgramResult second = fetch();
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_TRUE(content_of(target()) == content_);
  EXPECT_TRUE(has(server_.requests(), fmt::format("bytes={}-", content_.size() / 2)));
}

TEST_F(Data, GoesOnByItselfAfterErrorsThatMayPass) {
  retries_ = "1";
  use("truncated", pin());
  EXPECT_EQ(fetch().exit_code, 0);
  std::filesystem::remove_all(folder_ / "out");
  use("flaky", pin());
  EXPECT_EQ(fetch().exit_code, 0);
  EXPECT_TRUE(content_of(target()) == content_);
}

TEST_F(Data, AServerThatAlwaysBreaksOffIsLeftInTheEnd) {
  use("broken", pin());
  const ProgramResult result = fetch();
  EXPECT_EQ(result.exit_code, 5) << result.err;
  EXPECT_TRUE(content_of(part()) == content_.substr(0, 1000));
}

TEST_F(Data, ATamperedFileIsRemoved) {
  use("tampered", pin());
  const ProgramResult result = fetch();
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_TRUE(has(result.err, "expected " + sha256_)) << result.err;
  EXPECT_TRUE(has(result.err, "nothing of it is kept")) << result.err;
  EXPECT_EQ(names_in(folder_ / "out/test/a b"), std::vector<std::string>{});
}

TEST_F(Data, AFileLongerThanItShouldBeIsRefusedWhileItComes) {
  use("plain", fmt::format(", size = 500, sha256 = \"{}\"", sha256_));
  const ProgramResult result = fetch();
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_TRUE(has(result.err, "got more than 500 bytes")) << result.err;
}

TEST_F(Data, AServerWithoutRangesSendsAllAgain) {
  use("norange", pin());
  folder_.put("out/test/a b/file.txt.part", content_.substr(0, 777));
  const ProgramResult result = fetch();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(content_of(target()) == content_);
}

TEST_F(Data, APartOfAnotherFileIsThrownAway) {
  for (const std::size_t size : {std::size_t{777}, content_.size(), content_.size() + 5}) {
    use("plain", size > content_.size() ? fmt::format(", sha256 = \"{}\"", sha256_) : pin());
    folder_.put("out/test/a b/file.txt.part", std::string(size, 'x'));
    const ProgramResult result = fetch();
    EXPECT_EQ(result.exit_code, 0) << size << result.err;
    EXPECT_TRUE(content_of(target()) == content_);
    std::filesystem::remove(target());
  }
}

TEST_F(Data, FollowsRedirectsButNotToPlainHttpElsewhere) {
  use("moved", pin());
  EXPECT_EQ(fetch().exit_code, 0);
  EXPECT_TRUE(content_of(target()) == content_);
  std::filesystem::remove_all(folder_ / "out");
  use("away", pin());
  const ProgramResult away = fetch();
  EXPECT_TRUE(away.exit_code == 3 || away.exit_code == 5) << away.err;
  EXPECT_FALSE(std::filesystem::exists(target()));
  folder_.put("sources.toml",
              "schema = 1\n[[sources]]\nname = \"test\"\ntitle = \"t\"\n"
              "licence = \"l\"\nbase_url = \"http://files.invalid/\"\n"
              "files = [{path = \"f\"}]\n");
  const ProgramResult plain = fetch();
  EXPECT_EQ(plain.exit_code, 3);
  EXPECT_TRUE(has(plain.err, "expected https (or --allow-http)")) << plain.err;
}

TEST_F(Data, TheServersRefusalAndAServerThatIsNotThere) {
  use("plain/missing", pin());
  const ProgramResult missing = fetch();
  EXPECT_EQ(missing.exit_code, 5);
  EXPECT_TRUE(has(missing.err, "the server answers 404 (not there)")) << missing.err;
  folder_.put("sources.toml",
              "schema = 1\n[[sources]]\nname = \"test\"\ntitle = \"t\"\n"
              "licence = \"l\"\nbase_url = \"http://127.0.0.1:1/\"\n"
              "files = [{path = \"f\"}]\n");
  const ProgramResult none = fetch();
  EXPECT_EQ(none.exit_code, 5);
  EXPECT_TRUE(has(none.err, "http://127.0.0.1:1/f: ")) << none.err;
}

TEST_F(Data, AnInterruptKeepsThePartAndTheNextRunResumes) {
  use("slow", pin());
  std::vector<std::string> command = arguments();
  command.insert(command.begin(), POSEMIX_PROGRAM);
  testing::RunningProgram program(command);
  for (int i = 0; i < 1000; ++i) {
    if (std::filesystem::exists(part()) && std::filesystem::file_size(part()) > 3000) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  program.send(SIGINT);
  const ProgramResult stopped = program.wait();
  EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
  EXPECT_TRUE(has(stopped.err, "the next run resumes")) << stopped.err;
  const auto size = std::filesystem::file_size(part());
  EXPECT_GT(size, 3000U);
  use("plain", pin());
  EXPECT_EQ(fetch().exit_code, 0);
  EXPECT_TRUE(content_of(target()) == content_);
  EXPECT_TRUE(has(server_.requests(), fmt::format("bytes={}-", size))) << server_.requests();
}

TEST_F(Data, ComparesWithTheHashThatTheHostPublishes) {
  use("plain", ", published = true");
  const std::string pointer =
      "version https://git-lfs.github.com/spec/v1\noid sha256:{}\nsize {}\n";
  const ProgramResult missing = fetch();
  EXPECT_EQ(missing.exit_code, 5) << missing.err;
  server_.put("pointers/a b/file.txt", "<html>");
  EXPECT_TRUE(has(fetch().err, "expected a Git LFS pointer"));
  server_.put("pointers/a b/file.txt",
              fmt::format(fmt::runtime(pointer), std::string(64, '0'), content_.size()));
  const ProgramResult other = fetch();
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_TRUE(has(other.err, "the one its host publishes")) << other.err;
  server_.put("pointers/a b/file.txt",
              fmt::format(fmt::runtime(pointer), sha256_, content_.size()));
  const ProgramResult right = fetch();
  EXPECT_EQ(right.exit_code, 0) << right.err;
  EXPECT_TRUE(has(right.out, "1 checked against the SHA-256 that its host publishes")) << right.out;
  EXPECT_EQ(lock()["files"]["a b/file.txt"]["check"], "published");
  std::filesystem::remove(target());
  server_.put("pointers/a b/file.txt",
              fmt::format(fmt::runtime(pointer), std::string(64, '1'), content_.size()));
  EXPECT_TRUE(has(fetch().err, "the host now publishes SHA-256 1111"));
}

TEST_F(Data, WithoutAHashWhatCameFirstIsNotedAndCompared) {
  use("plain", "");
  const ProgramResult first = fetch();
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_TRUE(has(first.out, "not checked: no SHA-256 is known")) << first.out;
  std::filesystem::remove(target());
  use("tampered", "");
  EXPECT_EQ(fetch().exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(target()));
}

}  // namespace
}  // namespace posemix
