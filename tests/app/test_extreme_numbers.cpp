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

}  // namespace
}  // namespace posemix
