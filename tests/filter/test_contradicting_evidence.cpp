// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "multi_object_scene.hpp"
#include "posemix/filter/multi_object_filter.hpp"

/// Evidence with dependent detections counted once, and the full one, for the same hypothesis.
namespace posemix {
namespace {

using namespace testing;

TEST(ContradictingEvidence, TheLeaderHasTheLargestWeightAndPosesStayAmongTheDetections) {
  // Flipped detections come in bursts, right ones now and then: the full evidence is that of the
  // bursts, while the probability counts each once.
  OrbitScene scene(11, 3, 1.0, 0.01);
  const DetectorNoise noise(ray_noise(0.02).components(), ray_noise(0.02).clutter(),
                            {.mode_time_s = 5.0});
  MultiObjectSettings settings;
  settings.has_odometry = false;
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                           {{noise}, {noise}, {noise}}, settings);
  std::size_t contradictions = 0;
  for (int frame = 0; frame < 300; ++frame) {
    if (frame > 0) {
      scene.advance();
      const double dt = frame % 60 < 40 ? 0.01 : 2.0;
      filter.predict_random_walk(dt * isotropic(60.0, 0.5), dt);
    }
    for (std::size_t j = 0; j < 3; ++j) {
      const bool flipped = frame % 60 < 40 && frame >= 20;
      filter.update(j, scene.detect(j, flipped ? 1.0 : 0.0, 0.02));
      const std::vector<ObjectHypothesis> all = filter.hypotheses(j);
      const std::size_t leading = filter.leading(j).value();
      for (const ObjectHypothesis& one : all) {
        EXPECT_LT(one.pose.translation().norm(), 10.0) << "frame " << frame;
        if (one.log_weight > all[leading].log_weight &&
            one.probability * 1.3 < all[leading].probability)
          ++contradictions;
      }
    }
  }
  EXPECT_EQ(contradictions, 0U);
}

}  // namespace
}  // namespace posemix
