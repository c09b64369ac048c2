// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>

#include "posemix/density/pose_stack.hpp"
#include "scenario.hpp"

namespace posemix {
namespace {

using testing::camera_filter;
using testing::draw;
using testing::gaussian_noise;
using testing::heavy_tailed_noise;
using testing::isotropic;
using testing::kCameraPose;
using testing::kObject;
using testing::pose;

double log_weight_sum(const Posterior& posterior) {
  std::vector<double> terms;
  for (const auto& component : posterior.components()) terms.push_back(component.log_weight);
  return log_sum_exp(terms);
}

TEST(GaussianSumFilter, OneHypothesisAndOneComponentIsTheInvariantEkf) {
  RandomStream stream(1);
  const DetectorNoise noise = gaussian_noise();
  GaussianSumSettings settings;
  settings.update = UpdateRule::linearized;
  GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(1.0, 0.01), settings);
  const std::size_t object = filter.add_object(kCameraPose.inverse() * kObject, noise);
  Hypothesis ekf = filter.posterior()[0].density;
  double log_evidence = 0.0;
  for (int frame = 0; frame < 50; ++frame) {
    const SE3d motion = pose(0.01, 0.0, 0.02, 0.0, 0.01, 0.0);
    const Matrix6d q = isotropic(0.2, 0.002);
    filter.predict([&](Hypothesis h) { return predict_with_odometry(std::move(h), motion, q); });
    ekf = predict_with_odometry(std::move(ekf), motion, q);
    const SE3d relative = ekf.mean()[0].inverse() * ekf.mean()[1];
    const Detection detection{object, relative * SE3d::exp(draw(isotropic(4.0, 0.01), stream)),
                              &noise};
    const NoiseComponent* const component = &noise.components().front();
    const UpdateResult result = update(ekf, std::span(&detection, 1), std::span(&component, 1));
    ekf = result.posterior;
    log_evidence = result.log_likelihood;
    EXPECT_NEAR(filter.update(std::span(&detection, 1)).log_evidence, log_evidence, 1e-9);
  }
  ASSERT_EQ(filter.posterior().size(), 1U);
  EXPECT_TRUE(filter.summarise().mean().is_approx(ekf.mean(), 1e-12));
  EXPECT_TRUE(filter.summarise().covariance().isApprox(ekf.covariance(), 1e-10));
}

TEST(GaussianSumFilter, WeightsFollowBayesRule) {
  // Two components, one object: w_i proportional to alpha_i N(z; 0, S_i), by hand.
  const DetectorNoise noise = heavy_tailed_noise(30.0);
  GaussianSumSettings settings;
  settings.update = UpdateRule::linearized;
  GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(0.5, 0.005), settings);
  const std::size_t object =
      filter.add_independent_object(kCameraPose.inverse() * kObject, isotropic(2.0, 0.01));
  const Hypothesis prior = filter.posterior()[0].density;
  const Detection detection{object, kCameraPose.inverse() * kObject * pose(0, 0, 0.3, 0, 0, 0),
                            &noise};
  filter.update(std::span(&detection, 1));
  ASSERT_EQ(filter.posterior().size(), 2U);
  double joint[2];
  for (std::size_t i = 0; i < 2; ++i) {
    const NoiseComponent& component = noise.components()[i];
    const Innovation one = innovation(prior.mean(), detection, component);
    const Eigen::MatrixXd p = prior.covariance();
    const Matrix6d s = p.topLeftCorner(6, 6) + p.bottomRightCorner(6, 6) - p.topRightCorner(6, 6) -
                       p.bottomLeftCorner(6, 6) + one.noise;
    joint[i] = component.weight * std::exp(-0.5 * one.residual.dot(s.inverse() * one.residual)) /
               std::sqrt(s.determinant());
  }
  EXPECT_NEAR(filter.posterior().weight(0), joint[0] / (joint[0] + joint[1]), 1e-10);
}

TEST(GaussianSumFilter, SharpNoiseDoesNotUnderflow) {
  // Likelihoods of exp(-1e6) and less: with plain weights all would be zero.
  const DetectorNoise noise({{0.7, isotropic(0.01, 1e-5)}, {0.3, isotropic(0.02, 2e-5)}});
  GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(0.01, 1e-5));
  const std::size_t object = filter.add_object(kCameraPose.inverse() * kObject, noise);
  const Detection far{object, kCameraPose.inverse() * kObject * pose(0.5, 0.3, 0.2, 0.1, 0.1, 0.2),
                      &noise};
  const UpdateReport report = filter.update(std::span(&far, 1));
  EXPECT_LT(report.log_evidence, -1e5);
  EXPECT_FALSE(report.failed.front());
  EXPECT_NEAR(log_weight_sum(filter.posterior()), 0.0, 1e-12);
  // The wide component explains it better.
  EXPECT_GT(filter.posterior()[filter.posterior().heaviest()].density.covariance()(6, 6), 0.0);
}

