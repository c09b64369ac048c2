// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// How coordinates change where a detection moves poses far, and where it is linearised.
#include <cmath>

#include <gtest/gtest.h>

#include "filter/multi_object/detection_update.hpp"
#include "filter/multi_object/transport.hpp"
#include "scenario.hpp"

namespace posemix {
namespace {

using internal::PairTransport;
using internal::TransportMap;
using testing::isotropic;
using testing::pose;

/// d/dx of `moved` at zero, by central differences.
template <class Moved>
Matrix6d derivative_of_move(const Moved& moved) {
  constexpr double kStep = 1e-6;
  Matrix6d result;
  for (Eigen::Index k = 0; k < 6; ++k) {
    const Vector6d by = kStep * Vector6d::Unit(k);
    result.col(k) = ((moved(by) * moved(Vector6d(-by)).inverse()).log()) / (2.0 * kStep);
  }
  return result;
}

Vector6d some_tangent(double rotation, double position) {
  return (Vector6d() << rotation, -0.5 * rotation, 0.3 * rotation, position, 0.4 * position,
          -0.7 * position)
      .finished();
}

TEST(Transport, IsTheDerivativeOfTheMoveOfAPairOfWhichOneStays) {
  const SE3d camera = pose(0.3, -0.2, 0.9, 1.0, 2.0, -0.5);
  const SE3d object = pose(1.3, 0.2, -0.4, 2.0, 1.0, 0.5);
  const Vector6d by = some_tangent(0.4, 1.5);
  // The object is certain: G = 0, and r is its error.
  const PairTransport pair({camera, SE3d::exp(by) * camera}, {object, object}, Matrix6d::Zero());
  const TransportMap of_camera = pair.of_camera();
  EXPECT_TRUE(of_camera.camera.isApprox(
      derivative_of_move([&](const Vector6d& x) { return SE3d::exp(by + x); }), 1e-6));
  EXPECT_TRUE(
      Matrix6d(of_camera.own + of_camera.camera + of_camera.object).isApprox(Matrix6d::Identity()));
  const TransportMap of_object = pair.of_object();
  EXPECT_TRUE(of_object.object.isApprox(Matrix6d::Identity(), 1e-12));
}

TEST(Transport, TakesAlongWhatMovedWithTheCamera) {
  const SE3d camera = pose(0.3, -0.2, 0.9, 1.0, 2.0, -0.5);
  const SE3d object = pose(1.3, 0.2, -0.4, 2.0, 1.0, 0.5);
  const SE3d other = pose(0.1, 0.7, 0.2, 1.2, 2.2, -0.1);
  const Vector6d by = some_tangent(0.4, 1.5);
  const Vector6d beyond = some_tangent(0.02, 0.03);
  const PairTransport pair({camera, SE3d::exp(by) * camera}, {object, object}, Matrix6d::Zero());
  SE3d to = SE3d::exp(by + beyond) * other;
  const TransportMap map = pair.of_other(other, to);
  EXPECT_TRUE(
      (to * other.inverse()).log().isApprox((SE3d::exp(by) * SE3d::exp(beyond)).log(), 1e-12));
  EXPECT_TRUE(map.own.isApprox(
      derivative_of_move([&](const Vector6d& x) { return SE3d::exp(by) * SE3d::exp(beyond + x); }),
      1e-6));
  EXPECT_TRUE(Matrix6d(map.own + map.camera + map.object).isApprox(Matrix6d::Identity()));
  // One that stays, next to the object, keeps its coordinates.
  SE3d still = other;
  EXPECT_TRUE(pair.of_other(other, still).own.isApprox(Matrix6d::Identity(), 1e-12));
}

/// The derivative of Log(T_C Y T_O^-1) where a detection takes a camera beside an object that is
/// known, or an object before a camera that is.
TEST(Linearisation, IsThatOfThePlaceWhereTheDetectionTakesThePoses) {
  const DetectorNoise noise = DetectorNoise(
      {{.weight = 1.0, .covariance = isotropic(1.0, 1e-6), .frame = NoiseFrame::ray}});
  const ObjectSensor sensor{noise};
  for (const bool moves_camera : {true, false}) {
    internal::DetectionState state{pose(0.3, -0.2, 0.9, 1.0, 2.0, -0.5),
                                   pose(1.3, 0.2, -0.4, 2.0, 1.0, 0.5)};
    state.has_slow = false;
    const Matrix6d wide = isotropic(60.0, 3.0);
    const Matrix6d sharp = isotropic(1e-5, 1e-7);
    state.covariance.topLeftCorner<6, 6>() = moves_camera ? wide : sharp;
    state.covariance.block<6, 6>(6, 6) = moves_camera ? sharp : wide;
    const SE3d moved = SE3d::exp(some_tangent(0.4, 1.2));
    const SE3d seen = moves_camera ? (moved * state.camera).inverse() * state.object
                                   : state.camera.inverse() * (moved * state.object);
    const internal::WeighedObservation observation =
        internal::weigh(observation_of(seen), sensor, 1.0, {});
    internal::Explanation explanation = internal::explain(state, observation, sensor);
    internal::linearise_there(state, observation, sensor, explanation);
    const internal::Innovation& innovation = explanation.inlier();
    const SE3d camera = moves_camera ? moved * state.camera : state.camera;
    const SE3d object = moves_camera ? state.object : moved * state.object;
    const Vector6d by = some_tangent(0.4, 1.2);
    const Matrix6d k = derivative_of_move([&](const Vector6d& x) { return SE3d::exp(by + x); });
    const NoiseAtPose at = noise_at(noise.components().front(), seen);
    const Matrix6d there = (camera * at.axes).adjoint_congruence(at.covariance);
    const Matrix6d expected = k.inverse() * there * k.inverse().transpose();
    EXPECT_TRUE(innovation.noise.isApprox(expected, 1e-3)) << moves_camera;
    // What is left beyond the linear model is nothing: the detection has no error.
    EXPECT_LT((innovation.residual - (moves_camera ? Vector6d(-by) : by)).norm(), 1e-3)
        << moves_camera;
    EXPECT_LT((camera * seen * object.inverse()).log().norm(), 1e-9);
  }
}

TEST(LinearRange, IsLessForAPoseWhoseRotationIsLessCertain) {
  const internal::LinearRange range(isotropic(1.0, 0.001));
  const SE3d from = pose(0.1, 0.2, 0.3, 1, 2, 3);
  const SE3d to = SE3d(SO3d(), Eigen::Vector3d(0.004, 0, 0)) * from;
  EXPECT_TRUE(range.has(from, to, std::pow(0.14, 2)));
  EXPECT_FALSE(range.has(from, to, std::pow(0.16, 2)));
  EXPECT_FALSE(range.has(from, from * pose(0.35, 0, 0, 0, 0, 0), 0.0));
}

}  // namespace
}  // namespace posemix
