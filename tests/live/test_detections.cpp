// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <limits>

#include <gtest/gtest.h>

#include "live_scene.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using namespace testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// An array with one detection that has these results.
RosDetections one_detection(std::vector<RosResult> results) {
  RosDetections message{.header = {at_ns(1.0), "/camera"}};
  message.detections.push_back({.header = message.header, .results = std::move(results)});
  return message;
}

std::vector<LiveImage> images(const RosDetections& message, const LiveSource& source = {}) {
  return images_of(message, source, 5.0, at_ns(9.0));
}

/// The numbers of a matrix row by row.
std::array<double, 36> numbers(const Matrix6d& matrix) {
  std::array<double, 36> values;
  for (Eigen::Index i = 0; i < 36; ++i) values[static_cast<std::size_t>(i)] = matrix(i / 6, i % 6);
  return values;
}

TEST(LiveDetections, AllResultsOfTheClassOfTheBestOneAreTaken) {
  const auto found =
      images(one_detection({result("mug", mug_pose(), 0.2), result("can", box_pose(), 0.3),
                            result("mug", box_pose(), 0.6)}));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].frame, "camera") << "without the slash of ROS 1";
  EXPECT_EQ(found[0].stamp_ns, at_ns(1.0));
  ASSERT_EQ(found[0].detections.size(), 1u);
  const LiveDetection& mug = found[0].detections[0];
  EXPECT_EQ(mug.class_id, "mug");
  EXPECT_EQ(mug.score, 0.6);
  ASSERT_EQ(mug.components.size(), 2u);
  EXPECT_NEAR(mug.components[0].weight, 0.25, 1e-15);
  EXPECT_TRUE(mug.components[1].pose.is_approx(box_pose(), 1e-15));
  EXPECT_FALSE(mug.components[0].covariance) << "zeros stand where there is none";
}

TEST(LiveDetections, ScoresThatAreNoSharesWeighEqually) {
  EXPECT_EQ(weights_of_scores({3.0, 1.0}), (std::vector{0.75, 0.25}));
  EXPECT_EQ(weights_of_scores({-2.0, -7.0}), (std::vector{0.5, 0.5}));
  EXPECT_EQ(weights_of_scores({0.0, 0.0}), (std::vector{0.5, 0.5}));
  EXPECT_EQ(weights_of_scores({kNan, 1.0}), (std::vector{0.5, 0.5}));
  EXPECT_EQ(weights_of_scores({1e308, 1e308}), (std::vector{0.5, 0.5}));
}

TEST(LiveDetections, CovariancesAreTurnedToTheAxesOfTheObject) {
  // A quarter turn about z: the object's x is the camera's y. Messages have the translation first.
  const SE3d turned(SO3d::exp({0.0, 0.0, std::acos(0.0)}), {0.0, 0.0, 1.0});
  Matrix6d stated = Matrix6d::Zero();
  stated.diagonal() << 1e-4, 4e-4, 9e-4, 1e-2, 4e-2, 9e-2;
  stated(0, 3) = stated(3, 0) = 5e-4;
  RosResult of_message = result("mug", turned);
  of_message.covariance = numbers(stated);
  const auto found = images(one_detection({of_message}));
  const auto& covariance = found[0].detections[0].components[0].covariance;
  ASSERT_TRUE(covariance);
  Matrix6d expected = Matrix6d::Zero();
  expected.diagonal() << 4e-2, 1e-2, 9e-2, 4e-4, 1e-4, 9e-4;
  expected(1, 4) = expected(4, 1) = 5e-4;
  EXPECT_TRUE(matrices_near(*covariance, expected, 1e-15));
}

TEST(LiveDetections, PlaceholdersAreNoCovariances) {
  for (const Matrix6d& placeholder : {Matrix6d(Matrix6d::Identity()), Matrix6d(Matrix6d::Zero()),
                                      Matrix6d(-Matrix6d::Identity())}) {
    RosResult of_message = result("mug", mug_pose());
    of_message.covariance = numbers(placeholder);
    EXPECT_FALSE(images(one_detection({of_message}))[0].detections[0].components[0].covariance);
  }
}

