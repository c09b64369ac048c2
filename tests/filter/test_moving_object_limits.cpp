// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The filter of one moving object at its limits: many places, no slow error, detections of nothing.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "moving_object_scene.hpp"

namespace posemix {
namespace {

using testing::kFramePeriod_s;
using testing::MovingScene;
using testing::plain_moving_settings;
using testing::pose;
using testing::SceneNoise;
using testing::sds;
using testing::thrown_message;

/// A covariance so large along one direction that an entry beyond the other variances is rounding
/// beside it, with such an entry that has no mirror image: a part of the product of the standard
/// deviations of its row and its column.
Matrix6d lopsided(double part) {
  Matrix6d covariance = testing::isotropic(1.0, 0.01);
  covariance(4, 4) = 1e8;
  covariance(0, 5) = part * std::sqrt(covariance(0, 0) * covariance(5, 5));
  return covariance;
}

/// A filter of an object that may be held, and was seen.
MovingObjectFilter filter_that_has_seen(MovingScene& scene, const DetectorNoise& noise) {
  const MotionModels models{.models = {StaticMotion{}, AttachedMotion{}},
                            .rates = Eigen::MatrixXd::Constant(2, 2, 0.5)};
  MovingObjectFilter filter({noise}, models, plain_moving_settings());
  filter.update(scene.observed(scene.inlier()), exact_camera(scene.camera), {KnownFrame{}});
  return filter;
}

/// All bits of what is reported.
std::vector<double> bits_of(const MovingObjectFilter& filter) {
  const MovingObjectEstimate estimate = filter.estimate();
  std::vector<double> all{estimate.time_s, estimate.lost_probability};
  for (const MovingObjectHypothesis& hypothesis : estimate.hypotheses) {
    const Eigen::Matrix4d mean = hypothesis.world.mean().matrix();
    all.insert(all.end(), mean.data(), mean.data() + mean.size());
    const Matrix6d& covariance = hypothesis.world.covariance();
    all.insert(all.end(), covariance.data(), covariance.data() + covariance.size());
    all.push_back(hypothesis.probability);
  }
  return all;
}

TEST(MovingObjectFilter, RefusesADetectorWhosePartsDifferBeyondWhatADoubleHolds) {
  Matrix6d wide = testing::isotropic(1.0, 0.01);
  wide(1, 1) = 2.5e15;
  const std::string message = thrown_message([&] {
    MovingObjectFilter({DetectorNoise({{1.0, wide}})});
  });
  EXPECT_NE(message.find("a component of a detector's noise has a standard deviation of 5e+07 rad"),
            std::string::npos)
      << message;
}

// However many places the detector shows.
TEST(MovingObjectFilter, KeepsNoMoreHypothesesThanItMay) {
  const DetectorNoise noise = SceneNoise{.clutter = 0.3}.noise();
  MovingScene scene(12, noise);
  MovingObjectSettings settings = plain_moving_settings();
  settings.max_hypotheses = 2;
  MovingObjectFilter filter({noise}, {}, settings);
  std::uint64_t newest = 0;
  for (int k = 0; k < 12; ++k) {
    scene.advance(StaticMotion{}, kFramePeriod_s);
    filter.update(scene.observed(k % 3 == 2 ? scene.anywhere() : scene.inlier()),
                  exact_camera(scene.camera));
    const MovingObjectEstimate estimate = filter.estimate();
    EXPECT_LE(estimate.hypotheses.size(), 2U) << k;
    double sum = estimate.lost_probability;
    for (const auto& hypothesis : estimate.hypotheses) {
      sum += hypothesis.probability;
      newest = std::max(newest, hypothesis.id);
    }
    EXPECT_NEAR(sum, 1.0, 1e-12) << k;
  }
  EXPECT_GT(newest, 2U);
}

// Without a slow error a detection is expected where the object is, up to its white error.
TEST(MovingObjectFilter, ExpectsDetectionsOfADetectorWithoutASlowErrorAtTheObject) {
  const DetectorNoise noise = SceneNoise{}.noise();
  MovingScene scene(13, noise);
  const MotionModels models{.models = {StaticMotion{}, RandomWalkMotion{sds(0.1, 0.03)}},
                            .rates = (Eigen::MatrixXd(2, 2) << 0.0, 0.5, 0.5, 0.0).finished()};
  MovingObjectFilter filter({noise}, models, plain_moving_settings());
  KnownCamera camera = exact_camera(scene.camera);
  camera.frame.covariance = testing::isotropic(0.1, 0.001);
  for (int k = 0; k < 5; ++k) {
    scene.advance(StaticMotion{}, kFramePeriod_s);
    filter.update(scene.observed(scene.inlier()), camera);
    const auto expected = filter.relative(camera);
    const auto detection = filter.predicted_detection(camera);
    EXPECT_TRUE(detection.mean().is_approx(expected.mean(), 1e-12));
    EXPECT_TRUE(detection.covariance().isApprox(expected.covariance(), 1e-9));
  }
}

// So far away that no component of the noise has any density there.
TEST(MovingObjectFilter, SaysThatADetectionFarAwayIsNotOfTheObject) {
  const DetectorNoise noise = SceneNoise{.flips = 0.1, .mode_time_s = 1.0}.noise();
  MovingScene scene(14, noise);
  MovingObjectFilter filter({noise}, {}, plain_moving_settings());
  for (int k = 0; k < 20; ++k) {
    scene.advance(StaticMotion{}, kFramePeriod_s);
    filter.update(scene.observed(scene.inlier()), exact_camera(scene.camera));
  }
  const SE3d far = scene.inlier() * pose(0.5, 1.5, 0.3, 0.3, 0.0, 0.0);
  const MovingObjectReport report = filter.update(scene.observed(far), exact_camera(scene.camera));
  EXPECT_GE(report.right_probability, 0.0);
  EXPECT_LT(report.right_probability, 1e-9);
  EXPECT_GE(report.inlier_probability, 0.0);
  EXPECT_LT(report.inlier_probability, 1e-9);
  EXPECT_TRUE(std::isfinite(report.log_evidence));
}

// Its mirror images were compared in units of its largest entry, and its definiteness was that of
// one triangle. The filter computes with the mean of both, and so reported a covariance that is
// none.
TEST(MovingObjectFilter, RefusesACovarianceThatIsNegativeInSomeDirectionAndStaysAsItWas) {
  const DetectorNoise noise = SceneNoise{}.noise();
  MovingScene scene(15, noise);
  MovingObjectFilter filter = filter_that_has_seen(scene, noise);
  const std::vector<double> before = bits_of(filter);
  const Matrix6d zero = Matrix6d::Zero();
  const Matrix6d upper = lopsided(3.0);
  for (const Matrix6d& bad : {upper, Matrix6d(upper.transpose())}) {
    const auto refused = [&](const std::string& what, const auto& action) {
      EXPECT_EQ(thrown_message(action), what + " is not positive semidefinite");
      EXPECT_EQ(bits_of(filter), before);
    };
    KnownCamera of_image = exact_camera(scene.camera);
    of_image.frame.covariance = bad;
    KnownCamera still = exact_camera(scene.camera);
    still.constant_covariance = bad;
    const std::vector<KnownFrame> held{{.covariance = bad}};
    const Observation seen = scene.observed(scene.inlier());
    refused("the covariance of a frame", [&] { filter.update(seen, of_image, {KnownFrame{}}); });
    refused("the constant covariance of the camera",
            [&] { filter.update(seen, still, {KnownFrame{}}); });
    refused("the covariance of a frame",
            [&] { filter.update(seen, exact_camera(scene.camera), held); });
    refused("the covariance of a frame", [&] { filter.predict(1.0, held); });
    refused("the covariance of a motion of the world",
            [&] { filter.move_world(SE3d(), bad, zero); });
    refused("the constant covariance of the camera", [&] { filter.move_world(SE3d(), zero, bad); });
    refused("the covariance of a frame", [&] { filter.relative(of_image); });
    Observation given = seen;
    given.components[0].covariance = bad;
    EXPECT_EQ(
        thrown_message([&] { filter.update(given, exact_camera(scene.camera), {KnownFrame{}}); }),
        "components[0].covariance is not positive definite");
    EXPECT_EQ(bits_of(filter), before);
  }
}

// Neither of its triangles is that of a covariance, and their mean is one.
TEST(MovingObjectFilter, ComputesWithTheSymmetricPartOfACovariance) {
  const DetectorNoise noise = SceneNoise{}.noise();
  const Matrix6d upper = lopsided(1.5);
  Matrix6d symmetric = upper;
  symmetrize(symmetric);
  const auto after = [&](const Matrix6d& covariance) {
    MovingScene scene(16, noise);
    MovingObjectFilter filter = filter_that_has_seen(scene, noise);
    filter.move_world(SE3d(), covariance, covariance);
    const KnownCamera camera{.frame = {.pose = scene.camera, .covariance = covariance},
                             .constant_covariance = covariance};
    const std::vector<KnownFrame> held{{.covariance = covariance}};
    for (int k = 0; k < 3; ++k) {
      scene.advance(StaticMotion{}, kFramePeriod_s);
      Observation observation = scene.observed(k == 1 ? scene.anywhere() : scene.inlier());
      observation.components[0].covariance = covariance;
      filter.update(observation, camera, held);
    }
    filter.predict(1.0, held);
    for (const auto& hypothesis : filter.estimate().hypotheses)
      EXPECT_EQ(Eigen::LLT<Matrix6d>(hypothesis.world.covariance()).info(), Eigen::Success);
    std::vector<double> all = bits_of(filter);
    for (const auto& relative : {filter.relative(camera), filter.predicted_detection(camera)}) {
      const Matrix6d& of_object = relative.covariance();
      all.insert(all.end(), of_object.data(), of_object.data() + of_object.size());
    }
    return all;
  };
  EXPECT_EQ(after(upper), after(symmetric));
  EXPECT_EQ(after(upper.transpose()), after(symmetric));
}

}  // namespace
}  // namespace posemix
