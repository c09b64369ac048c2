// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A camera on a head that pans: the body stands, and its pose on the body is another in every frame
// (docs/many-objects.md, eq. 39 to 42).
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "drifted_camera_scene.hpp"
#include "posemix/detector/default_noise.hpp"

namespace posemix {
namespace {

using testing::draw;
using testing::isotropic;
using testing::NeesSummary;
using testing::pose;

constexpr double kSweep_deg = 40.0;
constexpr int kPanningFrames = 300;

/// Slow errors along a sweep. Their correlation is exponential in the angle between two views, so
/// that the chain over steps of one angle is exact, and a view that returns errs as it did before.
std::vector<Vector6d> errors_along_sweep(const SlowError& slow, double step_deg,
                                         RandomStream& stream) {
  const double a = slow.correlation(0.0, step_deg * std::numbers::pi / 180.0);
  std::vector<Vector6d> errors{draw(slow.covariance, stream)};
  const int steps = static_cast<int>(kSweep_deg / step_deg);
  for (int k = 0; k < steps; ++k) {
    errors.push_back(a * errors.back() + std::sqrt(1.0 - a * a) * draw(slow.covariance, stream));
  }
  return errors;
}

/// NEES per degree of freedom of an object from the body, whose head circles it, there and back
/// again.
NeesSummary nees_of_panning_head(double step_deg) {
  const DetectorNoise noise = default_detector_noise();
  const NoiseComponent& white = noise.components().front();
  const SE3d object = pose(0.3, 0.2, 0.1, 0, 0, 1.0);
  const SE3d place(SO3d(), object.translation());
  const Matrix6d q = isotropic(0.02, 2e-4);
  const Matrix6d start = isotropic(0.05, 1e-3);
  NeesSummary nees;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    RandomStream stream(seed, 21);
    MultiObjectFilter filter({SE3d::exp(draw(start, stream)).inverse(), start},
                             {ObjectSensor{noise}}, {});
    const std::vector<Vector6d> slow =
        errors_along_sweep(*noise.dependence().slow, step_deg, stream);
    const int last = static_cast<int>(slow.size()) - 1;
    for (int frame = 0; frame < kPanningFrames; ++frame) {
      const int at = last - std::abs(frame % (2 * last) - last);
      const double pan = at * step_deg * std::numbers::pi / 180.0;
      const SE3d body_camera = place * pose(0, pan, 0, 0, 0, 0) * place.inverse();
      if (frame > 0) filter.predict_with_odometry(SE3d::exp(draw(q, stream)).inverse(), q, 0.1);
      const SE3d seen = body_camera.inverse() * object;
      const NoiseAtPose here = noise_at(white, seen);
      Vector6d error = slow[static_cast<std::size_t>(at)];
      error.tail<3>() *= seen.translation().norm();
      error += draw(here.covariance, stream);
      filter.update(0, observation_of(here.axes * SE3d::exp(error) * here.axes.inverse() * seen),
                    {.body_camera = body_camera});
    }
    nees.add(testing::nees_of(object, filter.leading_estimates()[0]->relative) / 6.0);
  }
  return nees;
}

/// More views than a filter keeps slow errors of, and yet none is taken for one more opinion.
TEST(PanningHead, IsAsSureAsItMayBeByTheDefaults) {
  for (const double step_deg : {0.5, 1.0}) {
    const NeesSummary nees = nees_of_panning_head(step_deg);
    EXPECT_GT(nees.mean(), 0.4) << step_deg;
    EXPECT_LT(nees.mean(), 1.8) << step_deg;
    EXPECT_LT(nees.worst, 5.0) << step_deg;
  }
}

/// Few views that are seen again and again while odometry errs: too sure by as much as is told
/// (docs/filter-consistency.md).
TEST(PanningHead, SweepsInFewViewsAreTooSureByWhatIsTold) {
  const NeesSummary nees = nees_of_panning_head(5.0);
  EXPECT_GT(nees.mean(), 0.8);
  EXPECT_LT(nees.mean(), 3.5);
  EXPECT_LT(nees.worst, 10.0);
}

}  // namespace
}  // namespace posemix
