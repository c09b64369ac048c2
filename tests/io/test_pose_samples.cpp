// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/pose_samples.hpp"

#include <gtest/gtest.h>

#include "expect_invalid.hpp"
#include "mixture_draws.hpp"
#include "posemix/io/npy.hpp"

namespace posemix {
namespace {

std::vector<SE3d> some_poses() {
  RandomStream stream(1);
  std::vector<SE3d> poses;
  for (int i = 0; i < 20; ++i) poses.push_back(testing::awkward_pose(stream));
  return poses;
}

TEST(PoseSamples, EveryFormatReadsBack) {
  const std::vector<SE3d> poses = some_poses();
  for (const PoseFormat format : {PoseFormat::csv, PoseFormat::npy, PoseFormat::tum}) {
    const PoseSamples read = parse_pose_samples(format_poses(poses, format), "p", format);
    ASSERT_EQ(read.poses.size(), poses.size());
    EXPECT_TRUE(read.weights.empty());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_TRUE(read.poses[i].is_approx(poses[i], format == PoseFormat::tum ? 1e-11 : 1e-15));
      if (format == PoseFormat::tum) continue;
      EXPECT_EQ(read.poses[i].translation(), poses[i].translation());
    }
  }
}

TEST(PoseSamples, NpyKeepsEveryBit) {
  const std::vector<SE3d> poses = some_poses();
  const std::string bytes = format_poses(poses, PoseFormat::npy);
  EXPECT_EQ(format_poses(parse_pose_samples(bytes, "p", PoseFormat::npy).poses, PoseFormat::npy),
            bytes);
}

TEST(PoseSamples, MatricesInNpy) {
  const std::vector<SE3d> poses = some_poses();
  NpyArray array{{poses.size(), 4, 4}, {}};
  for (const SE3d& pose : poses) {
    const Eigen::Matrix4d transposed = pose.matrix().transpose();
    array.values.insert(array.values.end(), transposed.data(), transposed.data() + 16);
  }
  const PoseSamples read = parse_pose_samples(format_npy(array), "p.npy", PoseFormat::npy);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_TRUE(read.poses[i].is_approx(poses[i], 1e-14));
  }
  array.values[3 * 16 + 15] = 2.0;
  EXPECT_INVALID_WITH(parse_pose_samples(format_npy(array), "p.npy", PoseFormat::npy),
                      "p.npy[3]: ");
  EXPECT_INVALID_WITH(
      parse_pose_samples(format_npy({{2, 3}, std::vector<double>(6)}), "p.npy", PoseFormat::npy),
      "p.npy: got an array of 6 numbers of another shape, expected (n, 7) or (n, 4, 4)");
}

TEST(PoseSamples, WeightsAreAColumn) {
  const std::string text =
      "id,tx,ty,tz,qx,qy,qz,qw,weight,w2\na,1,2,3,0,0,0,1,0.5,7\nb,1,2,4,0,0,0,1,0,8\n";
  EXPECT_EQ(parse_pose_samples(text, "s.csv", PoseFormat::csv).weights,
            (std::vector<double>{0.5, 0.0}));
  EXPECT_EQ(parse_pose_samples(text, "s.csv", PoseFormat::csv, {.weights = "w2"}).weights,
            (std::vector<double>{7.0, 8.0}));
  EXPECT_INVALID(parse_pose_samples(text, "s.csv", PoseFormat::csv, {.weights = "w3"}),
                 "s.csv:1: got no column w3, expected one of that name");
  std::string negative = text;
  negative.replace(negative.find("0.5"), 3, "-1");
  EXPECT_INVALID(parse_pose_samples(negative, "s.csv", PoseFormat::csv),
                 "s.csv:2: got weight = -1, expected a number of at least zero");
  EXPECT_INVALID_WITH(
      parse_pose_samples("0 1 2 3 0 0 0 1\n", "s.tum", PoseFormat::tum, {.weights = "w"}),
      "expected CSV for residuals and weights");
}

TEST(PoseSamples, ResidualsOfEstimates) {
  const std::vector<SE3d> poses = some_poses();
  std::string text =
      "est_tx,est_ty,est_tz,est_qx,est_qy,est_qz,est_qw,gt_tx,gt_ty,gt_tz,gt_qx,gt_qy,gt_qz,gt_"
      "qw\n";
  std::string row = format_poses(std::span(poses).first(2), PoseFormat::csv);
  row = row.substr(row.find('\n') + 1);
  row[row.find('\n')] = ',';
  text += row;
  const auto read = [&](Side side) {
    return parse_pose_samples(text, "r.csv", PoseFormat::csv, {.residuals = side}).poses[0];
  };
  EXPECT_TRUE((read(Side::left) * poses[1]).is_approx(poses[0], 1e-14));
  EXPECT_TRUE((poses[1] * read(Side::right)).is_approx(poses[0], 1e-14));
  EXPECT_INVALID(parse_pose_samples(text, "r.csv", PoseFormat::csv),
                 "r.csv:1: got no column tx, expected one of that name");
}

TEST(PoseSamples, BadRows) {
  const std::string head = "tx,ty,tz,qx,qy,qz,qw\n";
  const auto parse = [&](const std::string& rows) {
    return parse_pose_samples(head + rows, "s.csv", PoseFormat::csv);
  };
  EXPECT_INVALID(parse(""), "s.csv: got no poses, expected at least one");
  EXPECT_INVALID(parse("1,2,3,0,0,0\n"), "s.csv:2: got 6 columns, expected 7");
  EXPECT_INVALID(parse("1,2,nan,0,0,0,1\n"), "s.csv:2: got tz = \"nan\", expected a finite number");
  EXPECT_INVALID_WITH(parse("1,2,3,0,0,0,2\n"), "s.csv:2: got a quaternion of norm 2");
  EXPECT_INVALID_WITH(parse("1,2,3e8,0,0,0,1\n"), "s.csv: got a position beyond 1e+08 m in pose 0");
}

TEST(PoseSamples, FormatOfAName) {
  EXPECT_EQ(pose_format_of("a/b.csv"), PoseFormat::csv);
  EXPECT_EQ(pose_format_of("b.npy"), PoseFormat::npy);
  EXPECT_EQ(pose_format_of("b.tum"), PoseFormat::tum);
  EXPECT_EQ(pose_format_of("0001.txt"), PoseFormat::tum);
  EXPECT_EQ(pose_format_of("-"), std::nullopt);
}

}  // namespace
}  // namespace posemix
