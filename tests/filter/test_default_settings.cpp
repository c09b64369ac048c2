// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include <cmath>

#include "multi_object_scene.hpp"
#include "posemix/detector/default_noise.hpp"

/// The multi-object filter as it ships: every test here leaves the settings alone, but for what it
/// is about.
namespace posemix {
namespace {

using testing::draw;
using testing::isotropic;
using testing::pose;

const Matrix6d kStartCovariance = isotropic(0.1, 0.002);
const Matrix6d kOdometry = isotropic(0.04, 0.5e-3);  // per frame of a tenth of a second

SymmetryGroup ball() {
  return SymmetryGroup({}, {{Eigen::Vector3d::UnitZ()}, {Eigen::Vector3d::UnitX()}});
}

/// Independent detections of one object with a known white noise.
struct WhiteScene {
  explicit WhiteScene(std::uint64_t seed, const SymmetryGroup& symmetries = {},
                      const MultiObjectSettings& settings = {})
      : stream(seed, 5),
        filter(ConcentratedGaussian<SE3d>(SE3d(), isotropic(1e-4, 1e-6)), {{noise, symmetries}},
               settings) {}

  SE3d detection() { return truth * SE3d::exp(draw(covariance, stream)); }
  void see(int count) {
    for (int i = 0; i < count; ++i) {
      filter.predict_with_odometry(SE3d(), isotropic(1e-7, 1e-9), 0.1);
      filter.update(0, detection());
    }
  }
  SE3d estimate() const { return filter.hypotheses(0)[*filter.leading(0)].pose; }

  Matrix6d covariance = isotropic(3.0, 0.01);
  DetectorNoise noise{{{.weight = 0.95, .covariance = covariance}}, {.weight = 0.05}};
  SE3d truth = pose(0.3, -0.2, 0.5, 0.1, -0.05, 1.0);
  RandomStream stream;
  MultiObjectFilter filter;
};

// A camera that detections do not move keeps its covariance, whatever the filter learns of the
// detector, also over a pause.
TEST(DefaultSettings, AConsideredCameraDoesNotBecomeSurer) {
  MultiObjectSettings settings;
  settings.camera_gain = 0.0;
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(SE3d(), isotropic(1.0, 0.05)),
                           {{default_detector_noise()}}, settings);
  const Matrix6d before = filter.camera().covariance();
  const SE3d seen = pose(0.1, 0.2, 0.3, 0.0, 0.1, 1.0);
  for (int i = 0; i < 100; ++i) {
    filter.predict_with_odometry(SE3d(), Matrix6d::Zero(), 0.1);
    filter.update(0, seen);
  }
  filter.predict_with_odometry(SE3d(), Matrix6d::Zero(), 1000.0);
  filter.update(0, seen);
  EXPECT_TRUE(filter.camera().covariance().isApprox(before, 1e-9));
}

// An object that is not seen becomes as uncertain from the camera as the odometry makes it, in all
// that is reported of it.
TEST(DefaultSettings, ThePauseIsInTheRelativePose) {
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(SE3d(), kStartCovariance),
                           {{default_detector_noise()}}, {});
  filter.update(0, pose(0.1, 0.2, 0.3, 0.0, 0.1, 1.0));
  const Matrix6d before = filter.relative(0, 0).covariance();
  const Matrix6d expected_before = filter.predicted_detection(0, 0).covariance();
  for (int i = 0; i < 1000; ++i) filter.predict_with_odometry(SE3d(), kOdometry, 0.1);
  const Matrix6d added = 1000.0 * kOdometry;
  EXPECT_TRUE(filter.relative(0, 0).covariance().isApprox(before + added, 1e-6));
  EXPECT_TRUE(
      filter.predicted_detection(0, 0).covariance().isApprox(expected_before + added, 1e-6));
  // The joint Gaussian and the hypotheses have the same numbers.
  const auto joint = filter.joint();
  const ObjectHypothesis h = filter.hypotheses(0)[0];
  EXPECT_EQ(Matrix6d(joint.covariance().block<6, 6>(6, 6)), h.covariance);
  EXPECT_EQ(Matrix6d(joint.covariance().block<6, 6>(6, 0)), h.cross_covariance);
  EXPECT_EQ(Matrix6d(joint.covariance().topLeftCorner<6, 6>()), filter.camera().covariance());
}

TEST(DefaultSettings, TheCameraHasAllOfItsOdometrysNoise) {
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(SE3d(), kStartCovariance),
                           {{default_detector_noise()}}, {});
  for (int i = 0; i < 100; ++i) filter.predict_with_odometry(SE3d(), kOdometry, 0.1);
  EXPECT_TRUE(filter.camera().covariance().isApprox(kStartCovariance + 100.0 * kOdometry, 1e-9));
}

/// Root mean square of the position's error per axis after `count` detections, over several runs.
double position_rms(const SymmetryGroup& symmetries, int count, double* tilt_deg = nullptr) {
  constexpr int kRuns = 40;
  double sum = 0.0;
  double tilt = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    WhiteScene scene(static_cast<std::uint64_t>(run), symmetries);
    scene.see(count);
    const SE3d error = scene.truth.inverse() * scene.estimate();
    sum += error.translation().squaredNorm() / (3.0 * kRuns);
    tilt += std::pow(std::acos(std::min(1.0, error.rotation().matrix()(2, 2))), 2) / (2.0 * kRuns);
  }
  if (tilt_deg != nullptr) *tilt_deg = degrees(std::sqrt(tilt));
  return std::sqrt(sum);
}

