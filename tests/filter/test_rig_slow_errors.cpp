// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Slow errors of a detector whose cameras stand on one body: each has its own, by where it sees the
// object from (docs/many-objects.md, eq. 39 to 42).
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "drifted_camera_scene.hpp"
#include "filter/multi_object/other_cameras.hpp"
#include "posemix/detector/default_noise.hpp"

namespace posemix {
namespace {

using internal::is_same_camera;
using testing::draw;
using testing::isotropic;
using testing::nees_of;
using testing::NeesSummary;
using testing::pose;

/// A camera that looks along its body, and one that sees the object a metre ahead from elsewhere.
struct TwoViews {
  SE3d object = pose(0.3, 0.2, 0.1, 0, 0, 1.0);
  SE3d second;

  explicit TwoViews(double apart_deg) {
    const SE3d place(SO3d(), object.translation());
    second = place * pose(0, apart_deg * std::numbers::pi / 180.0, 0, 0, 0, 0) * place.inverse();
  }
};

struct Result {
  NeesSummary nees;  ///< of the object from the body
  double square_m = 0.0;
  double rms_mm(std::uint64_t runs) const {
    return 1e3 * std::sqrt(square_m / static_cast<double>(runs));
  }
};

constexpr std::uint64_t kSlowRigSeeds = 24;
constexpr double kStanding = 0.0;
constexpr double kOrbit_rad = 0.02;

/// A rig that stands, or circles the object, whose detector errs as its model says: slow errors of
/// the cameras are one process over the direction that they see from.
Result run_rig(const DetectorNoise& noise, double apart_deg, int cameras, double turn_rad) {
  const SlowError slow = *noise.dependence().slow;
  const NoiseComponent& white = noise.components().front();
  const Matrix6d q = isotropic(0.02, 2e-4);
  Result result;
  for (std::uint64_t seed = 1; seed <= kSlowRigSeeds; ++seed) {
    const TwoViews views(apart_deg);
    const SE3d place(SO3d(), views.object.translation());
    const SE3d motion = place * pose(0, turn_rad, 0, 0, 0, 0) * place.inverse();
    RandomStream stream(seed, 11);
    const Matrix6d start = isotropic(0.05, 1e-3);
    MultiObjectFilter filter({SE3d::exp(draw(start, stream)).inverse(), start},
                             {ObjectSensor{noise}}, {});
    const double with_other = slow.correlation(0.0, radians(apart_deg));
    const auto drawn = [&](const Vector6d& one) -> Vector6d {
      return with_other * one +
             std::sqrt(1.0 - with_other * with_other) * draw(slow.covariance, stream);
    };
    std::vector<Vector6d> b{draw(slow.covariance, stream)};
    b.push_back(drawn(b[0]));
    const double a = slow.correlation(0.0, turn_rad);
    SE3d body;
    for (int frame = 0; frame < 100; ++frame) {
      for (int camera = 0; camera < cameras; ++camera) {
        const SE3d body_camera = camera == 0 ? SE3d() : views.second;
        const SE3d seen = (body * body_camera).inverse() * views.object;
        const NoiseAtPose at = noise_at(white, seen);
        Vector6d error = b[static_cast<std::size_t>(camera)];
        error.tail<3>() *= seen.translation().norm();
        error += draw(at.covariance, stream);
        filter.update(0, observation_of(at.axes * SE3d::exp(error) * at.axes.inverse() * seen),
                      {.body_camera = body_camera});
      }
      body = body * motion;
      filter.predict_with_odometry(motion * SE3d::exp(draw(q, stream)).inverse(), q, 0.1);
      const Vector6d fresh = draw(slow.covariance, stream);
      const Vector6d fresh_other = drawn(fresh);
      b[0] = a * b[0] + std::sqrt(1.0 - a * a) * fresh;
      b[1] = a * b[1] + std::sqrt(1.0 - a * a) * fresh_other;
    }
    const SE3d truth = body.inverse() * views.object;
    const LeadingEstimate estimate = *filter.leading_estimates()[0];
    result.nees.add(nees_of(truth, estimate.relative) / 6.0);
    result.square_m += (truth.translation() - estimate.relative.mean().translation()).squaredNorm();
  }
  return result;
}

/// Two cameras in place of one: they know more of the object, and what they say is true. Taken for
/// one slow error they had NEES of 6 to 18, and were farther off than one camera.
TEST(RigSlowErrors, TwoCamerasKnowMoreThanOneByTheDefaults) {
  const Result one = run_rig(default_detector_noise(), 0.0, 1, kStanding);
  for (const double apart_deg : {15.0, 30.0, 60.0, 90.0}) {
    const Result two = run_rig(default_detector_noise(), apart_deg, 2, kStanding);
    EXPECT_GT(two.nees.mean(), 0.4) << apart_deg;
    EXPECT_LT(two.nees.mean(), 1.6) << apart_deg;
    EXPECT_LT(two.nees.worst, 8.0) << apart_deg;
    EXPECT_LT(two.rms_mm(kSlowRigSeeds), 0.7 * one.rms_mm(kSlowRigSeeds)) << apart_deg;
    const Result moving = run_rig(default_detector_noise(), apart_deg, 2, kOrbit_rad);
    EXPECT_GT(moving.nees.mean(), 0.4) << apart_deg;
    EXPECT_LT(moving.nees.mean(), 1.5) << apart_deg;
  }
}

/// A tenth as large, where all is linear; the white error of the first component alone.
TEST(RigSlowErrors, AreAsLeastSquaresHasThem) {
  const DetectorNoise given = default_detector_noise();
  NoiseComponent white = given.components().front();
  white.covariance *= 1e-4;
  SlowError slow = *given.dependence().slow;
  slow.covariance *= 1e-4;
  const DetectorNoise noise({white}, {.weight = 0.01, .volume_m3 = 1.0}, {.slow = slow});
  for (const double apart_deg : {15.0, 60.0, 120.0}) {
    const TwoViews views(apart_deg);
    RandomStream stream(3, 7);
    const Matrix6d start = isotropic(1e-4, 1e-6);
    MultiObjectSettings settings;
    settings.noise_scale_detections = std::numeric_limits<double>::infinity();
    MultiObjectFilter filter({SE3d(), start}, {ObjectSensor{noise}}, settings);
    constexpr int kFrames = 30;
    for (int frame = 0; frame < kFrames; ++frame) {
      for (const SE3d& body_camera : {SE3d(), views.second})
        filter.update(0, observation_of(body_camera.inverse() * views.object),
                      {.body_camera = body_camera});
      filter.predict_with_odometry(SE3d(), 1e-6 * start, 0.1);
    }
    // [e + b_1; e + b_2] with the error of the mean of all detections.
    Eigen::Matrix<double, 12, 6> h;
    Eigen::Matrix<double, 12, 12> of_both;
    const double a = slow.correlation(0.0, radians(apart_deg));
    const Matrix6d mean = white.covariance / kFrames;
    of_both << slow.covariance + mean, a * slow.covariance, a * slow.covariance,
        slow.covariance + mean;
    int row = 0;
    for (const SE3d& body_camera : {SE3d(), views.second}) {
      const SE3d seen = body_camera.inverse() * views.object;
      const NoiseAtPose at = noise_at(white, seen);
      const Vector6d units = at.units;
      const SE3d axes = body_camera * at.axes;
      h.middleRows<6>(row) = units.cwiseInverse().asDiagonal() * axes.inverse().adjoint();
      row += 6;
    }
    const Matrix6d information = h.transpose() * of_both.llt().solve(h);
    const Matrix6d expected = information.llt().solve(Matrix6d::Identity());
    const Matrix6d found = filter.leading_estimates()[0]->relative.covariance();
    // Along the axes of the object, where it is.
    const SE3d place = views.object.inverse();
    const Vector6d ratio = place.adjoint_congruence(found).diagonal().cwiseQuotient(
        place.adjoint_congruence(expected).diagonal());
    EXPECT_LT(ratio.maxCoeff(), 1.1) << apart_deg;
    EXPECT_GT(ratio.minCoeff(), 0.8) << apart_deg;
  }
}

/// The object is seen by both cameras in turn, then something known tells that the world is turned,
/// and both see the object again. Returns the NEES of the object from the body.
double nees_in_turned_world(std::uint64_t seed, double turned_deg) {
  const DetectorNoise noise = default_detector_noise();
  const NoiseComponent& white = noise.components().front();
  const SlowError slow = *noise.dependence().slow;
  const TwoViews views(20.0);
  const SE3d cameras[] = {SE3d(), views.second};
  const SE3d known = pose(0, 0, 0, 0.3, 0, 1.0);
  const Matrix6d sharp = isotropic(0.5, 2e-3);
  const DetectorNoise tag({{.weight = 0.95, .covariance = sharp}},
                          {.weight = 0.05, .volume_m3 = 1.0});
  RandomStream stream(seed, 5);
  const SE3d world(SO3d::exp(radians(turned_deg) * Eigen::Vector3d(0.6, 0.0, 0.8)), {0.1, 0, 0});
  MultiObjectFilter filter({world, isotropic(75.0, 0.3)}, {ObjectSensor{noise}}, {});
  filter.add_object(
      ObjectSensor{tag},
      ObjectPrior{.world = {known, SE3d(SO3d(), known.translation()).adjoint_congruence(sharp)}});
  std::vector<Vector6d> b{draw(slow.covariance, stream)};
  const double a = slow.correlation(0.0, radians(20.0));
  b.emplace_back(a * b[0] + std::sqrt(1.0 - a * a) * draw(slow.covariance, stream));
  const Matrix6d q = isotropic(0.02, 2e-4);
  const auto stand = [&] {
    filter.predict_with_odometry(SE3d::exp(draw(q, stream)).inverse(), q, 0.1);
  };
  const auto see_in_turns = [&] {
    for (std::size_t camera = 0; camera < 2; ++camera) {
      for (int frame = 0; frame < 15; ++frame) {
        const SE3d seen = cameras[camera].inverse() * views.object;
        const NoiseAtPose at = noise_at(white, seen);
        Vector6d error = b[camera];
        error.tail<3>() *= seen.translation().norm();
        error += draw(at.covariance, stream);
        filter.update(0, observation_of(at.axes * SE3d::exp(error) * at.axes.inverse() * seen),
                      {.body_camera = cameras[camera]});
        stand();
      }
    }
  };
  see_in_turns();
  for (int frame = 0; frame < 5; ++frame) {
    filter.update(1, SE3d::exp(draw(sharp, stream)) * known);
    stand();
  }
  see_in_turns();
  return nees_of(views.object, filter.leading_estimates()[0]->relative) / 6.0;
}

/// What the cameras know of each other turns with the world: NEES were 0.9 without a turn and 1.7
/// after 90 deg.
TEST(RigSlowErrors, TurnWithAWorldThatWasWrong) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const double as_it_is = nees_in_turned_world(seed, 0.0);
    EXPECT_NEAR(nees_in_turned_world(seed, 30.0), as_it_is, 0.05 * as_it_is + 0.02) << seed;
    EXPECT_NEAR(nees_in_turned_world(seed, 90.0), as_it_is, 0.3 * as_it_is + 0.05) << seed;
  }
}

