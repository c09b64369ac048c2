// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/engine/table.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

StudyTable sample() {
  StudyTable table({"name", "value", "count"});
  table.add({"plain", 0.1, std::int64_t{3}});
  table.add({"a, \"b\"", std::numeric_limits<double>::quiet_NaN(), std::monostate{}});
  return table;
}

TEST(StudyTable, CsvQuotesTextsAndKeepsEveryDigit) {
  EXPECT_EQ(sample().csv(), "name,value,count\nplain,0.1,3\n\"a, \"\"b\"\"\",nan,\n");
}

TEST(StudyTable, TextAlignsColumns) {
  EXPECT_EQ(sample().text(), "name    value  count\nplain     0.1      3\na, \"b\"    nan\n");
}

TEST(StudyTable, JsonHasSchemaStudyAndRows) {
  const std::string json = format_study("sample", sample());
  EXPECT_EQ(
      json,
      "{\n \"schema\": 1,\n \"study\": \"sample\",\n \"rows\": [\n  {\n   \"name\": \"plain\",\n"
      "   \"value\": 0.1,\n   \"count\": 3\n  },\n  {\n   \"name\": \"a, \\\"b\\\"\",\n"
      "   \"value\": null,\n   \"count\": null\n  }\n ]\n}\n");
}

TEST(StudyTable, RefusesARowOfAnotherLength) {
  StudyTable table({"a", "b"});
  EXPECT_THROW(table.add({1.0}), InvalidInput);
}

}  // namespace
}  // namespace posemix
