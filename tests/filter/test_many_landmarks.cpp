// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "filter/multi_object/global_hypotheses.hpp"
#include "multi_object_scene.hpp"

/// Filters with more objects than are active at a time, against filters in which all are.
namespace posemix {
namespace {

using internal::ActiveLimits;
using internal::GlobalHypotheses;
using internal::JointGaussian;
using internal::MultiObjectState;
using testing::isotropic;
using testing::OrbitScene;
using testing::plain_settings;
using testing::ray_noise;

constexpr ActiveLimits kDense{.dense = 1000};
constexpr ActiveLimits kFew{.dense = 9, .most = 9, .kept = 4};

/// Noise without clutter, with which every object has one hypothesis.
DetectorNoise one_mode(bool has_slow, bool is_typical) {
  NoiseDependence dependence;
  if (has_slow) {
    dependence.slow =
        SlowError{.covariance = pose_covariance({0.06, 0.06, 0.03}, {0.004, 0.004, 0.03}),
                  .correlation_time_s = 3.0};
  }
  dependence.is_typical = is_typical;
  return DetectorNoise(ray_noise().components(), {.weight = 0.0}, dependence);
}

class ManyLandmarks : public ::testing::Test {
 protected:
  GlobalHypotheses filter_of(const DetectorNoise& noise, const MultiObjectSettings& settings,
                             const ActiveLimits& limits) const {
    MultiObjectState state(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                           std::vector<ObjectSensor>(scene.truth.size(), {noise}), settings);
    state.limits = limits;
    return GlobalHypotheses(state);
  }

  /// Both filters get the same; objects are seen in an order with loops, gaps and repetitions.
  template <class Predict>
  void run(GlobalHypotheses& a, GlobalHypotheses& b, int frames, double flips, Predict predict) {
    for (int frame = 0; frame < frames; ++frame) {
      const SE3d motion = scene.advance();
      for (GlobalHypotheses* filter : {&a, &b})
        filter->for_each([&](MultiObjectState& state) { predict(state, motion); });
      for (int k = 0; k < 3; ++k) {
        const auto place = static_cast<std::size_t>(scene.stream.uniform() * 4.0);
        const std::size_t j =
            (static_cast<std::size_t>(scene.frame / 5) + place) % scene.truth.size();
        const SE3d seen = scene.detect(j, flips, 0.0);
        a.update(j, observation_of(seen), {});
        b.update(j, observation_of(seen), {});
      }
    }
  }
  void run(GlobalHypotheses& a, GlobalHypotheses& b, int frames, double flips) {
    run(a, b, frames, flips, [&](MultiObjectState& state, const SE3d& motion) {
      state.predict_with_odometry(motion, scene.q, 0.1);
    });
  }

