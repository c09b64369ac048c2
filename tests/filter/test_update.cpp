// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <array>

#include "posemix/density/pose_stack.hpp"
#include "scenario.hpp"

namespace posemix {
namespace {

using testing::correlated_covariance;
using testing::draw;
using testing::gaussian_noise;
using testing::isotropic;
using testing::pose;
using testing::three_poses;
using testing::updates_of_both_modes;

/// A scene with two objects and a correlated prior.
struct Scene {
  PoseStackd truth = three_poses();
  RandomStream stream{42};
  Eigen::MatrixXd covariance = correlated_covariance(3, stream);

  Hypothesis prior() {
    Eigen::VectorXd white(18);
    stream.fill_normal(white);
    const Eigen::VectorXd error = Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL() * white;
    return Hypothesis(PoseStackd::exp(error).inverse() * truth, covariance);
  }
  SE3d detect(std::size_t object, const Matrix6d& noise) {
    return truth[0].inverse() * truth[object] * SE3d::exp(draw(noise, stream));
  }
};

/// The right-invariant EKF of textbooks, dense and in the camera frame, without the structure that
/// the library uses: v = Log(T_co^-1-measured...), H = [-Ad(T_c^-1) .. Ad(T_c^-1)
/// ..], explicit inverse, P+ = (I - K H) P.
struct Textbook {
  PoseStackd mean;
  Eigen::MatrixXd covariance;
  double log_likelihood = 0.0;

