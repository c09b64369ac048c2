// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/report.hpp"

#include <cstring>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/expect_invalid.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/io/output_folder.hpp"
#include "report_data.hpp"
#include "small_results.hpp"

namespace posemix {
namespace {

using nlohmann::json;
using testing::content_of;
using testing::TemporaryFolder;

/// A folder with results of slam.
const TemporaryFolder& slam_folder() {
  static const TemporaryFolder folder;
  static const bool written = [] {
    for (const auto& [name, text] : testing::SmallResults({"filter={}"}).files) {
      folder.put(name, text);
    }
    return true;
  }();
  static_cast<void>(written);
  return folder;
}

std::string mixture_text() {
  return format_mixture(
      {{"camera", "mug"}, ConcentratedPoses({{0.0, {SE3d(), 1e-4 * Matrix6d::Identity()}}})});
}

json report_of(const std::filesystem::path& results, const ReportOptions& options = {}) {
  return json::parse(format_report(results, options));
}

TEST(Report, OfARun) {
  const json report = report_of(slam_folder().path());
  EXPECT_EQ(report["schema"], 1);
  EXPECT_EQ(report["type"], "posemix.report");
  EXPECT_EQ(report["kind"], "slam");
  EXPECT_EQ(report["title"], "small 0001: multi-object");
  EXPECT_TRUE(report["program"].get<std::string>().starts_with("posemix 0."));
  EXPECT_EQ(report["documents"]["metrics.json"],
            json::parse(content_of(slam_folder() / "metrics.json")));
  EXPECT_TRUE(report["documents"].contains("mixture_mug.json"));
  EXPECT_FALSE(report["documents"].contains("trace.json"));
  EXPECT_EQ(report["pictures"]["picture.svg"], content_of(slam_folder() / "picture.svg"));
  EXPECT_EQ(report["meshes"], json::object());
  EXPECT_EQ(report["trace"]["frames"], testing::kSmallFrames);
}

TEST(Report, OfMixtures) {
  const TemporaryFolder folder;
  folder.put("a.json", mixture_text());
  folder.put("b.json", mixture_text());
  folder.put("settings.json", "{\"type\": 3}");
  folder.put("notes.md", "of something else");
  const json report = report_of(folder.path());
  EXPECT_EQ(report["kind"], "mixture");
  EXPECT_EQ(report["title"], folder.path().filename().string());
  EXPECT_EQ(report["documents"].size(), 2U);
  EXPECT_EQ(report["documents"]["a.json"], json::parse(mixture_text()));
  EXPECT_EQ(report["texts"], json::object());
  EXPECT_FALSE(report.contains("trace"));
  const json one = report_of(folder / "a.json", {.title = "One"});
  EXPECT_EQ(one["documents"].size(), 1U);
  EXPECT_EQ(one["title"], "One");
}

TEST(Report, OfStudies) {
  const TemporaryFolder folder;
  folder.put("study.json", R"({"schema": 1, "study": "salt-box", "rows": [{"x": 0.1}]})");
  folder.put("stages.csv", "stage,x\n\"a<b\",1\n");
  folder.put("report.md", "# Salt box\n");
  folder.put("report.html", "an older report");
  folder.put("within/other.json", "{");
  json report = report_of(folder.path());
  EXPECT_EQ(report["kind"], "salt_box");
  EXPECT_EQ(report["title"], "Study salt-box");
  EXPECT_EQ(report["tables"]["stages.csv"], "stage,x\n\"a<b\",1\n");
  EXPECT_EQ(report["texts"]["report.md"], "# Salt box\n");
  EXPECT_EQ(report["documents"].size(), 1U);
  folder.put("study.json", R"({"schema": 1, "study": "noise", "rows": []})");
  EXPECT_EQ(report_of(folder.path())["kind"], "study");
  folder.put("study.json", R"({"schema": 1})");
  EXPECT_INVALID_WITH(format_report(folder.path()),
                      "study.json: got no key 'study', expected the study's name");
}

TEST(Report, WithoutResults) {
  const TemporaryFolder folder;
  EXPECT_INVALID(format_report(folder.path()),
                 folder.path().string() +
                     ": got a folder without results, expected what posemix slam, study or "
                     "consistency wrote, or mixture files");
  for (const std::string name : {"riekf", "multi"}) {
    folder.put(name + "/trace.json", "{}");
  }
  EXPECT_INVALID(format_report(folder.path()),
                 folder.path().string() +
                     ": got a folder without results, expected one of the folders within that have "
                     "some: " +
                     (folder / "multi").string() + ", " + (folder / "riekf").string());
  EXPECT_INVALID_WITH(format_report(folder / "multi"), "metrics.json: cannot be read");
  EXPECT_INVALID_WITH(format_report(folder / "none"), "none: cannot be read: No such file");
  folder.put("damaged.json", "{");
  EXPECT_INVALID_WITH(format_report(folder.path()), "damaged.json: got a text that is not JSON");
  folder.put("damaged.json", R"({"type": "posemix.mixture", "schema": 7})");
  EXPECT_INVALID_WITH(format_report(folder.path()), "damaged.json: schema: got 7");
  EXPECT_INVALID_WITH(format_report(folder / "damaged.json"), "damaged.json: schema: got 7");
}

TEST(Report, Meshes) {
  const TemporaryFolder folder;
  const auto ply = folder.put(
      "mug.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n100 0 0\n0 100 50\n3 0 1 2\n");
  const json report = report_of(slam_folder().path(), {.meshes = {{"mug", {ply, 1e-3}}}});
  const std::string vertices = testing::from_base64(report["meshes"]["mug"]["vertices"]);
  const std::string triangles = testing::from_base64(report["meshes"]["mug"]["triangles"]);
  ASSERT_EQ(vertices.size(), 9 * sizeof(float));
  ASSERT_EQ(triangles.size(), 3 * sizeof(std::uint32_t));
  float last[3];
  std::memcpy(last, vertices.data() + 6 * sizeof(float), sizeof last);
  EXPECT_EQ(last[1], 0.1F);
  EXPECT_EQ(last[2], 0.05F);
  EXPECT_EQ(static_cast<int>(triangles[8]), 2);
  EXPECT_INVALID(
      format_report(slam_folder().path(), {.meshes = {{"cup", {ply, 1e-3}}}}),
      ply.string() + ": got a mesh for the object \"cup\", expected one for box, can, mug");
  EXPECT_INVALID_WITH(
      format_report(slam_folder().path(), {.meshes = {{"mug", {folder / "none.ply", 1.0}}}}),
      "none.ply: cannot be read");
}

TEST(Report, ProgressMayStopIt) {
  struct Stop {};
  std::string text = content_of(slam_folder() / "trace.json");
  // Long enough for a word about how far it is.
  text.insert(
      1, "\"more\":[" + std::string(200000, ' ') + [] {
        std::string list = "0";
        for (int i = 0; i < 100000; ++i) list += ",0";
        return list;
      }() + "],");
  const TemporaryFolder folder;
  folder.put("metrics.json", "{}");
  folder.put("trace.json", text);
  std::size_t seen = 0;
  const auto stop = [&](std::size_t done, std::size_t total) {
    EXPECT_EQ(total, text.size());
    EXPECT_LE(done, total);
    seen = done;
    throw Stop();
  };
  EXPECT_THROW(format_report(folder.path(), {.progress = stop}), Stop);
  EXPECT_GT(seen, 200000U);
}

class ReportPage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_report_page()) GTEST_SKIP() << "built without the page (POSEMIX_REPORT)";
  }
};

