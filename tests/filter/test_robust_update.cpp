// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/robust_update.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "posemix/testing/expect.hpp"
#include "scenario.hpp"

namespace posemix {
namespace {

using testing::camera_filter;
using testing::draw;
using testing::gaussian_noise;
using testing::isotropic;
using testing::kCameraPose;
using testing::kObject;

UpdateResult robust(const Hypothesis& prior, const Detection& detection,
                    const NoiseComponent& noise, double scale) {
  const std::array given{&noise};
  const std::span<const Detection> one(&detection, 1);
  const auto step = [&](std::span<const NoiseComponent* const> multiplied) {
    return update(prior, one, multiplied);
  };
  return cauchy_update(prior, one, given, step, {.scale = scale});
}

Hypothesis camera_and_object(const SE3d& camera, const SE3d& object) {
  const Hypothesis alone(PoseStackd(std::vector<SE3d>{camera}), isotropic(0.5, 0.005));
  return with_independent_pose(alone, object, isotropic(2.0, 0.02));
}

double distance_moved(const Hypothesis& prior, const Hypothesis& posterior) {
  return (posterior.mean()[1] * prior.mean()[1].inverse()).log().norm();
}

TEST(CauchyUpdate, LargeScaleIsTheInvariantEkf) {
  RandomStream stream(3);
  const DetectorNoise noise = gaussian_noise();
  const NoiseComponent& component = noise.components().front();
  const Hypothesis prior = camera_and_object(kCameraPose, kObject);
  for (int i = 0; i < 20; ++i) {
    const SE3d error = SE3d::exp(draw(isotropic(6.0, 0.03), stream));
    const Detection detection{1, kCameraPose.inverse() * kObject * error, &noise};
    const std::array given{&component};
    const UpdateResult plain = update(prior, std::span(&detection, 1), given);
    const UpdateResult cauchy = robust(prior, detection, component, 1e6);
    // lambda is within d^2 / c^2 < 1e-10 of one.
    EXPECT_TRUE(cauchy.posterior.mean().is_approx(plain.posterior.mean(), 1e-9));
    EXPECT_TRUE(cauchy.posterior.covariance().isApprox(plain.posterior.covariance(), 1e-8));
    EXPECT_NEAR(cauchy.log_likelihood, plain.log_likelihood, 1e-8);
    // And a scale that counts does not move further than that.
    EXPECT_LT(distance_moved(prior, robust(prior, detection, component, 1.0).posterior),
              distance_moved(prior, plain.posterior));
  }
}

TEST(CauchyUpdate, InfluenceFallsAsTheInverseOfAGrossError) {
  const DetectorNoise noise = gaussian_noise();
  const Hypothesis prior = camera_and_object(kCameraPose, kObject);
  const auto influence = [&](double error_m) {
    const SE3d off(SO3d(), {error_m, 0.0, 0.0});
    const Detection detection{1, kCameraPose.inverse() * off * kObject, &noise};
    return distance_moved(prior, robust(prior, detection, noise.components()[0], 3.0).posterior);
  };
  // Far out lambda = d^2 / c^2 and the gain falls with its inverse: ten times as far, a tenth of
  // the influence. What is left of the 1 in lambda at 2 m is (c sd / 2 m)^2, less than 1e-3.
  EXPECT_GT(influence(0.05), influence(0.5));
  EXPECT_NEAR(influence(20.0) / influence(2.0), 0.1, 1e-3);
  EXPECT_NEAR(influence(2000.0) / influence(20.0), 0.01, 1e-5);
}

TEST(CauchyUpdate, FixedPointMinimisesTheCauchyLoss) {
  // Camera and object at the origin: every matrix is diagonal, and an error along x is a problem in
  // one dimension, J(e) = e^2 / p + c^2 log(1 + (x - e)^2 / (r c^2)), solved on a grid.
  const Hypothesis prior = camera_and_object(SE3d(), SE3d());
  const DetectorNoise noise = gaussian_noise(4.0, 0.01);
  const double p = 0.005 * 0.005 + 0.02 * 0.02;
  const double r = 0.01 * 0.01;
  const double c = 2.0;
  for (const double x : {0.005, 0.02, 0.04, 0.3}) {
    const auto loss = [&](double e) {
      return e * e / p + c * c * std::log1p((x - e) * (x - e) / (r * c * c));
    };
    constexpr int kSteps = 200'000;
    double best = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
      const double e = x * i / kSteps;
      if (loss(e) < loss(best)) best = e;
    }
    const Detection detection{1, SE3d(SO3d(), {x, 0.0, 0.0}), &noise};
    const UpdateResult result = robust(prior, detection, noise.components()[0], c);
    const PoseStackd& mean = result.posterior.mean();
    const double e = mean[1].translation().x() - mean[0].translation().x();
    // Ten reweightings come within a thousandth of the detector's standard deviation.
    EXPECT_NEAR(e, best, 1e-5) << x;
  }
}

TEST(CauchyUpdate, IsASettingOfTheFilter) {
  // Ten good detections and one of half a metre.
  const DetectorNoise noise = gaussian_noise();
  const auto error_after = [&](RobustLoss loss) {
    GaussianSumSettings settings;
    settings.update = UpdateRule::linearized;
    settings.robust_loss = loss;
    GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(0.1, 0.001), settings);
    const SE3d seen = kCameraPose.inverse() * kObject;
    const std::size_t object = filter.add_object(seen, noise);
    const Detection good{object, seen, &noise};
    for (int i = 0; i < 10; ++i) filter.update(std::span(&good, 1));
    const Detection wrong{object, seen * SE3d(SO3d(), {0.5, 0.0, 0.0}), &noise};
    filter.update(std::span(&wrong, 1));
    return (filter.summarise().mean()[object].translation() - kObject.translation()).norm();
  };
  EXPECT_GT(error_after(RobustLoss::none), 0.02);
  EXPECT_LT(error_after(RobustLoss::cauchy), 0.001);
}

