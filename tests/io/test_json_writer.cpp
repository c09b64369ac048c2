// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "io/json_writer.hpp"

#include <gtest/gtest.h>

#include "io/unnamed_file.hpp"
#include "temporary_folder.hpp"

namespace posemix {
namespace {

using internal::GrowingTexts;
using internal::Json;
using internal::json_text;
using internal::JsonWriter;

TEST(JsonWriter, WritesTheBytesOfTheDocument) {
  const std::vector<double> numbers{0.1, -1e300, 3.0, 1.0 / 3.0};
  Json document = {{"schema", 1}, {"a \"b\"\n<", nullptr}, {"empty", Json::array()}};
  document["numbers"] = numbers;
  document["inside"] = {{"list", {1, {{"x", true}}, "\xff"}}, {"none", Json::object()}};
  document["last"] = Json::array();
  std::string text;
  JsonWriter out([&](std::string_view piece) { text += piece; });
  out.begin_object();
  out.entry("schema", 1);
  out.entry("a \"b\"\n<", nullptr);
  out.array("empty", 0, [](std::size_t) { return Json(); });
  out.array("numbers", numbers.size(), [&](std::size_t i) { return Json(numbers[i]); });
  out.key("inside");
  out.begin_object();
  out.entry("list", document["inside"]["list"]);
  out.key("none");
  out.begin_object();
  out.end_object();
  out.end_object();
  out.key("last");
  out.begin_array();
  out.raw("");
  out.end_array();
  out.end_object();
  out.flush();
  EXPECT_EQ(text + "\n", json_text(document));
}

TEST(JsonWriter, PassesOnLongTextsInPieces) {
  std::size_t pieces = 0;
  std::string text;
  JsonWriter out([&](std::string_view piece) {
    ++pieces;
    text += piece;
  });
  out.begin_array();
  for (int i = 0; i < 100000; ++i) out.value(i);
  out.end_array();
  out.flush();
  EXPECT_GT(pieces, 5U);
  EXPECT_EQ(Json::parse(text).size(), 100000U);
}

TEST(GrowingTexts, KeepsTextsApart) {
  const testing::TemporaryFolder folder;
  GrowingTexts texts(folder.path(), 3);
  std::vector<std::string> expected(3);
  for (std::size_t i = 0; i < 30000; ++i) {
    const std::size_t text = i % 2;
    const std::string more = std::to_string(i) + ",";
    texts.append(text, more);
    expected[text] += more;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the file has no name";
  for (std::size_t text = 0; text < 3; ++text) {
    std::string got;
    texts.copy(text, [&](std::string_view piece) { got += piece; });
    EXPECT_EQ(got, expected[text]) << text;
  }
}

TEST(GrowingTexts, SaysWhereItCannotWrite) {
  try {
    GrowingTexts texts("/nowhere", 1);
    FAIL() << "no error";
  } catch (const OutputError& error) {
    EXPECT_STREQ(error.what(),
                 "/nowhere: a temporary file cannot be created: No such file or directory");
  }
}

}  // namespace
}  // namespace posemix