/// The sum that a detection sees stays where slow errors are rescaled, and so does what is known of
/// the sum of another camera.
TEST(RigSlowErrors, AreRescaledWithThePose) {
  RandomStream stream(4, 2);
  const Matrix6d map = isotropic(20.0, 0.4);
  internal::OtherCamera other;
  other.mean = draw(map, stream);
  other.covariance = isotropic(1.0, 0.01);
  for (Eigen::Index k = 0; k < 12; ++k) other.given.col(k) = draw(isotropic(30.0, 0.5), stream);
  const Vector6d factor = Vector6d::LinSpaced(0.7, 1.3);
  const internal::OtherCamera before = other;
  rescale(other, factor, map);
  const Vector6d e = draw(map, stream);
  const Vector6d b = draw(map, stream);  // from its mean
  const Vector6d e_after = e + map * (Vector6d::Ones() - factor).cwiseProduct(b);
  const Vector6d told = before.mean + before.on_error() * e + before.on_seeing() * b;
  const Vector6d told_after =
      other.mean + other.on_error() * e_after + other.on_seeing() * factor.cwiseProduct(b);
  EXPECT_LT((told_after - factor.cwiseProduct(told)).norm(), 1e-12);
}

/// What is predicted of a camera's detection has its own slow error, before it sees, too.
TEST(RigSlowErrors, APredictionIsThatOfTheCamera) {
  const TwoViews views(60.0);
  const Matrix6d start = isotropic(0.05, 1e-3);
  MultiObjectFilter filter({SE3d(), start}, {ObjectSensor{default_detector_noise()}}, {});
  for (int frame = 0; frame < 5; ++frame) filter.update(0, views.object);
  const ObservationSource other{.body_camera = views.second};
  const auto before = filter.predicted_detection(0, 0, other);
  const auto own = filter.predicted_detection(0, 0, ObservationSource{});
  // Along the ray of the other camera there are both slow errors.
  EXPECT_GT(before.covariance().trace(), 1.2 * own.covariance().trace());
  filter.update(0, observation_of(views.second.inverse() * views.object), other);
  const auto first_again = filter.predicted_detection(0, 0, ObservationSource{});
  EXPECT_LT(first_again.covariance().trace(), 1.05 * own.covariance().trace());
}

