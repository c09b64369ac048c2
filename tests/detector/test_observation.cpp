// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/observation.hpp"

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

Observation two_peaks() {
  Observation observation;
  observation.components = {
      {.weight = 0.7, .pose = SE3d(), .covariance = Matrix6d::Identity()},
      {.weight = 0.3, .pose = SE3d(SO3d::exp({0.0, 0.0, 3.0}), {0.0, 0.0, 1.0})}};
  return observation;
}

TEST(Observation, OfOnePoseIsValidAndItsBestComponentTheHeaviest) {
  EXPECT_NO_THROW(validate(observation_of(SE3d())));
  EXPECT_NO_THROW(validate(two_peaks()));
  Observation observation = two_peaks();
  EXPECT_EQ(best_component(observation), 0U);
  std::swap(observation.components[0].weight, observation.components[1].weight);
  EXPECT_EQ(best_component(observation), 1U);
}

TEST(Observation, RefusesWhatIsNoMixtureAndNamesTheComponent) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Matrix6d indefinite = Matrix6d::Identity();
  indefinite(0, 5) = indefinite(5, 0) = 2.0;
  Matrix6d lopsided = Matrix6d::Identity();
  lopsided(0, 5) = 0.5;
  const std::vector<std::pair<std::function<void(Observation&)>, std::string>> cases{
      {[](Observation& o) { o.components.clear(); }, "no components"},
      {[](Observation& o) { o.components[1].weight = -0.3; }, "components[1].weight is -0.3"},
      {[=](Observation& o) { o.components[1].weight = nan; }, "components[1].weight"},
      {[](Observation& o) { o.components[1].weight = 0.2; }, "sum to 0.9"},
      {[=](Observation& o) { o.components[0].covariance = indefinite; },
       "components[0].covariance is not positive"},
      {[=](Observation& o) { o.components[0].covariance = lopsided; }, "not symmetric"},
      {[=](Observation& o) { (*o.components[0].covariance)(2, 2) = nan; },
       "components[0].covariance"},
      {[=](Observation& o) {
         o.components[1].pose = SE3d(SO3d(), {nan, 0.0, 0.0});
       },
       "components[1].pose"},
      {[](Observation& o) { o.clutter = 1.0; }, "clutter is 1"},
      {[](Observation& o) { o.clutter = 0.0; }, "clutter is 0"},
      {[](Observation& o) { o.clutter = 1.0 - 1e-12; }, "at most 1 - 1e-9"},
      {[=](Observation& o) { o.stamp_s = nan; }, "stamp_s is nan"},
      {[=](Observation& o) { o.score = nan; }, "score is nan"},
  };
  for (const auto& [spoil, named] : cases) {
    Observation observation = two_peaks();
    spoil(observation);
    try {
      validate(observation);
      ADD_FAILURE() << "accepted what should name '" << named << "'";
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace posemix
