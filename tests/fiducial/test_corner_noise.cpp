// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "io/expect_invalid.hpp"
#include "posemix/fiducial/corner_noise.hpp"
#include "views.hpp"

namespace posemix {
namespace {

using testing::image_of;
using testing::kTagSize;
using testing::pinhole_camera;
using testing::view;
using testing::with_noise;

/// The minima of views of which many are ambiguous.
std::vector<std::vector<TagMinimum>> draw_minima(double sd, double dof, int count) {
  RandomStream stream(21);
  std::vector<std::vector<TagMinimum>> sightings;
  for (int i = 0; i < count; ++i) {
    const SE3d pose = view(0.5 + 4.0 * stream.uniform(), 0.1 + 1.2 * stream.uniform(),
                           6.0 * stream.uniform(), 6.0 * stream.uniform());
    double scale = sd;
    if (!std::isinf(dof)) {
      double chi2 = 0.0;
      for (int j = 0; j < static_cast<int>(dof); ++j) chi2 += std::pow(stream.normal(), 2);
      scale *= std::sqrt(dof / chi2);
    }
    sightings.push_back(tag_minima(with_noise(image_of(pose, pinhole_camera()), scale, stream),
                                   kTagSize, pinhole_camera()));
  }
  return sightings;
}

TEST(CornerNoise, NormalNoiseIsLearned) {
  const CornerNoiseFit fit =
      fit_corner_noise(draw_minima(0.3, std::numeric_limits<double>::infinity(), 5000));
  EXPECT_TRUE(fit.converged);
  EXPECT_GT(fit.sightings, 4990U);
  EXPECT_NEAR(fit.noise.sd_px, 0.3, 0.01);  // one standard error is 0.002
  EXPECT_GT(fit.noise.dof, 30.0);
}

TEST(CornerNoise, HeavyTailsAreLearned) {
  const CornerNoiseFit fit = fit_corner_noise(draw_minima(0.2, 4.0, 10000));
  EXPECT_TRUE(fit.converged);
  EXPECT_NEAR(fit.noise.sd_px, 0.2, 0.01);
  EXPECT_NEAR(fit.noise.dof, 4.0, 0.5);
}

TEST(CornerNoise, SightingsWithoutPoseDoNotCount) {
  auto sightings = draw_minima(0.3, std::numeric_limits<double>::infinity(), 200);
  const CornerNoiseFit fit = fit_corner_noise(sightings);
  sightings.insert(sightings.begin() + 7, std::vector<TagMinimum>{});
  const CornerNoiseFit with_gap = fit_corner_noise(sightings);
  EXPECT_EQ(with_gap.sightings, fit.sightings);
  EXPECT_EQ(with_gap.noise.sd_px, fit.noise.sd_px);
}

TEST(CornerNoise, CornersWithoutNoiseHaveAFiniteOne) {
  const CornerNoiseFit fit =
      fit_corner_noise(draw_minima(0.0, std::numeric_limits<double>::infinity(), 50));
  EXPECT_GT(fit.noise.sd_px, 0.0);
  EXPECT_LT(fit.noise.sd_px, 1e-5);
}

TEST(CornerNoise, NeedsASighting) {
  EXPECT_INVALID(fit_corner_noise(std::vector<std::vector<TagMinimum>>(3)),
                 "no sighting has a pose, expected at least one to learn the noise from");
}

}  // namespace
}  // namespace posemix
