// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/tum_covariance.hpp"

#include <string>

#include <gtest/gtest.h>

#include "expect_invalid.hpp"
#include "posemix/base/random.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

constexpr const char* kPoseText = "0.5 1 2 3 0 0 0 1";
/// The upper triangle of diag(1, 2, 3, 4, 5, 6) with 0.5 between the first and the last.
constexpr const char* kUpper = " 1 0 0 0 0 0.5 2 0 0 0 0 3 0 0 0 4 0 0 5 0 6";

std::vector<StampedDensity> parse_densities(const std::string& text,
                                            const CovarianceConvention& convention = {}) {
  return parse_tum_covariance(text, "t.tum", convention);
}

Matrix6d stated() {
  Matrix6d covariance = Vector6d(1, 2, 3, 4, 5, 6).asDiagonal();
  covariance(0, 5) = covariance(5, 0) = 0.5;
  return covariance;
}

TEST(TumCovariance, ReadsTheUpperTriangleOrAllOfIt) {
  const auto upper = parse_densities("# comment\n" + std::string(kPoseText) + kUpper + "\n");
  ASSERT_EQ(upper.size(), 1U);
  EXPECT_EQ(upper[0].stamp, 0.5);
  EXPECT_EQ(upper[0].density.covariance(), stated());
  std::string full = kPoseText;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = 0; j < 6; ++j) full += " " + std::to_string(stated()(i, j));
  }
  EXPECT_EQ(parse_densities(full)[0].density.covariance(), stated());
}

/// The error that a convention speaks of, and a left perturbation that causes it, to first order.
Vector6d left_of(const SE3d& mean, const Vector6d& error, const CovarianceConvention& convention) {
  Vector6d e = error;
  if (convention.order == TangentOrder::translation_rotation) e << error.tail<3>(), error.head<3>();
  const SE3d small = SE3d::exp(1e-7 * e);
  SE3d moved = small * mean;
  if (convention.side == ErrorSide::right) moved = mean * small;
  if (convention.side == ErrorSide::fixed) {
    moved = SE3d(SO3d::exp(1e-7 * e.head<3>()) * mean.rotation(),
                 mean.translation() + 1e-7 * e.tail<3>());
  }
  return 1e7 * (moved * mean.inverse()).log();
}

TEST(TumCovariance, ConventionsAreWhatTheySay) {
  const SE3d mean(SO3d::exp(Eigen::Vector3d(0.3, -0.5, 1.0)), Eigen::Vector3d(2, -1, 0.5));
  for (const ErrorSide side : {ErrorSide::left, ErrorSide::right, ErrorSide::fixed}) {
    for (const auto order :
         {TangentOrder::rotation_translation, TangentOrder::translation_rotation}) {
      const CovarianceConvention convention{side, order};
      Matrix6d map;
      for (Eigen::Index i = 0; i < 6; ++i)
        map.col(i) = left_of(mean, Vector6d::Unit(i), convention);
      const Matrix6d expected = map * stated() * map.transpose();
      EXPECT_LT((left_covariance(mean, stated(), convention) - expected).cwiseAbs().maxCoeff(),
                1e-5)
          << word_of(side) << ", " << word_of(order);
    }
  }
  EXPECT_EQ(CovarianceConvention::ros().side, ErrorSide::fixed);
  EXPECT_EQ(CovarianceConvention::ros().order, TangentOrder::translation_rotation);
}

TEST(TumCovariance, WrittenReadsBack) {
  const auto frames = parse_densities(std::string(kPoseText) + kUpper);
  const auto again = parse_densities(format_tum_covariance(frames));
  EXPECT_EQ(again[0].density.covariance(), frames[0].density.covariance());
  EXPECT_TRUE(again[0].density.mean().is_approx(frames[0].density.mean(), 0));
}

TEST(TumCovariance, ErrorsNameTheLine) {
  const std::string good = std::string(kPoseText) + kUpper + "\n";
  EXPECT_INVALID(parse_densities(kPoseText),
                 "t.tum:1: got 8 columns, expected 29: a pose without its covariance says nothing "
                 "on consistency");
  EXPECT_INVALID_WITH(parse_densities(std::string(kPoseText) + " 1 2 3"),
                      "t.tum:1: got 11 columns, expected 29");
  EXPECT_INVALID_WITH(parse_densities(good + good), "t.tum:2: got stamp 0.5 after stamp 0.5");
  const std::string indefinite = " 1 0 0 0 0 3 2 0 0 0 0 3 0 0 0 4 0 0 5 0 6";
  EXPECT_INVALID(parse_densities(good + "1 1 2 3 0 0 0 1" + indefinite),
                 "t.tum:2: got a covariance that is not positive definite, expected one that is");
  std::string zeros = kPoseText;
  for (int i = 0; i < 21; ++i) zeros += " 0";
  EXPECT_INVALID(parse_densities(zeros),
                 "t.tum:1: got a covariance of zeros (unknown), expected one that is positive "
                 "definite");
  std::string skew = kPoseText;
  for (int i = 0; i < 36; ++i) skew += i % 7 == 0 ? " 1" : (i == 1 ? " 0.5" : " 0");
  EXPECT_INVALID_WITH(parse_densities(skew), "t.tum:1: got a covariance that is not symmetric");
  EXPECT_INVALID_WITH(parse_densities(std::string(kPoseText) + " nan" + (kUpper + 2)), "t.tum:1: ");
  EXPECT_INVALID_WITH(parse_densities("# nothing\n"), "t.tum: got no poses");
}

}  // namespace
}  // namespace posemix