TEST(LiveDetections, WhatIsWrongIsNamed) {
  const auto message_of = [](const RosResult& wrong) {
    return thrown_message([&] { images(one_detection({wrong})); });
  };
  RosResult wrong = result("mug", mug_pose());
  wrong.covariance = numbers(-2.0 * Matrix6d::Identity());
  EXPECT_NE(
      message_of(wrong).find("detections: detection 0 at 1700000001000000000 ns: result 0: got "
                             "a covariance with the eigenvalue -2"),
      std::string::npos)
      << message_of(wrong);
  wrong.covariance = numbers(0.1 * Matrix6d::Identity());
  wrong.covariance[1] = 0.05;
  EXPECT_NE(message_of(wrong).find("not symmetric"), std::string::npos);
  wrong.covariance[1] = kNan;
  EXPECT_NE(message_of(wrong).find("not finite"), std::string::npos);
  wrong = result("mug", mug_pose());
  wrong.pose[0] = kNan;
  EXPECT_NE(message_of(wrong).find("position that is not finite"), std::string::npos);
  wrong.pose = {};
  EXPECT_NE(message_of(wrong).find("quaternion has zero norm"), std::string::npos);
}

TEST(LiveDetections, TheStampOfTheImageIsThatOfTheDetection) {
  // As happypose has it: the array is stamped when it is published.
  RosDetections message = array_at(1.0, {{"mug", mug_pose()}, {"box", box_pose()}});
  message.header.stamp_ns = at_ns(1.4);
  ASSERT_EQ(images(message).size(), 1u);
  EXPECT_EQ(images(message)[0].stamp_ns, at_ns(1.0));
  message.detections[1].header.stamp_ns = 0;
  const auto found = images(message);
  ASSERT_EQ(found.size(), 2u) << "without a stamp of its own it has that of the array";
  EXPECT_EQ(found[1].stamp_ns, at_ns(1.4));
  message.header.stamp_ns = 0;
  EXPECT_EQ(images(message)[1].stamp_ns, at_ns(9.0)) << "and that of its arrival at last";
}

TEST(LiveDetections, AnEmptyArrayIsAnImageThatShowsNothing) {
  const auto found = images({.header = {at_ns(2.0), "camera"}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].detections.empty());
  EXPECT_EQ(found[0].arrival_s, 5.0);
}

TEST(LiveDetections, SourcesSayWhatIsTaken) {
  RosDetections message = array_at(1.0, {{"box", box_pose()}, {"mug", mug_pose()}});
  message.detections[0].results[0].score = 0.1;
  for (RosDetection& detection : message.detections) detection.box = numbers_of(box_pose());
  const auto found =
      images(message, {.detector = "fine", .frame = "optical", .of_box = true, .least_score = 0.5});
  ASSERT_EQ(found[0].detections.size(), 1u);
  EXPECT_EQ(found[0].detector, "fine");
  EXPECT_EQ(found[0].frame, "optical");
  EXPECT_EQ(found[0].detections[0].frame, "optical");
  EXPECT_TRUE(found[0].detections[0].components[0].pose.is_approx(box_pose(), 1e-15));
}

TEST(LiveMessages, CovariancesOfObjectsAreThoseOfErrorsAtTheObject) {
  // By samples of the left perturbation: position and rotation vector of the moved pose.
  const SE3d pose = mug_pose();
  Matrix6d left = Matrix6d::Zero();
  left.diagonal() << 1e-6, 2e-6, 3e-6, 4e-6, 5e-6, 6e-6;
  left(0, 4) = left(4, 0) = 1e-6;
  Matrix6d expected = Matrix6d::Zero();
  const Matrix6d root = left.llt().matrixL();
  for (Eigen::Index i = 0; i < 6; ++i) {
    // A small step along every column of the root; the covariance is the sum of the squares.
    const double step = 1e-4;
    const SE3d moved = SE3d::exp(step * root.col(i)) * pose;
    Vector6d change;
    change.head<3>() = (moved.translation() - pose.translation()) / step;
    change.tail<3>() = (moved.rotation() * pose.rotation().inverse()).log() / step;
    expected += change * change.transpose();
  }
  const auto values = covariance_numbers(pose, left);
  Matrix6d actual;
  for (Eigen::Index i = 0; i < 36; ++i) actual(i / 6, i % 6) = values[static_cast<std::size_t>(i)];
  EXPECT_TRUE(matrices_near(actual, expected, 1e-11));
}

}  // namespace
}  // namespace posemix