// Position and tilt converge with a declared symmetry as without.
TEST(DefaultSettings, ADeclaredSymmetryCostsNoAccuracy) {
  const SymmetryGroup axis = SymmetryGroup::turns(Eigen::Vector3d::UnitZ(), 0);
  double plain_tilt = 0.0;
  double axis_tilt = 0.0;
  const double plain = position_rms({}, 300, &plain_tilt);
  const double with_axis = position_rms(axis, 300, &axis_tilt);
  const double with_ball = position_rms(ball(), 300);
  std::printf(
      "position after 300 detections of 10 mm: %.2f mm, axis %.2f, ball %.2f; tilt %.3f deg,"
      " axis %.3f\n",
      1e3 * plain, 1e3 * with_axis, 1e3 * with_ball, plain_tilt, axis_tilt);
  EXPECT_LT(plain, 1e-3);
  EXPECT_LT(with_axis, 1.25 * plain);
  EXPECT_LT(with_ball, 1.25 * plain);
  EXPECT_LT(axis_tilt, 1.25 * plain_tilt);
  EXPECT_LT(position_rms(axis, 300), 0.7 * position_rms(axis, 75));
}

// The scale of a noise that is as stated stays one, whatever the symmetry.
TEST(DefaultSettings, TheLearnedScaleIsNotBiasedBySymmetries) {
  for (const SymmetryGroup& group :
       {SymmetryGroup(), SymmetryGroup::turns(Eigen::Vector3d::UnitZ(), 0), ball()}) {
    Vector6d mean = Vector6d::Zero();
    constexpr int kRuns = 10;
    for (int run = 0; run < kRuns; ++run) {
      WhiteScene scene(static_cast<std::uint64_t>(100 + run), group);
      scene.see(200);
      mean += scene.filter.noise_scale(0) / kRuns;
    }
    // At most one: the mean of what is cut off at one is below it by the scatter.
    for (const double scale : mean) EXPECT_GT(scale, 0.93) << mean.transpose();
  }
}

// A model without clutter gets some: 30 wrong detections, then right ones.
TEST(DefaultSettings, AModelWithoutClutterStillGivesUpAWrongBeginning) {
  const Matrix6d covariance = isotropic(3.0, 0.01);
  const SE3d truth = pose(0.3, -0.2, 0.5, 0.1, -0.05, 1.0);
  const SE3d wrong = truth * pose(0, 0, 3.14, 0.2, 0, 0);
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(SE3d(), kStartCovariance),
                           {{DetectorNoise({{.covariance = covariance}})}}, {});
  RandomStream stream(3, 1);
  for (int i = 0; i < 230; ++i) {
    filter.predict_with_odometry(SE3d(), kOdometry, 0.1);
    filter.update(0, (i < 30 ? wrong : truth) * SE3d::exp(draw(covariance, stream)));
  }
  const SE3d found = filter.relative(0, *filter.leading(0)).mean();
  EXPECT_LT((found.translation() - truth.translation()).norm(), 0.02);
  EXPECT_LT(degrees((found.rotation().inverse() * truth.rotation()).log().norm()), 5.0);
}

// A young object is as certain as its one detection: white error, slow error and that in common.
TEST(DefaultSettings, AYoungObjectIsAsCertainAsItsDetection) {
  const DetectorNoise noise = default_detector_noise();
  MultiObjectFilter filter(ConcentratedGaussian<SE3d>(SE3d(), kStartCovariance), {{noise}}, {});
  const SE3d seen(SO3d(), {0.0, 0.0, 1.0});  // along the axis of the camera, at one metre
  filter.update(0, seen);
  const auto& c = noise.components();
  const Matrix6d white =
      (c[0].weight * c[0].covariance + c[1].weight * c[1].covariance) / (c[0].weight + c[1].weight);
  const Matrix6d expected =
      white + noise.dependence().slow->covariance + noise.dependence().common.value();
  // The axes of the ray are those of the object here.
  const Matrix6d body = seen.inverse().adjoint_congruence(filter.relative(0, 0).covariance());
  EXPECT_TRUE(body.isApprox(expected, 1e-9)) << body << "\n\n" << expected;
}

// Detections with three times the stated error across the ray, from a camera that moves and turns:
// the object is not moved far outside of its detections, whose errors are 17 mm.
TEST(DefaultSettings, ErrorsBeyondTheModelDoNotMoveTheObjectAwayFromItsDetections) {
  const SE3d object(SO3d::exp({0.2, 0.3, 0.1}), {0.1, 0.0, 0.8});
  constexpr int kRuns = 20;
  double squared = 0.0;
  double worst = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    RandomStream stream(static_cast<std::uint64_t>(run), 9);
    MultiObjectFilter filter(ConcentratedGaussian<SE3d>(SE3d(), kStartCovariance),
                             {{default_detector_noise()}}, {});
    SE3d before;
    for (int k = 0; k < 12; ++k) {
      const SE3d camera = pose(0.0, 0.01 * k, 0.0, 0.01 * k, 0.0, 0.0);
      if (k > 0) filter.predict_with_odometry(before.inverse() * camera, kOdometry, 0.1);
      before = camera;
      const SE3d expected = camera.inverse() * object;
      filter.update(0, expected * SE3d::exp(draw(isotropic(0.573, 0.01), stream)));
      if (k < 11) continue;
      const SE3d found = filter.relative(0, *filter.leading(0)).mean();
      const double error = (found.translation() - expected.translation()).norm();
      squared += error * error / kRuns;
      worst = std::max(worst, error);
    }
  }
  std::printf("position: rms %.1f mm, worst %.1f mm\n", 1e3 * std::sqrt(squared), 1e3 * worst);
  EXPECT_LT(std::sqrt(squared), 0.035);
  EXPECT_LT(worst, 0.07);
}

}  // namespace
}  // namespace posemix
