// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/small_recording.hpp"
#include "posemix/results/report.hpp"
#include "run_program.hpp"

namespace posemix {
namespace {

using testing::content_of;
using testing::names_in;
using testing::ProgramResult;
using testing::run_posemix;

constexpr const char* kTriangle =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

class ReportCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_report_page()) GTEST_SKIP() << "built without the page (POSEMIX_REPORT)";
    const ProgramResult result = slam({});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }

  ProgramResult slam(std::vector<std::string> more) {
    std::vector<std::string> arguments{"slam", (small_.folder / "sequence.toml").string(), "--out",
                                       run()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_posemix(arguments);
  }

  ProgramResult report(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"report", run()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_posemix(arguments);
  }

  std::string run() const { return (results_ / "a run").string(); }
  std::string page() const { return content_of(results_ / "a run/report.html"); }

  testing::SmallFolder small_;
  testing::TemporaryFolder results_;
};

TEST_F(ReportCommand, WritesThePageAndSaysWhere) {
  const ProgramResult result = report();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "Report: file://" + results_.path().string() + "/a%20run/report.html\n");
  EXPECT_EQ(result.err, "");
  EXPECT_NE(page().find(" 0001: gm-iekf (midway)\",\"program\":"), std::string::npos);
  const ProgramResult quiet = report({"--out", (results_ / "x.html").string(), "--quiet"});
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_EQ(quiet.out, "");
  EXPECT_EQ(content_of(results_ / "x.html"), page());
}

