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

namespace posemix {
namespace {

using testing::thrown_message;

/// T_world_camera at an angle about the world's z axis, looking at the origin from `range` [m].
SE3d camera_at(double angle_deg, double range = 0.8) {
  const double angle = radians(angle_deg);
  const Eigen::Vector3d z(-std::cos(angle), -std::sin(angle), 0.0);
  const Eigen::Vector3d y(0.0, 0.0, -1.0);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() << y.cross(z), y, z;
  matrix.topRightCorner<3, 1>() = -range * z;
  return SE3d::from_matrix(matrix);
}

SE3d object_at(double x = 0.0, double y = 0.0) {
  return SE3d(SO3d::exp({0.3, -0.2, 0.5}), {x, y, 0.02});
}

SE3d turn(double deg) { return SE3d(SO3d::exp({0.0, 0.0, radians(deg)}), Eigen::Vector3d::Zero()); }

/// White errors along the ray, wide along it.
DetectorNoise white_noise(double clutter = 0.1) {
  return DetectorNoise({{.weight = 1.0 - clutter,
                         .covariance = pose_covariance({0.03, 0.03, 0.02}, {0.004, 0.004, 0.04}),
                         .frame = NoiseFrame::ray}},
                       {.weight = clutter});
}

/// The same with three quarters of the variance slow.
DetectorNoise slow_noise(double angle_deg) {
  NoiseComponent component = white_noise().components().front();
  const SlowError slow{.covariance = 0.75 * component.covariance,
                       .correlation_angle_rad = radians(angle_deg)};
  component.covariance *= 0.25;
  return DetectorNoise({component}, {.weight = 0.1}, {.slow = slow});
}

Observation seen(const SE3d& camera_object) {
  Observation observation = observation_of(camera_object);
  observation.class_id = "cup";
  return observation;
}

/// Views around the object, each with an exact observation of every pose.
std::vector<View> exact_views(const std::vector<SE3d>& objects, int count = 4) {
  std::vector<View> views;
  for (int v = 0; v < count; ++v) {
    View view{camera_at(50.0 * v), {}};
    for (const SE3d& object : objects)
      view.observations.push_back(seen(view.world_camera.inverse() * object));
    views.push_back(view);
  }
  return views;
}

/// Y of an object at T_camera_object with an error along the ray's axes.
SE3d with_error(const SE3d& camera_object, const Vector6d& error, const DetectorNoise& noise) {
  const NoiseAtPose at = noise_at(noise.components().front(), camera_object);
  return at.axes * SE3d::exp(at.units.cwiseProduct(error)) * at.axes.inverse() * camera_object;
}

double position_error(const FusedInstance& instance, const SE3d& truth) {
  return (instance.density[0].density.mean().translation() - truth.translation()).norm();
}

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

TEST(FuseViews, AFlippedViewIsOutvotedAndStillCountsForThePlace) {
  std::vector<View> views = exact_views({object_at()});
  SE3d& flipped = views[1].observations[0].components[0].pose;
  flipped = flipped * turn(180.0);
  const auto instances = fuse_views(views, {{"cup", {white_noise(), {}}}});
  ASSERT_EQ(instances.size(), 1U);
  const FusedInstance& instance = instances[0];
  EXPECT_LT((object_at().inverse() * instance.density[0].density.mean()).rotation().angle(), 1e-6);
  EXPECT_GT(instance.probability, 0.99);
  ASSERT_EQ(instance.support.size(), 4U);
  EXPECT_LT(instance.support[1].probability, 1e-3);
  EXPECT_GT(instance.support[2].probability, 0.9);
  EXPECT_NEAR(instance.supporting_views, 3.0, 0.2);
}

// Where views from the same side show the flip, it is not certain that they are right.
TEST(FuseViews, ViewsFromOneSideCountOnceForTheMode) {
  const SE3d truth = object_at();
  std::vector<View> views;
  for (const double angle : {0.0, 2.0, 90.0}) {
    View view{camera_at(angle), {}};
    const SE3d pose = angle < 10.0 ? truth * turn(180.0) : truth;
    view.observations.push_back(seen(view.world_camera.inverse() * pose));
    views.push_back(view);
  }
  // So wide that the flip's odds stay moderate.
  const NoiseComponent wide{
      .weight = 0.9,
      .covariance = pose_covariance(Eigen::Vector3d::Constant(0.2), {0.02, 0.02, 0.1}),
      .frame = NoiseFrame::ray};
  const ViewClasses classes{{"cup", {DetectorNoise({wide}, {.weight = 0.1}), {}}}};
  FuseViewsSettings settings;
  settings.prune_below = 0.0;
  settings.mode_angle_rad = 0.0;
  const auto flip_odds = [&] {
    const auto density = fuse_views(views, classes, settings).front().density;
    if (density.size() < 2) throw InvalidInput("got one mode, expected two");
    EXPECT_LT((density[0].density.mean().inverse() * truth * turn(180.0)).rotation().angle(), 1e-6);
    return density[0].log_weight - density[1].log_weight;
  };
  const double independent = flip_odds();
  settings.mode_angle_rad = radians(30.0);
  // The shares of the views: 1 / (1 + exp(-2 / 30) + exp(-90 / 30)) and so on, of which the mean.
  // A mode is a sum over hypotheses, so that its odds are not quite a power.
  EXPECT_NEAR(flip_odds() / independent, (0.504 + 0.503 + 0.907) / 3.0, 0.01);
}

TEST(FuseViews, AMissingViewAndClutterCostProbability) {
  const ViewClasses classes{{"cup", {white_noise(), {}}}};
  std::vector<View> views = exact_views({object_at()});
  const double all = fuse_views(views, classes).front().probability;
  views[3].observations.clear();
  views[2].observations = {seen(SE3d(SO3d(), {0.4, 0.3, 1.5}))};
  const auto instances = fuse_views(views, classes);
  ASSERT_EQ(instances.size(), 2U);
  EXPECT_LT(position_error(instances[0], object_at()), 1e-6);
  EXPECT_EQ(instances[0].support.size(), 2U);
  EXPECT_LT(instances[0].probability, all);
  EXPECT_LT(instances[1].probability, instances[0].probability);
}

TEST(FuseViews, NeighboursOfOneClassStayTwo) {
  const SE3d left = object_at(0.0, -0.03), right = object_at(0.0, 0.03);
  std::vector<View> views = exact_views({left, right});
  std::swap(views[2].observations[0], views[2].observations[1]);
  const auto instances = fuse_views(views, {{"cup", {white_noise(), {}}}});
  ASSERT_EQ(instances.size(), 2U);
  for (const FusedInstance& instance : instances) {
    EXPECT_EQ(instance.support.size(), 4U);
    EXPECT_LT(std::min(position_error(instance, left), position_error(instance, right)), 1e-4);
  }
  EXPECT_GT((instances[0].density[0].density.mean().translation() -
             instances[1].density[0].density.mean().translation())
                .norm(),
            0.05);
}

TEST(FuseViews, EquivalentPosesAgree) {
  const std::vector<SymmetryGroup> groups{SymmetryGroup::turns({0.0, 0.0, 1.0}, 2),
                                          SymmetryGroup::turns({0.0, 0.0, 1.0}, 0)};
  for (const SymmetryGroup& group : groups) {
    std::vector<View> views = exact_views({object_at()});
    for (std::size_t v = 0; v < views.size(); ++v) {
      SE3d& pose = views[v].observations[0].components[0].pose;
      pose = pose * turn(group.axes().empty() ? 180.0 * double(v % 2) : 70.0 * double(v));
    }
    const auto declared = fuse_views(views, {{"cup", {white_noise(), group}}});
    ASSERT_EQ(declared.size(), 1U);
    EXPECT_GT(declared[0].supporting_views, 3.9);
    const auto& density = declared[0].density[0].density;
    EXPECT_LT(ErrorReduction(group).nees(density, object_at()), 1e-3);
    const double about_axis = density.body_covariance()(2, 2);
    const double uniform = std::numbers::pi * std::numbers::pi / 3.0;
    if (group.axes().empty()) {
      EXPECT_LT(about_axis, 1e-3);
    } else {
      EXPECT_NEAR(about_axis, uniform, 1e-2);
    }
    const auto none = fuse_views(views, {{"cup", {white_noise(), {}}}});
    EXPECT_LT(none[0].supporting_views, 2.5);
  }
}

TEST(FuseViews, TheOtherModeOfAnObservationIsFound) {
  std::vector<View> views = exact_views({object_at()});
  for (View& view : views) {
    auto& components = view.observations[0].components;
    components[0].weight = 0.4;
    // Every view prefers another wrong pose.
    const double wrong = 60.0 + 70.0 * double(&view - views.data());
    components.push_back({.weight = 0.6, .pose = components[0].pose * turn(wrong)});
  }
  const auto instances = fuse_views(views, {{"cup", {white_noise(), {}}}});
  ASSERT_EQ(instances.size(), 1U);
  EXPECT_LT((object_at().inverse() * instances[0].density[0].density.mean()).rotation().angle(),
            1e-6);
  EXPECT_GT(instances[0].density.weight(0), 0.99);
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
            "view 2, observation 0: it has neither object nor class, expected one of them");
  EXPECT_NE(message([](auto& views, auto&) {
              views[1].observations[0].components[0].weight = 0.5;
            }).find("view 1, observation 0: the weights"),
            std::string::npos);
  EXPECT_NE(message([](auto& views, auto&) {
              views[3].world_camera = SE3d(SO3d(), {std::nan(""), 0.0, 0.0});
            }).find("view 3: the camera"),
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
