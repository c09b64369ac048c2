// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/association.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>

#include "posemix/base/random.hpp"
#include "posemix/base/units.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using InstanceDensity = ConcentratedGaussian<SE3d>;
using testing::thrown_message;

/// The least sum over all permutations.
double least_by_trying(const Eigen::MatrixXd& cost) {
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(cost.cols()));
  std::iota(columns.begin(), columns.end(), Eigen::Index{0});
  double least = std::numeric_limits<double>::infinity();
  do {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < cost.rows(); ++i) sum += cost(i, columns[std::size_t(i)]);
    least = std::min(least, sum);
  } while (std::next_permutation(columns.begin(), columns.end()));
  return least;
}

TEST(LeastCostAssignment, IsTheBestOfAllPermutations) {
  RandomStream stream(1);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Index rows = 1 + i % 5;
    const Eigen::Index columns = rows + i % 3;
    Eigen::MatrixXd cost(rows, columns);
    // Every third matrix has ties, every fourth forbidden pairs, some costs are negative.
    for (double& c : cost.reshaped()) {
      c = i % 3 == 0 ? std::floor(4.0 * stream.uniform()) : stream.normal();
      if (i % 4 == 0 && stream.uniform() < 0.3) c = 1e6;
    }
    const std::vector<Eigen::Index> chosen = least_cost_assignment(cost);
    double sum = 0.0;
    for (Eigen::Index r = 0; r < rows; ++r) sum += cost(r, chosen[std::size_t(r)]);
    EXPECT_NEAR(sum, least_by_trying(cost), 1e-9 * (1.0 + std::abs(sum)));
    std::vector<Eigen::Index> sorted = chosen;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end());
  }
}

TEST(LeastCostAssignment, RefusesWhatCannotBeMatched) {
  EXPECT_NE(thrown_message([] { least_cost_assignment(Eigen::MatrixXd::Zero(3, 2)); }), "");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(thrown_message([&] { least_cost_assignment(Eigen::MatrixXd::Constant(2, 2, nan)); }),
            "");
  EXPECT_TRUE(least_cost_assignment(Eigen::MatrixXd(0, 3)).empty());
}

SE3d at(double x, double y, double yaw_deg = 0.0) {
  return SE3d(SO3d::exp({0.2, -0.1, radians(yaw_deg)}), {x, y, 0.8});
}

InstanceDensity density(const SE3d& pose, double rotation_deg = 2.0, double translation_m = 0.004) {
  // A body covariance, moved to the camera's frame.
  const Matrix6d body = pose_covariance(Eigen::Vector3d::Constant(radians(rotation_deg)),
                                        Eigen::Vector3d::Constant(translation_m));
  return InstanceDensity(pose, pose.adjoint_congruence(body));
}

NoiseComponent noise(double rotation_deg = 3.0, double translation_m = 0.005) {
  return {.covariance = pose_covariance(Eigen::Vector3d::Constant(radians(rotation_deg)),
                                        Eigen::Vector3d::Constant(translation_m))};
}

Candidate candidate(const SE3d& pose, double score = 1.0) { return {"box", pose, score}; }

SE3d half_turn_about_z() {
  return SE3d(SO3d::exp({0, 0, std::numbers::pi}), Eigen::Vector3d::Zero());
}

TEST(Associate, GivesEveryInstanceItsDetection) {
  const std::vector<InstanceDensity> instances{density(at(0, 0)), density(at(0.1, 0, 20)),
                                               density(at(0, 0.15, 80))};
  const SE3d error(SO3d::exp({0.02, 0.03, -0.02}), {0.003, -0.002, 0.004});
  const std::vector<Candidate> seen{candidate(instances[2].mean() * error),
                                    candidate(instances[0].mean() * error),
                                    candidate(instances[1].mean() * error)};
  const auto result = associate(instances, seen, noise(), {});
  ASSERT_EQ(result.size(), 3U);
  const std::vector<std::size_t> expected{2, 0, 1};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(result[i].status, CandidateStatus::assigned);
    EXPECT_EQ(result[i].instance, expected[i]);
    EXPECT_TRUE(result[i].camera_object.is_approx(seen[i].camera_object, 0.0));
  }
}

TEST(Associate, TakesTheEquivalentPoseNearestToTheInstance) {
  const std::vector<InstanceDensity> instances{density(at(0, 0))};
  const std::vector<Candidate> seen{candidate(at(0.002, 0, 4) * half_turn_about_z())};
  const auto plain = associate(instances, seen, noise(), {});
  const auto aware = associate(instances, seen, noise(), SymmetryGroup({half_turn_about_z()}));
  // Without the symmetry the place decides, at the price of the cap: the 0.99 quantile of a
  // chi-square with three degrees of freedom is 11.345 (tables).
  ASSERT_EQ(plain[0].status, CandidateStatus::assigned);
  EXPECT_TRUE(plain[0].camera_object.is_approx(seen[0].camera_object, 0.0));
  const double variance = 0.004 * 0.004 + 0.005 * 0.005;
  EXPECT_NEAR(plain[0].cost, 0.002 * 0.002 / variance + 11.345, 1e-3);
  ASSERT_EQ(aware[0].status, CandidateStatus::assigned);
  EXPECT_TRUE(aware[0].camera_object.is_approx(at(0.002, 0, 4), 1e-12));
  EXPECT_LT(aware[0].cost, 2.0);
}

