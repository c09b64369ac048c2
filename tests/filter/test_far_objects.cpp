// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "base/state_writer.hpp"
#include "filter/multi_object/state_fields.hpp"
#include "multi_object_scene.hpp"

/// Objects that are far from the camera, which has driven away or is given elsewhere: nothing of
/// them is lost to rounding.
namespace posemix {
namespace {

using testing::draw;
using testing::isotropic;
using testing::OrbitScene;

/// Of a pose that turns about its own place, in the world.
Matrix6d about(const Eigen::Vector3d& place, double rotation_deg, double translation_m) {
  return SE3d(SO3d(), place).adjoint_congruence(isotropic(rotation_deg, translation_m));
}

/// NEES per degree of freedom, as seen from a world whose origin is at the pose.
double nees_near(const ConcentratedGaussian<SE3d>& found, const SE3d& truth) {
  const SE3d near(SO3d(), -truth.translation());
  const Matrix6d p = near.adjoint_congruence(found.covariance());
  const Vector6d error = ((near * truth) * (near * found.mean()).inverse()).log();
  return error.dot(p.llt().solve(error)) / 6.0;
}

void see(MultiObjectFilter& filter, OrbitScene& scene, std::size_t objects) {
  for (std::size_t j = 0; j < objects; ++j) filter.update(j, scene.detect(j, 0.0, 0.0));
}

/// The way of a robot that drives away and comes back.
struct Trip {
  double start_deg;
  double distance_m;
  int frames;