/// The text of the page's data.
std::string data_of(const std::string& page) {
  const std::string begin = R"(<script type="application/json" id="posemix-report">)";
  const std::size_t at = page.find(begin) + begin.size();
  EXPECT_EQ(page.find(begin, at), std::string::npos);
  return page.substr(at, page.find("</script>", at) - at);
}

TEST_F(ReportPage, HoldsTheData) {
  const TemporaryFolder folder;
  folder.put("mixture.json", mixture_text());
  const std::string title = "</script><b>\"&\xff";
  const auto path = write_report(folder.path(), {.title = title});
  EXPECT_EQ(path, folder / "report.html");
  const std::string page = content_of(path);
  EXPECT_EQ(page.find("@POSEMIX_REPORT@"), std::string::npos);
  const std::string data = data_of(page);
  EXPECT_EQ(data.find('<'), std::string::npos);
  EXPECT_EQ(json::parse(data)["title"], "</script><b>\"&\xEF\xBF\xBD");
  EXPECT_EQ(json::parse(data), report_of(folder.path(), {.title = title}));
}

TEST_F(ReportPage, IsWrittenWhereItIsWanted) {
  const TemporaryFolder folder;
  const auto file = folder.put("mug.json", mixture_text());
  EXPECT_EQ(write_report(file), folder / "mug.html");
  EXPECT_EQ(write_report(file, {.out = folder / "other.html"}), folder / "other.html");
  EXPECT_EQ(content_of(folder / "mug.html"), content_of(folder / "other.html"));
  EXPECT_THROW(write_report(file, {.out = folder / "no/folder.html"}), OutputError);
  EXPECT_INVALID_WITH(write_report(folder / "none"), "none: cannot be read");
}

TEST(Report, WithoutThePage) {
  if (has_report_page()) GTEST_SKIP() << "built with the page";
  try {
    write_report(slam_folder().path());
    FAIL() << "no error";
  } catch (const OutputError& error) {
    EXPECT_NE(std::string(error.what()).find("POSEMIX_REPORT"), std::string::npos);
  }
}

}  // namespace
}  // namespace posemix
