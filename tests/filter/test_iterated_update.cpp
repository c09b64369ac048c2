// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <array>

#include <Eigen/Eigenvalues>

#include "posemix/density/pose_stack.hpp"
#include "posemix/filter/iterated_update.hpp"
#include "scenario.hpp"

namespace posemix {
namespace {

using testing::correlated_covariance;
using testing::draw;
using testing::gaussian_noise;
using testing::isotropic;
using testing::pose;
using testing::three_poses;
using testing::updates_of_both_modes;

/// Detections of objects 1 and 2, off by a given motion.
struct TwoDetections {
  DetectorNoise noise;
  std::array<Detection, 2> detections;
  std::array<const NoiseComponent*, 2> components;

  TwoDetections(const PoseStackd& truth, const SE3d& error, DetectorNoise detector)
      : noise(std::move(detector)),
        detections{Detection{1, truth[0].inverse() * truth[1] * error, &noise},
                   Detection{2, truth[0].inverse() * truth[2] * error.inverse(), &noise}},
        components{&noise.components().front(), &noise.components().front()} {}
};

TEST(IteratedUpdate, IsTheLinearizedUpdateWhereEverythingIsSmall) {
  RandomStream stream(1);
  const Eigen::MatrixXd covariance = 1e-8 * correlated_covariance(3, stream);
  const Hypothesis prior(three_poses(), covariance);
  const TwoDetections seen(prior.mean(), pose(1e-6, -2e-6, 1e-6, 1e-6, 3e-6, -1e-6),
                           DetectorNoise({{1.0, 1e-8 * isotropic(4.0, 0.05)}}));
  const UpdateResult once = update(prior, seen.detections, seen.components);
  const UpdateResult iterated = iterated_update(prior, seen.detections, seen.components);
  ASSERT_TRUE(iterated.ok);
  EXPECT_TRUE(iterated.posterior.mean().is_approx(once.posterior.mean(), 1e-10));
  const double scale = once.posterior.covariance().cwiseAbs().maxCoeff();
  EXPECT_LT((iterated.posterior.covariance() - once.posterior.covariance()).cwiseAbs().maxCoeff(),
            1e-4 * scale);
  EXPECT_NEAR(iterated.log_likelihood, once.log_likelihood, 1e-3);
}

/// |zeta|^2_P + |n|^2_R of relative poses, directly from the definitions.
double cost(const Hypothesis& prior, const TwoDetections& seen, const std::array<SE3d, 2>& z) {
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(12, 18);
  Eigen::VectorXd zeta(12);
  double sum = 0.0;
  for (Eigen::Index j = 0; j < 2; ++j) {
    const SE3d& object = prior.mean()[static_cast<std::size_t>(j + 1)];
    const SE3d inverse = object.inverse();
    d.block<6, 6>(6 * j, 0) = inverse.adjoint();
    d.block<6, 6>(6 * j, 6 * (j + 1)) = -inverse.adjoint();
    const SE3d& relative = z[static_cast<std::size_t>(j)];
    zeta.segment<6>(6 * j) = (relative * (inverse * prior.mean()[0]).inverse()).log();
    const Vector6d n =
        (relative * seen.detections[static_cast<std::size_t>(j)].camera_object).log();
    sum += n.dot(seen.components[0]->covariance.inverse() * n);
  }
  return sum + zeta.dot((d * prior.covariance() * d.transpose()).inverse() * zeta);
}

TEST(IteratedUpdate, OneDetectionLandsOnTheMinimumOfTheCost) {
  RandomStream stream(2);
  const Hypothesis prior(three_poses(), 9.0 * correlated_covariance(3, stream));
  TwoDetections seen(prior.mean(), pose(0.2, -0.3, 0.15, 0.1, 0.05, -0.1),
                     gaussian_noise(4.0, 0.02));
  const UpdateResult result = iterated_update(
      prior, std::span(seen.detections).first(1),
      std::span<const NoiseComponent* const>(seen.components).first(1), 1, {50, 1e-12});
  ASSERT_TRUE(result.ok);
  const SE3d solution = result.posterior.mean()[1].inverse() * result.posterior.mean()[0];
  // The relative pose of object 1 alone: its own prior, its own detection.
  const SE3d prior_relative = prior.mean()[1].inverse() * prior.mean()[0];
  const Matrix6d p = inverse(relative_pose(prior, 0, 1)).covariance();
  const auto one_cost = [&](const Vector6d& step) {
    const SE3d z = SE3d::exp(step) * solution;
    const Vector6d zeta = (z * prior_relative.inverse()).log();
    const Vector6d n = (z * seen.detections[0].camera_object).log();
    return zeta.dot(p.inverse() * zeta) + n.dot(seen.components[0]->covariance.inverse() * n);
  };
  constexpr double kStep = 1e-5;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Vector6d unit = kStep * Vector6d::Unit(i);
    const double slope = (one_cost(unit) - one_cost(-unit)) / (2.0 * kStep);
    const double curvature =
        (one_cost(unit) + one_cost(-unit) - 2.0 * one_cost(Vector6d::Zero())) / (kStep * kStep);
    EXPECT_LT(std::abs(slope / curvature), 1e-7) << "coordinate " << i;
  }
}

TEST(IteratedUpdate, TwoDetectionsLowerTheCostBelowTheLinearizedOne) {
  RandomStream stream(3);
  const Hypothesis prior(three_poses(), 9.0 * correlated_covariance(3, stream));
  const TwoDetections seen(prior.mean(), pose(0.3, -0.3, 0.25, 0.1, 0.05, -0.1),
                           gaussian_noise(4.0, 0.02));
  const auto relative = [](const Hypothesis& h) {
    return std::array<SE3d, 2>{h.mean()[1].inverse() * h.mean()[0],
                               h.mean()[2].inverse() * h.mean()[0]};
  };
  const double once =
      cost(prior, seen, relative(update(prior, seen.detections, seen.components).posterior));
  const double iterated = cost(
      prior, seen, relative(iterated_update(prior, seen.detections, seen.components).posterior));
  EXPECT_LT(iterated, once);
}

TEST(IteratedUpdate, DoesNotDependOnWhereTheWorldIs) {
  RandomStream stream(4);
  const Hypothesis prior(three_poses(), 4.0 * correlated_covariance(3, stream));
  const TwoDetections seen(prior.mean(), pose(0.2, -0.1, 0.1, 0.05, 0.05, -0.02), gaussian_noise());
  const UpdateResult here = iterated_update(prior, seen.detections, seen.components);
  const SE3d shift = pose(0.8, -0.5, 1.9, 3.0, -2.0, 5.0);
  const PoseStackd shifts(std::vector<SE3d>(3, shift));
  const Hypothesis moved(shifts * prior.mean(), shifts.adjoint_congruence(prior.covariance()));
  const UpdateResult there = iterated_update(moved, seen.detections, seen.components);
  EXPECT_TRUE(there.posterior.mean().is_approx(shifts * here.posterior.mean(), 1e-9));
  EXPECT_NEAR(there.log_likelihood, here.log_likelihood, 1e-7);
  const Eigen::MatrixXd back = shifts.inverse().adjoint_congruence(there.posterior.covariance());
  EXPECT_LT((back - here.posterior.covariance()).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(IteratedUpdate, CommonMotionGainsNoInformationInTenThousandUpdates) {
  RandomStream stream(5);
  const DetectorNoise noise = gaussian_noise(4.0, 0.01);
  const Matrix6d r = noise.components().front().covariance;
  const PoseStackd truth = three_poses();
  Hypothesis h(truth, correlated_covariance(3, stream));
  Eigen::Matrix<double, 18, 6> common;
  common << Matrix6d::Identity(), Matrix6d::Identity(), Matrix6d::Identity();
  const auto information = [&](const Hypothesis& x) -> Matrix6d {
    return common.transpose() *
           Eigen::MatrixXd(x.covariance()).llt().solve(Eigen::MatrixXd(common));
  };
  // A vector of common motion is carried along by the resets of the anchor, J_l(xi_a), and by
  // nothing else.
  Matrix6d carried = Matrix6d::Identity();
  const Matrix6d before = information(h);
  for (int step = 0; step < 10000; ++step) {
    const std::size_t anchor = step % 2 == 0 ? 1 : 2;
    const std::size_t other = 3 - anchor;
    const std::array<Detection, 2> detections{
        Detection{anchor, truth[0].inverse() * truth[anchor] * SE3d::exp(draw(r, stream)), &noise},
        Detection{other, truth[0].inverse() * truth[other] * SE3d::exp(draw(r, stream)), &noise}};
    const std::array<const NoiseComponent*, 2> components{&noise.components().front(),
                                                          &noise.components().front()};
    const std::size_t used = step % 3 == 0 ? 2 : 1;
    const UpdateResult result =
        iterated_update(h, std::span(detections).first(used),
                        std::span<const NoiseComponent* const>(components).first(used));
    ASSERT_TRUE(result.ok);
    const Vector6d moved = (result.posterior.mean()[anchor] * h.mean()[anchor].inverse()).log();
    carried = SE3d::left_jacobian(moved) * carried;
    h = result.posterior;
  }
  const Matrix6d after = carried.transpose() * information(h) * carried;
  EXPECT_LT((after - before).norm(), 1e-6 * before.norm());
  // Observable quantities did gain: the relative pose is far more certain than one detection.
  EXPECT_LT(relative_pose(h, 0, 1).covariance()(0, 0), 1e-3 * r(0, 0));
}

TEST(IteratedUpdate, OffsetExplainsADetectionOfTheOtherMode) {
  RandomStream stream(6);
  const Hypothesis prior(three_poses(), correlated_covariance(3, stream));
  for (const NoiseFrame frame : {NoiseFrame::object, NoiseFrame::camera}) {
    const NoiseComponent plain{1.0, isotropic(3.0, 0.01), frame};
    const SE3d detected =
        prior.mean()[0].inverse() * prior.mean()[1] * pose(0.05, 0.1, -0.05, 0.02, 0, 0);
    const auto [a, b] = updates_of_both_modes(detected, plain, [&](auto detections, auto noise) {
      return iterated_update(prior, detections, noise);
    });
    EXPECT_TRUE(a.posterior.mean().is_approx(b.posterior.mean(), 1e-10));
    EXPECT_NEAR(a.log_likelihood, b.log_likelihood, 1e-8);
  }
}

TEST(IteratedUpdate, NoiseAlongCameraAxesAgreesWithTheLinearizedUpdateToFirstOrder) {
  RandomStream stream(7);
  const Hypothesis prior(three_poses(), 1e-8 * correlated_covariance(3, stream));
  NoiseComponent component{1.0, 1e-8 * pose_covariance({0.05, 0.1, 0.02}, {0.01, 0.02, 0.2}),
                           NoiseFrame::camera, pose(0.0, 0.4, 0.0, 0.1, 0.0, 0.0)};
  const DetectorNoise noise({component});
  const Detection seen{1,
                       prior.mean()[0].inverse() * prior.mean()[1] * component.offset *
                           pose(1e-6, 0, 2e-6, 1e-6, 0, 0),
                       &noise};
  const std::array<const NoiseComponent*, 1> components{&component};
  const UpdateResult once = update(prior, std::span(&seen, 1), components);
  const UpdateResult iterated = iterated_update(prior, std::span(&seen, 1), components);
  EXPECT_NEAR(iterated.log_likelihood, once.log_likelihood, 1e-3);
  EXPECT_TRUE(iterated.posterior.covariance().isApprox(once.posterior.covariance(), 1e-4));
}

TEST(IteratedUpdate, NoiseAlongCameraAxesHasOneSolutionHoweverFarItIsIterated) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    RandomStream stream(9, seed);
    const Hypothesis prior(three_poses(), 36.0 * correlated_covariance(3, stream));
    const Matrix6d r = pose_covariance({radians(3.0), radians(3.0), radians(15.0)},  //
                                       {0.01, 0.01, 0.15});
    const SE3d error = SE3d::exp(draw(isotropic(20.0, 0.15), stream));
    const TwoDetections seen(prior.mean(), error, DetectorNoise({{1.0, r, NoiseFrame::camera}}));
    const auto solve = [&](double tolerance) {
      return iterated_update(prior, seen.detections, seen.components, 1, {400, tolerance});
    };
    const UpdateResult loose = solve(1e-7);
    const UpdateResult tight = solve(1e-12);
    ASSERT_TRUE(loose.ok && tight.ok);
    EXPECT_TRUE(loose.posterior.mean().is_approx(tight.posterior.mean(), 1e-6)) << seed;
    EXPECT_NEAR(loose.log_likelihood, tight.log_likelihood, 1e-5) << seed;
    EXPECT_TRUE(loose.posterior.covariance().isApprox(tight.posterior.covariance(), 1e-5)) << seed;
  }
}

TEST(IteratedUpdate, MotionInTheStateIsNoPartOfTheCommonMotion) {
  RandomStream stream(8);
  PoseStackd mean = three_poses();
  mean[kMotion] = pose(0.02, 0.01, 0.0, 0.01, 0.0, 0.0);
  const Hypothesis prior(mean, correlated_covariance(3, stream));
  const DetectorNoise noise = gaussian_noise();
  const Detection seen{2, mean[0].inverse() * mean[2] * pose(0.1, 0.05, 0, 0.02, 0, 0.02), &noise};
  const std::array<const NoiseComponent*, 1> components{&noise.components().front()};
  const UpdateResult here = iterated_update(prior, std::span(&seen, 1), components, 2);
  // Moving the world moves camera and object; the motion, seen from the camera, stays.
  const SE3d shift = pose(0.8, -0.5, 1.9, 3.0, -2.0, 5.0);
  const PoseStackd shifts(std::vector<SE3d>{shift, SE3d(), shift});
  const Hypothesis moved(shifts * mean, shifts.adjoint_congruence(prior.covariance()));
  const UpdateResult there = iterated_update(moved, std::span(&seen, 1), components, 2);
  EXPECT_TRUE(there.posterior.mean().is_approx(shifts * here.posterior.mean(), 1e-9));
}

// An object of unknown rotation, from which odometry claims to be 100 m away where a detection sees
// it at 1 m: the steps turned by 300 rad, of which the reset of the covariance left nothing.
TEST(IteratedUpdate, TurnsByLessThanManyTurns) {
  const Matrix6d unknown = isotropic(160.0, 0.08);
  const DetectorNoise noise({{1.0, unknown}});
  const PoseStackd mean(std::vector<SE3d>{pose(0.3, 1.2, -0.4, -20.0, 97.0, 0.2), SE3d()});
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(12, 12);
  covariance.topLeftCorner<6, 6>() = isotropic(3.0, 0.6);
  covariance.bottomRightCorner<6, 6>() = unknown;
  const Hypothesis prior(mean, covariance);
  const std::array<const NoiseComponent*, 1> components{&noise.components().front()};
  for (int turn = -3; turn <= 3; ++turn) {
    const Detection seen{1, pose(0.2 * turn, 1.7, -2.0, 0.4, 0.4, 1.2), &noise};
    const UpdateResult updated = iterated_update(prior, std::span(&seen, 1), components);
    ASSERT_TRUE(updated.ok);
    const Eigen::VectorXd scale = updated.posterior.covariance().diagonal().array().rsqrt();
    const Eigen::MatrixXd correlations =
        scale.asDiagonal() * updated.posterior.covariance() * scale.asDiagonal();
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlations).eigenvalues()[0], 1e-7)
        << turn;
  }
}