  OrbitScene scene{11, 14, 0.05, 1e-3};
};

/// The joint Gaussian with the error of the world, of which passive objects keep another part in
/// it.
JointGaussian in_world(const GlobalHypotheses& filter) {
  JointGaussian joint = filter.summary().joint;
  joint.add_world_error(filter.summary().world_error);
  return joint;
}

/// Largest difference of two joint Gaussians, in standard deviations and in correlations.
double weight_difference(const GlobalHypotheses& a, const GlobalHypotheses& b) {
  EXPECT_LT(b.summary().joint.active(), b.summary().joint.size());
  EXPECT_TRUE(b.joint().covariance().allFinite());
  const auto x = a.joint();
  const auto y = b.joint();
  const Eigen::VectorXd scale = x.covariance().diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd apart = (y.mean() * x.mean().inverse()).log();
  return std::max(scale.cwiseProduct(apart).cwiseAbs().maxCoeff(),
                  (scale.asDiagonal() * (y.covariance() - x.covariance()) * scale.asDiagonal())
                      .cwiseAbs()
                      .maxCoeff());
}

/// KL of N(0, p) from N(apart, q), nats.
double divergence(const Eigen::VectorXd& apart, const Eigen::MatrixXd& p,
                  const Eigen::MatrixXd& q) {
  const Eigen::LLT<Eigen::MatrixXd> factor(q);
  const Eigen::LLT<Eigen::MatrixXd> other(p);
  const auto log_det = [](const Eigen::LLT<Eigen::MatrixXd>& llt) {
    return 2.0 * Eigen::MatrixXd(llt.matrixL()).diagonal().array().log().sum();
  };
  return 0.5 * (factor.solve(p).trace() + apart.dot(factor.solve(apart)) -
                static_cast<double>(p.rows()) + log_det(factor) - log_det(other));
}

TEST_F(ManyLandmarks, PassiveOnesAreThoseOfTheDenseFilter) {
  GlobalHypotheses dense = filter_of(one_mode(false, false), plain_settings(), kDense);
  GlobalHypotheses compressed = filter_of(one_mode(false, false), plain_settings(), kFew);
  run(dense, compressed, 300, 0.0);
  const auto joint = compressed.joint();
  const auto estimates =
      compressed.summary().leading_estimates(internal::WorldShift(Eigen::Vector3d::Zero()));
  for (std::size_t j = 0; j < estimates.size(); ++j) {
    const auto index = compressed.summary().objects[j].belief.pose_index();
    ASSERT_TRUE(index && estimates[j]);
    EXPECT_TRUE(estimates[j]->world.covariance().isApprox(marginal(joint, *index).covariance()));
    EXPECT_TRUE(estimates[j]->relative.covariance().isApprox(
        relative_pose(joint, 0, *index).covariance(), 1e-9));
  }
  EXPECT_LT(weight_difference(dense, compressed), 1e-8);
}

TEST_F(ManyLandmarks, SoTheyAreWithSlowErrorsAndDampedGains) {
  GlobalHypotheses dense =
      filter_of(one_mode(true, true), MultiObjectSettings{.default_clutter = 0.0}, kDense);
  GlobalHypotheses compressed =
      filter_of(one_mode(true, true), MultiObjectSettings{.default_clutter = 0.0}, kFew);
  for (int part = 0; part < 6; ++part) {
    run(dense, compressed, 50, 0.0);
    EXPECT_LT(weight_difference(dense, compressed), 1e-8);
  }
  const Eigen::MatrixXd here = in_world(dense).covariance();
  const Eigen::MatrixXd there = in_world(compressed).covariance();
  EXPECT_LT((here - there).norm(), 1e-9 * here.norm());
  for (std::size_t i = 0; i < compressed.summary().joint.size(); ++i) {
    if (compressed.summary().joint.is_pose(i)) continue;
    EXPECT_LT((compressed.summary().joint.slow(i) - dense.summary().joint.slow(i)).norm(), 1e-8);
  }
}

TEST_F(ManyLandmarks, SoTheyAreWithConstantVelocity) {
  MultiObjectSettings settings = plain_settings();
  settings.has_odometry = false;
  GlobalHypotheses dense = filter_of(one_mode(false, false), settings, kDense);
  GlobalHypotheses compressed = filter_of(one_mode(false, false), settings, kFew);
  run(dense, compressed, 200, 0.0, [&](MultiObjectState& state, const SE3d&) {
    state.predict_constant_velocity(1.0, isotropic(0.1, 1e-3), isotropic(0.2, 2e-3),
                                    isotropic(2.0, 0.05), 0.1);
  });
  EXPECT_LT(weight_difference(dense, compressed), 1e-8);
}

// A slow error that has decayed to a thousandth is taken out of the base, and is drawn anew when
// its object is seen again.
TEST_F(ManyLandmarks, AForgottenSlowErrorIsIndependent) {
  NoiseDependence dependence = one_mode(true, false).dependence();
  dependence.slow->correlation_time_s = 0.3;
  const DetectorNoise noise(ray_noise().components(), {.weight = 0.0}, dependence);
  GlobalHypotheses dense = filter_of(noise, plain_settings(), kDense);
  GlobalHypotheses compressed = filter_of(noise, plain_settings(), kFew);
  for (int part = 0; part < 10; ++part) {
    run(dense, compressed, 30, 0.0);
    EXPECT_LT(weight_difference(dense, compressed), 2e-3);
  }
  const MultiObjectState& all = compressed.summary();
  std::size_t independent = 0;
  for (const auto& object : all.objects) {
    const auto index = object.belief.pose_index();
    if (index && all.joint.covariance(*index + 1, *index).isZero(0.0)) ++independent;
  }
  EXPECT_GT(independent, 3U);
}

// While modes compete the regression on few neighbours is in place of that on all (eq. 13).
TEST_F(ManyLandmarks, CompetingModesLoseLittle) {
  MultiObjectSettings settings = plain_settings();
  GlobalHypotheses dense = filter_of(ray_noise(), settings, kDense);
  GlobalHypotheses compressed = filter_of(ray_noise(), settings, kFew);
  double worst = 0.0;
  for (int part = 0; part < 20; ++part) {
    run(dense, compressed, 20, 0.2);
    const auto a = dense.joint();
    const auto b = compressed.joint();
    const Eigen::VectorXd apart = (b.mean() * a.mean().inverse()).log();
    const Matrix6d p = block(a.covariance(), 0, 0);
    const Matrix6d q = block(b.covariance(), 0, 0);
    worst = std::max(worst, divergence(apart.head<6>(), p, q));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> values(b.covariance());
    EXPECT_GT(values.eigenvalues()[0], 0.0);
    EXPECT_EQ((b.covariance() - b.covariance().transpose()).norm(), 0.0);
  }
  EXPECT_LT(worst, 0.05);
}

/// Eq. (5) to (8) with the regression on everything, for a gain of one.
struct Projection {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

Projection exact_projection(const Eigen::MatrixXd& b, Eigen::Index at,
                            const internal::Explanation& leading,
                            const internal::CameraAlternative& alternative) {
  const Eigen::Index n = b.rows();
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(6, n);
  h.leftCols<6>() = -Matrix6d::Identity();
  h.middleCols<6>(at) = Matrix6d::Identity();
  Projection own{Eigen::VectorXd::Zero(n), leading.clutter_probability * b};
  for (const internal::Innovation& seen : leading.innovations) {
    const Eigen::MatrixXd k = b * h.transpose() * seen.covariance.inverse();
    const Eigen::VectorXd moved = k * seen.residual;
    own.mean += seen.weight * moved;
    own.covariance += seen.weight * (b - k * h * b + moved * moved.transpose());
  }
  own.covariance -= own.mean * own.mean.transpose();
  const Matrix6d camera = b.topLeftCorner<6, 6>();
  const Eigen::MatrixXd g = b.leftCols<6>() * camera.inverse();
  const Eigen::VectorXd apart = g * alternative.mean - own.mean;
  const Eigen::MatrixXd other = b + g * (alternative.covariance - camera) * g.transpose();
  const double w = alternative.weight;
  Projection all{own.mean + w * apart, (1.0 - w) * own.covariance + w * other +
                                           w * (1.0 - w) * apart * apart.transpose()};
  std::vector<Eigen::Index> s;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i < at || i >= at + 6) s.push_back(i);
  }
  const Eigen::MatrixXd before = own.covariance(s, s);
  const Eigen::MatrixXd by =
      before.ldlt().solve(Eigen::MatrixXd(own.covariance(s, Eigen::seqN(at, 6)))).transpose();
  const Eigen::MatrixXd after = all.covariance(s, s);
  const Eigen::MatrixXd row = by * after;
  const Matrix6d self = own.covariance.block<6, 6>(at, at) + by * (after - before) * by.transpose();
  all.mean.segment<6>(at) = own.mean.segment<6>(at) + w * by * Eigen::VectorXd(apart(s));
  for (std::size_t i = 0; i < s.size(); ++i) {
    all.covariance.col(s[i]).segment<6>(at) = row.col(static_cast<Eigen::Index>(i));
    all.covariance.row(s[i]).segment<6>(at) = row.col(static_cast<Eigen::Index>(i)).transpose();
  }
  all.covariance.block<6, 6>(at, at) = self;
  return all;
}

/// The largest KL of the exact projection from that of the filter, over the objects [nats].
double worst_loss(std::size_t objects) {
  OrbitScene scene(3, objects, 0.05, 1e-3);
  MultiObjectState state(ConcentratedGaussian<SE3d>(scene.camera, isotropic(0.1, 0.002)),
                         std::vector<ObjectSensor>(objects, {one_mode(false, false)}),
                         plain_settings());
  GlobalHypotheses filter(state);
  for (int frame = 0; frame < 60; ++frame) {
    const SE3d motion = scene.advance();
    filter.for_each([&](MultiObjectState& s) { s.predict_with_odometry(motion, scene.q, 0.1); });
    for (std::size_t k = 0; k < 8; ++k) {
      const std::size_t j = (static_cast<std::size_t>(frame) + k) % objects;
      filter.update(j, observation_of(scene.detect(j, 0.0, 0.0)), {});
    }
  }
  const MultiObjectState& all = filter.summary();
  EXPECT_EQ(all.joint.active() < all.joint.size(), objects == 60);
  double worst = 0.0;
  for (std::size_t j = 0; j < objects; ++j) {
    const auto seen = all.observe(j, observation_of(scene.detect(j, 0.0, 0.0)), {}).updates.front();
    const auto before = all.joint;
    const Matrix6d camera = before.covariance(0, 0);
    const internal::CameraAlternative alternative{
        0.5, Eigen::LLT<Matrix6d>(camera).matrixL() * Vector6d::Constant(0.7), 0.8 * camera};
    auto after = before;
    const std::size_t index = all.objects[j].belief.pose_index().value();
    after.update(index, seen.explanation, alternative, {});
    const Projection exact =
        exact_projection(before.covariance(), offset(index), seen.explanation, alternative);
    Eigen::VectorXd mean(offset(after.size()));
    for (std::size_t i = 0; i < after.size(); ++i)
      segment(mean, i) = (after.pose(i) * before.pose(i).inverse()).log();
    worst = std::max(worst, divergence(mean - exact.mean, exact.covariance, after.covariance()));
  }
  return worst;
}

TEST(Neighbours, LoseNothingWhereTheRegressionHasAll) {
  for (const std::size_t objects : {12U, 17U, 30U}) EXPECT_LT(worst_loss(objects), 1e-8);
}

TEST(Neighbours, LoseATenthOfANatOfSixtyObjects) { EXPECT_LT(worst_loss(60), 0.11); }

}  // namespace
}  // namespace posemix
