// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "app/terminal_text.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "run_program.hpp"

/// What strangers have written never reaches a terminal as more than text.
namespace posemix {
namespace {

using testing::ProgramResult;
using testing::run_posemix;
using testing::TemporaryFolder;

/// Clears the screen, changes the title, writes to the clipboard, and the same by 8-bit codes.
const std::string kHostile = "a\033[2J\033]0;x\007\033]52;c;eA==\007\x9b\x32J\xc2\x9b\x32J\r\b\x7f";

bool is_plain(const std::string& text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); });
}

TEST(TerminalText, KeepsTextAndEscapesWhatIsNone) {
  EXPECT_EQ(terminal_text("tab\tline\nü 日本 😀"), "tab\tline\nü 日本 😀");
  EXPECT_EQ(terminal_text("a\033[2Jb\r\x7f"), "a\\x1b[2Jb\\x0d\\x7f");
  EXPECT_EQ(terminal_text(std::string_view("\0", 1)), "\\x00");
  EXPECT_EQ(terminal_text("\xc2\x9b"), "\\xc2\\x9b") << "a control character of two bytes";
  EXPECT_EQ(terminal_text("\u202e\u2066\u2028"), "\\xe2\\x80\\xae\\xe2\\x81\\xa6\\xe2\\x80\\xa8");
  EXPECT_TRUE(is_plain(terminal_text(kHostile)));
}

TEST(TerminalText, EscapesBytesThatAreNotUtf8) {
  // A single byte, one that is cut off, too long a form, a surrogate, and beyond the last.
  for (const char* bytes :
       {"\x9b", "\xe2\x80", "\xc0\x9b", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xff"})
    EXPECT_TRUE(is_plain(terminal_text(bytes))) << terminal_text(bytes);
}

TEST(TerminalText, ALineIsOne) {
  EXPECT_EQ(terminal_line("a\nposemix: error: b\tc"), "a\\x0aposemix: error: b\\x09c");
}

TEST(TerminalText, MessagesOnFilesOfStrangersAreOneLineOfPlainText) {
  const TemporaryFolder folder;
  const std::string escape = R"(\u001b[2J\u001b]0;x\u0007\nposemix: error: none)";
  const std::string out = (folder / "out").string();
  const auto slam = [&](const std::string& name, const std::string& toml) {
    return run_posemix({"slam", folder.put(name, toml).string(), "--out", out});
  };
  const std::vector<ProgramResult> results{
      slam("key.toml", fmt::format("schema = 1\n\"{}\" = 1\n", escape)),
      slam("value.toml", fmt::format("schema = 1\n[filter]\nmethod = \"{}\"\n", escape)),
      slam("raw.toml", "schema = 1\n\033[2J\n"),
      slam("id.toml", fmt::format("schema = 1\n[[objects]]\nid = \"{}\"\n", escape)),
      slam(kHostile, "schema = 1\nx = \n"),
      run_posemix({"slam", "missing-" + kHostile + ".toml", "--out", out}),
      run_posemix({kHostile}),
      run_posemix({"reduce", folder.put("m.json", fmt::format("{{\"{}\": 1}}", escape)).string()}),
      run_posemix({"reduce", folder.put("n.json", "{\033[2J").string()})};
  for (const ProgramResult& result : results) {
    EXPECT_NE(result.exit_code, 0);
    EXPECT_TRUE(is_plain(result.err)) << terminal_text(result.err);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

TEST(TerminalText, NamesInTablesArePlainText) {
  const TemporaryFolder folder;
  const std::string escape = R"(\u001b[2J)";
  const auto registry = folder.put(
      "sources.toml",
      fmt::format("schema = 1\n[[sources]]\nname = \"test\"\ntitle = \"A {0}\"\nlicence = \"{0}\"\n"
                  "base_url = \"https://example.org/{0}\"\nfiles = [{{path = \"a\"}}]\n",
                  escape));
  const ProgramResult listed = run_posemix({"data", "list", "--registry", registry.string()});
  EXPECT_TRUE(is_plain(listed.out)) << terminal_text(listed.out);
  EXPECT_TRUE(is_plain(listed.err)) << terminal_text(listed.err);
}

}  // namespace
}  // namespace posemix
