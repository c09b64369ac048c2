// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/tum.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "expect_invalid.hpp"
#include "posemix/base/random.hpp"
#include "posemix/testing/data.hpp"
#include "temporary_folder.hpp"

namespace posemix {
namespace {

constexpr const char* kPlain =
    "# stamp tx ty tz qx qy qz qw\n"
    "0.0 1 2 3 0 0 0 1\r\n"
    "\n"
    "  0.1\t-1e-3 2.5 3 0 0 0.7071068 0.7071068  \n";

std::vector<StampedPose> parse_poses(std::string_view text, const TumOptions& options = {}) {
  return parse_tum(text, "t.txt", options);
}

TEST(Tum, ReadsPosesCommentsAndLineEnds) {
  const auto frames = parse_poses(kPlain);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].stamp, 0.0);
  EXPECT_TRUE(frames[0].pose->is_approx(SE3d(SO3d(), {1, 2, 3}), 0));
  EXPECT_EQ(frames[1].stamp, 0.1);
  const SO3d quarter = SO3d::exp(Eigen::Vector3d(0, 0, std::acos(0.0)));
  EXPECT_TRUE(frames[1].pose->is_approx(SE3d(quarter, {-1e-3, 2.5, 3}), 1e-14));
}

TEST(Tum, LastLineWithoutEnd) { EXPECT_EQ(parse_poses("0 0 0 0 0 0 0 1").size(), 1U); }

TEST(Tum, MissesOnlyInDetections) {
  const std::string text = "0 0 -0.0 0 0 0 0 0\n1 0 0 1 0 0 0 1\n";
  EXPECT_INVALID_WITH(parse_poses(text),
                      "t.txt:1: got an all-zero pose, expected a pose in every line");
  const auto frames = parse_poses(text, {.allow_misses = true});
  EXPECT_FALSE(frames[0].pose.has_value());
  EXPECT_TRUE(frames[1].pose.has_value());
}

TEST(Tum, ZeroTranslationMayCountAsMiss) {
  const std::string text = "0.5 0.0 -0.0 0.0 0 0 0 1\n";
  EXPECT_TRUE(parse_poses(text, {.allow_misses = true})[0].pose.has_value());
  EXPECT_FALSE(parse_poses(text, {.allow_misses = true, .zero_translation_is_miss = true})[0]
                   .pose.has_value());
}

TEST(Tum, StampsIncrease) {
  EXPECT_INVALID(parse_poses("0.2 0 0 0 0 0 0 1\n0.1 0 0 0 0 0 0 1\n"),
                 "t.txt:2: got stamp 0.1 after stamp 0.2, expected strictly increasing stamps");
  EXPECT_INVALID_WITH(parse_poses("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"),
                      "t.txt:2: got stamp 1 after");
}

TEST(Tum, QuaternionIsNearlyUnit) {
  EXPECT_INVALID(
      parse_poses("0 1 2 3 0 0 0 0.98\n"),
      "t.txt:1: got a quaternion of norm 0.98, expected qx qy qz qw of norm 1 within 0.01");
  EXPECT_INVALID_WITH(parse_poses("0 1 2 3 0 0 0 0\n"), "got a quaternion of norm 0,");
  EXPECT_INVALID_WITH(parse_poses("0 1 2 3 1e308 1e308 1e308 1e308\n"),
                      "got a quaternion of norm ");
  const SE3d pose = *parse_poses("0 1 2 3 0 0 0.6 0.805\n")[0].pose;
  EXPECT_NEAR(pose.rotation().quaternion().norm(), 1, 1e-15);
}

TEST(Tum, RejectsDamagedFiles) {
  EXPECT_INVALID(parse_poses(""),
                 "t.txt: got no poses, expected lines 'stamp tx ty tz qx qy qz qw'");
  EXPECT_INVALID_WITH(parse_poses("# only a comment\n"), "got no poses");
  EXPECT_INVALID(parse_poses("0 1 2 3 0 0 0 1\n1 1 2 3 0 0 0\n"),
                 "t.txt:2: got 7 columns, expected 8: stamp tx ty tz qx qy qz qw");
  EXPECT_INVALID_WITH(parse_poses("0 1 2 3 0 0 0 1 9\n"), "got 9 columns");
  EXPECT_INVALID(parse_poses("0 1 nan 3 0 0 0 1\n"),
                 "t.txt:1: got ty = \"nan\", expected a finite number");
  EXPECT_INVALID_WITH(parse_poses("inf 1 2 3 0 0 0 1\n"), "got stamp = \"inf\"");
  EXPECT_INVALID_WITH(parse_poses("0 1 2 3 0 0 0 1e999\n"), "got qw = \"1e999\"");
  EXPECT_INVALID_WITH(parse_poses("0 1,5 2 3 0 0 0 1\n"), "got tx = \"1,5\"");
  EXPECT_INVALID_WITH(parse_poses("0,1,2,3,0,0,0,1\n"), "got 1 columns");
  EXPECT_INVALID_WITH(parse_poses(std::string("0 1 2 3 0 0 0 1\n\x7f"
                                              "ELF\0\0",
                                              22)),
                      "t.txt:2: got a NUL byte");
  EXPECT_INVALID_WITH(parse_poses("\x89PNG\r\n\x1a\n"), "t.txt:1: got 1 columns");
}

