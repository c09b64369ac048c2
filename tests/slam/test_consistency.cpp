// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>
#include <cstdio>

#include "filter/scenario.hpp"
#include "posemix/base/draw_index.hpp"
#include "posemix/slam/object_slam.hpp"

namespace posemix {
namespace {

using testing::draw;
using testing::gaussian_noise;
using testing::heavy_tailed_noise;
using testing::isotropic;
using testing::pose;

constexpr int kRuns = 1000;
constexpr int kRunFrames = 60;
constexpr std::size_t kMapped = 2;

/// A draw from a detector's own noise model.
SE3d draw_detection(const SE3d& relative, const DetectorNoise& noise, RandomStream& stream) {
  const std::vector<NoiseComponent>& components = noise.components();
  const NoiseComponent& component = components[index_at_sum(
      stream.uniform(), components.size(), [&](std::size_t i) { return components[i].weight; },
      components.size() - 1)];
  return relative * component.offset * SE3d::exp(draw(component.covariance, stream));
}

/// e^T P^-1 e of the full state (camera and objects) at the last frame of one simulated run. Prior,
/// odometry and detector errors are drawn from the model of the filter.
double squared_normalized_error(const DetectorNoise& noise, std::uint64_t run) {
  RandomStream stream(20221124, run);
  const Matrix6d camera_covariance = isotropic(0.5, 0.01);
  const Matrix6d q = isotropic(0.1, 0.002);
  const SE3d start = pose(0.2, -0.1, 0.3, 0.1, 0.2, -0.1);
  const std::vector<SE3d> objects = {pose(0.5, 0.2, -0.4, 0.3, 0.1, 1.0),
                                     pose(-0.8, 0.3, 1.0, -0.4, 0.2, 1.2)};

  ObjectSlamSettings settings;
  GaussianSumSettings filter;
  filter.noise_use = NoiseUse::per_object;
  filter.reduction.max_components = noise.components().size() == 1 ? 1 : 8;
  settings.tracker = filter;
  settings.motion.noise = {q, NoisePer::frame};
  ObjectSlam slam(ConcentratedGaussian<SE3d>(start, camera_covariance),
                  {{"a", noise, std::nullopt}, {"b", noise, std::nullopt}}, settings);

  SE3d camera = SE3d::exp(draw(camera_covariance, stream)) * start;
  const auto detect = [&] {
    std::vector<std::optional<SE3d>> detections;
    for (const SE3d& object : objects) {
      detections.emplace_back(draw_detection(camera.inverse() * object, noise, stream));
    }
    return detections;
  };
  slam.step({.detections = detect()});
  for (int frame = 1; frame < kRunFrames; ++frame) {
    const SE3d odometry = pose(0.01, -0.02, 0.015, 0.02 * std::cos(0.1 * frame), 0.01, 0.0);
    camera = camera * odometry * SE3d::exp(draw(q, stream));
    slam.step({0.1, odometry, detect()});
  }
  const Hypothesis& estimate = slam.estimate();
  const PoseStackd truth(std::vector<SE3d>{camera, objects[0], objects[1]});
  const Eigen::VectorXd error = (truth * estimate.mean().inverse()).log();
  return error.dot(Eigen::LLT<Eigen::MatrixXd>(estimate.covariance()).solve(error));
}

/// ANEES (midway-merge paper, eq. 35) over independent runs, and its 95 % chi-square band.
void expect_consistent(const DetectorNoise& noise) {
  double sum = 0.0;
  for (int run = 0; run < kRuns; ++run)
    sum += squared_normalized_error(noise, static_cast<std::uint64_t>(run));
  const double dof = 6.0 * (1 + kMapped) * kRuns;
  const boost::math::chi_squared distribution(dof);
  const double anees = sum / dof;
  const double lower = boost::math::quantile(distribution, 0.025) / dof;
  const double upper = boost::math::quantile(distribution, 0.975) / dof;
  std::printf("ANEES %.4f, band [%.4f, %.4f]\n", anees, lower, upper);
  EXPECT_GT(anees, lower);
  EXPECT_LT(anees, upper);
}

TEST(ConsistencySlow, OneGaussianComponent) { expect_consistent(gaussian_noise(4.0, 0.01)); }

TEST(ConsistencySlow, HeavyTailedMixture) { expect_consistent(heavy_tailed_noise(12.0)); }

}  // namespace
}  // namespace posemix