  void update(const std::vector<std::size_t>& objects, const std::vector<SE3d>& detections,
              const Matrix6d& object_noise) {
    const auto n = covariance.rows();
    const auto m = static_cast<Eigen::Index>(6 * objects.size());
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(m, n);
    Eigen::MatrixXd r = Eigen::MatrixXd::Zero(m, m);
    Eigen::VectorXd v(m);
    const Matrix6d to_camera = mean[0].inverse().adjoint();
    for (std::size_t j = 0; j < objects.size(); ++j) {
      const auto row = static_cast<Eigen::Index>(6 * j);
      const SE3d predicted = mean[0].inverse() * mean[objects[j]];
      v.segment<6>(row) = (detections[j] * predicted.inverse()).log();
      h.block<6, 6>(row, 0) = -to_camera;
      h.block<6, 6>(row, static_cast<Eigen::Index>(6 * objects[j])) = to_camera;
      r.block<6, 6>(row, row) =
          predicted.adjoint() * object_noise * predicted.adjoint().transpose();
    }
    const Eigen::MatrixXd s = h * covariance * h.transpose() + r;
    const Eigen::MatrixXd k = covariance * h.transpose() * s.inverse();
    const double two_pi = 2.0 * std::numbers::pi;
    log_likelihood = -0.5 * (v.dot(s.inverse() * v) + std::log((two_pi * s).determinant()));
    mean = PoseStackd::exp(k * v) * mean;
    covariance = (Eigen::MatrixXd::Identity(n, n) - k * h) * covariance;
  }
};

TEST(Update, AgreesWithTextbookFilterOverManyFrames) {
  Scene scene;
  const Hypothesis start = scene.prior();
  const DetectorNoise noise = gaussian_noise(3.0, 0.008);
  const Matrix6d r = noise.components().front().covariance;
  const Matrix6d q = isotropic(0.3, 0.004);
  Textbook textbook{start.mean(), start.covariance()};
  Hypothesis hypothesis = start;
  for (int frame = 0; frame < 200; ++frame) {
    const SE3d motion = pose(0.01, -0.02, 0.015, 0.01, 0.0, 0.005);
    scene.truth[0] = scene.truth[0] * motion;
    textbook.mean[0] = textbook.mean[0] * motion;
    textbook.covariance.topLeftCorner<6, 6>() +=
        textbook.mean[0].adjoint() * q * textbook.mean[0].adjoint().transpose();
    hypothesis = predict_with_odometry(std::move(hypothesis), motion, q);

    const std::vector<std::size_t> objects =
        frame % 3 == 0 ? std::vector<std::size_t>{2} : std::vector<std::size_t>{1, 2};
    std::vector<Detection> detections;
    std::vector<SE3d> poses;
    std::vector<const NoiseComponent*> components;
    for (const std::size_t object : objects) {
      poses.push_back(scene.detect(object, r));
      detections.push_back({object, poses.back(), &noise});
      components.push_back(&noise.components().front());
    }
    textbook.update(objects, poses, r);
    const UpdateResult result = update(hypothesis, detections, components);
    ASSERT_TRUE(result.ok);
    EXPECT_NEAR(result.log_likelihood, textbook.log_likelihood, 1e-8);
    hypothesis = result.posterior;
  }
  EXPECT_TRUE(hypothesis.mean().is_approx(textbook.mean, 1e-10));
  const double scale = textbook.covariance.cwiseAbs().maxCoeff();
  EXPECT_LT((hypothesis.covariance() - textbook.covariance).cwiseAbs().maxCoeff(), 1e-10 * scale);
}

TEST(Update, InnovationIsLinearInTheErrors) {
  // z = Log(T_R Y T_o^-1) with T = Exp(xi) T_0: central differences give H = [-I I].
  const PoseStackd mean(
      std::vector<SE3d>{pose(0.3, -0.2, 0.5, 0.4, 0.1, -0.6), pose(1.0, 0.4, -0.3, 0.2, 0.8, 0.5)});
  const DetectorNoise noise = gaussian_noise();
  constexpr double kStep = 1e-5;
  for (Eigen::Index i = 0; i < 12; ++i) {
    const auto residual = [&](double step) {
      const Eigen::VectorXd xi = step * Eigen::VectorXd::Unit(12, i);
      const PoseStackd truth = PoseStackd::exp(xi) * mean;
      const Detection detection{1, truth[0].inverse() * truth[1], &noise};
      return innovation(mean, detection, noise.components().front()).residual;
    };
    const Vector6d slope = (residual(kStep) - residual(-kStep)) / (2.0 * kStep);
    const Vector6d expected = (i < 6 ? -1.0 : 1.0) * Vector6d::Unit(i % 6);
    EXPECT_LT((slope - expected).norm(), 1e-8) << "column " << i;
  }
}

TEST(Update, NoiseEntersInTheNamedFrame) {
  // The slope of the innovation with respect to the noise n, by central differences, is the root of
  // R in world axes.
  const PoseStackd mean(
      std::vector<SE3d>{pose(0.3, -0.2, 0.5, 0.4, 0.1, -0.6), pose(1.0, 0.4, -0.3, 0.2, 0.8, 0.5)});
  const SE3d relative = mean[0].inverse() * mean[1];
  Vector6d sd;
  sd << 0.01, 0.02, 0.03, 0.004, 0.005, 0.006;
  constexpr double kStep = 1e-5;
  for (const NoiseFrame frame : {NoiseFrame::object, NoiseFrame::camera, NoiseFrame::ray}) {
    const NoiseComponent component{1.0, sd.cwiseAbs2().asDiagonal(), frame,
                                   pose(0.0, 0.0, std::numbers::pi, 0.01, 0.02, 0.0)};
    const DetectorNoise noise({component});
    Matrix6d slope;
    for (Eigen::Index i = 0; i < 6; ++i) {
      const auto residual = [&](double step) {
        Vector6d n = step * sd(i) * Vector6d::Unit(i);
        // Along the camera's axes the same small motion is applied after turning it into the
        // object's axes.
        const SE3d mode = relative * component.offset;
        SE3d axes(frame == NoiseFrame::object ? SO3d() : mode.rotation().inverse(),
                  Eigen::Vector3d::Zero());
        if (frame == NoiseFrame::ray) {
          // The z axis on the ray, turned about the axis that is perpendicular to both.
          const Eigen::Vector3d ray = mode.translation().normalized();
          const Eigen::Vector3d about = Eigen::Vector3d::UnitZ().cross(ray);
          const SO3d turn = SO3d::exp(std::acos(ray.z()) * about.normalized());
          axes = SE3d(mode.rotation().inverse() * turn, Eigen::Vector3d::Zero());
          n.tail<3>() *= mode.translation().norm();
        }
        const Detection detection{1, mode * axes * SE3d::exp(n) * axes.inverse(), &noise};
        return innovation(mean, detection, component).residual;
      };
      slope.col(i) = (residual(kStep) - residual(-kStep)) / (2.0 * kStep);
    }
    const Matrix6d world =
        innovation(mean, {1, relative * component.offset, &noise}, component).noise;
    EXPECT_LT((slope * slope.transpose() - world).cwiseAbs().maxCoeff(),
              1e-6 * world.cwiseAbs().maxCoeff());
  }
}

TEST(Update, NoiseAlongTheRayNeedsARange) {
  // At the camera itself the ray is the camera's z axis and the range counts as a millimetre.
  const NoiseComponent component{1.0, isotropic(2.0, 0.1), NoiseFrame::ray};
  const NoiseComponent at_zero = along_camera(component, SE3d());
  EXPECT_EQ(at_zero.frame, NoiseFrame::camera);
  EXPECT_NEAR(at_zero.covariance(5, 5), 1e-8, 1e-20);
}

TEST(Update, OffsetExplainsADetectionOfTheOtherMode) {
  Scene scene;
  const Hypothesis prior = scene.prior();
  const NoiseComponent plain{1.0, isotropic(3.0, 0.01)};
  const auto [a, b] = updates_of_both_modes(
      scene.detect(1, plain.covariance), plain,
      [&](auto detections, auto noise) { return update(prior, detections, noise); });
  EXPECT_TRUE(a.posterior.mean().is_approx(b.posterior.mean(), 1e-12));
  EXPECT_NEAR(a.log_likelihood, b.log_likelihood, 1e-9);
}

TEST(Update, DoesNotDependOnWhereTheWorldIs) {
  Scene scene;
  const Hypothesis prior = scene.prior();
  const DetectorNoise noise = gaussian_noise();
  const Detection detection{1, scene.detect(1, isotropic(4.0, 0.01)), &noise};
  const std::array<const NoiseComponent*, 1> components{&noise.components().front()};
  const UpdateResult here = update(prior, std::span(&detection, 1), components);

  const SE3d shift = pose(0.8, -0.5, 1.9, 3.0, -2.0, 5.0);
  const PoseStackd shifts(std::vector<SE3d>(3, shift));
  const Hypothesis moved(shifts * prior.mean(), shifts.adjoint_congruence(prior.covariance()));
  const UpdateResult there = update(moved, std::span(&detection, 1), components);
  EXPECT_TRUE(there.posterior.mean().is_approx(shifts * here.posterior.mean(), 1e-10));
  EXPECT_NEAR(there.log_likelihood, here.log_likelihood, 1e-8);
}

TEST(Update, ReportsAnInnovationCovarianceThatIsNotPositiveDefinite) {
  Scene scene;
  Eigen::MatrixXd indefinite = scene.covariance;
  indefinite.block<6, 6>(6, 6) = -Matrix6d::Identity();
  const Hypothesis broken = Hypothesis::trusted(scene.truth, indefinite);
  const DetectorNoise noise = gaussian_noise();
  const Detection detection{1, scene.detect(1, isotropic(4.0, 0.01)), &noise};
  const std::array<const NoiseComponent*, 1> components{&noise.components().front()};
  const UpdateResult result = update(broken, std::span(&detection, 1), components);
  EXPECT_FALSE(result.ok);
  EXPECT_TRUE(std::isinf(result.log_likelihood));
  EXPECT_TRUE(std::isinf(squared_mahalanobis(broken, detection, noise.components().front())));
}

TEST(Update, RefusesNoiseThatIsNotOfTheDetections) {
  Scene scene;
  const Hypothesis prior = scene.prior();
  const DetectorNoise noise = gaussian_noise();
  const std::array detections{Detection{1, scene.detect(1, isotropic(4.0, 0.01)), &noise},
                              Detection{2, scene.detect(2, isotropic(4.0, 0.01)), &noise}};
  const std::array components{&noise.components().front()};
  const std::span<const Detection> none;
  EXPECT_THROW(update(prior, detections, components), InvalidInput);
  EXPECT_THROW(update(prior, none, components), InvalidInput);
  EXPECT_THROW(iterated_update(prior, detections, components), InvalidInput);
  const NoiseUpdate by = [&](auto given) { return update(prior, detections, given); };
  EXPECT_THROW(cauchy_update(prior, detections, components, by), InvalidInput);
}

TEST(NewObject, ErrorIsThatOfCameraAndDetectionTogether) {
  // Covariance of (xi_R, xi_o) by drawing camera errors and detection noise, against
  // with_detected_object.
  RandomStream stream(7);
  const Matrix6d camera_covariance = isotropic(1.0, 0.01);
  const SE3d camera = pose(0.3, -0.2, 0.5, 0.4, 0.1, -0.6);
  const NoiseComponent component{1.0, isotropic(1.5, 0.01), NoiseFrame::object,
                                 pose(0, 0, 2.0, 0.1, 0, 0)};
  const SE3d detected = pose(1.0, 0.4, -0.3, 0.2, 0.1, 1.0);
  const Hypothesis prior(PoseStackd(std::vector<SE3d>{camera}), camera_covariance);
  const Hypothesis joint = with_detected_object(prior, detected, component);

  constexpr int kDraws = 40000;
  Eigen::Matrix<double, 12, 12> sum = Eigen::Matrix<double, 12, 12>::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const SE3d true_camera = SE3d::exp(draw(camera_covariance, stream)) * camera;
    const SE3d clean = detected * SE3d::exp(draw(component.covariance, stream)).inverse() *
                       component.offset.inverse();
    Eigen::Matrix<double, 12, 1> error;
    error << (true_camera * camera.inverse()).log(),
        (true_camera * clean * joint.mean()[1].inverse()).log();
    sum += error * error.transpose() / kDraws;
  }
  const Eigen::Matrix<double, 12, 12> expected = joint.covariance();
  const Eigen::Matrix<double, 12, 1> sd = expected.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < 12; ++i) {
    for (Eigen::Index j = 0; j < 12; ++j) {
      // Five standard errors of a sample covariance, 1/sqrt(n) of the product of the deviations,
      // plus 1 % curvature.
      EXPECT_NEAR(sum(i, j) / (sd(i) * sd(j)), expected(i, j) / (sd(i) * sd(j)),
                  5.0 * std::sqrt(2.0 / kDraws) + 0.01);
    }
  }
}

