// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include <archive.h>
#include <archive_entry.h>
#include <gtest/gtest.h>

#include "data_fixture.hpp"

/// `posemix data` on existing files: verify, unpack, read a registry.
namespace posemix {
namespace {

using testing::content_of;
using testing::Data;
using testing::has;
using testing::ProgramResult;
using testing::run_posemix;

TEST_F(Data, VerifyFindsChangedAndMissingFiles) {
  use("plain", pin());
  ASSERT_EQ(fetch().exit_code, 0);
  const std::string out = (folder_ / "out").string();
  EXPECT_EQ(run_posemix({"data", "verify", out}).exit_code, 0);
  folder_.put("out/test/a b/file.txt", "changed");
  const ProgramResult changed = run_posemix({"data", "verify", out + "/test"});
  EXPECT_EQ(changed.exit_code, 3);
  EXPECT_TRUE(has(changed.out, "a b/file.txt: got 7 bytes of SHA-256")) << changed.out;
  const ProgramResult refetch = fetch();
  EXPECT_EQ(refetch.exit_code, 3);
  EXPECT_TRUE(has(refetch.err, "the file was there before and is another")) << refetch.err;
  EXPECT_EQ(content_of(target()), "changed") << "a user's file stays";
  std::filesystem::remove(target());
  EXPECT_TRUE(has(run_posemix({"data", "verify", out}).out, "a b/file.txt: is not there"));
  EXPECT_EQ(run_posemix({"data", "verify", (folder_ / "nowhere").string()}).exit_code, 3);
}

/// A zip file of one entry.
void write_zip(const std::filesystem::path& path, const std::string& name,
               const std::string& content, const std::string& link = "") {
  archive* zip = archive_write_new();
  archive_write_set_format_zip(zip);
  ASSERT_EQ(archive_write_open_filename(zip, path.c_str()), ARCHIVE_OK);
  archive_entry* entry = archive_entry_new();
  archive_entry_set_pathname(entry, name.c_str());
  archive_entry_set_perm(entry, 0644);
  archive_entry_set_filetype(entry, link.empty() ? AE_IFREG : AE_IFLNK);
  if (!link.empty()) archive_entry_set_symlink(entry, link.c_str());
  archive_entry_set_size(entry, static_cast<la_int64_t>(content.size()));
  archive_write_header(zip, entry);
  archive_write_data(zip, content.data(), content.size());
  archive_entry_free(entry);
  archive_write_free(zip);
}

TEST_F(Data, UnpacksArchivesInsideTheFolderOnly) {
  const auto fetch_zip = [&](const std::string& name, const std::string& link = "") {
    write_zip(folder_ / "a.zip", name, link.empty() ? "hello" : "", link);
    server_.put("a.zip", content_of(folder_ / "a.zip"));
    std::filesystem::remove_all(folder_ / "out");
    folder_.put("sources.toml",
                fmt::format("schema = 1\n[[sources]]\nname = \"test\"\ntitle = \"t\"\n"
                            "licence = \"l\"\nbase_url = \"{}\"\n"
                            "files = [{{path = \"a.zip\", strip = \"top\"}}]\n",
                            server_.url("plain")));
    return fetch({"--yes", "--unpack"});
  };
  EXPECT_EQ(fetch_zip("top/inner/x.txt").exit_code, 0);
  EXPECT_EQ(content_of(folder_ / "out/test/inner/x.txt"), "hello");
  for (const char* evil : {"../x.txt", "top/../../x.txt", "/x.txt"}) {
    const ProgramResult result = fetch_zip(evil);
    EXPECT_EQ(result.exit_code, 3) << evil << result.err;
    EXPECT_TRUE(has(result.err, "expected a path inside the folder")) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/x.txt"));
  }
  const ProgramResult link = fetch_zip("link", "/tmp");
  EXPECT_EQ(link.exit_code, 3);
  EXPECT_TRUE(has(link.err, "no links")) << link.err;
}

/// A tar file of one entry, which is a hole but for its last bytes.
void write_sparse_tar(const std::filesystem::path& path, const std::string& name, la_int64_t size) {
  archive* tar = archive_write_new();
  archive_write_set_format_pax(tar);
  ASSERT_EQ(archive_write_open_filename(tar, path.c_str()), ARCHIVE_OK);
  archive_entry* entry = archive_entry_new();
  archive_entry_set_pathname(entry, name.c_str());
  archive_entry_set_perm(entry, 0644);
  archive_entry_set_filetype(entry, AE_IFREG);
  archive_entry_set_size(entry, size);
  archive_entry_sparse_add_entry(entry, size - 4, 4);
  archive_write_header(tar, entry);
  // The bytes of the hole are left out by the writer.
  const std::string zeros(1U << 20U, '\0');
  for (la_int64_t left = size; left > 0;) {
    const auto more = std::min<la_int64_t>(left, static_cast<la_int64_t>(zeros.size()));
    archive_write_data(tar, zeros.data(), static_cast<std::size_t>(more));
    left -= more;
  }
  archive_entry_free(entry);
  archive_write_free(tar);
}

TEST_F(Data, AnArchiveThatUnpacksToFarMoreThanItsSizeOrTooDeepIsRefused) {
  const auto unpack = [&](const std::string& name, la_int64_t size) {
    write_sparse_tar(folder_ / "a.tar", name, size);
    EXPECT_LT(std::filesystem::file_size(folder_ / "a.tar"), 20000U);
    server_.put("a.tar", content_of(folder_ / "a.tar"));
    std::filesystem::remove_all(folder_ / "out");
    folder_.put("sources.toml",
                fmt::format("schema = 1\n[[sources]]\nname = \"test\"\ntitle = \"t\"\n"
                            "licence = \"l\"\nbase_url = \"{}\"\nfiles = [{{path = \"a.tar\"}}]\n",
                            server_.url("plain")));
    return fetch({"--yes", "--unpack"});
  };
  EXPECT_EQ(unpack("x", 1 << 20).exit_code, 0);
  EXPECT_EQ(std::filesystem::file_size(folder_ / "out/test/x"), 1U << 20U);
  const ProgramResult bomb = unpack("x", la_int64_t{2} << 30);
  EXPECT_EQ(bomb.exit_code, 3) << bomb.err;
  EXPECT_TRUE(has(bomb.err, "more than 100 times its size and 1 GiB")) << bomb.err;
  for (const char* left : {"out/test/x", "out/test/x.part"})
    EXPECT_FALSE(std::filesystem::exists(folder_ / left)) << left;
  std::string deep = "x";
  for (int i = 0; i < 32; ++i) deep.insert(0, "d/");
  const ProgramResult deeper = unpack(deep, 8);
  EXPECT_EQ(deeper.exit_code, 3) << deeper.err;
  EXPECT_TRUE(has(deeper.err, "a path of at most 32 names")) << deeper.err;
  EXPECT_EQ(unpack(deep.substr(2), 8).exit_code, 0);
}

/// It is no bad input.
TEST_F(Data, AFolderThatTheSystemRefusesCannotBeWritten) {
  use("plain", pin());
  std::filesystem::create_symlink(folder_ / "out", folder_ / "out");
  const ProgramResult loop = fetch();
  EXPECT_EQ(loop.exit_code, 4) << loop.err;
  EXPECT_TRUE(has(loop.err, "out/test: cannot be written: ")) << loop.err;
  EXPECT_EQ(run_posemix({"data", "fetch", "test", "--out", ""}).exit_code, 2);
}

TEST_F(Data, ADamagedRegistryIsRefused) {
  const auto error_of = [&](const std::string& files) {
    folder_.put("sources.toml",
                "schema = 1\n[[sources]]\nname = \"test\"\ntitle = \"t\"\n"
                "licence = \"l\"\nbase_url = \"https://files.invalid/\"\n" +
                    files);
    const ProgramResult result = fetch();
    EXPECT_EQ(result.exit_code, 3) << result.err;
    return result.err;
  };
  EXPECT_TRUE(has(error_of("files = [{path = \"../a\"}]\n"), "sources.toml:7: key"));
  EXPECT_TRUE(has(error_of("files = [{path = \"a\", sha256 = \"12\"}]\n"), "64 hexadecimal"));
  EXPECT_TRUE(has(error_of("files = [{path = \"a\", published = true}]\n"), "'published_url'"));
  EXPECT_TRUE(has(error_of("files = [{path = \"a\"}, {path = \"a\"}]\n"), "twice"));
  EXPECT_TRUE(has(error_of(""), "sources[0].files"));
  folder_.put("list.sha256", "12  a\n");
  EXPECT_TRUE(has(error_of("manifest = \"list.sha256\"\n"), "list.sha256:1: got"));
  EXPECT_TRUE(has(error_of("manifest = \"../list\"\n"), "'sources[0].manifest'"));
}

}  // namespace
}  // namespace posemix
