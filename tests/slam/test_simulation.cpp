// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/simulation.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "simulation_samples.hpp"

namespace posemix {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace)

TEST(Simulation, SameSeedSameRecordingAndOtherSeedAnother) {
  const SimulationConfig config = config_with({object_with({{1.0, small_sd()}})}, 50);
  const auto digits = [&](std::uint64_t seed) {
    const SimulatedSequence simulated = simulate(config, seed);
    return std::pair(simulated.odometry.back().billionths,
                     simulated.objects[0].detections.back()->billionths);
  };
  EXPECT_EQ(digits(1), digits(1));
  EXPECT_NE(digits(1).first, digits(2).first);
  EXPECT_NE(digits(1).second, digits(2).second);
}

TEST(Simulation, AnotherObjectChangesNothingElse) {
  SimulationConfig config = config_with({object_with({{1.0, small_sd()}}, "can")}, 40);
  const SimulatedSequence alone = simulate(config, 3);
  config.objects.insert(config.objects.begin(), object_with({{1.0, small_sd()}}, "box"));
  const SimulatedSequence both = simulate(config, 3);
  for (std::size_t k = 0; k < 40; ++k) {
    EXPECT_EQ(alone.odometry[k].billionths, both.odometry[k].billionths);
    EXPECT_EQ(alone.objects[0].detections[k]->billionths,
              both.objects[1].detections[k]->billionths);
    EXPECT_NE(both.objects[0].detections[k]->billionths, both.objects[1].detections[k]->billionths);
  }
}

TEST(Simulation, CameraGoesAroundTheTargetAndLooksAtIt) {
  SimulationConfig config = config_with({}, 300);
  config.path.turns = 2;
  config.path.target_m = Vector3d(0.3, -0.2, 0.1);
  const Sequence sequence = simulate(config, 1).sequence();
  double largest_step = 0.0;
  double angle = 0.0;
  for (std::size_t k = 0; k < 300; ++k) {
    const SE3d camera = *sequence.camera_truth[k];
    const Vector3d target = camera.inverse() * config.path.target_m;
    EXPECT_NEAR(target.head<2>().norm(), 0.0, 1e-8);
    EXPECT_NEAR(target.z(), 1.0, 0.1 + 1e-8);
    const Vector3d offset = camera.translation() - config.path.target_m;
    EXPECT_NEAR(offset.z(), 0.5, 0.1 + 1e-8);
    EXPECT_LT((camera.rotation() * Vector3d::UnitY()).z(), 0.0);
    EXPECT_NEAR((camera.rotation() * Vector3d::UnitX()).z(), 0.0, 1e-8);
    const SE3d next = *sequence.camera_truth[(k + 1) % 300];
    const Vector3d next_offset = next.translation() - config.path.target_m;
    angle += std::atan2(offset.x() * next_offset.y() - offset.y() * next_offset.x(),
                        offset.head<2>().dot(next_offset.head<2>()));
    largest_step = std::max(largest_step, (camera.inverse() * next).log().norm());
  }
  EXPECT_NEAR(angle, 4.0 * std::numbers::pi, 1e-6);
  EXPECT_LT(largest_step, 0.1);
}

TEST(Simulation, OdometryIncrementsHaveTheirNoiseOnTheRight) {
  SimulationConfig config = config_with({}, kManyFrames);
  config.odometry = small_sd();
  config.path.period_s = 0.25;
  config.path.turns = kManyFrames / 5;  // large steps tell the right side from the left
  const Sequence sequence = simulate(config, 5).sequence();
  EXPECT_TRUE(sequence.odometry[0]->is_approx(SE3d(), 0.0));
  SampleMoments moments(6);
  for (std::size_t k = 1; k < kManyFrames; ++k) {
    const SE3d truth = sequence.camera_truth[k - 1]->inverse() * *sequence.camera_truth[k];
    const SE3d measured = sequence.odometry[k - 1]->inverse() * *sequence.odometry[k];
    moments.add((truth.inverse() * measured).log());
  }
  EXPECT_LT(moments.worst_score(Vector6d::Zero(), 0.25 * covariance_of(config.odometry)), kBound);
}

