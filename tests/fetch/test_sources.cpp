// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fetch/checksum.hpp"
#include "fetch/fetch.hpp"
#include "fetch/lock_file.hpp"
#include "fetch/paths.hpp"
#include "fetch/sources.hpp"
#include "io/expect_invalid.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/testing/data.hpp"
#include "posemix/testing/mutate.hpp"

namespace posemix {
namespace {

const std::string kHash(64, 'a');

TEST(Sources, BuiltInOnesNameHttpsAndHaveAHashForEveryFile) {
  const std::vector<DataSource> sources = built_in_sources();
  ASSERT_EQ(sources.size(), 4U);
  for (const DataSource& source : sources) {
    EXPECT_NO_THROW(check_url(source.base_url, false)) << source.name;
    EXPECT_EQ(source.revision.size(), 40U);
    EXPECT_NE(source.base_url.find(source.revision), std::string::npos);
    EXPECT_FALSE(source.licence.empty());
    for (const SourceFile& file : source.files)
      EXPECT_TRUE(is_sha256(file.sha256) || file.published) << file.path;
  }
  EXPECT_EQ(find_source(sources, "midway").files.size(), 4600U);
  EXPECT_EQ(find_source(sources, "slam-super-6d").files.size(), 188U);
  EXPECT_EQ(selected_files(find_source(sources, "ycbv"), {}).size(), 3U);
  EXPECT_EQ(selected_files(find_source(sources, "ycbv"), {"*test*"}).size(), 2U);
  EXPECT_INVALID_WITH(selected_files(sources[0], {"*.zip"}), "\"*.zip\" matches no file");
}

TEST(Sources, HashesAreThoseOfTheFilesOnThisMachine) {
  POSEMIX_REQUIRE_DATA();
  const std::vector<DataSource> sources = built_in_sources();
  for (const char* name : {"midway", "slam-super-6d"}) {
    for (const SourceFile& file : find_source(sources, name).files) {
      const auto content = content_of_file(*testing::data_dir() / name / file.path);
      ASSERT_EQ(content->sha256, file.sha256) << file.path;
    }
  }
}

TEST(Sources, Sha256OfKnownText) {
  const testing::TemporaryFolder folder;
  EXPECT_EQ(content_of_file(folder.put("abc", "abc"))->sha256,
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(content_of_file(folder.put("none", ""))->sha256,
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_INVALID_WITH(content_of_file(folder / "missing"), "missing: cannot be read");
}

TEST(Paths, OnlyThoseThatStayInside) {
  for (const char* good : {"a", "a/b.txt", "..a/b", "a b/c"}) EXPECT_TRUE(is_inner_path(good));
  for (const char* bad : {"", "/a", "a//b", "a/", "./a", "a/../b", "..", "a\\b", "a\nb"})
    EXPECT_FALSE(is_inner_path(bad)) << bad;
  EXPECT_TRUE(matches_pattern("a/b.zip", "*.zip"));
  EXPECT_TRUE(matches_pattern("a/b.zip", "a*b*p"));
  EXPECT_FALSE(matches_pattern("a/b.zip", "b*"));
}

TEST(Paths, APatternStandsForAnyLettersAtItsStars) {
  // By definition, for all names of up to five letters and patterns of up to four.
  const std::function<bool(std::string_view, std::string_view)> matches =
      [&](std::string_view text, std::string_view pattern) {
        if (pattern.empty()) return text.empty();
        if (pattern[0] != '*')
          return !text.empty() && text[0] == pattern[0] &&
                 matches(text.substr(1), pattern.substr(1));
        for (std::size_t n = 0; n <= text.size(); ++n)
          if (matches(text.substr(n), pattern.substr(1))) return true;
        return false;
      };
  const auto words = [](std::string_view letters, std::size_t most) {
    std::vector<std::string> all{""};
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].size() == most) continue;
      for (const char letter : letters) all.push_back(all[i] + letter);
    }
    return all;
  };
  for (const std::string& pattern : words("ab*", 4)) {
    for (const std::string& text : words("ab", 5))
      ASSERT_EQ(matches_pattern(text, pattern), matches(text, pattern)) << text << ' ' << pattern;
  }
}

TEST(Paths, APatternOfManyStarsTakesNoTime) {
  std::string stars;
  for (int k = 0; k < 30; ++k) stars += "*a";
  EXPECT_FALSE(matches_pattern(std::string(1000, 'a'), stars + "*b"));
  EXPECT_TRUE(matches_pattern(std::string(1000, 'a') + "b", stars + "*b"));
}

TEST(Addresses, HttpsOrThisMachine) {
  for (const char* good : {"https://example.org/", "http://localhost/", "http://127.0.0.1:80/a",
                           "http://[::1]:8080/a"})
    EXPECT_NO_THROW(check_url(good, false)) << good;
  for (const char* bad : {"http://example.org/", "http://localhost.example.org/",
                          "http://localhost:80@example.org/", "http://127.0.0.1.example.org/"}) {
    EXPECT_INVALID_WITH(check_url(bad, false), "expected https");
    EXPECT_NO_THROW(check_url(bad, true));
  }
  EXPECT_INVALID_WITH(check_url("file:///etc/passwd", true), "expected https");
  // At a zero byte the address would end, at a line break the request.
  for (const std::string& bad :
       {std::string("https://a.org/\0b", 16), std::string("https://a.org/ b"),
        std::string("http://localhost/\nb"), std::string("https://a.org/\x7f")})
    EXPECT_INVALID_WITH(check_url(bad, true), "control character");
}

LockFile some_lock() {
  LockFile lock{"test", "1", {}};
  lock.files["a/b"] = {"https://example.org/a/b", 3, kHash, HashCheck::pinned, download_time()};
  lock.files["c"] = {"https://example.org/c", 0, kHash, HashCheck::none, download_time()};
  return lock;
}

TEST(LockFiles, ReadBackAndRefuseWhatIsWrong) {
  const std::string text = format_lock_file(some_lock());
  EXPECT_EQ(format_lock_file(parse_lock_file(text, "l")), text);
  const auto error = [&](const std::string& old, const std::string& by) {
    std::string changed = text;
    changed.replace(changed.find(old), old.size(), by);
    return testing::invalid_input_message([&] { parse_lock_file(changed, "l"); });
  };
  EXPECT_EQ(error("\"size\": 3", "\"size\": -3"),
            "l: files: a/b: size: got \"-3\", expected a number of bytes");
  EXPECT_EQ(error("\"a/b\"", "\"../b\""),
            "l: files: got the path \"../b\", expected one below the folder");
  EXPECT_NE(error("\"pinned\"", "\"loose\"").find("expected pinned, published or none"),
            std::string::npos);
  EXPECT_NE(error("\"schema\": 1", "\"schema\": 2").find("l: schema: got"), std::string::npos);
}

TEST(Sources, AManifestHasADashForASumThatIsNotKnown) {
  const std::string text =
      "schema = 1\n[[sources]]\nname = \"a\"\ntitle = \"t\"\nlicence = \"l\"\n"
      "base_url = \"https://example.org/\"\nmanifest = \"m\"\n";
  const auto read = [&](const std::string& manifest) {
    return parse_sources(TomlDocument::parse(text, "r"),
                         [&](const std::string&) { return manifest; })
        .at(0)
        .files;
  };
  const std::vector<SourceFile> files = read("-  a/b\n" + kHash + "  c\n- *-  d\n");
  ASSERT_EQ(files.size(), 3U);
  EXPECT_EQ(files[0].path, "a/b");
  EXPECT_EQ(files[0].sha256, "");
  EXPECT_EQ(files[1].sha256, kHash);
  EXPECT_EQ(files[2].path, "-  d");
  EXPECT_THROW(read("--  a\n"), InvalidInput);
  EXPECT_THROW(read("- \n"), InvalidInput);
}

TEST(Sources, AnAddressHasNoSpacesAndNoControlCharacters) {
  for (const char* url : {"https://a.org/ b", "https://a.org/\\u0000b", "https://a.org\\n"}) {
    const std::string text =
        std::string("schema = 1\n[[sources]]\nname = \"a\"\ntitle = \"t\"\nlicence = \"l\"\n") +
        "base_url = \"" + url + "\"\nmanifest = \"m\"\n";
    EXPECT_INVALID_WITH(
        parse_sources(TomlDocument::parse(text, "r"), [](const std::string&) { return "-  a\n"; }),
        "expected an address https://");
  }
}

TEST(Sources, DamagedFilesAreRefusedOrRead) {
  const std::vector<std::string> locks{format_lock_file(some_lock())};
  const std::vector<std::string> registries{
      "schema = 1\n[[sources]]\nname = \"a\"\ntitle = \"t\"\nlicence = \"l\"\n"
      "base_url = \"https://example.org/\"\nmanifest = \"m\"\nfiles = [{path = \"x\"}]\n"};
  const std::vector<std::string> manifests{kHash + "  a/b\n" + kHash + " *c d\n"};
  const std::vector<std::string> pointers{
      "version https://git-lfs.github.com/spec/v1\noid sha256:" + kHash + "\nsize 12\n"};
  const auto registry = [&](const std::string& text, const std::string& manifest) {
    for (const DataSource& source : parse_sources(TomlDocument::parse(text, "r"),
                                                  [&](const std::string&) { return manifest; }))
      for (const SourceFile& file : source.files)
        if (!is_inner_path(file.path)) throw std::logic_error("a path that leads out");
  };
  const auto sound = [](const testing::FuzzReport& report) {
    EXPECT_TRUE(report.failures.empty()) << report.failures.at(0);
    EXPECT_GT(report.accepted, 20U);
    EXPECT_GT(report.rejected, 20U);
  };
  sound(testing::fuzz(locks, 3000, 1, [](const std::string& t) { parse_lock_file(t, "l"); }));
  sound(
      testing::fuzz(registries, 3000, 2, [&](const std::string& t) { registry(t, manifests[0]); }));
  sound(
      testing::fuzz(manifests, 3000, 3, [&](const std::string& t) { registry(registries[0], t); }));
  sound(testing::fuzz(pointers, 3000, 4, [](const std::string& t) { parse_lfs_pointer(t, "p"); }));
}

}  // namespace
}  // namespace posemix
