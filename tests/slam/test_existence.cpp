// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The probability that an instance exists.
#include "posemix/slam/existence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "posemix/base/error.hpp"
#include "posemix/base/random.hpp"

namespace posemix {
namespace {

const ExistenceSettings kSettings;
constexpr double kLookPeriod = 100.0;  // so long that every image is a look of its own

/// With a chain that hardly changes, the posterior is that of two beta-binomial distributions.
double beta_binomial(int detections, int images) {
  const auto log_beta = [](double a, double b) {
    return std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b);
  };
  // The first detection, which is not counted, makes a larger by one.
  const auto evidence = [&](const BetaDistribution& rate) {
    return std::exp(log_beta(rate.a + 1 + detections, rate.b + images - detections) -
                    log_beta(rate.a + 1, rate.b));
  };
  const double object = kSettings.birth_probability * evidence(kSettings.object_rate);
  return object / (object + (1.0 - kSettings.birth_probability) * evidence(kSettings.clutter_rate));
}

ExistenceSettings without_changes() {
  ExistenceSettings settings;
  settings.visible_time_s = settings.hidden_time_s = settings.lifetime_s = 1e12;
  return settings;
}

TEST(Existence, IsThatOfUnknownRatesOfDetection) {
  const ExistenceSettings settings = without_changes();
  RandomStream stream(3, 1);
  for (const double rate : {0.2, 0.5, 0.9}) {
    Existence existence(settings);
    EXPECT_NEAR(existence.probability(), settings.birth_probability, 1e-12);
    int detections = 0;
    for (int images = 1; images <= 20; ++images) {
      const bool detected = stream.uniform() < rate;
      detections += detected ? 1 : 0;
      existence.predict(kLookPeriod, settings);
      existence.update(detected ? Sighting::detected : Sighting::missed, kLookPeriod, settings);
      // The rates are on a grid, and the density of clutter has a pole at zero.
      EXPECT_NEAR(existence.probability(), beta_binomial(detections, images), 0.03)
          << detections << " of " << images;
    }
  }
}

TEST(Existence, PredictionIsThatOfTheChain) {
  ExistenceSettings settings;
  settings.lifetime_s = 50.0;
  Existence once(settings);
  Existence often(settings);
  once.predict(8.0, settings);
  for (int k = 0; k < 800; ++k) often.predict(0.01, settings);
  EXPECT_NEAR(once.probability(), often.probability(), 1e-9);
  EXPECT_NEAR(once.visible_probability(), often.visible_probability(), 1e-9);
  // Detailed balance, and the decay of what stays where it is.
  const double alive = std::exp(-8.0 / 50.0);
  EXPECT_NEAR(once.probability(), alive * settings.birth_probability, 1e-12);
  const double balance = 30.0 / 40.0;
  const double expected = balance + (1.0 - balance) * std::exp(-8.0 * (1.0 / 30.0 + 1.0 / 10.0));
  EXPECT_NEAR(once.visible_probability(), alive * expected, 1e-12);
}

TEST(Existence, OfClutterIsGivenUpAndOfAnObjectConfirmed) {
  Existence clutter(kSettings);
  Existence object(kSettings);
  for (int k = 0; k < 16; ++k) {
    clutter.predict(1.0, kSettings);
    clutter.update(k == 5 ? Sighting::detected : Sighting::missed, 1.0, kSettings);
    object.predict(1.0, kSettings);
    object.update(k % 4 == 3 ? Sighting::missed : Sighting::detected, 1.0, kSettings);
  }
  EXPECT_LT(clutter.probability(), 0.1);
  EXPECT_GT(object.probability(), kSettings.confirmed_probability);
}

TEST(Existence, OfWhatIsTakenAwayFallsWhileItShouldBeSeen) {
  Existence existence(kSettings);
  const auto look = [&](Sighting sighting, int images) {
    for (int k = 0; k < images; ++k) {
      existence.predict(1.0, kSettings);
      existence.update(sighting, 1.0, kSettings);
    }
  };
  look(Sighting::detected, 20);
  EXPECT_GT(existence.visible_probability(), 0.95);
  look(Sighting::missed, 10);
  EXPECT_LT(existence.visible_probability(), 0.1);
  EXPECT_GT(existence.probability(), 0.9) << "it may be hidden";
  look(Sighting::missed, 190);
  EXPECT_LT(existence.probability(), kSettings.deleted_probability);
}

/// After days in which nobody looked, what is there is found again.
TEST(Existence, ReturnsAfterDays) {
  const ExistenceSettings settings;
  for (const double days : {1.0, 14.0, 3000.0}) {
    Existence existence(settings);
    for (int k = 0; k < 300; ++k) {
      existence.predict(0.1, settings);
      existence.update(Sighting::detected, 0.1, settings);
    }
    existence.predict(86400.0 * days, settings);
    EXPECT_LT(existence.probability(), 0.01) << days;
    for (int k = 0; k < 300; ++k) {
      existence.predict(0.1, settings);
      existence.update(Sighting::detected, 0.1, settings);
    }
    EXPECT_GT(existence.probability(), 0.95) << days;
  }
}

TEST(Existence, StaysWhileNothingCanBeSeen) {
  Existence existence(kSettings);
  for (int k = 0; k < 10; ++k) existence.update(Sighting::detected, 1.0, kSettings);
  const double before = existence.probability();
  for (int k = 0; k < 100; ++k) {
    existence.predict(1.0, kSettings);
    existence.update(Sighting::out_of_view, 1.0, kSettings);
  }
  EXPECT_NEAR(existence.probability(), before * std::exp(-100.0 / kSettings.lifetime_s), 1e-9);
}

TEST(Existence, ImagesThatFollowEachOtherCloselyCountAsOne) {
  Existence fast(kSettings);
  Existence slow(kSettings);
  for (int k = 0; k < 300; ++k) fast.update(Sighting::detected, 0.001, kSettings);
  slow.update(Sighting::detected, 100.0, kSettings);
  EXPECT_NEAR(fast.probability(), slow.probability(), 2e-3);
}

TEST(Existence, SettingsOutOfRangeAreRefused) {
  const auto refused = [](auto change) {
    ExistenceSettings settings;
    change(settings);
    EXPECT_THROW(Existence{settings}, InvalidInput);
  };
  refused([](auto& s) { s.birth_probability = 1.0; });
  refused([](auto& s) { s.object_rate.a = 0.0; });
  refused([](auto& s) { s.clutter_rate.b = std::nan(""); });
  refused([](auto& s) { s.visible_time_s = 0.0; });
  refused([](auto& s) { s.deleted_probability = 0.99; });
  refused([](auto& s) { s.exclusion_m = -1.0; });
}

/// Instances whose rates are drawn from beta distributions with small integer parameters, as order
/// statistics of uniform numbers.
std::vector<InstanceCounts> drawn_instances(std::size_t count) {
  RandomStream stream(5, 2);
  const auto beta = [&](int a, int b) {
    std::vector<double> numbers(static_cast<std::size_t>(a + b - 1));
    for (double& number : numbers) number = stream.uniform();
    std::sort(numbers.begin(), numbers.end());
    return numbers[static_cast<std::size_t>(a - 1)];
  };
  std::vector<InstanceCounts> counts;
  while (counts.size() < count) {
    const bool is_object = stream.uniform() < 0.3;
    const double rate = is_object ? beta(4, 2) : beta(1, 6);
    if (stream.uniform() > rate) continue;  // its first detection
    InstanceCounts one{.images = 40.0, .is_object = is_object};
    for (int k = 0; k < 40; ++k) one.detections += stream.uniform() < rate ? 1.0 : 0.0;
    counts.push_back(one);
  }
  return counts;
}

TEST(FitExistence, FindsTheRatesThatInstancesWereDrawnWith) {
  const ExistenceSettings fitted = fit_existence(drawn_instances(3000));
  EXPECT_NEAR(fitted.object_rate.a, 4.0, 0.6);
  EXPECT_NEAR(fitted.object_rate.b, 2.0, 0.3);
  EXPECT_NEAR(fitted.clutter_rate.a, 1.0, 0.25);
  EXPECT_NEAR(fitted.clutter_rate.b, 6.0, 0.9);
  // Objects are detected first four or five times as often.
  const double expected = 0.3 * (4.0 / 6.0) / (0.3 * (4.0 / 6.0) + 0.7 / 7.0);
  EXPECT_NEAR(fitted.birth_probability, expected, 0.03);
  EXPECT_EQ(fitted.hidden_time_s, kSettings.hidden_time_s);
}

TEST(FitExistence, RefusesCountsThatCannotBe) {
  const std::vector<InstanceCounts> few(3, {.images = 4.0, .detections = 2.0, .is_object = true});
  EXPECT_THROW(fit_existence(few), InvalidInput);
  std::vector<InstanceCounts> wrong = drawn_instances(20);
  wrong[3].detections = 41.0;
  EXPECT_THROW(fit_existence(wrong), InvalidInput);
  wrong[3].detections = std::nan("");
  EXPECT_THROW(fit_existence(wrong), InvalidInput);
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

TEST(FieldOfView, HasRoomForRounding) {
  FieldOfView view;
  view.add({0.1, -0.2, 0.7});
  EXPECT_TRUE(view.contains({0.1 + 1e-15, -0.2 - 1e-15, 0.7 + 1e-15}));
  EXPECT_FALSE(view.contains({0.1 + 1e-4, -0.2, 0.7}));
}

}  // namespace
}  // namespace posemix
