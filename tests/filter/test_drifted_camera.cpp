// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A camera whose odometry drifts by many standard deviations of the detector, as it says, with the
// default settings: what is seen again corrects the camera, and what was seen since moves with it.
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "filter/multi_object/detection_update.hpp"
#include "filter/multi_object/transport.hpp"
#include "moving_object_scene.hpp"
#include "posemix/filter/multi_object_filter.hpp"

namespace posemix {
namespace {

using internal::PairTransport;
using internal::TransportMap;
using testing::draw;
using testing::isotropic;
using testing::nees_of;
using testing::pose;

DetectorNoise sharp_tag_noise(const Eigen::Vector3d& position_sds_m, double volume_m3 = 1.0,
                              bool is_typical = false) {
  const Matrix6d covariance =
      pose_covariance(Eigen::Vector3d::Constant(radians(1.0)), position_sds_m);
  return DetectorNoise({{.weight = 0.95, .covariance = covariance, .frame = NoiseFrame::ray}},
                       {.weight = 0.05, .volume_m3 = volume_m3}, {.is_typical = is_typical});
}

DetectorNoise sharp_tag_noise(double position_sd_m) {
  return sharp_tag_noise(Eigen::Vector3d::Constant(position_sd_m));
}

/// A camera among tags that stand still; detections and odometry err as they say.
class TagTrip {
 public:
  TagTrip(std::uint64_t seed, const DetectorNoise& noise, std::vector<SE3d> tags)
      : tags_(std::move(tags)),
        stream_(seed, 5),
        noise_(noise),
        filter_(ConcentratedGaussian<SE3d>(
                    SE3d::exp(draw(isotropic(0.01, 1e-3), stream_)).inverse() * camera_,
                    isotropic(0.01, 1e-3)),
                std::vector<ObjectSensor>(tags_.size(), ObjectSensor{noise_}), {}) {}

  void see(std::size_t tag) {
    const SE3d seen = camera_.inverse() * tags_[tag];
    const NoiseAtPose at = noise_at(noise_.components().front(), seen);
    filter_.update(tag,
                   at.axes * SE3d::exp(draw(at.covariance, stream_)) * at.axes.inverse() * seen);
  }
  void go(const SE3d& motion, double rotation_sd_deg, double position_sd_m) {
    const Matrix6d q = isotropic(rotation_sd_deg, position_sd_m);
    camera_ = camera_ * motion;
    filter_.predict_with_odometry(motion * SE3d::exp(draw(q, stream_)).inverse(), q, 0.1);
  }
  double camera_nees() const { return nees_of(camera_, filter_.camera()) / 6.0; }
  /// As seen from the camera.
  double relative_nees(std::size_t tag) const {
    return nees_of(camera_.inverse() * tags_[tag], filter_.leading_estimates()[tag]->relative) /
           6.0;
  }
  double tag_nees(std::size_t tag) const {
    return nees_of(tags_[tag], filter_.leading_estimates()[tag]->world) / 6.0;
  }
  /// Of the camera and all tags together.
  double joint_nees() const {
    const auto joint = filter_.joint();
    Eigen::VectorXd error(joint.covariance().rows());
    for (std::size_t i = 0; i < joint.mean().size(); ++i) {
      const SE3d& truth = i == 0 ? camera_ : tags_[i - 1];
      error.segment<6>(6 * static_cast<Eigen::Index>(i)) =
          (truth * joint.mean()[i].inverse()).log();
    }
    return error.dot(joint.covariance().ldlt().solve(error)) / static_cast<double>(error.size());
  }

 private:
  SE3d camera_ = pose(0.1, 0.2, 0.3, 0, 0, 0);
  std::vector<SE3d> tags_;
  RandomStream stream_;
  DetectorNoise noise_;
  MultiObjectFilter filter_;
};

struct NeesSummary {
  double sum = 0.0;
  double worst = 0.0;
  std::size_t count = 0;