TEST(GaussianSumFilter, JointUseBranchesOncePerFrameAndPerObjectOncePerObject) {
  const DetectorNoise noise = heavy_tailed_noise();
  for (const NoiseUse use : {NoiseUse::joint, NoiseUse::per_object}) {
    GaussianSumSettings settings;
    settings.noise_use = use;
    settings.reduction.prune_below = 0.0;
    GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(0.5, 0.005), settings);
    const SE3d second = kObject * pose(0, 0, 0, 0.3, 0, 0);
    const std::size_t a =
        filter.add_independent_object(kCameraPose.inverse() * kObject, isotropic(2.0, 0.01));
    const std::size_t b =
        filter.add_independent_object(kCameraPose.inverse() * second, isotropic(2.0, 0.01));
    const Detection detections[] = {{a, kCameraPose.inverse() * kObject, &noise},
                                    {b, kCameraPose.inverse() * second, &noise}};
    filter.update(detections);
    EXPECT_EQ(filter.posterior().size(), use == NoiseUse::joint ? 2U : 4U);
  }
}

TEST(GaussianSumFilter, NumberOfHypothesesStaysBounded) {
  RandomStream stream(5);
  const DetectorNoise noise = heavy_tailed_noise();
  GaussianSumSettings settings;
  settings.reduction.max_components = 4;
  GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(0.5, 0.005), settings);
  const std::size_t object = filter.add_object(kCameraPose.inverse() * kObject, noise);
  for (int frame = 0; frame < 30; ++frame) {
    const Detection detection{
        object, kCameraPose.inverse() * kObject * SE3d::exp(draw(isotropic(8.0, 0.01), stream)),
        &noise};
    filter.update(std::span(&detection, 1));
    EXPECT_LE(filter.posterior().size(), 4U);
    EXPECT_NEAR(log_weight_sum(filter.posterior()), 0.0, 1e-12);
  }
}

TEST(GaussianSumFilter, GateIsTheChiSquareQuantile) {
  const DetectorNoise noise = gaussian_noise();
  GaussianSumSettings settings;
  settings.gate_probability = 0.99;
  const double threshold = boost::math::quantile(boost::math::chi_squared(6), 0.99);
  const auto gated = [&](double scale) {
    GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(0.5, 0.005), settings);
    const std::size_t object =
        filter.add_independent_object(kCameraPose.inverse() * kObject, isotropic(2.0, 0.01));
    const auto at = [&](double shift) {
      return Detection{object, kCameraPose.inverse() * kObject * pose(0, 0, 0, 0, shift, 0),
                       &noise};
    };
    const Hypothesis prior = filter.posterior()[0].density;
    const double unit = squared_mahalanobis(prior, at(0.1), noise.components().front());
    const Detection detection = at(0.1 * std::sqrt(scale * threshold / unit));
    const Hypothesis before = filter.summarise();
    const bool out = filter.update(std::span(&detection, 1)).gated.front();
    if (out) {
      EXPECT_TRUE(filter.summarise().covariance().isApprox(before.covariance(), 0.0));
    }
    return out;
  };
  EXPECT_FALSE(gated(0.98));
  EXPECT_TRUE(gated(1.02));
}

TEST(GaussianSumFilter, SummariesAreWhatTheyAreCalled) {
  const DetectorNoise noise = heavy_tailed_noise(30.0);
  const auto summary = [&](Summary kind) {
    GaussianSumSettings settings;
    settings.summary = kind;
    settings.reduction.prune_below = 0.0;
    GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(0.5, 0.005), settings);
    const std::size_t object = filter.add_object(kCameraPose.inverse() * kObject, noise);
    const Detection detection{object, kCameraPose.inverse() * kObject * pose(0, 0, 0.3, 0, 0, 0),
                              &noise};
    filter.update(std::span(&detection, 1));
    return std::pair(filter.summarise(), filter.posterior());
  };
  const auto [best, posterior] = summary(Summary::best);
  EXPECT_EQ(posterior.size(), 4U);
  EXPECT_TRUE(best.mean().is_approx(posterior[posterior.heaviest()].density.mean(), 0.0));

  std::vector<Component<Hypothesis>> sorted = posterior.components();
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.log_weight > b.log_weight; });
  const auto two =
      merge<PoseStackd>(std::span<const Component<Hypothesis>>(sorted).first(2)).component.density;
  EXPECT_TRUE(
      summary(Summary::merge_two_largest).first.covariance().isApprox(two.covariance(), 1e-12));
  const auto all =
      merge<PoseStackd>(std::span<const Component<Hypothesis>>(sorted)).component.density;
  EXPECT_TRUE(summary(Summary::whole_mixture).first.covariance().isApprox(all.covariance(), 1e-9));
}