TEST(CauchyUpdate, RefusesAScaleThatIsNotPositive) {
  GaussianSumSettings settings;
  settings.cauchy_scale = 0.0;
  EXPECT_THROW(camera_filter(kCameraPose, isotropic(0.1, 0.001), settings), InvalidInput);
  const DetectorNoise noise = gaussian_noise();
  const Detection detection{1, kCameraPose.inverse() * kObject, &noise};
  const Hypothesis prior = camera_and_object(kCameraPose, kObject);
  const auto message = [&](double scale) {
    return testing::thrown_message([&] { robust(prior, detection, noise.components()[0], scale); });
  };
  EXPECT_EQ(message(-1.0), "cauchy scale is -1, expected a positive number");
  EXPECT_EQ(message(0.0), "cauchy scale is 0, expected a positive number");
  EXPECT_NE(message(std::nan("")), "");
}

TEST(CauchyUpdate, DefaultScaleHas95PercentOfTheEfficiency) {
  // M-estimate of location in six dimensions: efficiency = E[w + r w' / 6]^2 / E[r^2 w^2 / 6] over
  // the chi distribution of r with six degrees of freedom (Maronna 1976, for psi(x) = x w(|x|)).
  double mass = 0.0;
  double variance = 0.0;
  double slope = 0.0;
  const double c = kCauchyScale;
  for (double r = 0.0005; r < 20.0; r += 0.001) {
    const double density = std::pow(r, 5) * std::exp(-0.5 * r * r);
    const double w = 1.0 / (1.0 + r * r / (c * c));
    mass += density;
    variance += density * r * r * w * w / 6.0;
    slope += density * (w - 2.0 * r * r / (c * c) * w * w / 6.0);
  }
  EXPECT_NEAR(slope * slope / (mass * variance), 0.95, 1e-4);
}

}  // namespace
}  // namespace posemix
