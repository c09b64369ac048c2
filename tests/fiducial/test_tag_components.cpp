// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "io/expect_invalid.hpp"
#include "views.hpp"

namespace posemix {
namespace {

using testing::fisheye_camera;
using testing::image_of;
using testing::kTagSize;
using testing::pinhole_camera;
using testing::view;
using testing::with_noise;

constexpr double kNoise = 0.3;  // [px]

/// A pose of the flat prior whose tag faces the camera, in a box before it.
SE3d draw_view(RandomStream& stream) {
  while (true) {
    const Eigen::Vector4d q(stream.normal(), stream.normal(), stream.normal(), stream.normal());
    const SE3d pose(SO3d::from_quaternion(Eigen::Quaterniond(q)),
                    Eigen::Vector3d(2.0 * stream.uniform() - 1.0, 2.0 * stream.uniform() - 1.0,
                                    1.0 + 4.0 * stream.uniform()));
    const Eigen::Vector3d normal = pose.rotation() * Eigen::Vector3d::UnitZ();
    // Seen from the side a tag is not detected.
    if (normal.dot(pose.translation().normalized()) < -0.1) return pose;
  }
}

/// A variance's factor dof / chi2 of Student's t.
double draw_factor(double dof, RandomStream& stream) {
  double chi2 = 0.0;
  for (int i = 0; i < static_cast<int>(dof); ++i) chi2 += std::pow(stream.normal(), 2);
  return dof / chi2;
}

struct Reliability {
  std::array<double, 5> stated{};
  std::array<double, 5> right{};
  std::array<double, 5> count{};
};

std::size_t nearest(const std::vector<ObservationComponent>& components, const SE3d& truth) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < components.size(); ++k) {
    const auto angle = [&](std::size_t i) {
      return (components[i].pose.rotation().inverse() * truth.rotation()).angle();
    };
    if (angle(k) < angle(best)) best = k;
  }
  return best;
}

/// Weights of leading components in bins from 0.5 to 1, and how often these are the true ones.
Reliability simulate(double dof, int views) {
  RandomStream stream(11);
  Reliability found;
  for (int i = 0; i < views; ++i) {
    const SE3d truth = draw_view(stream);
    const double scale = std::isinf(dof) ? 1.0 : std::sqrt(draw_factor(dof, stream));
    const TagCorners corners =
        with_noise(image_of(truth, pinhole_camera()), kNoise * scale, stream);
    const auto components = tag_components(tag_minima(corners, kTagSize, pinhole_camera()),
                                           {.sd_px = kNoise, .dof = dof});
    if (components.size() != 2) continue;
    const double weight = components[0].weight;
    const auto bin = static_cast<std::size_t>(std::min(4.0, (weight - 0.5) * 10.0));
    found.count[bin] += 1.0;
    found.stated[bin] += weight;
    found.right[bin] += nearest(components, truth) == 0 ? 1.0 : 0.0;
  }
  return found;
}

void expect_reliable(const Reliability& found) {
  for (std::size_t bin = 0; bin < found.count.size(); ++bin) {
    ASSERT_GT(found.count[bin], 200.0);
    const double stated = found.stated[bin] / found.count[bin];
    const double right = found.right[bin] / found.count[bin];
    // Four standard errors, and 0.02 for peaks that are not normal.
    const double error = std::sqrt(stated * (1.0 - stated) / found.count[bin]);
    EXPECT_NEAR(right, stated, 4.0 * error + 0.02) << "bin " << bin;
  }
}

TEST(TagComponents, WeightsAreProbabilitiesForNormalNoise) {
  expect_reliable(simulate(std::numeric_limits<double>::infinity(), 20000));
}

TEST(TagComponents, WeightsAreProbabilitiesForHeavyTails) { expect_reliable(simulate(3.0, 20000)); }

TEST(TagComponents, CovariancesHoldForBothNoises) {
  for (const double dof : {std::numeric_limits<double>::infinity(), 5.0}) {
    RandomStream stream(12);
    const SE3d truth = view(0.5, 0.9);
    double nees = 0.0;
    constexpr int kDraws = 4000;
    for (int i = 0; i < kDraws; ++i) {
      const double scale = std::isinf(dof) ? 1.0 : std::sqrt(draw_factor(dof, stream));
      const TagCorners corners =
          with_noise(image_of(truth, fisheye_camera()), kNoise * scale, stream);
      const auto components = tag_components(tag_minima(corners, kTagSize, fisheye_camera()),
                                             {.sd_px = kNoise, .dof = dof});
      const auto& component = components[nearest(components, truth)];
      const Vector6d error = (component.pose.inverse() * truth).log();
      nees += error.dot(component.covariance->llt().solve(error)) / kDraws;
    }
    // The posterior is Student's t with dof + 2 degrees of freedom and this covariance: its squared
    // Mahalanobis distance is 6 on average too. One standard error is 0.06 and 0.1.
    EXPECT_NEAR(nees, 6.0, 0.4) << dof;
  }
}

