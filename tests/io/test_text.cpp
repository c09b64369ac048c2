// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/text.hpp"

#include <clocale>
#include <locale>

#include <gtest/gtest.h>

#include "expect_invalid.hpp"
#include "posemix/io/rigid.hpp"
#include "temporary_folder.hpp"

namespace posemix {
namespace {

TEST(Text, NumbersAreDecimalAndFinite) {
  EXPECT_EQ(parse_number("1.5"), 1.5);
  EXPECT_EQ(parse_number("+1.5e-3"), 1.5e-3);
  EXPECT_EQ(parse_number("-.5"), -0.5);
  EXPECT_EQ(parse_number("7"), 7.0);
  for (const char* bad :
       {"", "+", "-", "+-1", "++1", "1,5", "1.5x", " 1", "nan", "-inf", "1e999", "0x10", "1e"}) {
    EXPECT_EQ(parse_number(bad), std::nullopt) << bad;
  }
}

class DecimalComma : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(Text, NumbersDoNotDependOnTheLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  EXPECT_EQ(parse_number("1.5"), 1.5);
  EXPECT_EQ(parse_number("1,5"), std::nullopt);
  EXPECT_EQ(format_pose(SE3d(SO3d(), {1.5, 0, 0})), "1.5 0 0 0 0 0 1");
  std::setlocale(LC_ALL, "C");
  std::locale::global(before);
}

TEST(Text, IntegersAreDecimal) {
  EXPECT_EQ(parse_integer("-12"), -12);
  EXPECT_EQ(parse_integer("+000223"), 223);
  for (const char* bad : {"", "1.0", "1e3", "9223372036854775808", "0x1"}) {
    EXPECT_EQ(parse_integer(bad), std::nullopt) << bad;
  }
}

TEST(Text, Splitting) {
  EXPECT_EQ(split_words(" a\t bc  "), (std::vector<std::string_view>{"a", "bc"}));
  EXPECT_TRUE(split_words(" \t").empty());
  EXPECT_EQ(split_fields("a,,b", ','), (std::vector<std::string_view>{"a", "", "b"}));
  EXPECT_EQ(split_fields("", ','), (std::vector<std::string_view>{""}));
  EXPECT_EQ(trimmed("\t a b "), "a b");
  EXPECT_EQ(trimmed(" "), "");
}

TEST(Text, QuotesShowBytes) {
  EXPECT_EQ(in_quotes("ab\x01\xff"), "\"ab\\x01\\xff\"");
  EXPECT_EQ(in_quotes("abcdef", 3), "\"abc...\"");
}

TEST(LineReader, LineEndsAndNumbers) {
  LineReader reader(
      "\xEF\xBB\xBF"
      "a\r\n\n# note\n  # note\nb",
      "f");
  ASSERT_TRUE(reader.next_content());
  EXPECT_EQ(reader.line(), "a");
  EXPECT_EQ(reader.number(), 1U);
  ASSERT_TRUE(reader.next_content());
  EXPECT_EQ(reader.line(), "b");
  EXPECT_EQ(reader.number(), 5U);
  EXPECT_FALSE(reader.next_content());
}

TEST(LineReader, ErrorsSayWhere) {
  LineReader reader("a", "f.txt");
  reader.next();
  EXPECT_INVALID(reader.fail("a", "b"), "f.txt:1: got a, expected b");
  EXPECT_INVALID(reader.number_from("x", "tx"),
                 "f.txt:1: got tx = \"x\", expected a finite number");
  EXPECT_INVALID(reader.index_from("-1", "im_id"),
                 "f.txt:1: got im_id = \"-1\", expected an integer that is not negative");
  EXPECT_INVALID(LineReader(std::string_view("a\nb\0c", 5), "f.txt"),
                 "f.txt:2: got a NUL byte (binary content), expected text");
}

TEST(ReadFile, BytesOrTheReason) {
  const testing::TemporaryFolder folder;
  const std::string bytes("a\0b\r\n", 5);
  EXPECT_EQ(read_file(folder.put("bytes", bytes)), bytes);
  EXPECT_INVALID(read_file(folder / "missing"),
                 (folder / "missing").string() + ": cannot be read: No such file or directory");
  EXPECT_INVALID(read_file(folder.path()),
                 folder.path().string() + ": cannot be read: Is a directory");
}

}  // namespace
}  // namespace posemix
