// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "live/complaints.hpp"
#include "live/ros_domain.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix::internal {
namespace {

/// The environment of the tests, without what is about ROS.
class RosEnvironment : public ::testing::Test {
 protected:
  void SetUp() override { clear(); }
  void TearDown() override { clear(); }
  static void clear() {
    for (const char* name :
         {"ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE", "CYCLONEDDS_URI"})
      unsetenv(name);
  }
};

TEST_F(RosEnvironment, TheDomainIsANumber) {
  EXPECT_EQ(ros_domain(), 0u);
  setenv("ROS_DOMAIN_ID", "42", 1);
  EXPECT_EQ(ros_domain(), 42u);
  for (const char* wrong : {"-1", "233", "one", "4x"}) {
    setenv("ROS_DOMAIN_ID", wrong, 1);
    const std::string message = testing::thrown_message([] { ros_domain(); });
    EXPECT_NE(message.find("expected a number from 0 to 232"), std::string::npos) << wrong;
  }
}

TEST_F(RosEnvironment, TheLoopbackIsWantedByEitherVariable) {
  EXPECT_EQ(loopback_configuration(), "");
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  EXPECT_NE(loopback_configuration().find("127.0.0.1"), std::string::npos);
  setenv("CYCLONEDDS_URI", "file:///etc/cyclonedds.xml", 1);
  EXPECT_EQ(loopback_configuration(), "") << "which has the last word";
  clear();
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", 1);
  EXPECT_NE(loopback_configuration().find("127.0.0.1"), std::string::npos);
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET", 1);
  EXPECT_EQ(loopback_configuration(), "");
}

TEST(Complaints, TheSameAtAnotherStampIsLoggedOnceInAWhile) {
  Complaints complaints;
  EXPECT_TRUE(complaints.add("no odometry at 1700000000123 ns", 0.0));
  EXPECT_FALSE(complaints.add("no odometry at 1700000000456 ns", 1.0));
  EXPECT_TRUE(complaints.add("no transform from 'a'", 1.0)) << "another one";
  EXPECT_TRUE(complaints.add("no odometry at 1700000000789 ns", 6.0));
  EXPECT_EQ(complaints.recent(6.5, 2.0),
            std::vector<std::string>{"no odometry at 1700000000789 ns"});
  EXPECT_TRUE(complaints.recent(9.0, 2.0).empty());
}

TEST(Complaints, WhatLastsIsToldForEver) {
  Complaints complaints;
  complaints.add("another reliability", 0.0, true);
  EXPECT_EQ(complaints.recent(1e6, 2.0).size(), 1u);
}

}  // namespace
}  // namespace posemix::internal
