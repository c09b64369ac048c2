// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "posemix/results/report.hpp"
#include "report_data.hpp"
#include "small_results.hpp"

/// Pages that compare runs, and what a page has of the camera.
namespace posemix {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using testing::content_of;
using testing::SmallResults;
using testing::TemporaryFolder;

class Comparison : public ::testing::Test {
 protected:
  static const std::map<std::string, std::string>& files(bool joint) {
    static const SmallResults hypotheses({"filter={}"});
    static const SmallResults one;
    return joint ? one.files : hypotheses.files;
  }

  fs::path put(const std::string& name, bool joint) const {
    for (const auto& [file, text] : files(joint)) folder_.put(name + "/" + file, text);
    return folder_ / name;
  }

  /// A run whose trace is another one.
  fs::path put_trace(const std::string& name, const json& trace) const {
    folder_.put(name + "/metrics.json", R"({"objects": {}})");
    folder_.put(name + "/trace.json", trace.dump());
    return folder_ / name;
  }

  static json trace() { return json::parse(files(true).at("trace.json")); }

  TemporaryFolder folder_;
};

/// The frames from `begin` to `end` of all lists over frames.
void cut(json& value, std::size_t begin, std::size_t end) {
  if (value.is_array() && value.size() == testing::kSmallFrames) {
    value = json(std::vector<json>(value.begin() + static_cast<std::ptrdiff_t>(begin),
                                   value.begin() + static_cast<std::ptrdiff_t>(end)));
  } else if (value.is_object()) {
    for (json& inner : value) cut(inner, begin, end);
  }
}

json part(json trace, std::size_t begin, std::size_t end) {
  cut(trace, begin, end);
  trace["frames"] = end - begin;
  return trace;
}

TEST_F(Comparison, HasTheRunsInTheirOrder) {
  const auto a = put("multi", false);
  const auto b = put("gm", true);
  const json report = json::parse(format_comparison({a, b}));
  EXPECT_EQ(report["kind"], "comparison");
  EXPECT_EQ(report["title"], "small 0001: 2 runs");
  ASSERT_EQ(report["runs"].size(), 2U);
  for (const auto& [i, name] : {std::pair{0, "multi"}, {1, "gm"}}) {
    const json& run = report["runs"][static_cast<std::size_t>(i)];
    EXPECT_EQ(run["name"], name);
    EXPECT_EQ(run["documents"]["metrics.json"],
              json::parse(content_of(folder_ / name / "metrics.json")));
    const json alone = json::parse(format_report(folder_ / name));
    EXPECT_EQ(run["trace"], alone["trace"]);
  }
  EXPECT_FALSE(report.contains("trace"));
}

TEST_F(Comparison, OfAFolderWithSeveralRuns) {
  put("a", false);
  put("b", true);
  folder_.put("sequence/odometry.tum", "");
  const json report = json::parse(format_report(folder_.path(), {.title = "Both"}));
  EXPECT_EQ(report["kind"], "comparison");
  EXPECT_EQ(report["title"], "Both");
  EXPECT_EQ(report["runs"][1]["name"], "b");
  folder_.put("study.json", R"({"schema": 1, "study": "noise", "rows": []})");
  EXPECT_EQ(json::parse(format_report(folder_.path()))["kind"], "study");
}

TEST_F(Comparison, RunsMayHaveOtherLengths) {
  const auto all = put_trace("all", trace());
  const auto end = put_trace("end", part(trace(), 5, 20));
  const auto middle = put_trace("middle", part(trace(), 3, 9));
  const json report = json::parse(format_comparison({all, end, middle}));
  EXPECT_EQ(report["runs"][1]["trace"]["frames"], 15);
  EXPECT_EQ(report["runs"][2]["trace"]["frames"], 6);
}

TEST_F(Comparison, RunsMustBeOverOneRecording) {
  const auto all = put_trace("all", trace());
  json later = trace();
  for (json& stamp : later["stamps_s"]) stamp = stamp.get<double>() + 100.0;
  EXPECT_INVALID_WITH(format_comparison({all, put_trace("later", later)}),
                      "without a frame in common, expected runs over the same recording");
  json shifted = trace();
  shifted["stamps_s"][7] = shifted["stamps_s"][7].get<double>() + 0.01;
  EXPECT_INVALID_WITH(format_comparison({all, put_trace("shifted", shifted)}),
                      "got 2 frames that are in one of the runs alone beside 19 in both");
  json others = trace();
  for (const std::string id : {"mug", "box", "can"}) {
    others["objects"]["my " + id] = others["objects"][id];
    others["objects"].erase(id);
  }
  others["order"] = {"my mug", "my box", "my can"};
  EXPECT_INVALID_WITH(format_comparison({all, put_trace("others", others)}),
                      "got runs of other objects, box, can, mug and my box, my can, my mug");
  EXPECT_INVALID_WITH(format_comparison({all}), "got 1 runs, expected at least two");
  folder_.put("empty/x", "");
  EXPECT_INVALID_WITH(format_comparison({all, folder_ / "empty"}), "empty: got a folder without");
  const auto mixture = folder_.put("mixture_mug.json", files(false).at("mixture_mug.json"));
  EXPECT_INVALID_WITH(format_comparison({all, mixture}),
                      "mixture_mug.json: is a file, expected a folder that posemix slam wrote");
}

TEST_F(Comparison, FoldersOfOneNameAreToldApart) {
  put("x/run", true);
  put("y/run", true);
  const json report = json::parse(format_comparison({folder_ / "x/run", folder_ / "y/run/"}));
  EXPECT_EQ(report["runs"][0]["name"], "x/run");
  EXPECT_EQ(report["runs"][1]["name"], "y/run");
}

TEST_F(Comparison, IsWrittenWhereAllRunsAre) {
  if (!has_report_page()) GTEST_SKIP() << "built without the page (POSEMIX_REPORT)";
  const auto a = put("a", true);
  const auto b = put("b", false);
  EXPECT_EQ(write_comparison({a, b}), folder_ / "comparison.html");
  EXPECT_EQ(write_comparison({a, b}, {.out = folder_ / "c.html"}), folder_ / "c.html");
  EXPECT_EQ(content_of(folder_ / "comparison.html"), content_of(folder_ / "c.html"));
  EXPECT_INVALID_WITH(write_comparison({a, put("sub/b", false)}), "runs of several folders");
}

TEST_F(Comparison, AndRunsHaveTheIntrinsicsOfTheCamera) {
  const auto a = put("a", true);
  const auto b = put("b", false);
  const ReportOptions options{.camera = ReportCamera{600.5, 601, 320, 240, 640, 480}};
  const json expected = {{"fx", 600.5}, {"fy", 601.0},  {"cx", 320.0},
                         {"cy", 240.0}, {"width", 640}, {"height", 480}};
  EXPECT_EQ(json::parse(format_report(a, options))["trace"]["intrinsics"], expected);
  const json report = json::parse(format_comparison({a, b}, options));
  EXPECT_EQ(report["runs"][1]["trace"]["intrinsics"], expected);
  EXPECT_INVALID_WITH(format_report(a, {.camera = ReportCamera{0, 1, 1, 1, 640, 480}}),
                      "expected positive focal lengths");
  folder_.put("mixture/mug.json", files(false).at("mixture_mug.json"));
  EXPECT_INVALID_WITH(format_report(folder_ / "mixture", options), "results without a run");
}

const std::string kJpeg("\xff\xd8\xff\xe0 a picture");
const std::string kPng("\x89PNG\r\n\x1a\n another");

TEST_F(Comparison, ImagesHaveTheStampsOfTheirNames) {
  const auto run = put("run", true);
  folder_.put("images/1700000000250000000.png", kPng);
  folder_.put("images/cam0_12.5.jpg", kJpeg);
  folder_.put("images/frame-000003.JPEG", kJpeg);
  folder_.put("images/notes.txt", "no image");
  const json images =
      json::parse(format_report(run, {.images = ReportImages{folder_ / "images"}}))["images"];
  ASSERT_EQ(images.size(), 3U);
  EXPECT_EQ(images[0]["stamp_s"], 3.0);
  EXPECT_EQ(images[1]["stamp_s"], 12.5);
  EXPECT_EQ(images[2]["stamp_s"], 1700000000.25);
  EXPECT_EQ(images[1]["type"], "image/jpeg");
  EXPECT_EQ(images[2]["type"], "image/png");
  EXPECT_EQ(testing::from_base64(images[1]["data"]), kJpeg);
  EXPECT_EQ(testing::from_base64(images[2]["data"]), kPng);
}

TEST_F(Comparison, ImagesHaveTheStampsOfAFile) {
  const auto run = put("run", true);
  folder_.put("images/a.png", kPng);
  folder_.put("images/b, c.jpg", kJpeg);
  const ReportOptions options{.images = ReportImages{folder_ / "images"}};
  EXPECT_INVALID_WITH(format_report(run, options), "a.png: got no stamp, expected a number");
  folder_.put("images/stamps.csv", "name,stamp_s\nb, c.jpg,0.5\na.png, 1.5\n");
  const json images = json::parse(format_report(run, options))["images"];
  ASSERT_EQ(images.size(), 2U);
  EXPECT_EQ(images[0]["stamp_s"], 0.5);
  EXPECT_EQ(images[1]["type"], "image/png");
  folder_.put("images/stamps.csv", "name,stamp_s\na.png,soon\n");
  EXPECT_INVALID_WITH(format_report(run, options), "stamps.csv:2: got \"a.png,soon\"");
  folder_.put("images/stamps.csv", "name,stamp_s\na.png,1\n");
  EXPECT_INVALID_WITH(format_report(run, options), "b, c.jpg: got no stamp, expected one in");
  folder_.put("images/stamps.csv", "a.png,1\n");
  EXPECT_INVALID_WITH(format_report(run, options), "expected the columns name,stamp_s");
}

TEST_F(Comparison, AFolderIsNoImageAndADanglingLinkIsRefused) {
  const auto run = put("run", true);
  folder_.put("images/1.png", kPng);
  folder_.put("images/2.png/inside.txt", "no image");
  const ReportOptions options{.images = ReportImages{folder_ / "images"}};
  const json images = json::parse(format_report(run, options))["images"];
  ASSERT_EQ(images.size(), 1U);
  EXPECT_EQ(images[0]["stamp_s"], 1.0);
  std::filesystem::create_symlink("nowhere.png", folder_ / "images/3.png");
  EXPECT_INVALID_WITH(format_report(run, options), "3.png: cannot be read");
}

TEST_F(Comparison, EveryNthImageIsTakenWhereThereAreTooManyBytes) {
  const auto run = put("run", true);
  for (int i = 0; i < 10; ++i)
    folder_.put("images/" + std::to_string(i) + ".jpg", kJpeg + std::string(1000, 'x'));
  std::vector<std::string> warnings;
  const ReportOptions options{
      .images = ReportImages{folder_ / "images", 4500},
      .warn = [&](const std::string& warning) { warnings.push_back(warning); }};
  const json images = json::parse(format_report(run, options))["images"];
  ASSERT_EQ(images.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(images[i]["stamp_s"], 3.0 * static_cast<double>(i));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("the page has 4 of 10 images, one in 3"), std::string::npos);
}

TEST_F(Comparison, ImagesMustBeThere) {
  const auto run = put("run", true);
  const ReportOptions none{.images = ReportImages{folder_ / "none"}};
  EXPECT_INVALID_WITH(format_report(run, none), "none: cannot be read");
  folder_.put("images/x.txt", "");
  const ReportOptions options{.images = ReportImages{folder_ / "images"}};
  EXPECT_INVALID_WITH(format_report(run, options), "images: got no image");
  folder_.put("images/1.jpg", "text");
  EXPECT_INVALID_WITH(format_report(run, options), "1.jpg: got another content");
}

}  // namespace
}  // namespace posemix
