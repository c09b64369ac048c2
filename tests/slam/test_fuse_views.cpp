// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/fuse_views.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "posemix/base/random.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/mixture/operations.hpp"
#include "posemix/slam/observed_error.hpp"
#include "posemix/testing/expect.hpp"
#include "view_scene.hpp"

namespace posemix {
namespace {

using testing::thrown_message;
using namespace testing::views;  // NOLINT(google-build-using-namespace)

// Without slow error, clutter and turns this is the library's product of independent mixtures.
TEST(FuseViews, IsTheProductOfIndependentMixtures) {
  const DetectorNoise noise = white_noise(1e-9);
  const SE3d truth = object_at();
  std::vector<View> views = exact_views({truth}, 2);
  RandomStream stream(1);
  std::optional<Mixture<ConcentratedGaussian<SE3d>>> product;
  for (View& view : views) {
    const SE3d& pose = truth;
    Observation& observation = view.observations.front();
    observation.components.clear();
    std::vector<Component<ConcentratedGaussian<SE3d>>> components;
    for (const double angle : {0.0, 5.0}) {
      const SE3d camera_object = with_error(view.world_camera.inverse() * pose * turn(angle),
                                            0.01 * Vector6d::Ones(), noise);
      const double weight = angle == 0.0 ? 0.6 : 0.4;
      observation.components.push_back({.weight = weight, .pose = camera_object});
      const NoiseAtPose at = noise_at(noise.components().front(), camera_object);
      components.push_back({std::log(weight),
                            {view.world_camera * camera_object,
                             (view.world_camera * at.axes).adjoint_congruence(at.covariance)}});
    }
    const Mixture<ConcentratedGaussian<SE3d>> mixture(components);
    product = product ? fuse(*product, mixture).density : mixture;
  }
  FuseViewsSettings settings;
  settings.turned_share = 0.0;
  settings.mode_angle_rad = 0.0;
  settings.max_components = 1;
  const auto instances = fuse_views(views, {{"cup", {noise, {}}}}, settings);
  ASSERT_EQ(instances.size(), 1U);
  // The four modes are within 30 degrees of each other, so that one component has the moments.
  const auto merged =
      merge(std::span<const Component<ConcentratedGaussian<SE3d>>>(product->components()))
          .component.density;
  const auto& density = instances[0].density[0].density;
  EXPECT_LT((density.mean() * merged.mean().inverse()).log().norm(), 2e-4);
  const Matrix6d own = density.body_covariance();
  EXPECT_LT((own - merged.body_covariance()).norm(), 0.02 * own.norm());
}

TEST(FuseViews, MoreViewsGiveSmallerAndHonestErrors) {
  for (const bool slow : {false, true}) {
    const DetectorNoise noise = slow ? slow_noise(90.0) : white_noise();
    RandomStream stream(7);
    double previous = std::numeric_limits<double>::infinity();
    for (const int count : {1, 2, 4}) {
      std::vector<double> squares, nees;
      for (int run = 0; run < 60; ++run) {
        const SE3d truth = object_at(0.1 * stream.normal(), 0.1 * stream.normal());
        std::vector<View> views = exact_views({truth}, count);
        // Slow errors with the correlation of the angles.
        Eigen::MatrixXd correlation(count, count);
        for (int i = 0; i < count; ++i) {
          for (int k = 0; k < count; ++k) {
            const double angle = view_angle(views[std::size_t(i)].world_camera.inverse() * truth,
                                            views[std::size_t(k)].world_camera.inverse() * truth);
            correlation(i, k) = slow ? 0.75 * std::exp(-angle / radians(90.0)) : 0.0;
            if (i == k) correlation(i, k) = 1.0;
          }
        }
        const Eigen::MatrixXd factor = correlation.llt().matrixL();
        Eigen::MatrixXd normal(count, 6);
        for (double& value : normal.reshaped()) value = stream.normal();
        const Vector6d sd = white_noise().components().front().covariance.diagonal().cwiseSqrt();
        const Eigen::MatrixXd errors = factor * normal * sd.asDiagonal();
        for (int v = 0; v < count; ++v) {
          Observation& observation = views[std::size_t(v)].observations.front();
          SE3d& pose = observation.components.front().pose;
          pose = with_error(pose, errors.row(v).transpose(), noise);
        }
        const auto instances = fuse_views(views, {{"cup", {noise, {}}}});
        ASSERT_EQ(instances.size(), 1U);
        squares.push_back(std::pow(position_error(instances[0], truth), 2));
        nees.push_back(ErrorReduction().nees(instances[0].density[0].density, truth) / 6.0);
      }
      // Another view from the side tells the range, which is ten times as uncertain.
      const double rms = std::sqrt(mean(squares));
      EXPECT_LT(rms, (count == 1 ? 1.0 : 0.75) * previous) << count;
      previous = rms;
      // ANEES of 60 runs of 6 dof: standard error 0.075.
      EXPECT_NEAR(mean(nees), 1.0, 0.25) << count << slow;
    }
    EXPECT_LT(previous, 0.012);  // a single view: 0.03
  }
}

TEST(FuseViews, TakesGivenCovariancesAndClutter) {
  const ViewClasses classes{{"cup", {white_noise(), {}}}};
  std::vector<View> views = exact_views({object_at()}, 1);
  const Matrix6d given = pose_covariance({0.01, 0.02, 0.03}, {0.001, 0.002, 0.003});
  Observation& observation = views[0].observations[0];
  observation.components[0].covariance = given;
  const auto taken = fuse_views(views, classes);
  EXPECT_LT((taken[0].density[0].density.body_covariance() - given).norm(), 1e-12);
  FuseViewsSettings settings;
  settings.use_given_covariances = false;
  EXPECT_GT(fuse_views(views, classes, settings)[0].density[0].density.body_covariance()(0, 0),
            2.0 * given(0, 0));
  const double before = taken[0].probability;
  observation.clutter = 0.9;
  EXPECT_LT(fuse_views(views, classes)[0].probability, before);
}

// Within 1e-6 of the largest entry mirror images may differ.
TEST(FuseViews, TakesTheSymmetricPartOfAGivenCovariance) {
  std::vector<View> views = exact_views({object_at()}, 1);
  const auto fused = [&](const Matrix6d& given) {
    views[0].observations[0].components[0].covariance = given;
    const auto instances = fuse_views(views, {{"cup", {white_noise(), {}}}});
    return Matrix6d(instances[0].density[0].density.covariance());
  };
  Matrix6d lopsided = pose_covariance({0.01, 0.02, 1.0}, {0.001, 0.002, 0.003});
  lopsided(3, 4) = 5e-7;
  Matrix6d symmetric = lopsided;
  symmetrize(symmetric);
  EXPECT_EQ(fused(lopsided), fused(symmetric));
  EXPECT_EQ(fused(lopsided.transpose()), fused(symmetric));
}

TEST(FuseViews, ANamedObjectIsOne) {
  std::vector<View> views = exact_views({object_at(), object_at(0.3, 0.0)});
  for (View& view : views) {
    for (Observation& observation : view.observations) observation.object = "mug";
  }
  views[0].observations.pop_back();
  const auto instances = fuse_views(views);
  ASSERT_EQ(instances.size(), 1U);
  EXPECT_EQ(instances[0].class_id, "mug");
  EXPECT_EQ(instances[0].support.size(), 4U);
}

TEST(FuseViews, NothingSeenIsNothing) {
  EXPECT_TRUE(fuse_views({}).empty());
  EXPECT_TRUE(fuse_views(std::vector<View>(3)).empty());
}

TEST(FuseViews, NamesWhatIsNotValid) {
  const auto message = [](auto&& change) {
    std::vector<View> views = exact_views({object_at()});
    FuseViewsSettings settings;
    change(views, settings);
    return thrown_message([&] { fuse_views(views, {}, settings); });
  };
  EXPECT_EQ(message([](auto& views, auto&) { views[2].observations[0].class_id.clear(); }),
            "views[2].observations[0]: it has neither object nor class, expected one of them");
  EXPECT_NE(message([](auto& views, auto&) {
              views[1].observations[0].components[0].weight = 0.5;
            }).find("views[1].observations[0]: the weights"),
            std::string::npos);
  EXPECT_NE(message([](auto& views, auto&) {
              views[3].world_camera = SE3d(SO3d(), {std::nan(""), 0.0, 0.0});
            }).find("views[3].world_camera holds"),
            std::string::npos);
  EXPECT_NE(message([](auto&, auto& s) {
              s.detection_probability = 1.0;
            }).find("detection_probability is 1"),
            std::string::npos);
  EXPECT_NE(message([](auto&, auto& s) { s.max_components = 0; }).find("max_components"),
            std::string::npos);
  EXPECT_NE(message([](auto&, auto& s) { s.mode_angle_rad = -1.0; }).find("mode_angle_rad"),
            std::string::npos);
}

}  // namespace
}  // namespace posemix
