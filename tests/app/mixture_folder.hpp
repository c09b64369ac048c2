// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/io/mixture_file.hpp"
#include "run_program.hpp"

/// A folder with mixture files, and the program in a shell.
namespace posemix::testing {

inline ConcentratedPoses two_peaks() {
  Matrix6d covariance = 4e-4 * Matrix6d::Identity();
  covariance.topLeftCorner<3, 3>() = 0.01 * Eigen::Matrix3d::Identity();
  const SO3d half_turn = SO3d::from_quaternion(Eigen::Quaterniond(0, 0, 0, 1));
  const double weights[] = {0.7, 0.3};
  return ConcentratedPoses::from_weights(
      weights, {ConcentratedGaussian<SE3d>(SE3d(SO3d(), {0, 0, 0.8}), covariance),
                ConcentratedGaussian<SE3d>(SE3d(half_turn, {0, 0, 0.8}), covariance)});
}

inline ProjectedPoses two_projected_peaks() {
  const ConcentratedPoses peaks = two_peaks();
  std::vector<Component<ProjectedGaussian<SE3d>>> components;
  for (const auto& component : peaks.components()) {
    components.push_back(
        {component.log_weight,
         ProjectedGaussian<SE3d>(component.density.mean(), component.density.covariance())});
  }
  return ProjectedPoses(std::move(components));
}

class MixtureFolder : public ::testing::Test {
 protected:
  MixtureFolder() {
    put("mug.json", {{"camera", "mug"}, two_peaks()});
    put("mug-pg.json", {{"camera", "mug"}, two_projected_peaks()});
    put("camera.json", {{"table", "camera"}, two_peaks()});
    put("camera-pg.json", {{"table", "camera"}, two_projected_peaks()});
  }

  void put(const std::string& name, const MixtureFile& file) const {
    folder_.put(name, format_mixture(file));
  }

  /// Runs a line of shell in the folder, where `posemix` is the program.
  ProgramResult shell(const std::string& line) const {
    const std::string script = "cd '" + folder_.path().string() +
                               "' && posemix() { \"" POSEMIX_PROGRAM "\" \"$@\"; } && " + line;
    return RunningProgram({"/bin/bash", "-o", "pipefail", "-c", script}).wait();
  }

  /// The output of a line of shell, which must succeed without error messages.
  std::string output_of(const std::string& line) const {
    const ProgramResult result = shell(line);
    EXPECT_EQ(result.exit_code, 0) << line << "\n" << result.err;
    EXPECT_EQ(result.err, "") << line;
    return result.out;
  }

  MixtureFile mixture_of(const std::string& line) const {
    return parse_mixture(output_of(line), line);
  }

  void expect_error(const std::string& line, int exit_code, const std::string& part) const {
    const ProgramResult result = shell(line);
    EXPECT_EQ(result.exit_code, exit_code) << line << "\n" << result.err;
    EXPECT_TRUE(result.err.starts_with("posemix: error: ")) << result.err;
    EXPECT_TRUE(contains(result.err, part)) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
  }

  TemporaryFolder folder_;
};

}  // namespace posemix::testing
