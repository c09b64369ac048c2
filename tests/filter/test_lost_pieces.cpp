// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <numbers>

#include "multi_object_scene.hpp"
#include "posemix/filter/multi_object_filter.hpp"

/// A camera without odometry that is lost between pieces of its path: each piece of the map is
/// certain in itself to a millimetre, and of where it is to metres.
namespace posemix {
namespace {

using namespace testing;

constexpr std::size_t kPerPiece = 6;
constexpr std::size_t kPieces = 5;

/// Tags on the walls of rooms, seen with two poses each of which the wrong one is as heavy.
struct Rooms {
  explicit Rooms(std::uint64_t seed) : stream(seed, 31) {
    for (std::size_t j = 0; j < kPerPiece * kPieces; ++j) {
      const auto room = static_cast<double>(j / kPerPiece);
      const auto place = static_cast<double>(j % kPerPiece);
      tags.push_back(pose(0.1 * place, 2.8, 0.3, 10.0 * room + 0.4 * place, 0.3 * place, 2.0));
    }
  }

  Observation see(const SE3d& camera, std::size_t j) {
    const Matrix6d r = isotropic(0.6, 0.003);
    const SE3d seen = camera.inverse() * tags[j] * SE3d::exp(draw(r, stream));
    const SE3d turned = seen * pose(1.2, 0, 0, 0, 0, 0) * SE3d::exp(draw(r, stream));
    const double right = stream.uniform() < 0.9 ? 0.7 : 0.3;
    Observation observation{.object = "tag", .components = {}};
    observation.components = {{.weight = right, .pose = seen, .covariance = r},
                              {.weight = 1.0 - right, .pose = turned, .covariance = r}};
    return observation;
  }

  RandomStream stream;
  std::vector<SE3d> tags;
};

class LostPieces : public ::testing::TestWithParam<double> {};

TEST_P(LostPieces, StaysFiniteAndPositiveDefinite) {
  Rooms rooms(7);
  const DetectorNoise noise({{.covariance = isotropic(1.0, 0.01)}},
                            {.weight = 0.01, .volume_m3 = 100.0},
                            {.slow = std::nullopt, .mode_time_s = GetParam()});
  MultiObjectSettings settings;
  settings.has_odometry = false;
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(SE3d(), isotropic(0.01, 1e-4)),
                           std::vector<ObjectSensor>(rooms.tags.size(), {noise}), settings);
  const Matrix6d walk = isotropic(60.0, 1.0);
  // Every room twice, so that pieces meet again.
  for (std::size_t visit = 0; visit < 2 * kPieces; ++visit) {
    const std::size_t room = visit % kPieces;
    if (visit > 0) filter.predict_random_walk(60.0 * walk, 60.0);
    for (int frame = 0; frame < 50; ++frame) {
      const SE3d camera = pose(0.02 * frame, 0.0, 0.01 * frame,
                               10.0 * static_cast<double>(room) + 0.02 * frame, 0.0, 0.0);
      if (frame > 0) filter.predict_random_walk(0.05 * walk, 0.05);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t j =
            room * kPerPiece + (static_cast<std::size_t>(frame) / 8 + k) % kPerPiece;
        filter.update(j, rooms.see(camera, j));
      }
      const ConcentratedGaussian<PoseStackd> joint = filter.joint();
      ASSERT_TRUE(joint.covariance().allFinite()) << visit << " " << frame;
      const Eigen::VectorXd sd = joint.covariance().diagonal().cwiseSqrt();
      const Eigen::MatrixXd correlation =
          sd.cwiseInverse().asDiagonal() * joint.covariance() * sd.cwiseInverse().asDiagonal();
      if (frame % 10 == 0) {
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation);
        ASSERT_GT(solver.eigenvalues()(0), -1e-9) << visit << " " << frame;
      }
      for (std::size_t i = 0; i < joint.mean().size(); ++i)
        ASSERT_LT(joint.mean()[i].translation().norm(), 1000.0) << visit << " " << frame;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(ModeTimes, LostPieces, ::testing::Values(0.3, 5.0));

}  // namespace
}  // namespace posemix
