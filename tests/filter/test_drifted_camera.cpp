// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A camera whose odometry drifts by many standard deviations of the detector, as it says, with the
// default settings: what is seen again corrects the camera, and what was seen since moves with it.
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "moving_object_scene.hpp"
#include "posemix/filter/multi_object_filter.hpp"

namespace posemix {
namespace {

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

  /// From now on a camera on the body sees, whose pose there is known with this covariance.
  void see_from(const SE3d& body_camera, const Matrix6d& covariance) {
    mount_ = SE3d::exp(draw(covariance, stream_)) * body_camera;
    source_.camera = filter_.add_camera({body_camera, covariance});
  }
  void see(std::size_t tag) {
    const SE3d seen = (camera_ * mount_).inverse() * tags_[tag];
    const NoiseAtPose at = noise_at(noise_.components().front(), seen);
    const SE3d error = at.axes * SE3d::exp(draw(at.covariance, stream_)) * at.axes.inverse();
    filter_.update(tag, observation_of(error * seen), source_);
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
  SE3d mount_;
  ObservationSource source_;
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
                                    const DetectorNoise& noise,
                                    const std::optional<Matrix6d>& extrinsic = {}) {
  const SE3d camera = pose(0.1, 0.2, 0.3, 0, 0, 0);
  std::array<NeesSummary, 4> result;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    TagTrip trip(
        seed, noise,
        {camera * pose(0.3, -0.2, 0.5, 0.1, 0, 1), camera * pose(-0.2, 0.3, 0.1, -0.3, 0.1, 1.2)});
    if (extrinsic) trip.see_from(pose(0.1, -0.1, 0.05, 0.2, 0.1, 0), *extrinsic);
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

/// The body's pose is uncertain by that of the camera on it, over the drift.
TEST(DriftedCamera, OnARigOfUncertainExtrinsics) {
  for (const double position_m : {0.05, 1.0, 5.0}) {
    const auto all =
        of_drift(0.1, position_m, sharp_tag_noise(1e-3), Matrix6d(isotropic(2.0, 0.02)));
    for (const NeesSummary& nees : all) {
      EXPECT_GT(nees.mean(), 0.6) << position_m;
      EXPECT_LT(nees.mean(), 1.5) << position_m;
      EXPECT_LT(nees.worst, 6.0) << position_m;
    }
  }
}

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

// A camera comes back to a tag, which it has seen to 0.1 mm, after a kilometre of drift, as is
// told.
TEST(DriftedCamera, FindsItselfAfterAKilometre) {
  const Matrix6d sharp = isotropic(1.0, 1e-4);
  const DetectorNoise noise({{0.95, sharp}}, {.weight = 0.05, .volume_m3 = 1.0});
  const Matrix6d still = isotropic(1e-4, 1e-4);
  const Matrix6d drift = isotropic(0.05, 1000.0);
  const SE3d camera = pose(0.1, 0.2, 0.3, 0.0, 0.0, 0.0);
  const SE3d seen = pose(0.3, -0.2, 0.5, 0.1, 0.0, 1.0);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream stream(seed, 5);
    MultiObjectFilter filter({camera, isotropic(1e-3, 1e-3)}, {{noise}}, {});
    const auto see = [&] { filter.update(0, seen * SE3d::exp(draw(sharp, stream))); };
    for (int k = 0; k < 10; ++k) {
      filter.predict_with_odometry(SE3d(), still, 0.1);
      see();
    }
    filter.predict_with_odometry(SE3d::exp(draw(drift, stream)).inverse(), drift, 1.0);
    for (int k = 0; k < 5; ++k) {
      see();
      filter.predict_with_odometry(SE3d(), still, 0.1);
    }
    EXPECT_LT((filter.camera().mean().translation() - camera.translation()).norm(), 0.1) << seed;
  }
}

}  // namespace
}  // namespace posemix