// A camera of unknown heading is turned by about half a turn from where it is thought to be. Both
// relative poses then turn so, one of them a little more, and share the error of the camera.
TEST(IteratedUpdate, SeveralPosesTurnTogether) {
  RandomStream stream(7);
  const DetectorNoise noise({{1.0, isotropic(3.0, 0.01)}});
  const std::array<const NoiseComponent*, 2> components{&noise.components().front(),
                                                        &noise.components().front()};
  const PoseStackd mean(std::vector<SE3d>{SE3d(), pose(0.3, 0.2, 0.1, 0.5, 0.2, 1.0),
                                          pose(-0.2, 0.4, 0.3, -0.5, 0.3, 1.4)});
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(18, 18);
  covariance.block<6, 6>(0, 0) = isotropic(90.0, 0.05);
  for (const Eigen::Index object : {6, 12})
    covariance.block<6, 6>(object, object) = isotropic(0.5, 0.01);
  const Hypothesis prior(mean, covariance);
  for (int step = 0; step < 550; ++step) {
    const double angle = 2.9 + 0.001 * step;
    const SE3d camera(SO3d::exp({0.05, angle, 0.02}), {0.02, -0.03, 0.01});
    std::array<Detection, 2> seen{Detection{1, {}, &noise}, Detection{2, {}, &noise}};
    for (Detection& one : seen) {
      one.camera_object =
          SE3d::exp(draw(isotropic(3.0, 0.01), stream)) * camera.inverse() * mean[one.object];
    }
    const UpdateResult updated = iterated_update(prior, seen, components);
    ASSERT_TRUE(updated.ok) << angle;
    EXPECT_GT(updated.log_likelihood, -100.0) << angle;
  }
}

TEST(IteratedUpdate, ReportsWhatCannotBeUpdated) {
  const DetectorNoise noise = gaussian_noise();
  Eigen::MatrixXd indefinite = 1e-2 * Eigen::MatrixXd::Identity(18, 18);
  indefinite.block<6, 6>(6, 6) = -Matrix6d::Identity();
  const Hypothesis broken = Hypothesis::trusted(three_poses(), indefinite);
  const Detection seen{1, SE3d(), &noise};
  const std::array<const NoiseComponent*, 1> components{&noise.components().front()};
  const UpdateResult result = iterated_update(broken, std::span(&seen, 1), components);
  EXPECT_FALSE(result.ok);
  EXPECT_TRUE(std::isinf(result.log_likelihood));
  EXPECT_TRUE(iterated_update(broken, {}, {}).ok);
}

}  // namespace
}  // namespace posemix
