// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "mixture_folder.hpp"
#include "posemix/io/text.hpp"

/// Numbers that are allowed and far from any that are measured.
namespace posemix {
namespace {

using testing::contains;
using testing::ProgramResult;
using Json = nlohmann::json;

class ExtremeMixtures : public testing::MixtureFolder {
 protected:
  /// A projected Gaussian whose mean is u from the tangent point.
  void put_far(const std::string& name, double u, double variance = 1.0) const {
    Matrix6d covariance = 1e-4 * Matrix6d::Identity();
    covariance.topLeftCorner<3, 3>() = variance * Eigen::Matrix3d::Identity();
    Vector6d mean = Vector6d::Zero();
    mean[0] = u;
    put(name, {{"camera", "mug"}, ProjectedPoses({{0.0, {SO3d(), mean, covariance}}})});
  }
};

TEST_F(ExtremeMixtures, ADivergenceThatIsNoNumberIsNone) {
  for (const double u : {1e3, 1e6, 1e200}) {
    put_far("far.json", u);
    for (const std::string files : {"far.json mug-pg.json", "mug-pg.json far.json"}) {
      const std::string table = output_of("posemix divergence " + files);
      EXPECT_FALSE(contains(table, "nan") || contains(table, "inf")) << table;
      const Json found = Json::parse(output_of("posemix divergence " + files + " --json"));
      EXPECT_EQ(found["kl"]["value"].is_null(), contains(table, "kl:\n  value:           none"));
    }
  }
}

/// There is no proposal that would be accepted.
TEST_F(ExtremeMixtures, SamplesOfFarRotationsTakeNoTime) {
  for (const double u : {1e3, 1e6, 1e200}) {
    for (const double variance : {1e-3, 1.0, 1e6}) {
      put_far("far.json", u, variance);
      const std::string samples = output_of("posemix sample far.json -n 1000");
      EXPECT_EQ(std::count(samples.begin(), samples.end(), '\n'), 1001) << u << " " << variance;
    }
  }
}

TEST_F(ExtremeMixtures, WhatCannotBeConvertedIsNamed) {
  for (const double variance : {1e3, 1e6}) {
    Matrix6d covariance = Matrix6d::Identity();
    covariance.topLeftCorner<3, 3>() = variance * Eigen::Matrix3d::Identity();
    put("wide.json", {{"camera", "mug"}, ConcentratedPoses({{0.0, {SE3d(), covariance}}})});
    const ProgramResult result =
        shell("posemix convert wide.json --distribution projected --out out.json");
    if (result.exit_code == 0) continue;
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_TRUE(result.err.starts_with("posemix: error: wide.json: converted: ")) << result.err;
  }
}

class ExtremeRecordings : public testing::MixtureFolder {
 protected:
  /// Looks at one mug by frames of `period_s`; that of number 5 is at x = `stray_m`.
  void put_recording(double period_s, double stray_m, double variance,
                     const std::string& more = {}) const {
    std::string lines;
    for (int k = 0; k < 10; ++k) {
      Json covariance = Json::array();
      for (int i = 0; i < 6; ++i)
        for (int j = i; j < 6; ++j) covariance.push_back(i == j ? variance : 0.0);
      Json component = {{"weight", 1}, {"pose", {0.0, 0.001 * (k * 7 % 5 - 2), 0.8, 0, 0, 0, 1}}};
      if (k == 5) component["pose"][0] = stray_m;
      if (variance > 0.0) component["covariance"] = covariance;
      lines +=
          Json{{"stamp_s", period_s * k}, {"id", "mug"}, {"components", {component}}}.dump() + "\n";
    }
    folder_.put("looks.jsonl", lines);
    folder_.put("looks.toml",
                "schema = 1\n[[observations]]\njsonl = \"looks.jsonl\"\n[on_sight]\n" + more);
  }

  /// What a run writes is read by a report, or nothing is written and the error says why.
  void expect_readable(const std::string& options) const {
    const ProgramResult result =
        shell("rm -rf out; posemix slam looks.toml --quiet --out out " + options);
    if (result.exit_code == 0) {
      const ProgramResult report = shell("posemix report out --quiet --out page.html");
      if (contains(report.err, "without the report page")) GTEST_SKIP() << report.err;
      EXPECT_EQ(report.exit_code, 0) << report.err;
      return;
    }
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_TRUE(contains(result.err, "smoothing: at frame") ||
                contains(result.err, "smoothing: object 'mug' is so far") ||
                contains(result.err, "the estimate at stamp") ||
                contains(result.err, "mixture_mug.json: component") ||
                contains(result.err, "posterior.json: component"))
        << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }
};

TEST_F(ExtremeRecordings, WhatIsWrittenIsRead) {
  const std::string far_camera = "[[cameras]]\nname = \"\"\npose = [1e7, 0, 0, 0, 0, 0, 1]\n";
  for (const std::string options : {"", "--smooth"}) {
    SCOPED_TRACE(options);
    put_recording(1e5, 0.0, 0.0);
    expect_readable(options);
    put_recording(0.1, 1e6, 1e-6);
    expect_readable(options);
    put_recording(0.1, 1e5, 1e-4);
    expect_readable(options);
    put_recording(0.1, 1e6, 1e-4);
    expect_readable(options);
    put_recording(0.1, 0.0, 0.0, far_camera);
    expect_readable(options);
  }
}

}  // namespace
}  // namespace posemix
