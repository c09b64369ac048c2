// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "posemix/detector/default_noise.hpp"
#include "posemix/filter/moving_object_filter.hpp"
#include "scenario.hpp"

/// The filter of one moving object long after the last observation.
namespace posemix {
namespace {

using testing::pose;

TEST(MovingObjectFilter, ForgetsTheModelOverAnyTime) {
  // Two models that change into each other at one rate are equally probable after many changes,
  // however many: also where rate times time is no double any more, or the probability that the
  // object is where it was.
  MotionModels models;
  models.models = {StaticMotion{}, StaticMotion{}};
  models.start = {0.9, 0.1};
  for (const double rate : {1.0, 1e6, 1e200}) {
    models.rates = Eigen::MatrixXd::Constant(2, 2, rate);
    MovingObjectFilter filter({default_detector_noise()}, models);
    filter.update(observation_of(pose(0.1, 0.2, 0.3, 0.0, 0.0, 0.5)), exact_camera(SE3d()));
    for (const double time_s : {100.0, 1e7, 1e12}) {
      const MovingObjectEstimate later = filter.estimate_at(time_s);
      EXPECT_NEAR(later.models.at(0), 0.5, 1e-9) << rate << " over " << time_s;
      EXPECT_NEAR(later.models.at(1), 0.5, 1e-9) << rate << " over " << time_s;
    }
  }
}

}  // namespace
}  // namespace posemix