  void add(double value) {
    sum += value;
    worst = std::max(worst, value);
    ++count;
  }
  double mean() const { return sum / static_cast<double>(count); }
};

constexpr std::uint64_t kSeeds = 20;

/// A tag, the drift, a new tag, and both in turn: NEES of the camera, of the new tag in the world
/// and from the camera, and of all together.
std::array<NeesSummary, 4> of_drift(double rotation_deg, double position_m,
                                    const DetectorNoise& noise) {
  const SE3d camera = pose(0.1, 0.2, 0.3, 0, 0, 0);
  std::array<NeesSummary, 4> result;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    TagTrip trip(
        seed, noise,
        {camera * pose(0.3, -0.2, 0.5, 0.1, 0, 1), camera * pose(-0.2, 0.3, 0.1, -0.3, 0.1, 1.2)});
    for (int k = 0; k < 10; ++k) {
      trip.go(SE3d(), 1e-3, 1e-5);
      trip.see(0);
    }
    trip.go(SE3d(), rotation_deg, position_m);
    for (int k = 0; k < 5; ++k) {
      trip.see(1);
      trip.go(SE3d(), 1e-3, 1e-5);
    }
    for (std::size_t k = 0; k < 6; ++k) {
      trip.see(k % 2);
      trip.go(SE3d(), 1e-3, 1e-5);
    }
    result[0].add(trip.camera_nees());
    result[1].add(trip.tag_nees(1));
    result[2].add(trip.relative_nees(1));
    result[3].add(trip.joint_nees());
  }
  return result;
}

struct CameraDrift {
  double rotation_deg;
  double position_m;
  Eigen::Vector3d tag_m;
  double volume_m3;
};

class DriftedCamera : public ::testing::TestWithParam<CameraDrift> {};

TEST_P(DriftedCamera, TellsWhereItIsAndWhatItSawSince) {
  const CameraDrift& drift = GetParam();
  for (const NeesSummary& nees : of_drift(drift.rotation_deg, drift.position_m,
                                          sharp_tag_noise(drift.tag_m, drift.volume_m3))) {
    EXPECT_GT(nees.mean(), 0.6);
    EXPECT_LT(nees.mean(), 1.5);
    EXPECT_LT(nees.worst, 6.0);
  }
}

/// Detections to the same position in all directions.
CameraDrift drift(double rotation_deg, double position_m, double tag_m, double volume_m3 = 1.0) {
  return {rotation_deg, position_m, Eigen::Vector3d::Constant(tag_m), volume_m3};
}

INSTANTIATE_TEST_SUITE_P(All, DriftedCamera,
                         ::testing::Values(drift(0.001, 0.1, 1e-3), drift(0.001, 1.0, 1e-3),
                                           drift(1.0, 1.0, 1e-3), drift(0.02, 1.0, 5e-3),
                                           drift(2.0, 3.0, 5e-3), drift(0.05, 1.0, 1e-4)));

// One correction does not take the camera where the detection is: its rotation, over the drift, is
// another position than that of the detector.
INSTANTIATE_TEST_SUITE_P(Far, DriftedCamera,
                         ::testing::Values(drift(1.0, 10.0, 1e-3, 1e6),
                                           drift(1.0, 3.0, 1e-4, 1e6)));

// The drift is far more than the error across the ray, and not than that along it.
INSTANTIATE_TEST_SUITE_P(AcrossTheRay, DriftedCamera,
                         ::testing::Values(CameraDrift{0.01, 0.1, {1e-3, 1e-3, 0.05}, 100.0},
                                           CameraDrift{0.01, 0.05, {1e-3, 1e-3, 0.03}, 1e3}));

/// A part of each correction is taken back by a shift of the world (eq. 10).
TEST(DriftedCamera, WithATypicalDetectorKnowsWhatItSawSince) {
  for (const double position_m : {0.05, 1.0}) {
    const DetectorNoise noise = sharp_tag_noise(Eigen::Vector3d::Constant(3e-3), 1e4, true);
    const NeesSummary relative = of_drift(1.0, position_m, noise)[2];
    EXPECT_LT(relative.mean(), 1.6) << position_m;
    EXPECT_LT(relative.worst, 8.0) << position_m;
  }
}

/// A loop of places, in each of which the tag of the place before is seen again.
NeesSummary of_loop(std::size_t places, std::uint64_t seeds, double position_m) {
  const SE3d step = pose(0, 0, 2 * std::numbers::pi / static_cast<double>(places), 1, 0, 0);
  std::vector<SE3d> tags;
  SE3d at = pose(0.1, 0.2, 0.3, 0, 0, 0);
  for (std::size_t i = 0; i < places; ++i) {
    const auto k = static_cast<double>(i % 4);
    tags.push_back(at * pose(0.3 * (k - 1.0), -0.1 * k, 0.5, 0.1, 0.05 * k, 1));
    at = at * step;
  }
  NeesSummary result;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    TagTrip trip(seed, sharp_tag_noise(1e-3), tags);
    for (std::size_t i = 0; i < places; ++i) {
      if (i > 0) trip.go(step, 0.2, position_m);
      for (int k = 0; k < 5; ++k) {
        trip.see(i);
        if (i > 0 && k == 0) trip.see(i - 1);
        trip.go(SE3d(), 1e-3, 1e-4);
      }
    }
    trip.go(step, 0.2, position_m);
    for (int k = 0; k < 3; ++k) trip.see(0);
    for (std::size_t i = 0; i < places; ++i) result.add(trip.tag_nees(i));
  }
  return result;
}