TEST(Simulation, IndependentErrorsFollowTheGaussianOfTheModel) {
  const SimulationConfig config = config_with({object_with({{1.0, small_sd()}})}, kManyFrames);
  const std::vector<Vector6d> errors = errors_of(simulate(config, 7));
  const Matrix6d covariance = covariance_of(small_sd());
  ASSERT_EQ(errors.size(), kManyFrames);
  EXPECT_LT(moments_of(errors).worst_score(Vector6d::Zero(), covariance), kBound);
  double squared = 0.0;
  SampleMoments lagged(1);
  for (std::size_t k = 0; k < errors.size(); ++k) {
    squared += errors[k].dot(covariance.inverse() * errors[k]);
    if (k > 0) lagged.add(Eigen::VectorXd::Constant(1, errors[k].x() * errors[k - 1].x()));
  }
  const auto [low, high] = chi_square_band(6.0 * static_cast<double>(errors.size()));
  EXPECT_GT(squared, low);
  EXPECT_LT(squared, high);
  EXPECT_NEAR(lagged.mean()[0] / covariance(0, 0), 0.0, kBound / std::sqrt(kManyFrames));
}

TEST(Simulation, ErrorsAlongTheCameraAxesTurnAboutTheModesOrigin) {
  const Vector3d turn(0.0, 0.0, 2.0);
  const Vector3d shift(0.05, 0.02, 0.0);
  const SimulationNoise noise{1.0, small_sd(), NoiseFrame::camera, turn, shift};
  const SimulatedSequence simulated = simulate(config_with({object_with({noise})}, kManyFrames), 8);
  SampleMoments moments(6);
  const SE3d mode(SO3d::exp(turn), shift);
  for (std::size_t k = 0; k < kManyFrames; ++k) {
    const SE3d centre = simulated.objects[0].relative_truth[k].pose() * mode;
    const Vector6d error = (centre.inverse() * simulated.objects[0].detections[k]->pose()).log();
    Vector6d in_camera;
    in_camera << centre.rotation() * Vector3d(error.head<3>()),
        centre.rotation() * Vector3d(error.tail<3>());
    moments.add(in_camera);
  }
  EXPECT_LT(moments.worst_score(Vector6d::Zero(), covariance_of(small_sd())), kBound);
}

/// An error n in the axes of the viewing ray to the mode, its translation in units of the range.
Vector6d along_ray(const Vector6d& error, const SE3d& camera_mode) {
  const Vector3d ray = camera_mode.translation();
  const Vector3d axis = Vector3d::UnitZ().cross(ray).normalized();
  const Eigen::Matrix3d from_ray =
      Eigen::AngleAxisd(std::acos(ray.normalized().z()), axis).toRotationMatrix();
  const Eigen::Matrix3d turn = from_ray.transpose() * camera_mode.rotation().matrix();
  Vector6d along;
  along << turn * error.head<3>(), turn * error.tail<3>() / ray.norm();
  return along;
}

TEST(Simulation, ErrorsAlongTheViewingRayAreFractionsOfTheRange) {
  const Vector3d turn(0.0, 0.0, 2.0);
  const Vector3d shift(0.05, 0.02, 0.0);
  const SimulationSd sd = sd_of(Vector3d(1.0, 2.0, 4.0), Vector3d(0.004, 0.007, 0.045));
  const SimulationNoise noise{1.0, sd, NoiseFrame::ray, turn, shift};
  SimulationConfig config = config_with({object_with({noise})}, kManyFrames);
  config.path.range = {1.5, 0.6, 5};
  const SimulatedSequence simulated = simulate(config, 12);
  SampleMoments moments(6);
  const SE3d mode(SO3d::exp(turn), shift);
  for (std::size_t k = 0; k < kManyFrames; ++k) {
    const SE3d centre = simulated.objects[0].relative_truth[k].pose() * mode;
    const Vector6d error = (centre.inverse() * simulated.objects[0].detections[k]->pose()).log();
    moments.add(along_ray(error, centre));
  }
  EXPECT_LT(moments.worst_score(Vector6d::Zero(), covariance_of(sd)), kBound);
}