TEST(Associate, GateIsOfThePosition) {
  // The 0.999 quantile of a chi-square with three degrees of freedom is 16.266 (tables).
  const double sd = std::hypot(0.004, 0.005);
  const double gate = sd * std::sqrt(16.266);
  const std::vector<InstanceDensity> instances{density(at(0, 0))};
  const auto status = [&](double x) {
    return associate(instances, std::vector{candidate(at(x, 0))}, noise(), {})[0].status;
  };
  EXPECT_EQ(status(0.999 * gate), CandidateStatus::assigned);
  EXPECT_EQ(status(1.001 * gate), CandidateStatus::fresh);
}

TEST(Associate, SecondDetectionOfOneObjectIsRejected) {
  const std::vector<InstanceDensity> instances{density(at(0, 0))};
  const std::vector<Candidate> seen{candidate(at(0.006, 0)), candidate(at(0.001, 0)),
                                    candidate(at(0.3, 0), 0.6), candidate(at(0.305, 0), 0.7),
                                    candidate(at(0.6, 0), 0.1)};
  AssociationSettings settings;
  settings.least_new_score = 0.5;
  const auto result = associate(instances, seen, noise(), {}, settings);
  EXPECT_EQ(result[0].status, CandidateStatus::rejected);
  EXPECT_EQ(result[1].status, CandidateStatus::assigned);
  EXPECT_EQ(result[2].status, CandidateStatus::rejected);  // beside a better one
  EXPECT_EQ(result[3].status, CandidateStatus::fresh);
  EXPECT_EQ(result[4].status, CandidateStatus::rejected);  // score
}

TEST(Associate, WithoutInstancesOrCandidates) {
  EXPECT_TRUE(associate({}, {}, noise(), {}).empty());
  EXPECT_TRUE(associate(std::vector{density(at(0, 0))}, {}, noise(), {}).empty());
  EXPECT_EQ(associate({}, std::vector{candidate(at(0, 0))}, noise(), {})[0].status,
            CandidateStatus::fresh);
  EXPECT_NE(thrown_message([] { associate({}, {}, noise(), {}, {.gate_probability = 1.0}); }), "");
}

/// The cost of a pair by the definition in the header, with the position's covariance from
/// finite differences and explicit inverses.
double pair_cost(const InstanceDensity& instance, const SE3d& seen,
                 const NoiseComponent& detector) {
  const double h = 1e-6;
  Eigen::Matrix<double, 3, 6> slope;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Vector6d step = h * Vector6d::Unit(i);
    slope.col(i) = ((SE3d::exp(step) * instance.mean()).translation() -
                    (SE3d::exp(-step) * instance.mean()).translation()) /
                   (2 * h);
  }
  Matrix6d to = Matrix6d::Identity();
  to.bottomRows<3>() = slope;
  const Eigen::Matrix3d r = instance.mean().rotation().matrix();
  Matrix6d turned = Matrix6d::Zero();
  turned.topLeftCorner<3, 3>() = r;
  turned.bottomRightCorner<3, 3>() = r;
  const Matrix6d s = to * instance.covariance() * to.transpose() +
                     turned * detector.covariance * turned.transpose();
  Vector6d e;
  e << (seen.rotation() * instance.mean().rotation().inverse()).log(),
      seen.translation() - instance.mean().translation();
  const Eigen::Matrix3d position = s.bottomRightCorner<3, 3>();
  const double near = e.tail<3>().dot(position.inverse() * e.tail<3>());
  if (near > 16.266236) return 1e6;
  return std::min(e.dot(s.inverse() * e), near + 11.344867);
}

TEST(Associate, TotalCostIsLeastOfAllAssignments) {
  RandomStream stream(9);
  for (int round = 0; round < 60; ++round) {
    // A crowd: distances are of the size of the errors.
    std::vector<InstanceDensity> instances;
    std::vector<Candidate> seen;
    const NoiseComponent detector = noise(10.0, 0.02);
    const std::size_t known = 1 + static_cast<std::size_t>(round % 4);
    const std::size_t detected = 1 + static_cast<std::size_t>(round % 3);
    const auto place = [&] {
      return at(0.05 * stream.normal(), 0.05 * stream.normal(), 20 * stream.normal());
    };
    for (std::size_t j = 0; j < known; ++j)
      instances.push_back(density(place(), 5.0, 0.01 * (1.0 + stream.uniform())));
    for (std::size_t i = 0; i < detected; ++i) seen.push_back(candidate(place()));
    const auto rows = static_cast<Eigen::Index>(detected);
    const auto columns = static_cast<Eigen::Index>(known);
    Eigen::MatrixXd cost(rows, columns + rows);
    cost.setConstant(16.266236 + 11.344867);
    for (Eigen::Index i = 0; i < rows; ++i)
      for (Eigen::Index j = 0; j < columns; ++j)
        cost(i, j) =
            pair_cost(instances[std::size_t(j)], seen[std::size_t(i)].camera_object, detector);
    double total = 0.0;
    for (const Association& a : associate(instances, seen, detector, {}))
      total += a.status == CandidateStatus::assigned ? a.cost : 16.266236 + 11.344867;
    EXPECT_NEAR(total, least_by_trying(cost), 1e-4 * total);
  }
}

}  // namespace
}  // namespace posemix