TEST(Tum, ErrorsNameTheFile) {
  const testing::TemporaryFolder folder;
  const auto path = folder.put("odometry.txt", "0 1 2\n");
  EXPECT_INVALID_WITH(read_tum(path), path.string() + ":1: got 3 columns");
  EXPECT_INVALID_WITH(read_tum(folder / "none.txt"), "No such file");
}

TEST(Tum, WritesWhatItReads) {
  RandomStream random(3);
  std::vector<StampedPose> frames;
  for (int i = 0; i < 200; ++i) {
    Eigen::VectorXd xi(6);
    random.fill_normal(xi);
    frames.push_back({1.7e9 + i / 30.0, SE3d::exp(SE3d::Tangent(xi))});
  }
  frames[7].pose.reset();
  const auto again =
      parse_poses(format_tum(frames, TumMisses::write_zeros), {.allow_misses = true});
  ASSERT_EQ(again.size(), frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(again[i].stamp, frames[i].stamp);
    ASSERT_EQ(again[i].pose.has_value(), frames[i].pose.has_value());
    if (frames[i].pose) {
      EXPECT_TRUE(again[i].pose->is_approx(*frames[i].pose, 1e-11));
    }
  }
  EXPECT_EQ(parse_poses(format_tum(frames)).size(), frames.size() - 1);
}

TEST(Tum, WritesTwelveDigits) {
  const std::vector<StampedPose> frames{{0.1, SE3d(SO3d(), {1.0 / 3, -0.0, 1e-20})},
                                        {12, std::nullopt}};
  EXPECT_EQ(format_tum(frames), "0.1 0.333333333333 0 1e-20 0 0 0 1\n");
  EXPECT_EQ(format_tum(frames, TumMisses::write_zeros),
            "0.1 0.333333333333 0 1e-20 0 0 0 1\n12 0 0 0 0 0 0 0\n");
}

TEST(Tum, WritesNoStampsThatItWouldRefuse) {
  const SE3d pose;
  const auto text = [&](double first, double second) {
    return format_tum(std::vector<StampedPose>{{first, pose}, {second, pose}});
  };
  const double nan = std::nan("");
  EXPECT_INVALID_WITH(text(1, nan), "stamps[1] is nan, expected a finite number");
  EXPECT_INVALID_WITH(text(-INFINITY, 1), "stamps[0] is -inf, expected a finite number");
  EXPECT_INVALID_WITH(text(0.5, 0.5), "stamps[1] is 0.5 after 0.5, expected stamps that increase");
  EXPECT_INVALID_WITH(text(1, 0.5), "stamps[1] is 0.5 after 1, expected stamps that increase");
  EXPECT_EQ(format_tum({}), "");
}

TEST(TumData, SequenceOfTheSlamFolder) {
  POSEMIX_REQUIRE_DATA();
  const auto folder = *testing::data_dir() / "slam-super-6d/experiments/ycbv";
  const auto odometry = read_tum(folder / "odom/results/0001.txt");
  const auto truth = read_tum(folder / "odom/ground_truth/0001.txt");
  const auto path = folder / "inference/003_cracker_box_16k/Initial/0001.txt";
  const auto detections = read_tum(path, {.allow_misses = true});
  ASSERT_EQ(odometry.size(), 1111U);
  ASSERT_EQ(truth.size(), 1111U);
  ASSERT_EQ(detections.size(), 1111U);
  std::size_t misses = 0;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    EXPECT_EQ(detections[i].stamp, odometry[i].stamp);
    if (!detections[i].pose) ++misses;
  }
  EXPECT_EQ(misses, 489U);
}

TEST(TumData, EveryDetectionFileReads) {
  POSEMIX_REQUIRE_DATA();
  const auto folder = *testing::data_dir() / "slam-super-6d/experiments/ycbv/inference";
  std::size_t files = 0;
  std::size_t degenerate = 0;
  for (const auto& object : std::filesystem::directory_iterator(folder)) {
    for (const auto& file : std::filesystem::directory_iterator(object.path() / "Initial")) {
      const auto all = read_tum(file.path(), {.allow_misses = true});
      const auto kept =
          read_tum(file.path(), {.allow_misses = true, .zero_translation_is_miss = true});
      ASSERT_EQ(all.size(), kept.size());
      for (std::size_t i = 0; i < all.size(); ++i) {
        degenerate += all[i].pose.has_value() != kept[i].pose.has_value() ? 1 : 0;
      }
      ++files;
    }
  }
  EXPECT_EQ(files, 30U);
  EXPECT_EQ(degenerate, 550U);
}

}  // namespace
}  // namespace posemix