TEST(DriftedCamera, MapsALoop) {
  for (const double position_m : {0.03, 0.1, 0.3}) {
    const NeesSummary nees = of_loop(10, kSeeds, position_m);
    EXPECT_GT(nees.mean(), 0.7) << position_m;
    EXPECT_LT(nees.mean(), 1.4) << position_m;
    EXPECT_LT(nees.worst, 8.0) << position_m;
  }
}

/// So many that most become passive before the loop closes.
TEST(DriftedCamera, MapsALoopOfManyPlaces) {
  const NeesSummary nees = of_loop(60, 4, 0.3);
  EXPECT_GT(nees.mean(), 0.5);
  EXPECT_LT(nees.mean(), 1.4);
  EXPECT_LT(nees.worst, 8.0);
}

/// What was seen since a drift is known far worse than a detection tells until the loop closes.
TEST(DriftedCamera, MapsManyPlacesAfterADrift) {
  constexpr std::size_t kTags = 60;
  std::vector<SE3d> tags;
  for (std::size_t i = 0; i < kTags; ++i) {
    const double k = static_cast<double>(i);
    tags.push_back(pose(0.1, 0.2, 0.3, 0, 0, 0) * pose(0, 0, 0, 0.1 * k, 0, 0) *
                   pose(0.2 * static_cast<double>(i % 3), -0.3, 0.4, 0.1, 0, 0.6));
  }
  NeesSummary relative;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    TagTrip trip(seed, sharp_tag_noise(Eigen::Vector3d::Constant(1e-3), 1e4), tags);
    for (int k = 0; k < 10; ++k) {
      trip.see(0);
      trip.go(SE3d(), 1e-3, 1e-5);
    }
    trip.go(pose(0, 0, 0, 0.1, 0, 0), 1.0, 3.0);
    for (int round = 0; round < 2; ++round) {
      for (std::size_t i = 1; i < kTags; ++i) {
        for (int k = 0; k < 2; ++k) {
          trip.see(i);
          if (i > 1) trip.see(i - 1);
        }
        trip.go(i + 1 < kTags ? pose(0, 0, 0, 0.1, 0, 0)
                              : pose(0, 0, 0, -0.1 * static_cast<double>(kTags - 2), 0, 0),
                0.02, 5e-4);
      }
    }
    for (int k = 0; k < 3; ++k) trip.see(0);
    for (std::size_t i = 0; i < kTags; ++i) relative.add(trip.relative_nees(i));
  }
  EXPECT_GT(relative.mean(), 0.5);
  EXPECT_LT(relative.mean(), 2.0);
  EXPECT_LT(relative.worst, 10.0);
}

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
  const DetectorNoise noise = sharp_tag_noise(1e-6);
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
