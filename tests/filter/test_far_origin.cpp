// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "moving_object_scene.hpp"
#include "multi_object_scene.hpp"
#include "world_error_scene.hpp"

/// A world whose origin is far from the scene, as with coordinates of a map of the country: an
/// angle of a degree is hundreds of metres there, and millimetres are asked for.
namespace posemix {
namespace {

/// What the filter states of camera and objects, as seen from the place that is far.
using Stated = std::vector<ConcentratedGaussian<SE3d>>;

/// Four simulated objects that are seen in two modes each, by a camera whose pose is known to half
/// a degree and 5 mm.
Stated stated_at(double distance, bool on_a_rig, std::uint64_t seed) {
  const SE3d far(SO3d(), Eigen::Vector3d(distance, -0.6 * distance, 0.1 * distance));
  testing::OrbitScene scene(seed, 4, 0.05, 6e-4);
  const Matrix6d start = testing::start_covariance();
  const SE3d camera = SE3d::exp(testing::draw(start, scene.stream)) * scene.camera;
  MultiObjectFilter filter({far * camera, far.adjoint_congruence(start)},
                           std::vector<ObjectSensor>(4, ObjectSensor{testing::ray_noise(), {}}),
                           {});
  ObservationSource source;
  if (on_a_rig) source.camera = filter.add_camera({SE3d(), testing::isotropic(0.2, 0.002)});
  for (int frame = 0; frame < 100; ++frame) {
    filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    for (std::size_t j = 0; j < 4; ++j)
      filter.update(j, observation_of(scene.detect(j, 0.3, 0.0)), source);
  }
  const SE3d back = far.inverse();
  Stated stated;
  const auto add = [&](const SE3d& pose, const Matrix6d& covariance) {
    stated.emplace_back(back * pose, back.adjoint_congruence(covariance));
  };
  add(filter.camera().mean(), filter.camera().covariance());
  for (std::size_t j = 0; j < 4; ++j) {
    const ObjectHypothesis leading = filter.hypotheses(j)[*filter.leading(j)];
    add(leading.pose, leading.covariance);
  }
  return stated;
}

/// The squared Mahalanobis distance of the means of two statements of one pose.
double apart(const ConcentratedGaussian<SE3d>& near, const ConcentratedGaussian<SE3d>& far) {
  const Vector6d xi = (near.mean() * far.mean().inverse()).log();
  return xi.dot(near.covariance().llt().solve(xi));
}

void expect_same(const Stated& near, const Stated& far, double most_apart) {
  for (std::size_t k = 0; k < near.size(); ++k) {
    EXPECT_LT(apart(near[k], far[k]), most_apart) << k;
    EXPECT_LT((near[k].covariance() - far[k].covariance()).norm(),
              1e-3 * near[k].covariance().norm())
        << k;
  }
}

/// Before, variances grew by a tenth with every detection at 150 m with extrinsics, and the map was
/// lost to rounding at 20 to 100 km.
TEST(FarOrigin, OfAThousandKilometresChangesNothing) {
  for (const bool on_a_rig : {false, true}) {
    for (const std::uint64_t seed : {1U, 2U}) {
      const Stated near = stated_at(0.0, on_a_rig, seed);
      for (const double distance : {150.0, 1e4, 8e5})
        expect_same(near, stated_at(distance, on_a_rig, seed), 1e-8);
    }
  }
}

/// The camera, after a hundred frames of the Gaussian-sum filter whose camera starts as this
/// sure, in parts of half a degree and 5 mm.
ConcentratedGaussian<SE3d> camera_by_gaussian_sum(double distance, double start_part) {
  const SE3d far(SO3d(), Eigen::Vector3d(distance, -0.6 * distance, 0.1 * distance));
  testing::OrbitScene scene(3, 2, 0.05, 6e-4);
  const Matrix6d start = start_part * start_part * testing::start_covariance();
  const DetectorNoise noise(
      {{0.7, testing::isotropic(1.0, 5e-3)}, {0.3, testing::isotropic(5.0, 2e-2)}});
  Hypothesis prior(PoseStackd({far * scene.camera}), far.adjoint_congruence(start));
  GaussianSumFilter filter(Posterior({{0.0, std::move(prior)}}), {});
  for (const SE3d& object : scene.truth) filter.add_object(scene.camera.inverse() * object, noise);
  for (int frame = 0; frame < 100; ++frame) {
    const SE3d motion = scene.advance();
    filter.predict([&](Hypothesis hypothesis) {
      return predict_with_odometry(std::move(hypothesis), motion, scene.q);
    });
    const Detection detections[] = {{1, scene.detect(0, 0.0, 0.0), &noise},
                                    {2, scene.detect(1, 0.0, 0.0), &noise}};
    const UpdateReport report = filter.update(detections);
    EXPECT_EQ(report.failed, std::vector<bool>(2, false)) << distance;
  }
  const Hypothesis& best = filter.posterior()[filter.posterior().heaviest()].density;
  const SE3d back = far.inverse();
  return {back * best.mean()[kCamera],
          back.adjoint_congruence(Matrix6d(best.covariance().topLeftCorner<6, 6>()))};
}

/// Five kilometres were as good as none, at ten a covariance was none any more.
TEST(FarOrigin, OfAHundredKilometresChangesNothingInTheGaussianSumFilter) {
  for (const double start_part : {1.0, 0.01}) {
    const auto near = camera_by_gaussian_sum(150.0, start_part);
    for (const double distance : {1e3, 1e4, 8e4}) {
      const auto far = camera_by_gaussian_sum(distance, start_part);
      expect_same({near}, {far}, 1e-3);
    }
  }
}

/// Not to the last bit, however often.
TEST(FarOrigin, UpdatesOfNothingLeaveTheGaussianSumFilterAsItIs) {
  const SE3d far(SO3d(), {5e4, 4e4, 0.0});
  const Matrix6d sure = testing::isotropic(0.1, 5e-3);
  Hypothesis prior(PoseStackd({far}), Eigen::MatrixXd(far.adjoint_congruence(sure)));
  GaussianSumFilter filter(Posterior({{0.0, std::move(prior)}}), {});
  filter.add_independent_object(far.inverse(), testing::isotropic(60.0, 1e-3));
  const Eigen::MatrixXd before = filter.posterior()[0].density.covariance();
  for (int k = 0; k < 100; ++k) filter.update({});
  EXPECT_EQ(filter.posterior()[0].density.covariance(), before);
}

/// Where double precision holds nothing of what is stated, it is refused.
TEST(FarOrigin, BeyondWhatDoublePrecisionHoldsIsRefused) {
  const auto why = [](const char* name) {
    return std::string(name) +
           " is 5e+04 km from the origin of the world, where double precision holds no covariance "
           "of it that has a standard deviation of 8.73e+05 m; expected a world whose origin is "
           "near the scene";
  };
  const SE3d place(SO3d(), {0.0, -5e7, 0.0});
  const Matrix6d sure = testing::isotropic(1.0, 5e-3);
  const ConcentratedGaussian<SE3d> away(place, place.adjoint_congruence(sure));
  const ObjectSensor sensor{testing::ray_noise(), {}};
  EXPECT_EQ(testing::thrown_message([&] { MultiObjectFilter(away, {sensor}, {}); }),
            why("pose of the camera"));
  MultiObjectFilter filter({SE3d(), sure}, {sensor}, {});
  filter.update(0, SE3d(SO3d(), {0.0, 0.0, 0.7}));
  const Eigen::MatrixXd before = filter.joint().covariance();
  EXPECT_EQ(testing::thrown_message([&] { filter.set_camera(away, 0.1); }),
            why("pose of the camera"));
  EXPECT_EQ(testing::thrown_message([&] {
              filter.add_object(sensor, ObjectPrior{away, 1.0});
            }),
            why("the prior"));
  EXPECT_EQ(filter.object_count(), 1U);
  EXPECT_EQ(filter.joint().covariance(), before);
  Hypothesis prior(PoseStackd({SE3d(SO3d(), {0.0, -3e6, 0.0})}), Eigen::MatrixXd(sure));
  EXPECT_EQ(
      testing::thrown_message([&] {
        GaussianSumFilter(Posterior({{0.0, std::move(prior)}}), {});
      }),
      "filter: the prior is 3e+03 km from the origin of the world; expected at most 100 km, up "
      "to which double precision holds its errors: put the origin near the scene");
}

/// A camera that is given at a place so far away that nobody is.
TEST(FarOrigin, GivenPosesMayBeAnywhere) {
  testing::OrbitScene scene(2, 2, 0.05, 6e-4);
  const ObjectSensor sensor{testing::ray_noise(), {}};
  const Matrix6d sure = testing::isotropic(0.1, 0.01);
  const SE3d far(SO3d(), {4e5, 5.4e6, 100.0});  // as coordinates of UTM
  MultiObjectFilter filter({SE3d(), testing::isotropic(1.0, 0.1)}, {sensor, sensor}, {});
  for (int frame = 0; frame < 50; ++frame) {
    scene.advance();
    filter.set_camera({far * scene.camera, far.adjoint_congruence(sure)}, 0.1);
    for (std::size_t j = 0; j < 2; ++j) filter.update(j, observation_of(scene.detect(j, 0.3, 0.0)));
  }
  for (std::size_t j = 0; j < 2; ++j) {
    const ObjectHypothesis found = filter.hypotheses(j)[*filter.leading(j)];
    const ConcentratedGaussian<SE3d> near(
        far.inverse() * found.pose,
        far.inverse().adjoint_congruence(found.covariance) + Matrix6d::Identity() * 1e-12);
    EXPECT_LT(testing::nees_of(scene.truth[j], near), 40.0);
    EXPECT_LT(near.covariance().diagonal().tail<3>().maxCoeff(), 0.02 * 0.02);
  }
}

}  // namespace
}  // namespace posemix