  friend std::ostream& operator<<(std::ostream& out, const Trip& trip) {
    return out << trip.start_deg << " deg, " << trip.distance_m << " m, " << trip.frames
               << " frames";
  }
};

class FarObjects : public ::testing::TestWithParam<Trip> {};

TEST_P(FarObjects, StayAsTheyAreWhileARobotDrivesAwayAndComesBack) {
  const auto [start_deg, distance_m, frames] = GetParam();
  OrbitScene scene(3, 3, 0.05, 6e-4);
  MultiObjectFilter filter({scene.camera, about(scene.camera.translation(), start_deg, 0.005)},
                           std::vector<ObjectSensor>(3, {testing::ray_noise()}), {});
  for (int k = 0; k < 30; ++k) {
    filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    see(filter, scene, 3);
  }
  const auto before = filter.leading_estimates();
  const SE3d step(SO3d(), {0.0, 0.0, distance_m / frames});
  for (const SE3d& motion : {step, step.inverse()}) {
    for (int k = 0; k < frames; ++k) filter.predict_with_odometry(motion, Matrix6d::Zero(), 0.1);
    for (std::size_t j = 0; j < 3; ++j) {
      // The constructor refuses what is not symmetric and positive definite.
      for (const ObjectHypothesis& h : filter.hypotheses(j))
        EXPECT_NO_THROW(ConcentratedGaussian<SE3d>(h.pose, h.covariance));
      const auto now = filter.leading_estimates()[j];
      EXPECT_LT((now->world.mean().inverse() * before[j]->world.mean()).log().norm(), 1e-12);
      EXPECT_LT((now->world.covariance() - before[j]->world.covariance()).norm(),
                1e-12 * before[j]->world.covariance().norm());
    }
    EXPECT_NO_THROW(
        ConcentratedGaussian<PoseStackd>(filter.joint().mean(), filter.joint().covariance()));
  }
  for (int k = 0; k < 10; ++k) see(filter, scene, 3);
  for (std::size_t j = 0; j < 3; ++j) {
    const auto relative = filter.leading_estimates()[j]->relative;
    EXPECT_LT(nees_near(relative, scene.camera.inverse() * scene.truth[j]), 3.0) << j;
  }
}

INSTANTIATE_TEST_SUITE_P(Trips, FarObjects,
                         ::testing::Values(Trip{0.05, 15e3, 5000}, Trip{0.5, 3e3, 1500},
                                           Trip{0.5, 1e6, 10000}, Trip{90.0, 5e4, 500},
                                           Trip{90.0, 1e6, 10000}));

/// Of an object that is new to the filter nothing is known that would be near the camera.
TEST(FarObjectsOfASession, StayAsTheyAreWhereAnotherIsAddedFarAway) {
  for (const double distance : {1e4, 1e6, 1e8}) {
    OrbitScene scene(3, 3, 0.05, 6e-4);
    MultiObjectFilter filter({scene.camera, about(scene.camera.translation(), 20.0, 0.005)},
                             std::vector<ObjectSensor>(3, {testing::ray_noise()}), {});
    for (int k = 0; k < 10; ++k) {
      filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
      see(filter, scene, 3);
    }
    const auto before = filter.leading_estimates();
    const SE3d there(SO3d(), {0.0, 0.0, distance});
    filter.predict_with_odometry(there, scene.q, 0.1);
    filter.add_object({testing::ray_noise()});
    for (std::size_t j = 0; j < 3; ++j) {
      const Matrix6d& stated = before[j]->world.covariance();
      const Matrix6d now = filter.leading_estimates()[j]->world.covariance();
      EXPECT_LT((now - stated).norm(), 1e-12 * stated.norm()) << distance;
      for (const ObjectHypothesis& h : filter.hypotheses(j))
        EXPECT_NO_THROW(ConcentratedGaussian<SE3d>(h.pose, h.covariance)) << distance;
    }
  }
}

/// The shelf is known far from where the robot begins, which is told later to be near it.
TEST(KnownObjectsFarAway, KeepWhatIsKnownOfThem) {
  for (const double distance : {3e5, 9e5}) {
    for (const bool first : {true, false}) {
      OrbitScene scene(5, 3, 0.05, 6e-4);
      const SE3d far(SO3d(), {distance, 0.2 * distance, 0.0});
      const SE3d shelf = far * scene.truth[0];
      MultiObjectFilter filter({scene.camera, isotropic(0.5, 0.005)},
                               std::vector<ObjectSensor>(3, {testing::ray_noise()}), {});
      const auto add = [&] {
        return filter.add_object(
            {testing::ray_noise()},
            ObjectPrior{{shelf, about(shelf.translation(), 0.5, 0.005)}, 0.95});
      };
      if (first) add();
      for (int k = 0; k < 30; ++k) {
        filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
        see(filter, scene, 3);
      }
      const SE3d there = far * scene.camera;
      const Matrix6d given = about(there.translation(), 20.0, 1.0);
      const SE3d near_there(SO3d(), there.translation());
      filter.set_camera({near_there * SE3d::exp(draw(isotropic(10.0, 0.5), scene.stream)) *
                             near_there.inverse() * there,
                         given},
                        0.1);
      if (!first) add();
      for (int k = 0; k < 30; ++k) {
        if (k > 0) filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
        filter.update(3, scene.detect(0, 0.0, 0.0));
      }
      const auto found = filter.leading_estimates()[3];
      const Matrix6d own =
          SE3d(SO3d(), -shelf.translation()).adjoint_congruence(found->world.covariance());
      EXPECT_NEAR(std::sqrt(own(4, 4)), 0.005, 2e-4) << distance << first;
      EXPECT_LT(nees_near(found->world, shelf), 3.0) << distance << first;
      EXPECT_LT(nees_near(filter.camera(), far * scene.camera), 4.0) << distance << first;
    }
  }
}

TEST(KnownObjectsFarAway, AreRefusedForTheirOwnErrorsAndNotForWhereTheCameraIs) {
  const SE3d object = testing::pose(0.2, 0.1, 0.0, 0.1, 0.1, 0.05);
  const auto add = [&](double camera_m, double rotation_deg) {
    MultiObjectFilter filter(
        {SE3d(SO3d(), {camera_m, 0.0, 0.0}), about({camera_m, 0.0, 0.0}, 0.5, 0.005)},
        std::vector<ObjectSensor>(), {});
    DetectorNoise sharp({{.weight = 1.0, .covariance = isotropic(0.5, 0.002)}});
    filter.add_object({sharp}, ObjectPrior{{object, isotropic(rotation_deg, 0.02)}, 0.9});
  };
  EXPECT_NO_THROW(add(3e5, 2.0));
  EXPECT_NO_THROW(add(1e6, 2.0));
  EXPECT_NO_THROW(add(1e4, 104.0));
  try {
    add(1e6, 104.0);
    ADD_FAILURE() << "taken";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("the prior is 1e+03 km from the camera"),
              std::string::npos)
        << error.what();
  }
}

/// Every bit of a saved state.
std::string bits_of(const MultiObjectFilter& filter) {
  internal::StateWriter writer;
  writer(filter);
  return std::move(writer).take();
}

TEST(KnownObjectsFarAway, ThatAreRefusedLeaveEveryBit) {
  const OrbitScene scene(1, 1, 0.05, 6e-4);
  MultiObjectFilter filter({SE3d(), isotropic(0.5, 0.005)},
                           std::vector<ObjectSensor>(1, {testing::ray_noise()}), {});
  filter.update(0, testing::pose(0.2, 0.1, 0.0, 0.1, 0.1, 0.9));
  filter.predict_with_odometry(SE3d(SO3d(), {1e6, 0.0, 0.0}), scene.q, 0.1);
  const std::string before = bits_of(filter);
  const ObjectPrior turned{{SE3d(), isotropic(104.0, 0.005)}, 0.9};
  const ObjectPrior unlikely{{SE3d(), isotropic(0.5, 0.005)}, 1.5};
  for (const ObjectPrior& prior : {turned, unlikely}) {
    EXPECT_THROW(filter.add_object({testing::ray_noise()}, prior), InvalidInput);
    EXPECT_EQ(bits_of(filter), before);
  }
}

/// What is known of the camera at the start, and how the world becomes known.
struct Start {
  double rotation_deg;
  double translation_m;
  bool has_prior;
  bool is_seen;