TEST(Simulation, TheDefaultNoiseOfDetectorsCanBeSimulated) {
  SimulationObject object = object_with({});
  const DetectorNoise usual = default_detector_noise();
  for (const NoiseComponent& component : usual.components()) {
    const Vector6d sd = component.covariance.diagonal().cwiseSqrt();
    object.noise.push_back({component.weight, {sd.head<3>(), sd.tail<3>()}, component.frame});
  }
  const SimulatedSequence simulated = simulate(config_with({object}, kManyFrames), 13);
  // What the filter is told is what was simulated, at every pose.
  const DetectorNoise& told = object_model(object).noise;
  ASSERT_EQ(told.components().size(), 2U);
  EXPECT_EQ(told.components()[0].frame, NoiseFrame::ray);
  EXPECT_TRUE(told.components()[0].covariance.isApprox(usual.components()[0].covariance, 1e-12));
  const double wide = told.components()[1].weight;
  double squared = 0.0;
  for (std::size_t k = 0; k < kManyFrames; ++k) {
    const SE3d truth = simulated.objects[0].relative_truth[k].pose();
    const NoiseAtPose at = noise_at(told.components()[0], truth);
    const Vector6d error = (truth.inverse() * simulated.objects[0].detections[k]->pose()).log();
    Vector6d along;
    const SO3d turn = at.axes.rotation().inverse() * truth.rotation();
    along << turn * Vector3d(error.head<3>()), turn * Vector3d(error.tail<3>());
    squared += along.dot(at.covariance.llt().solve(along));
  }
  // A mixture of N(0, P) and N(0, 2.7^2 P): mean and variance of n^T P^-1 n.
  const double scale = std::pow(2.7, 2);
  const double mean = 6.0 * (1.0 - wide + wide * scale);
  const double variance = 48.0 * (1.0 - wide + wide * scale * scale) - mean * mean;
  EXPECT_NEAR(squared / kManyFrames, mean, kBound * std::sqrt(variance / kManyFrames));
}

TEST(Simulation, MixtureOfErrorsHasTheMomentsOfItsComponents) {
  const SimulationSd wide = sd_of(Vector3d(1.0, 2.0, 12.0), Vector3d(0.003, 0.005, 0.008));
  const SimulationConfig config =
      config_with({object_with({{3.0, small_sd()}, {2.0, wide}})}, kManyFrames);
  const std::vector<Vector6d> errors = errors_of(simulate(config, 9));
  const Matrix6d covariance = 0.6 * covariance_of(small_sd()) + 0.4 * covariance_of(wide);
  EXPECT_LT(moments_of(errors).worst_score(Vector6d::Zero(), covariance), kBound);
  SampleMoments fourth(1);
  for (const Vector6d& error : errors) {
    fourth.add(Eigen::VectorXd::Constant(1, std::pow(error[2], 4)));
  }
  const double expected =
      3.0 * (0.6 * std::pow(radians(4.0), 4) + 0.4 * std::pow(radians(12.0), 4));
  EXPECT_LT(fourth.worst_score(Eigen::VectorXd::Constant(1, expected), fourth.covariance()),
            kBound);
}

TEST(Simulation, CorrelatedErrorsAreStationaryWithTheirCorrelationTime) {
  SimulationObject object = object_with({{1.0, small_sd()}});
  object.correlation_s = 0.3;
  const std::vector<Vector6d> errors =
      errors_of(simulate(config_with({object}, 5 * kManyFrames), 11));
  const Matrix6d covariance = covariance_of(small_sd());
  const double r = std::exp(-0.1 / 0.3);
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    double power = 0.0;
    double lag_one = 0.0;
    double lag_five = 0.0;
    const std::size_t pairs = errors.size() - 5;
    for (std::size_t k = 0; k < pairs; ++k) {
      power += errors[k][axis] * errors[k][axis];
      lag_one += errors[k][axis] * errors[k + 1][axis];
      lag_five += errors[k][axis] * errors[k + 5][axis];
    }
    const double error =
        kBound * std::sqrt(2.0 * (1.0 + r * r) / (1.0 - r * r) / static_cast<double>(pairs));
    const double scale = covariance(axis, axis) * static_cast<double>(pairs);
    EXPECT_NEAR(power / scale, 1.0, error) << "axis " << axis;
    EXPECT_NEAR(lag_one / scale, r, error) << "axis " << axis;
    EXPECT_NEAR(lag_five / scale, std::pow(r, 5), error) << "axis " << axis;
  }
}

TEST(Simulation, CorrelatedErrorsHaveTheSameVarianceInEveryFrame) {
  SimulationObject object = object_with({{1.0, small_sd()}});
  object.correlation_s = 1.0;
  const SimulationConfig config = config_with({object}, 4);
  SampleMoments first(6);
  SampleMoments last(6);
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    const std::vector<Vector6d> errors = errors_of(simulate(config, seed));
    first.add(errors.front());
    last.add(errors.back());
  }
  EXPECT_LT(first.worst_score(Vector6d::Zero(), covariance_of(small_sd())), kBound);
  EXPECT_LT(last.worst_score(Vector6d::Zero(), covariance_of(small_sd())), kBound);
}

}  // namespace
}  // namespace posemix
