// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "io/sha256.hpp"
#include "posemix/results/report.hpp"
#include "small_results.hpp"

/// Which files belong to a run.
namespace posemix {
namespace {

using nlohmann::json;
using testing::SmallResults;
using testing::TemporaryFolder;

const SmallResults& with_hypotheses() {
  static const SmallResults results({"filter={}"});
  return results;
}

const SmallResults& joint() {
  static const SmallResults results;
  return results;
}

struct Reported {
  json data;
  std::vector<std::string> warnings;
};

Reported reported_run(const TemporaryFolder& folder) {
  Reported reported;
  ReportOptions options;
  options.warn = [&](const std::string& warning) { reported.warnings.push_back(warning); };
  reported.data = json::parse(format_report(folder.path(), options));
  return reported;
}

void put_all(const TemporaryFolder& folder, const SmallResults& results) {
  for (const auto& [name, text] : results.files) folder.put(name, text);
}

/// metrics.json as an earlier version wrote it.
json earlier_metrics(const SmallResults& results) {
  json metrics = json::parse(results.files.at("metrics.json"));
  metrics.erase("run");
  metrics.erase("files");
  for (json& object : metrics["objects"]) {
    object["gated"] = object["unexplained"];
    object.erase("unexplained");
  }
  return metrics;
}

TEST(RunFiles, TraceAndMetricsHaveTheIdOfTheRun) {
  const std::string& trace = joint().files.at("trace.json");
  const std::string id = json::parse(trace)["run"];
  EXPECT_EQ(json::parse(joint().files.at("metrics.json"))["run"], id);
  const std::size_t end = trace.find(",\"run\":");
  EXPECT_EQ(trace.substr(end), ",\"run\":\"" + id + "\"}\n");
  EXPECT_EQ(internal::sha256_of(trace.substr(0, end)).substr(0, 32), id);
  EXPECT_EQ(json::parse(SmallResults().files.at("trace.json"))["run"], id);
  EXPECT_NE(json::parse(with_hypotheses().files.at("trace.json"))["run"], id);
}

TEST(RunFiles, MetricsHaveTheDigestsOfFilesThatOnlySomeRunsHave) {
  const json files = json::parse(with_hypotheses().files.at("metrics.json"))["files"];
  EXPECT_EQ(files.size(), 4U);
  for (const auto& [name, digest] : files.items())
    EXPECT_EQ(digest, internal::sha256_of(with_hypotheses().files.at(name))) << name;
  EXPECT_TRUE(files.contains("mixture_mug.json"));
  EXPECT_EQ(json::parse(joint().files.at("metrics.json"))["files"].size(), 1U);
}

TEST(RunFiles, AReportLeavesOutMixturesOfAnotherRun) {
  const TemporaryFolder folder;
  put_all(folder, with_hypotheses());
  put_all(folder, joint());
  const Reported reported = reported_run(folder);
  for (const auto& [name, document] : reported.data["documents"].items())
    EXPECT_FALSE(name.starts_with("mixture_")) << name;
  ASSERT_EQ(reported.warnings.size(), 3U);
  EXPECT_EQ(reported.warnings[0],
            (folder / "mixture_box.json").string() +
                ": is left out, as it is not of the run whose metrics.json is beside it");
}

TEST(RunFiles, AReportKeepsItsOwnMixturesAlone) {
  const TemporaryFolder folder;
  put_all(folder, with_hypotheses());
  EXPECT_EQ(reported_run(folder).warnings, std::vector<std::string>{});
  folder.put("mixture_mug.json", with_hypotheses().files.at("mixture_box.json"));
  const Reported reported = reported_run(folder);
  EXPECT_EQ(reported.warnings.size(), 1U);
  EXPECT_TRUE(reported.data["documents"].contains("mixture_box.json"));
  EXPECT_FALSE(reported.data["documents"].contains("mixture_mug.json"));
}

TEST(RunFiles, OfAnEarlierVersionByTheFilter) {
  const TemporaryFolder folder;
  put_all(folder, with_hypotheses());
  folder.put("metrics.json", earlier_metrics(with_hypotheses()).dump());
  EXPECT_TRUE(reported_run(folder).data["documents"].contains("mixture_mug.json"));
  put_all(folder, joint());
  folder.put("metrics.json", earlier_metrics(joint()).dump());
  const Reported reported = reported_run(folder);
  EXPECT_FALSE(reported.data["documents"].contains("mixture_mug.json"));
}

TEST(RunFiles, AReportOfARunLeavesOutAStudyBesideIt) {
  const TemporaryFolder folder;
  put_all(folder, with_hypotheses());
  folder.put(
      "study.json",
      R"({"study": "divergence", "files": ["study.json", "divergence.csv", "divergence.svg"]})");
  folder.put("divergence.csv", "a\n1\n");
  folder.put("divergence.svg", "<svg/>");
  folder.put("mine.csv", "a\n1\n");
  const Reported reported = reported_run(folder);
  EXPECT_EQ(reported.data.at("kind"), "slam");
  EXPECT_FALSE(reported.data.at("documents").contains("study.json"));
  EXPECT_FALSE(reported.data.at("tables").contains("divergence.csv"));
  EXPECT_FALSE(reported.data.at("pictures").contains("divergence.svg"));
  EXPECT_TRUE(reported.data.at("tables").contains("mine.csv"));
  ASSERT_EQ(reported.warnings.size(), 1U);
  EXPECT_NE(reported.warnings.front().find("study.json: is left out"), std::string::npos);
}

TEST(RunFiles, TraceAndMetricsOfTwoRunsAreAnError) {
  const TemporaryFolder folder;
  put_all(folder, with_hypotheses());
  folder.put("trace.json", joint().files.at("trace.json"));
  EXPECT_INVALID_WITH(format_report(folder.path()), "got trace.json and metrics.json of two runs");
}

TEST(RunFiles, WhatWasGatedIsReadAsUnexplained) {
  const TemporaryFolder folder;
  put_all(folder, with_hypotheses());
  json metrics = earlier_metrics(with_hypotheses());
  metrics["objects"]["mug"]["gated"] = 7;
  folder.put("metrics.json", metrics.dump());
  const Reported reported = reported_run(folder);
  const json& mug = reported.data["documents"]["metrics.json"]["objects"]["mug"];
  EXPECT_EQ(mug["unexplained"], 7);
  EXPECT_FALSE(mug.contains("gated"));
  ASSERT_EQ(reported.warnings.size(), 1U);
  EXPECT_EQ(reported.warnings[0], (folder / "metrics.json").string() +
                                      ": key 'gated' is now 'unexplained'; the old name will be "
                                      "refused in 0.4");
}

using Paths = std::vector<std::filesystem::path>;

std::set<std::filesystem::path> names(const Paths& paths) { return {paths.begin(), paths.end()}; }

TEST(RunFiles, EarlierResultsAreThoseOfItsObjects) {
  const TemporaryFolder folder;
  folder.put("mixture_mug.json", "mine");
  EXPECT_TRUE(earlier_results(folder.path()).empty()) << "there was no run";
  put_all(folder, with_hypotheses());
  for (const char* mine : {"object_cup.tum", "mixture_mine.json", "notes.md", "run/camera.tum"})
    folder.put(mine, "mine");
  folder.put("report.html", "of the run");
  std::set<std::filesystem::path> expected{"report.html"};
  for (const auto& [name, text] : with_hypotheses().files) expected.insert(name);
  EXPECT_EQ(names(earlier_results(folder.path())), expected);
  folder.put("metrics.json", R"({"objects": {"../x": {}, "a/b": {}, "": {}}})");
  folder.put("x.tum", "mine");
  for (const auto& path : earlier_results(folder.path())) EXPECT_EQ(path, path.filename());
  for (const char* damaged : {"", "{", "[]", R"({"objects": 3})"}) {
    folder.put("metrics.json", damaged);
    EXPECT_TRUE(earlier_results(folder.path()).empty()) << damaged;
  }
  EXPECT_TRUE(earlier_results(folder / "none").empty());
}

TEST(RunFiles, EarlierStudiesAndComparisons) {
  const TemporaryFolder folder;
  for (const char* name : {"a.csv", "b.svg", "mine.csv", "consistency.svg"}) folder.put(name, "");
  EXPECT_TRUE(earlier_study(folder.path()).empty());
  folder.put("study.json", R"({"study": "x", "files": ["a.csv", "b.svg", "../c", "gone.csv", 3]})");
  EXPECT_EQ(names(earlier_study(folder.path())),
            (std::set<std::filesystem::path>{"a.csv", "b.svg", "study.json"}));
  EXPECT_TRUE(earlier_consistency(folder.path()).empty());
  folder.put("consistency.json", R"({"type": "posemix.consistency"})");
  EXPECT_EQ(names(earlier_consistency(folder.path())),
            (std::set<std::filesystem::path>{"consistency.json", "consistency.svg"}));
}

TEST(RunFiles, AnotherRunRemovesWhatItDoesNotWrite) {
  const TemporaryFolder folder;
  const auto write = [&](const SmallResults& results) {
    OutputFolder out(folder / "run");
    write_results(out, *results.job, *results.slam, results.metrics);
    out.commit();
  };
  write(with_hypotheses());
  folder.put("run/report.html", "of the first run");
  folder.put("run/notes.md", "mine");
  write(joint());
  std::set<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "run"))
    left.insert(entry.path().filename().string());
  std::set<std::string> expected{"notes.md"};
  for (const auto& [name, text] : joint().files) expected.insert(name);
  EXPECT_EQ(left, expected);
}

}  // namespace
}  // namespace posemix