  friend std::ostream& operator<<(std::ostream& out, const Start& start) {
    return out << start.rotation_deg << " deg, " << start.translation_m << " m"
               << (start.has_prior ? ", prior" : "") << (start.is_seen ? ", seen" : "");
  }
};

class ManyObjects : public ::testing::TestWithParam<Start> {};

/// More objects than are active at once, in a world of which little is known but where the camera
/// is: what objects have apart from it stays.
TEST_P(ManyObjects, StayRightInAnUncertainWorld) {
  constexpr std::size_t kMany = 50;
  const auto [rotation_deg, translation_m, has_prior, is_seen] = GetParam();
  OrbitScene scene(1, kMany, 0.05, 6e-4);
  for (std::size_t j = 0; j < kMany; ++j) {
    const auto row = static_cast<double>(j / 9), column = static_cast<double>(j % 9);
    scene.truth[j] = testing::pose(0.3 * column, 0.2, 0.5 - row, 0.08 * (column - 4.0),
                                   0.08 * (row - 3.0), 0.05);
  }
  const Matrix6d narrow = 0.09 * testing::ray_noise().components().front().covariance;
  const DetectorNoise noise({{.weight = 0.9, .covariance = narrow, .frame = NoiseFrame::ray}},
                            {.weight = 0.1, .volume_m3 = 1.0});
  MultiObjectFilter filter(
      {scene.camera, about(scene.camera.translation(), rotation_deg, translation_m)},
      std::vector<ObjectSensor>(kMany, {noise}), {});
  const auto detect = [&](std::size_t j) {
    const SE3d seen = scene.camera.inverse() * scene.truth[j];
    const NoiseAtPose at = noise_at(noise.components().front(), seen);
    return at.axes * SE3d::exp(draw(at.covariance, scene.stream)) * at.axes.inverse() * seen;
  };
  for (int k = 0; k < 20; ++k) {
    filter.predict_with_odometry(scene.advance(), scene.q, 0.1);
    if (k == 12 && has_prior) {
      const SE3d& known = scene.truth[0];
      filter.add_object({noise},
                        ObjectPrior{{known, about(known.translation(), 0.5, 0.005)}, 0.95});
    }
    for (std::size_t j = 0; j < kMany; ++j) filter.update(j, detect(j));
    if (is_seen && k >= 12) filter.update(kMany, detect(0));
  }
  const auto estimates = filter.leading_estimates();
  double mean = 0.0;
  for (std::size_t j = 0; j < kMany; ++j) {
    ASSERT_TRUE(estimates[j]);
    mean += nees_near(estimates[j]->relative, scene.camera.inverse() * scene.truth[j]) / kMany;
  }
  EXPECT_GT(mean, 0.5);
  EXPECT_LT(mean, 2.0);
  EXPECT_NO_THROW(
      ConcentratedGaussian<PoseStackd>(filter.joint().mean(), filter.joint().covariance()));
}

INSTANTIATE_TEST_SUITE_P(Starts, ManyObjects,
                         ::testing::Values(Start{90.0, 0.005, true, false},
                                           Start{90.0, 0.005, true, true},
                                           Start{0.5, 3.0, true, true},
                                           Start{5.0, 10.0, true, false},
                                           Start{0.5, 20.0, false, false}));

TEST(KnownObjectsFarAway, AreTakenWhereTheCameraCameBackTo) {
  for (const double distance : {2e4, 1e5}) {
    const OrbitScene scene(1, 1, 0.05, 6e-4);
    MultiObjectFilter filter({SE3d(), isotropic(60.0, 0.005)},
                             std::vector<ObjectSensor>(1, {testing::ray_noise()}), {});
    const auto drive = [&](double metres) {
      filter.predict_with_odometry(SE3d(SO3d(), {metres, 0.0, 0.0}), scene.q, 0.1);
    };
    drive(distance);
    filter.update(0, testing::pose(0.2, 0.1, 0.0, 0.1, 0.1, 0.9));
    drive(-distance);
    const SE3d before(SO3d(), {0.0, 0.0, 1.0});
    EXPECT_NO_THROW(
        filter.add_object({testing::ray_noise()},
                          ObjectPrior{{before, about(before.translation(), 60.0, 0.02)}, 0.9}))
        << distance;
  }
}

}  // namespace
}  // namespace posemix