TEST_F(ReportCommand, TitleAndMeshes) {
  const std::string mesh = results_.put("mug.ply", kTriangle).string();
  const ProgramResult result = report(
      {"--mesh", "mug=" + mesh, "--mesh", "box=" + mesh, "--mesh-unit", "mm", "--title", "T&T"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(page().find("\"title\":\"T&T\""), std::string::npos);
  EXPECT_NE(page().find("\"meshes\":{\"box\":{\"vertices\":"), std::string::npos);
}

TEST_F(ReportCommand, MeshesOfOneFlagOrOfSeveral) {
  const std::string mesh = results_.put("mug.ply", kTriangle).string();
  const std::vector<std::string> both{"--mesh", "mug=" + mesh, "box=" + mesh, "--mesh-unit", "mm"};
  EXPECT_EQ(report(both).exit_code, 0);
  const std::string once = page();
  EXPECT_EQ(
      report({"--mesh", "mug=" + mesh, "--mesh", "box=" + mesh, "--mesh-unit", "mm"}).exit_code, 0);
  EXPECT_EQ(once, page());
  std::vector<std::string> before{"report"};
  before.insert(before.end(), both.begin(), both.end());
  before.push_back(run());
  EXPECT_EQ(run_posemix(before).exit_code, 0);
  EXPECT_EQ(once, page());
  EXPECT_NE(once.find("\"meshes\":{\"box\":{\"vertices\":"), std::string::npos);
}

TEST_F(ReportCommand, ComparesRuns) {
  const std::string other = (results_ / "another").string();
  ASSERT_EQ(run_posemix({"slam", (small_.folder / "sequence.toml").string(), "--out", other,
                         "--set", "filter={}", "--quiet"})
                .exit_code,
            0);
  const ProgramResult result = report({other});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "Report: file://" + results_.path().string() + "/comparison.html\n");
  const std::string named = content_of(results_ / "comparison.html");
  EXPECT_NE(named.find("\"kind\":\"comparison\""), std::string::npos);
  EXPECT_LT(named.find("\"name\":\"a run\""), named.find("\"name\":\"another\""));
  const ProgramResult above = run_posemix({"report", results_.path().string()});
  EXPECT_EQ(above.exit_code, 0) << above.err;
  EXPECT_EQ(content_of(results_ / "report.html"), named) << "in the order of their names";
  const ProgramResult mixed = report({(small_.folder.path()).string()});
  EXPECT_EQ(mixed.exit_code, 3);
}

TEST_F(ReportCommand, TakesACameraAndItsImages) {
  results_.put("images/0.5.png", "\x89PNG\r\n\x1a\n a picture");
  const ProgramResult result = report(
      {"--camera", "600.5, 601,320,240,640,480", "--images", (results_ / "images").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(page().find("\"intrinsics\":{\"fx\":600.5,\"fy\":601.0,\"cx\":320.0,\"cy\":240.0,"
                        "\"width\":640,\"height\":480}"),
            std::string::npos);
  EXPECT_NE(page().find("\"images\":[{\"stamp_s\":0.5,\"type\":\"image/png\""), std::string::npos);
  for (const std::string wrong :
       {"600", "a,601,320,240,640,480", "600,601,320,240,640.5,480", "600,601,320,240,640,480,0"}) {
    const ProgramResult refused = report({"--camera", wrong});
    EXPECT_EQ(refused.exit_code, 2) << wrong;
    EXPECT_NE(refused.err.find("expected fx,fy,cx,cy,width,height"), std::string::npos);
  }
}

TEST_F(ReportCommand, Mistakes) {
  const std::string mesh = results_.put("mug.ply", kTriangle).string();
  const auto expect = [&](const std::vector<std::string>& more, int exit_code,
                          const std::string& part) {
    const ProgramResult result = report(more);
    EXPECT_EQ(result.exit_code, exit_code) << part;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  };
  expect({"--mesh", "mug=" + mesh}, 2, "--mesh-unit");
  expect({"--mesh", "mug=" + mesh, "--mesh-unit", "inch"}, 2, "inch");
  expect({"--mesh", "mug", "--mesh-unit", "m"}, 2, "--mesh: got \"mug\", expected ID=FILE.ply");
  expect({"--mesh", "mug=" + mesh, "--mesh", "mug=" + mesh, "--mesh-unit", "m"}, 2,
         "--mesh: got \"mug\" again, expected it once");
  expect({"--mesh", "cup=" + mesh, "--mesh-unit", "m"}, 3, "expected one for box, can, mug");
  expect({"--out", (results_ / "no/x.html").string()}, 4, "no/x.html");
  const std::string trace = content_of(std::filesystem::path(run()) / "trace.json");
  expect({"--out", (std::filesystem::path(run()) / "trace.json").string()}, 3,
         "one that ends in .html");
  EXPECT_EQ(content_of(std::filesystem::path(run()) / "trace.json"), trace);
  const ProgramResult above = run_posemix({"report", results_.path().string()});
  EXPECT_EQ(above.exit_code, 3);
  EXPECT_NE(above.err.find("one of the folders within that have some: " + run()), std::string::npos)
      << above.err;
  const std::vector<std::string> names = names_in(run());
  EXPECT_EQ(std::count(names.begin(), names.end(), "report.html"), 0);
}

TEST_F(ReportCommand, SlamWritesItToo) {
  const ProgramResult result = slam({"--report"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("\nResults: " + run() + "\n"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\nReport:  file://"), std::string::npos) << result.out;
  const std::string by_slam = page();
  EXPECT_EQ(report().exit_code, 0);
  EXPECT_EQ(by_slam, page());
}

/// A program of that name, first on the PATH, which writes its arguments to a file.
class Opener {
 public:
  Opener() : path_(std::getenv("PATH")) {
    const auto program = folder_.put("xdg-open",
                                     "#!/bin/sh\nprintf '%s|' \"$#\" \"$@\" > \"${0%/*}/part\"\n"
                                     "mv \"${0%/*}/part\" \"${0%/*}/arguments\"\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    ::setenv("PATH", (folder_.path().string() + ":" + path_).c_str(), 1);
  }
  ~Opener() { ::setenv("PATH", path_.c_str(), 1); }
  Opener(const Opener&) = delete;
  Opener& operator=(const Opener&) = delete;

  /// Its arguments. It runs in parallel with its caller, so this waits for them.
  std::string arguments() const {
    for (int i = 0; i < 200 && !std::filesystem::exists(folder_ / "arguments"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return content_of(folder_ / "arguments");
  }

 private:
  std::string path_;
  testing::TemporaryFolder folder_;
};

TEST_F(ReportCommand, OpensThePage) {
  const Opener opener;
  const ProgramResult result = report({"--open"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(opener.arguments(), "1|" + run() + "/report.html|");
}

TEST_F(ReportCommand, SaysWhenThePageCannotBeOpened) {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", results_.path().c_str(), 1);
  const ProgramResult result = report({"--open"});
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_NE(result.err.find("is written but cannot be opened: xdg-open: No such file"),
            std::string::npos)
      << result.err;
}

TEST_F(ReportCommand, ArraysWithinArraysWithoutEndAreRefused) {
  const std::string open(200000, '[');
  const std::string deep = open + std::string(open.size(), ']');
  const std::string trace = content_of(results_ / "a run/trace.json");
  // In a folder of a run, as its trace, and alone.
  const std::string alone = results_.put("alone/x.json", deep).parent_path().string();
  results_.put("a run/x.json", "{\"a\":" + deep + "}");
  for (const std::string& where : {run(), alone}) {
    const ProgramResult result = run_posemix({"report", where});
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_NE(result.err.find("x.json: got a value within more than 100 arrays and objects"),
              std::string::npos)
        << result.err;
  }
  std::filesystem::remove(results_ / "a run/x.json");
  results_.put("a run/trace.json", "{\"a\":" + deep + "," + trace.substr(1));
  EXPECT_NE(report().err.find("trace.json: got a value within more than 100"), std::string::npos);
}

}  // namespace
}  // namespace posemix