TEST(GaussianSumFilter, LateObjectCarriesTheCorrelationWithTheCamera) {
  // The camera drifts without detections, then sees a new object: its absolute error is the
  // camera's, its relative error the detector's alone.
  const DetectorNoise noise = gaussian_noise(2.0, 0.005);
  GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(5.0, 0.1));
  const SE3d relative = kCameraPose.inverse() * kObject;
  const std::size_t object = filter.add_object(relative, noise);
  const Hypothesis joint = filter.summarise();
  const Eigen::MatrixXd p = joint.covariance();
  EXPECT_TRUE(p.topRightCorner(6, 6).isApprox(p.topLeftCorner(6, 6), 1e-14));
  const ConcentratedGaussian<SE3d> between = relative_pose(joint, kCamera, object);
  EXPECT_TRUE(between.mean().is_approx(relative, 1e-14));
  EXPECT_TRUE(between.body_covariance().isApprox(noise.components().front().covariance, 1e-9));
}

TEST(GaussianSumFilter, ObjectWithNearSymmetryEntersAsSeveralHypotheses) {
  NoiseComponent plain{0.8, isotropic(3.0, 0.01)};
  NoiseComponent flipped{0.2, isotropic(3.0, 0.01), NoiseFrame::object,
                         pose(0, 0, std::numbers::pi, 0, 0, 0)};
  GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(0.5, 0.005));
  const SE3d relative = kCameraPose.inverse() * kObject;
  const std::size_t object = filter.add_object(relative, DetectorNoise({plain, flipped}));
  ASSERT_EQ(filter.posterior().size(), 2U);
  EXPECT_NEAR(filter.posterior().weight(1), 0.2, 1e-12);
  EXPECT_TRUE(filter.posterior()[1].density.mean()[object].is_approx(
      kObject * flipped.offset.inverse(), 1e-12));
}

TEST(GaussianSumFilter, RefusesImpossibleDetectionsAndSettings) {
  const DetectorNoise noise = gaussian_noise();
  const DetectorNoise other({{0.5, isotropic(4, 0.01)}, {0.5, isotropic(8, 0.01)}});
  GaussianSumSettings settings;
  settings.noise_use = NoiseUse::joint;
  GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(0.5, 0.005), settings);
  const std::size_t a = filter.add_object(kCameraPose.inverse() * kObject, noise);
  const std::size_t b = filter.add_object(kCameraPose.inverse() * kObject, noise);
  const SE3d y = kCameraPose.inverse() * kObject;
  const auto update = [&](std::vector<Detection> detections) { filter.update(detections); };
  EXPECT_THROW(update({{kCamera, y, &noise}}), InvalidInput);
  EXPECT_THROW(update({{b + 1, y, &noise}}), InvalidInput);
  EXPECT_THROW(update({{a, y, &noise}, {a, y, &noise}}), InvalidInput);
  EXPECT_THROW(update({{a, y, &noise}, {b, y, &other}}), InvalidInput);
  EXPECT_NO_THROW(update({}));
  EXPECT_THROW(filter.add_independent_object(y, -Matrix6d::Identity()), InvalidInput);
  for (const double probability : {0.0, -0.5, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    settings.gate_probability = probability;
    EXPECT_THROW(camera_filter(kCameraPose, isotropic(1, 1), settings), InvalidInput);
  }
}

