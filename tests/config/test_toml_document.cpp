// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "io/temporary_folder.hpp"
#include "posemix/config/toml_table.hpp"

namespace posemix {
namespace {

TomlDocument parsed(std::string_view text) { return TomlDocument::parse(text, "s.toml"); }

TomlDocument with_override(std::string_view text, std::string_view assignment) {
  TomlDocument document = parsed(text);
  document.apply_override(assignment);
  return document;
}

constexpr const char* kTwoObjects =
    "[[objects]]\nid = 'mug'\nx = 1\n[[objects]]\nid = 'can'\nx = 2\n";

TEST(TomlDocument, RejectsDamagedText) {
  EXPECT_INVALID(parsed(""), "s.toml: got an empty text, expected a TOML document");
  EXPECT_INVALID_WITH(parsed(" \r\n"), "empty text");
  EXPECT_INVALID_WITH(parsed("a = 1\nb = [1, 2\n"), "s.toml:");
  EXPECT_INVALID_WITH(parsed("a = 1\na = 2\n"), "s.toml:2: ");
  EXPECT_INVALID_WITH(parsed(std::string_view("a = 1\n\0\0", 8)), "s.toml:2: ");
  EXPECT_INVALID_WITH(parsed("\x89PNG\r\n\x1a\n"), "s.toml:1: ");
  EXPECT_INVALID_WITH(parsed("a = \"\xff\"\n"), "s.toml:1: ");
  EXPECT_INVALID_WITH(parsed(std::string((1 << 20) + 1, '#')),
                      "expected a TOML document of at most 1048576");
}

TEST(TomlDocument, RejectsWhatTheParserAssumes) {
  EXPECT_INVALID_WITH(parsed("a = 1\n[=]\n"), "s.toml:2: ");
  EXPECT_INVALID_WITH(parsed("\u00e9 = 1\n"), "s.toml:1: ");
  EXPECT_INVALID_WITH(parsed("a = 1 \u00e9\n"), "s.toml:1: ");
  EXPECT_INVALID_WITH(parsed("a = 1979-05-27T-1:32:00Z\n"), "s.toml:1: ");
}

TEST(TomlDocument, RejectsDeepNesting) {
  const auto dotted = [](std::size_t depth) {
    std::string key;
    for (std::size_t i = 0; i < depth; ++i) key += "a.";
    return key + "a";
  };
  EXPECT_INVALID_WITH(parsed(dotted(200000) + " = 1\n"), "got 200000 dots");
  EXPECT_INVALID_WITH(parsed("[" + dotted(2000) + "]\n" + dotted(1999) + " = 1\n"),
                      "more than 32 tables");
  EXPECT_INVALID_WITH(parsed("a = " + std::string(100000, '[')), "s.toml:1: ");
  EXPECT_INVALID_WITH(parsed("1.1.1.1 = 2").root().get_double("x"), "is missing");
  EXPECT_NO_THROW(parsed(dotted(20) + " = 1.5\n"));
  std::string numbers = "a = [1.5";
  for (int i = 0; i < 10000; ++i) numbers += ", 1.5";
  EXPECT_EQ(parsed(numbers + "]").root().get_vector("a").size(), 10001);
}

TEST(TomlDocument, LoadsFiles) {
  const testing::TemporaryFolder folder;
  const auto path = folder.put("s.toml", "a = 1\n");
  const TomlDocument document = TomlDocument::load(path);
  EXPECT_EQ(document.name(), path.string());
  EXPECT_EQ(document.root().get_integer("a"), 1);
  EXPECT_INVALID_WITH(TomlDocument::load(folder / "none.toml"),
                      "none.toml: cannot be read: No such file");
}

TEST(TomlOverride, ReplacesAndCreates) {
  EXPECT_EQ(with_override("a = 1", "a=2.5").root().get_double("a"), 2.5);
  EXPECT_EQ(with_override("a = 1", "b.c.d=[1, 2]")
                .root()
                .get_table("b")
                .get_table("c")
                .get_vector("d", 2)[1],
            2);
  EXPECT_TRUE(with_override("a = 1", "a=true").root().get_bool("a"));
  EXPECT_EQ(with_override("a = 1", "a={x = 3}").root().get_table("a").get_integer("x"), 3);
  EXPECT_EQ(with_override("a = 1", "\"k.l\"=3").root().get_integer("k.l"), 3);
}

TEST(TomlOverride, TextThatIsNoValueIsAString) {
  for (const char* text :
       {"0001", "003_cracker_box_16k", "a/b c.txt", "", "x#y", "[1, 2", "a = b", "${object}/x"}) {
    TomlDocument document = with_override("a = 1\nobject = 'o'", std::string("a=") + text);
    const std::string expected = text == std::string("${object}/x") ? "o/x" : text;
    EXPECT_EQ(document.root().get_string("a"), expected) << text;
  }
  EXPECT_EQ(with_override("a = 1", "a='quoted'").root().get_string("a"), "quoted");
  EXPECT_EQ(with_override("a = 1", "a=1\nb=2").root().get_string("a"), "1\nb=2");
}

TEST(TomlOverride, NumbersMayStandForStrings) {
  EXPECT_EQ(with_override("a = 'x'", "a=1001").root().get_string("a"), "1001");
  EXPECT_EQ(with_override("a = 'x'", "a=1e3").root().get_string("a"), "1e3");
  EXPECT_EQ(with_override("a = 'x'", "a=true").root().get_string("a"), "true");
  EXPECT_EQ(with_override("a = 'x'", "a=2020-01-01").root().get_string("a"), "2020-01-01");
  EXPECT_INVALID(with_override("a = 'x'", "a=[1]").root().get_string("a"),
                 "--set a=[1]: key 'a' is an array, expected a string");
}

TEST(TomlOverride, ElementsOfArrays) {
  const auto x_of = [](const TomlDocument& document, std::size_t index) {
    return document.root().get_tables("objects")[index].get_integer("x");
  };
  EXPECT_EQ(x_of(with_override(kTwoObjects, "objects.1.x=7"), 1), 7);
  EXPECT_EQ(x_of(with_override(kTwoObjects, "objects.can.x=7"), 1), 7);
  EXPECT_EQ(x_of(with_override(kTwoObjects, "objects.mug.x=7"), 0), 7);
  EXPECT_EQ(with_override("v = [1, 2]", "v.1=7").root().get_vector("v")[1], 7);
  EXPECT_INVALID(with_override(kTwoObjects, "objects.2.x=7"),
                 "--set objects.2.x=7: got index 2 in 'objects', expected 0 to 1");
  EXPECT_INVALID(with_override(kTwoObjects, "objects.cup.x=7"),
                 "--set objects.cup.x=7: got 'cup' in 'objects', expected an index or the id of "
                 "one of its tables");
}

TEST(TomlOverride, ErrorsNameTheOverride) {
  EXPECT_INVALID(
      with_override("[n]\nw = 1", "n.w=x").root().get_table("n").get_double("w", kUnitInterval),
      "--set n.w=x: key 'n.w' is the string \"x\", expected a number in [0, 1]");
  EXPECT_INVALID(with_override("a = 1", "a.b=1"), "--set a.b=1: key 'a' is 1, expected a table");
  EXPECT_INVALID(with_override("a = 1", "b.c=1").finish(),
                 "s.toml:1: unknown key 'a', known here: ");
  TomlDocument document = with_override("a = 1", "b.c=1");
  document.root().get_integer("a");
  EXPECT_INVALID(document.finish(), "--set b.c=1: unknown key 'b', known here: a");
  EXPECT_INVALID(document.root().get_table("b").get_double("d"),
                 "--set b.c=1: key 'b.d' is missing, expected a finite number");
}

TEST(TomlOverride, BadAssignments) {
  EXPECT_INVALID(with_override("a = 1", "a"),
                 "--set a: got no '=' after the key, expected key=value");
  EXPECT_INVALID_WITH(with_override("a = 1", ""), "--set : got an empty part of the key");
  EXPECT_INVALID_WITH(with_override("a = 1", "=1"), "got an empty part of the key");
  EXPECT_INVALID_WITH(with_override("a = 1", "a..b=1"), "got an empty part of the key");
  EXPECT_INVALID_WITH(with_override("a = 1", "a b=1"), "got no '=' after the key");
  EXPECT_INVALID_WITH(with_override("a = 1", "\"a=1"), "got a key without its closing quote");
  EXPECT_INVALID_WITH(with_override("a = 1", "a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a=1"),
                      "got 17 parts in the key");
}

TEST(TomlVariables, ReplacedInStrings) {
  TomlDocument document = parsed(
      "object = '003'\nnumber = 7\npath = '${object}/${number}/$x/${object}.txt'\n"
      "list = ['${data}/a']\n");
  document.set_variable("data", "/d");
  EXPECT_EQ(document.root().get_string("path"), "003/7/$x/003.txt");
  EXPECT_EQ(document.root().get_strings("list")[0], "/d/a");
  EXPECT_NO_THROW(document.finish());
}

TEST(TomlVariables, FromOverrides) {
  for (const char* sequence : {"0001", "1001", "'0001'"}) {
    TomlDocument document = parsed("path = 'odom/${sequence}.txt'\n");
    document.apply_override(std::string("sequence=") + sequence);
    const std::string expected =
        sequence == std::string("1001") ? "odom/1001.txt" : "odom/0001.txt";
    EXPECT_EQ(document.root().get_string("path"), expected);
    EXPECT_NO_THROW(document.finish());
  }
}

TEST(TomlVariables, Errors) {
  const auto read = [](std::string_view text) { return parsed(text).root().get_string("p"); };
  EXPECT_INVALID(
      read("p = '${object}'"),
      "s.toml:1: got ${object}, but there is no key 'object' at the top of the document: "
      "give it there or by --set object=...");
  EXPECT_INVALID_WITH(read("object = 'x'\np = '${objct}'"),
                      "--set objct=..., or did you mean ${object}?");
  EXPECT_INVALID(read("p = '${object'"), "s.toml:1: got '${' without '}' in \"${object\"");
  EXPECT_INVALID(read("q = 1.5\np = '${q}'"),
                 "s.toml:1: key 'q' is 1.5, expected a plain string, since it is used as ${q}");
  EXPECT_INVALID_WITH(read("q = '${p}'\np = '${q}'"),
                      "key 'q' is the string \"${p}\", expected a plain string");
  EXPECT_INVALID_WITH(read("p = '${}'"), "got ${}");
}

}  // namespace
}  // namespace posemix
