// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/engine/table.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"
#include "study/engine/columns.hpp"

namespace posemix {
namespace {

StudyTable sample() {
  StudyTable table({"name", "value", "count"});
  table.add({"plain", 0.1, std::int64_t{3}});
  // As 0 / 0 is on x86: with a sign.
  table.add({"a, \"b\"", -std::numeric_limits<double>::quiet_NaN(), std::monostate{}});
  return table;
}

TEST(StudyTable, CsvQuotesTextsAndKeepsEveryDigit) {
  EXPECT_EQ(sample().csv(), "name,value,count\nplain,0.1,3\n\"a, \"\"b\"\"\",nan,\n");
}

TEST(StudyTable, TextAlignsColumns) {
  EXPECT_EQ(sample().text(), "name    value  count\nplain     0.1      3\na, \"b\"    nan\n");
}

TEST(StudyTable, JsonHasWhatTheStudyAsksAndFinds) {
  const auto json = nlohmann::ordered_json::parse(
      format_study({"sample", "What is a sample?", {"It is small."}}, sample()));
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["study"], "sample");
  EXPECT_EQ(json["description"], "What is a sample?");
  EXPECT_EQ(json["notes"].dump(), R"(["It is small."])");
  EXPECT_EQ(json["rows"].dump(), R"([{"name":"plain","value":0.1,"count":3},)"
                                 R"({"name":"a, \"b\"","value":null,"count":null}])");
  EXPECT_EQ(json["columns"].size(), 3U);
  EXPECT_FALSE(json.contains("summary"));
}

TEST(StudyTable, ColumnsOfTheSummaryAreDescribedToo) {
  StudyTable summary({"name", "camera_position_rmse_m"});
  const auto json = nlohmann::ordered_json::parse(
      format_study({"sample", "What is a sample?"}, sample(), summary));
  EXPECT_EQ(json["notes"].dump(), "[]");
  EXPECT_EQ(json["columns"]["camera_position_rmse_m"]["unit"], "m");
  EXPECT_EQ(json["columns"].size(), 4U);
}

TEST(Columns, HaveTheUnitOfTheirNameAndWords) {
  const auto expect = [](const char* name, const char* title, const char* unit) {
    EXPECT_EQ(column_text(name).title, title) << name;
    EXPECT_EQ(column_text(name).unit, unit) << name;
  };
  expect("camera_rotation_rmse_deg", "camera rotation error (rms)", "deg");
  expect("mssd_m", "MSSD", "m");
  expect("median_ms_per_run", "median ms per run", "ms");
  expect("kl", "KL divergence", "nats");
  expect("kl_error", "KL divergence, standard error", "nats");
  expect("anees_band_low", "ANEES, 95 % band from", "");
  expect("rotation_standard_error_deg", "rotation, standard error", "deg");
  expect("method", "method", "");
  expect("m", "m", "");
  expect("calibration_error", "calibration error", "");
}

TEST(Columns, NameTheColumnOfTheirStandardError) {
  const std::vector<std::string> columns{"kl",           "kl_error",
                                         "anees",        "anees_standard_error",
                                         "rotation_deg", "rotation_standard_error_deg",
                                         "count",        "mean",
                                         "unit"};
  const auto json = columns_json(columns);
  EXPECT_EQ(json["kl"]["standard_error"], "kl_error");
  EXPECT_EQ(json["anees"]["standard_error"], "anees_standard_error");
  EXPECT_EQ(json["rotation_deg"]["standard_error"], "rotation_standard_error_deg");
  EXPECT_FALSE(json["count"].contains("standard_error"));
  EXPECT_FALSE(json["kl_error"].contains("standard_error"));
  EXPECT_EQ(json["mean"]["unit_column"], "unit");
  EXPECT_FALSE(json["kl"].contains("unit_column"));
}

TEST(StudyTable, RefusesARowOfAnotherLength) {
  StudyTable table({"a", "b"});
  EXPECT_THROW(table.add({1.0}), InvalidInput);
}

}  // namespace
}  // namespace posemix