TEST(GaussianSumFilter, RefusesWhatIsNotFiniteAndStaysAsItWas) {
  const DetectorNoise noise = heavy_tailed_noise();
  GaussianSumFilter filter = camera_filter(kCameraPose, isotropic(1.0, 0.01));
  const SE3d y = kCameraPose.inverse() * kObject;
  const std::size_t object = filter.add_object(y, noise);
  const Hypothesis before = filter.summarise();
  const SE3d bad(SO3d(), {0.0, std::numeric_limits<double>::quiet_NaN(), 0.0});
  const Detection detection{object, bad, &noise};
  EXPECT_THROW(filter.update(std::span(&detection, 1)), InvalidInput);
  EXPECT_THROW(filter.add_object(bad, noise), InvalidInput);
  EXPECT_THROW(filter.add_independent_object(bad, Matrix6d::Identity()), InvalidInput);
  EXPECT_THROW(filter.predict([&](Hypothesis h) {
    return predict_with_odometry(std::move(h), bad, Matrix6d::Identity());
  }),
               InvalidInput);
  const Hypothesis after = filter.summarise();
  EXPECT_EQ(after.covariance(), before.covariance());
  EXPECT_TRUE(after.mean().is_approx(before.mean(), 0.0));
}

TEST(GaussianSumFilter, RefusesWhatAMotionReturnsAndStaysAsItWas) {
  const Eigen::MatrixXd wide = Eigen::MatrixXd::Identity(6, 6);
  GaussianSumFilter filter = camera_filter(kCameraPose, wide);
  const auto refuses = [&](const SE3d& camera, double variance) {
    EXPECT_THROW(filter.predict([&](const Hypothesis&) {
      return Hypothesis::trusted(PoseStackd({camera}), variance * wide);
    }),
                 InvalidInput);
    EXPECT_EQ(filter.summarise().covariance(), wide);
    EXPECT_TRUE(filter.summarise().mean()[0].is_approx(kCameraPose, 0.0));
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  refuses(SE3d(SO3d(), {0.0, kNaN, 0.0}), 1.0);
  refuses(SE3d(SO3d(), {0.0, 1.7e308, 0.0}), 1.0);
  refuses(SE3d(SO3d::exp({kNaN, 0.0, 0.0}), {0.0, 0.0, 0.0}), 1.0);
  refuses(kCameraPose, kNaN);
}

TEST(GaussianSumFilter, RefusesAPriorInWhichTheNoiseIsLost) {
  Matrix6d wide = isotropic(1.0, 0.01);
  wide(4, 4) = 1e16;
  GaussianSumFilter filter = camera_filter(kCameraPose, wide, GaussianSumSettings());
  const Eigen::MatrixXd before = filter.posterior()[0].density.covariance();
  const DetectorNoise noise = gaussian_noise();
  const SE3d y = kCameraPose.inverse() * kObject;
  EXPECT_THROW(filter.add_object(y, noise), InvalidInput);
  const std::size_t object = filter.add_independent_object(y, isotropic(1.0, 0.01));
  const Detection detection{object, y, &noise};
  EXPECT_THROW(filter.update(std::span(&detection, 1)), InvalidInput);
  EXPECT_EQ(filter.posterior()[0].density.covariance().topLeftCorner(6, 6), before);
}

TEST(GaussianSumFilterSlow, CovarianceStaysPositiveDefiniteOverAMillionSteps) {
  RandomStream stream(9);
  const DetectorNoise noise = gaussian_noise(1.0, 0.002);
  const Matrix6d r = noise.components().front().covariance;
  const Matrix6d q = isotropic(0.05, 2e-4);
  Hypothesis h(PoseStackd(std::vector<SE3d>{kCameraPose}), isotropic(0.1, 0.001));
  h = with_detected_object(h, kCameraPose.inverse() * kObject, noise.components().front());
  SE3d camera = kCameraPose;
  const NoiseComponent* const component = &noise.components().front();
  for (int step = 1; step <= 1000000; ++step) {
    const double phase = 1e-3 * step;
    const SE3d motion =
        pose(0.001 * std::cos(phase), 0.001 * std::sin(phase), 0, 0.001 * std::sin(phase), 0, 0);
    camera = camera * motion;
    h = predict_with_odometry(std::move(h), motion, q);
    const Detection detection{1, camera.inverse() * kObject * SE3d::exp(draw(r, stream)), &noise};
    h = update(h, std::span(&detection, 1), std::span(&component, 1)).posterior;
    if (step % 1000 == 0) {
      const Eigen::MatrixXd& p = h.covariance();
      ASSERT_TRUE(p.allFinite());
      ASSERT_EQ((p - p.transpose()).cwiseAbs().maxCoeff(), 0.0);
      ASSERT_EQ(Eigen::LLT<Eigen::MatrixXd>(p).info(), Eigen::Success) << "step " << step;
    }
  }
}

}  // namespace
}  // namespace posemix
