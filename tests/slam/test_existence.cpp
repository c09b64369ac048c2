// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The probability that an instance exists.
#include "posemix/slam/existence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "posemix/base/random.hpp"

namespace posemix {
namespace {

const ExistenceSettings kSettings;
constexpr double kPeriod = 0.5;

/// A detection at a density ratio, or none.
using Image = std::optional<double>;

/// The sum over all histories of "visible" and "hidden", and of the time of death, by brute force.
double enumerated(const std::vector<Image>& images) {
  const double changes = 0.5 * (1.0 - std::exp(-2.0 * kPeriod / kSettings.occlusion_time_s));
  const double stays = std::exp(-kPeriod / kSettings.lifetime_s);
  const auto seen = [](const Image& image, bool visible) {
    if (!visible) return 1.0;
    const double missed = 1.0 - kSettings.detection_probability;
    if (!image) return missed;
    return missed + kSettings.detection_probability * (1.0 - kSettings.confusion_probability) *
                        std::exp(*image);
  };
  const std::size_t count = images.size();
  double alive = 0.0;
  double dead = 1.0 - kSettings.birth_probability;
  for (std::size_t life = 0; life <= count; ++life) {  // images that it lives to see
    for (std::size_t history = 0; history < (std::size_t{1} << life); ++history) {
      double weight = kSettings.birth_probability;
      bool visible = true;
      for (std::size_t k = 0; k < life; ++k) {
        const bool now = ((history >> k) & 1U) == 0;
        weight *= stays * (now == visible ? 1.0 - changes : changes) * seen(images[k], now);
        visible = now;
      }
      if (life < count) {
        dead += weight * (1.0 - stays);
      } else {
        alive += weight;
      }
    }
  }
  return alive / (alive + dead);
}

TEST(Existence, IsThatOfAnEnumerationOfAllHistories) {
  RandomStream stream(3, 1);
  for (int trial = 0; trial < 20; ++trial) {
    Existence existence(kSettings.birth_probability);
    std::vector<Image> images;
    for (int k = 0; k < 9; ++k) {
      images.push_back(stream.uniform() < 0.5 ? Image() : Image(4.0 * stream.uniform() - 2.0));
      existence.predict(kPeriod, kSettings);
      existence.update({.log_ratio = images.back()}, kSettings);
      EXPECT_NEAR(existence.probability(), enumerated(images), 1e-9);
    }
  }
}

TEST(Existence, OfClutterIsGivenUpAndOfAnObjectConfirmed) {
  Existence clutter(kSettings.birth_probability);
  Existence object(kSettings.birth_probability);
  for (int k = 0; k < 8; ++k) {
    clutter.predict(kPeriod, kSettings);
    clutter.update({}, kSettings);
    object.predict(kPeriod, kSettings);
    object.update({.log_ratio = k % 2 == 0 ? Image(6.0) : Image()}, kSettings);
  }
  EXPECT_LT(clutter.probability(), 0.3);
  EXPECT_GT(object.probability(), kSettings.confirmed_probability);
}

TEST(Existence, StaysWhileNothingCanBeSeen) {
  Existence existence(kSettings.birth_probability);
  for (int k = 0; k < 3; ++k) existence.update({.log_ratio = 6.0}, kSettings);
  const double before = existence.probability();
  for (int k = 0; k < 100; ++k) {
    existence.predict(1.0, kSettings);
    existence.update({.in_view = false}, kSettings);
  }
  EXPECT_NEAR(existence.probability(), before * std::exp(-100.0 / kSettings.lifetime_s), 1e-3);
}

TEST(Existence, ADetectionOfAnotherClassAtItsPlaceIsLessForIt) {
  Existence named(0.5);
  Existence confused(0.5);
  named.update({.log_ratio = 5.0}, kSettings);
  confused.update({.log_confused = 5.0}, kSettings);
  EXPECT_GT(confused.probability(), 0.5);
  EXPECT_NEAR(named.odds() / confused.odds(), 9.0, 0.5);
}

TEST(FieldOfView, IsWhereAnythingWasSeen) {
  FieldOfView view;
  EXPECT_FALSE(view.contains({0.0, 0.0, 1.0}));
  view.add({-0.5, -0.2, 1.0});
  view.add({1.0, 0.6, 2.0});
  EXPECT_TRUE(view.contains({0.0, 0.0, 1.5}));
  EXPECT_FALSE(view.contains({0.9, 0.0, 1.5}));
  EXPECT_FALSE(view.contains({0.0, 0.0, 2.5}));
  EXPECT_FALSE(view.contains({0.0, 0.0, -1.0}));
}

}  // namespace
}  // namespace posemix