TEST(DetectorNoiseTest, RefusesWhatIsNoMixture) {
  EXPECT_THROW(DetectorNoise({}), InvalidInput);
  for (const double weight : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(DetectorNoise({{weight, isotropic(1, 1)}}), InvalidInput);
  }
  Matrix6d indefinite = Matrix6d::Identity();
  indefinite(5, 5) = -1.0;
  EXPECT_THROW(DetectorNoise({{1.0, indefinite}}), InvalidInput);
}

TEST(DetectorNoiseTest, SingleGaussianKeepsTheSecondMomentOfCentredComponents) {
  const NoiseComponent core{2.0, isotropic(4.0, 0.01)};
  const NoiseComponent tail{1.0, isotropic(12.0, 0.02)};
  NoiseComponent flipped{1.0, isotropic(4.0, 0.01)};
  flipped.offset = pose(0, 0, 3.0, 0, 0, 0);
  const DetectorNoise single = DetectorNoise({core, tail, flipped}).single_gaussian();
  ASSERT_EQ(single.components().size(), 1U);
  const Matrix6d expected = (2.0 * core.covariance + tail.covariance) / 3.0;
  EXPECT_TRUE(single.components().front().covariance.isApprox(expected, 1e-14));
  NoiseComponent in_camera = tail;
  in_camera.frame = NoiseFrame::camera;
  EXPECT_THROW(DetectorNoise({core, in_camera}).single_gaussian(), InvalidInput);
  EXPECT_EQ(DetectorNoise({flipped}).single_gaussian().components().size(), 1U);
}

}  // namespace
}  // namespace posemix