TEST(TagComponents, AnErrorOfTheBearingIsARotationOfTheCamera) {
  constexpr double kBearing = 0.01;  // [rad], much more than corners' noise
  RandomStream stream(13);
  const SE3d truth = view(0.5, 0.9);
  double nees = 0.0;
  constexpr int kDraws = 4000;
  for (int i = 0; i < kDraws; ++i) {
    const SO3d error =
        SO3d::exp(kBearing * Eigen::Vector3d(stream.normal(), stream.normal(), stream.normal()));
    const TagCorners corners = with_noise(
        image_of(SE3d(error, Eigen::Vector3d::Zero()) * truth, fisheye_camera()), kNoise, stream);
    auto components =
        tag_components(tag_minima(corners, kTagSize, fisheye_camera()), {.sd_px = kNoise});
    add_bearing_error(components, kBearing);
    const auto& component = components[nearest(components, truth)];
    const Vector6d off = (component.pose.inverse() * truth).log();
    nees += off.dot(component.covariance->llt().solve(off)) / kDraws;
  }
  EXPECT_NEAR(nees, 6.0, 0.3);  // one standard error is 0.06
  std::vector<ObservationComponent> none;
  EXPECT_INVALID(add_bearing_error(none, -1.0),
                 "the error of the bearing is -1 rad, expected zero or more");
}

TEST(TagComponents, AreTheFormulasOfTheirComment) {
  const auto minima = tag_minima({{{500.2, 300.1}, {531.5, 301.9}, {532.3, 270.4}, {500.9, 268.8}}},
                                 kTagSize, pinhole_camera());
  ASSERT_EQ(minima.size(), 2U);
  const CornerNoise noise{.sd_px = 0.2, .dof = 3.0};
  const auto components = tag_components(minima, noise);
  std::array<double, 2> mass{};
  for (std::size_t k = 0; k < 2; ++k) {
    mass[k] = std::pow(3.0 * 0.04 + minima[k].squared_error, -2.5) /
              std::sqrt(minima[k].information.determinant());
  }
  const std::size_t lead = mass[0] > mass[1] ? 0 : 1;
  EXPECT_NEAR(components[0].weight, mass[lead] / (mass[0] + mass[1]), 1e-9);
  EXPECT_NEAR(components[0].weight + components[1].weight, 1.0, 1e-14);
  const Matrix6d covariance =
      minima[lead].information.inverse() * (3.0 * 0.04 + minima[lead].squared_error) / 3.0;
  EXPECT_LT((*components[0].covariance - covariance).norm(), 1e-7 * covariance.norm());
  Observation observation;
  observation.object = "5";
  observation.components = components;
  EXPECT_NO_THROW(validate(observation));
}

TEST(TagComponents, ManyDegreesOfFreedomAreNormalNoise) {
  const auto minima = tag_minima({{{500.2, 300.1}, {531.5, 301.9}, {532.3, 270.4}, {500.9, 268.8}}},
                                 kTagSize, pinhole_camera());
  const auto normal = tag_components(minima, {.sd_px = 0.2});
  const auto nearly = tag_components(minima, {.sd_px = 0.2, .dof = 1e8});
  ASSERT_EQ(normal.size(), nearly.size());
  for (std::size_t k = 0; k < normal.size(); ++k) {
    EXPECT_NEAR(normal[k].weight, nearly[k].weight, 1e-6);
    EXPECT_LT((*normal[k].covariance - *nearly[k].covariance).norm(),
              1e-6 * normal[k].covariance->norm());
  }
}

TEST(TagComponents, LightOnesAreLeftOut) {
  const auto minima =
      tag_minima(image_of(view(0.8, 0.9), pinhole_camera()), kTagSize, pinhole_camera());
  ASSERT_EQ(minima.size(), 2U);
  const CornerNoise noise{.sd_px = 0.001, .dof = 4.0};
  EXPECT_EQ(tag_components(minima, noise).size(), 1U);
  EXPECT_EQ(tag_components(minima, noise).front().weight, 1.0);
  EXPECT_EQ(tag_components(minima, noise, 0.0).size(), 2U);
  EXPECT_TRUE(tag_components({}, {}).empty());
}

TEST(TagComponents, RefuseANoiseThatIsNone) {
  EXPECT_INVALID(tag_components({}, {.sd_px = 0.0}),
                 "the noise of corners is 0 px, expected a number above zero");
  EXPECT_INVALID(tag_components({}, {.sd_px = 1.0, .dof = -1.0}),
                 "the noise of corners has -1 degrees of freedom, expected more than zero");
}

}  // namespace
}  // namespace posemix
