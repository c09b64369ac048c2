// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <stdexcept>

#include <gtest/gtest.h>

#include "mixture_draws.hpp"
#include "posemix/io/mixture_file.hpp"
#include "posemix/io/pose_samples.hpp"
#include "posemix/testing/mutate.hpp"

/// Damaged mixture files and files of poses.
namespace posemix {
namespace {

using testing::fuzz;
using testing::FuzzReport;

constexpr std::size_t kInputs = 10000;

void expect_sound(const FuzzReport& report, std::size_t least_of_each) {
  EXPECT_TRUE(report.failures.empty())
      << report.failures.size() << " failures, the first: " << report.failures[0];
  EXPECT_GT(report.accepted, least_of_each);
  EXPECT_GT(report.rejected, least_of_each);
}

TEST(DamagedMixture, MixtureFiles) {
  const FrameNames frames{"camera", "mug"};
  const std::vector<std::string> originals{
      format_mixture({frames, testing::awkward_concentrated(1, 3)}),
      format_mixture({frames, testing::awkward_projected(1, 3)}),
      format_mixture(
          {frames, testing::awkward_concentrated(2, 1)},
          {Side::right, TangentOrder::translation_rotation, AngleUnit::deg, LengthUnit::mm})};
  const auto parse = [](const std::string& text) {
    const MixtureFile file = parse_mixture(text, "m.json");
    const std::string written = format_mixture(file);
    if (format_mixture(parse_mixture(written, "m.json")) != written) {
      throw std::logic_error("reads back otherwise");
    }
  };
  expect_sound(fuzz(originals, kInputs, 21, parse), 300);
}

TEST(DamagedMixture, FilesOfPoses) {
  RandomStream stream(4);
  std::vector<SE3d> poses;
  for (int i = 0; i < 5; ++i) poses.push_back(testing::awkward_pose(stream));
  for (const PoseFormat format : {PoseFormat::csv, PoseFormat::npy, PoseFormat::tum}) {
    const std::vector<std::string> originals{format_poses(poses, format)};
    const auto parse = [&](const std::string& text) {
      for (const SE3d& pose : parse_pose_samples(text, "p", format).poses) {
        if (!pose.log().allFinite()) throw std::logic_error("a pose that is not finite");
      }
    };
    expect_sound(fuzz(originals, kInputs, 22, parse), 100);
  }
}

}  // namespace
}  // namespace posemix