TEST(RigSlowErrors, CamerasAreTheSameByPoseOrByIndex) {
  const SE3d there = pose(0.1, 0.2, 0.3, 1, 2, 3);
  EXPECT_TRUE(is_same_camera({.body_camera = there}, {.body_camera = there, .detector = 1}));
  EXPECT_FALSE(is_same_camera({.body_camera = there}, {}));
  EXPECT_TRUE(is_same_camera({.camera = 1}, {.body_camera = there, .camera = 1}));
  EXPECT_FALSE(is_same_camera({.camera = 1}, {.camera = 0}));
  EXPECT_FALSE(is_same_camera({.camera = 0}, {}));
}

/// A camera that is moved on its body has another pose there with every detection.
TEST(RigSlowErrors, ACameraThatIsMovedOnItsBodyIsFollowed) {
  const SE3d object = pose(0.3, 0.2, 0.1, 0, 0, 1.0);
  const Matrix6d start = isotropic(0.05, 1e-3);
  MultiObjectFilter filter({SE3d(), start}, {ObjectSensor{default_detector_noise()}}, {});
  MultiObjectFilter still = filter;
  for (int frame = 0; frame < 60; ++frame) {
    const SE3d body_camera = pose(0, 0.005 * frame, 0, 0.001 * frame, 0, 0);
    filter.update(0, observation_of(body_camera.inverse() * object), {.body_camera = body_camera});
    still.update(0, object);
    filter.predict_with_odometry(SE3d(), 1e-4 * start, 0.1);
    still.predict_with_odometry(SE3d(), 1e-4 * start, 0.1);
  }
  const auto moved = filter.leading_estimates()[0]->relative;
  const auto fixed = still.leading_estimates()[0]->relative;
  EXPECT_LT((moved.mean().translation() - object.translation()).norm(), 5e-3);
  EXPECT_GT(moved.covariance().trace(), 0.5 * fixed.covariance().trace());
  EXPECT_LT(moved.covariance().trace(), 1.2 * fixed.covariance().trace());
}

}  // namespace
}  // namespace posemix
