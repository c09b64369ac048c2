// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/object_poses.hpp"

#include <gtest/gtest.h>

#include "expect_invalid.hpp"
#include "posemix/testing/data.hpp"

namespace posemix {
namespace {

std::map<std::string, SE3d> parse_objects(std::string_view text) {
  return parse_object_poses(text, "o.txt");
}

TEST(ObjectPoses, ReadsAndWrites) {
  const auto poses =
      parse_objects("# id tx ty tz qx qy qz qw\n14 1 2 3 0 0 0 1\r\n\nmug 0 0 0 1 0 0 0\n");
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_TRUE(poses.at("14").is_approx(SE3d(SO3d(), {1, 2, 3}), 0));
  EXPECT_EQ(format_object_poses(poses), "14 1 2 3 0 0 0 1\nmug 0 0 0 1 0 0 0\n");
}

TEST(ObjectPoses, RejectsDamagedFiles) {
  EXPECT_INVALID(parse_objects(""),
                 "o.txt: got no poses, expected lines 'id tx ty tz qx qy qz qw'");
  EXPECT_INVALID(parse_objects("14 1 2 3 0 0 0\n"),
                 "o.txt:1: got 7 columns, expected 8: id tx ty tz qx qy qz qw");
  EXPECT_INVALID(parse_objects("a 1 2 3 0 0 0 1\na 1 2 3 0 0 0 1\n"),
                 "o.txt:2: got object \"a\" again, expected one line per object");
  EXPECT_INVALID_WITH(parse_objects("a 1 nan 3 0 0 0 1\n"), "o.txt:1: got ty = \"nan\"");
  EXPECT_INVALID_WITH(parse_objects("a 1 2 3 0 0 0 0\n"), "o.txt:1: got a quaternion of norm 0");
  EXPECT_INVALID_WITH(parse_objects(std::string_view("a\0", 2)), "NUL");
  EXPECT_INVALID_WITH(read_object_poses("/nowhere/o.txt"), "/nowhere/o.txt: cannot be read");
}

TEST(ObjectPosesData, ProxiesOf0022) {
  POSEMIX_REQUIRE_DATA();
  const auto poses =
      read_object_poses(*testing::data_dir() / "derived/0022_proxy_objects_no_lever_arm.txt");
  ASSERT_EQ(poses.size(), 4U);
  EXPECT_EQ(poses.at("14").translation().y(), -0.135877957556);
}

}  // namespace
}  // namespace posemix
