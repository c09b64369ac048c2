// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/smoothing.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>

#include "filter/scenario.hpp"
#include "posemix/slam/evaluation.hpp"
#include "slam/simulation_samples.hpp"

namespace posemix {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::draw;
using testing::isotropic;
using testing::pose;

constexpr std::size_t kFrames = 30;
constexpr std::size_t kGap = 12;  ///< odometry is missing here
const SE3d kStart = pose(0.1, 0.2, -0.1, 0.3, -0.2, 0.1);
const std::vector<SE3d> kObjects = {pose(0.4, -0.3, 0.2, 0.1, 0.2, 1.1),
                                    pose(-0.5, 0.3, 0.4, -0.4, 0.2, 1.2)};
const Matrix6d kQ = isotropic(0.05, 0.001);
const Matrix6d kR = isotropic(0.4, 0.004);
const Matrix6d kStartCovariance = isotropic(0.1, 0.002);

/// The filter takes all noise as given and every error as independent of all others.
ObjectSlamSettings plain_settings(double camera_share = 1.0) {
  ObjectSlamSettings settings;
  settings.multi_object.camera_share = camera_share;
  settings.multi_object.noise_scale_detections = std::numeric_limits<double>::infinity();
  settings.multi_object.correlation_s = 0.0;
  settings.multi_object.correlation_detections = std::numeric_limits<double>::infinity();
  settings.multi_object.common_error_share = 0.0;
  settings.motion.noise = {kQ, NoisePer::frame};
  settings.motion.unknown_motion = {isotropic(5.0, 0.1), NoisePer::frame};
  return settings;
}

std::vector<ObjectModel> models_with(const DetectorNoise& noise, std::size_t count) {
  std::vector<ObjectModel> models;
  for (std::size_t j = 0; j < count; ++j) models.push_back({std::to_string(j), noise});
  return models;
}

/// Drawn from the model: small errors, the second object seen from frame 4 on, every third frame
/// without it, one step without odometry.
Sequence drawn_sequence(std::uint64_t seed, std::size_t objects) {
  RandomStream stream(5, seed);
  Sequence sequence;
  SE3d camera = SE3d::exp(draw(kStartCovariance, stream)) * kStart;
  SE3d odometry;
  for (std::size_t j = 0; j < objects; ++j)
    sequence.objects.push_back({std::to_string(j), {}, {}, {}});
  for (std::size_t k = 0; k < kFrames; ++k) {
    if (k > 0) {
      const SE3d step = pose(0.02, 0.01, 0.0, 0.01, 0.0, 0.02);
      odometry = odometry * step;
      camera = camera * step * SE3d::exp(draw(kQ, stream));
    }
    sequence.stamps.push_back(0.1 * static_cast<double>(k));
    sequence.odometry.push_back(k == kGap ? std::nullopt : std::optional(odometry));
    sequence.camera_truth.emplace_back(camera);
    for (std::size_t j = 0; j < objects; ++j) {
      ObjectRecording& object = sequence.objects[j];
      object.world_truth.emplace_back(kObjects[j]);
      const SE3d seen = camera.inverse() * kObjects[j] * SE3d::exp(draw(kR, stream));
      object.detections.push_back(j == 1 && (k < 4 || k % 3 == 0) ? std::nullopt
                                                                  : std::optional(seen));
    }
  }
  return sequence;
}

/// All frames at once: Gauss-Newton on camera and object poses of every frame with a dense
/// information matrix, written down from the model alone. To first order in the errors, which are
/// small here, like the smoother.
class Batch {
 public:
  Batch(const Sequence& sequence, double camera_share)
      : sequence_(sequence), share_(camera_share), per_frame_(1 + sequence.objects.size()) {
    for (std::size_t k = 0; k < kFrames; ++k) {
      poses_.push_back(*sequence.camera_truth[k]);
      for (std::size_t j = 0; j + 1 < per_frame_; ++j) poses_.push_back(kObjects[j]);
    }
    for (int iteration = 0; iteration < 8; ++iteration) iterate();
  }

  const SE3d& at(std::size_t frame, std::size_t pose) const {
    return poses_[frame * per_frame_ + pose];
  }
  /// Of xi_b - xi_a at one frame; of xi_a alone where both are the same.
  Matrix6d covariance(std::size_t frame, std::size_t a, std::size_t b) const {
    MatrixXd h = MatrixXd::Zero(6, covariance_.rows());
    h.middleCols<6>(row(frame, b)) = Matrix6d::Identity();
    if (a != b) h.middleCols<6>(row(frame, a)) = -Matrix6d::Identity();
    return h * covariance_ * h.transpose();
  }

 private:
  Eigen::Index row(std::size_t frame, std::size_t pose) const {
    return 6 * static_cast<Eigen::Index>(frame * per_frame_ + pose);
  }

  /// A factor N(z; xi_to - xi_from, covariance), or N(z; xi_to, covariance).
  void add(std::optional<Eigen::Index> from, Eigen::Index to, const Vector6d& z,
           const Matrix6d& covariance) {
    const Matrix6d w = covariance.inverse();
    information_.block<6, 6>(to, to) += w;
    pull_.segment<6>(to) += w * z;
    if (!from) return;
    information_.block<6, 6>(*from, *from) += w;
    information_.block<6, 6>(*from, to) -= w;
    information_.block<6, 6>(to, *from) -= w;
    pull_.segment<6>(*from) -= w * z;
  }

  void iterate() {
    const Eigen::Index n = row(kFrames, 0);
    information_ = MatrixXd::Zero(n, n);
    pull_ = VectorXd::Zero(n);
    add(std::nullopt, row(0, 0), (kStart * at(0, 0).inverse()).log(), kStartCovariance);
    for (std::size_t k = 1; k < kFrames; ++k) add_motion(k);
    for (std::size_t k = 0; k < kFrames; ++k) {
      for (std::size_t j = 0; j + 1 < per_frame_; ++j) {
        const auto& seen = sequence_.objects[j].detections[k];
        if (!seen) continue;
        const SE3d& object = at(k, j + 1);
        add(row(k, 0), row(k, j + 1), (at(k, 0) * *seen * object.inverse()).log(),
            object.adjoint_congruence(kR));
      }
    }
    covariance_ = information_.inverse();
    const VectorXd step = covariance_ * pull_;
    for (std::size_t i = 0; i < poses_.size(); ++i)
      poses_[i] = SE3d::exp(step.segment<6>(6 * static_cast<Eigen::Index>(i))) * poses_[i];
  }

  void add_motion(std::size_t k) {
    const auto& before = sequence_.odometry[k - 1];
    const auto& now = sequence_.odometry[k];
    const bool known = before && now;
    const SE3d moved = at(k - 1, 0) * (known ? before->inverse() * *now : SE3d());
    const Matrix6d q = known ? Matrix6d(share_ * kQ) : isotropic(5.0, 0.1);
    add(row(k - 1, 0), row(k, 0), (moved * at(k, 0).inverse()).log(), moved.adjoint_congruence(q));
    for (std::size_t pose = 1; pose < per_frame_; ++pose) {
      // Without a drift: as good as none.
      const Matrix6d drift = (known ? 1.0 - share_ : 0.0) * kQ + 1e-14 * Matrix6d::Identity();
      add(row(k - 1, pose), row(k, pose), (at(k - 1, pose) * at(k, pose).inverse()).log(),
          at(k, pose).adjoint_congruence(drift));
    }
  }

  const Sequence& sequence_;
  double share_;
  std::size_t per_frame_;
  std::vector<SE3d> poses_;
  MatrixXd information_;
  VectorXd pull_;
  MatrixXd covariance_;
};

double distance(const SE3d& a, const SE3d& b) { return (a * b.inverse()).log().norm(); }

/// Largest relative difference, measured in units of the expected covariance.
double difference(const Matrix6d& a, const Matrix6d& expected) {
  const Matrix6d l = expected.llt().matrixL();
  const Matrix6d white = l.inverse() * a * l.inverse().transpose() - Matrix6d::Identity();
  return white.cwiseAbs().maxCoeff();
}

class SmoothingAgainstBatch : public ::testing::TestWithParam<double> {};

TEST_P(SmoothingAgainstBatch, Agrees) {
  const Sequence sequence = drawn_sequence(1, 2);
  const ObjectSlamSettings settings = plain_settings(GetParam());
  const SlamRun smoothed =
      run_smoothed(sequence, PoseDensity(kStart, kStartCovariance),
                   models_with(DetectorNoise({{1.0, kR}}), 2), settings, {.passes = 5});
  const Batch batch(sequence, GetParam());
  ASSERT_EQ(smoothed.frames.size(), kFrames);
  for (std::size_t k = 0; k < kFrames; ++k) {
    const FrameEstimate& frame = smoothed.frames[k];
    // Standard deviations are above 1e-3; where means and Jacobians are taken differs in second
    // order, 1e-2 of the error squared over the error.
    EXPECT_LT(distance(frame.camera.mean(), batch.at(k, 0)), 2e-5) << k;
    EXPECT_LT(difference(frame.camera.covariance(), batch.covariance(k, 0, 0)), 0.01) << k;
    for (std::size_t j = 0; j < 2; ++j) {
      ASSERT_EQ(frame.relative[j].has_value(), j == 0 || k >= 4);
      if (!frame.relative[j]) continue;
      EXPECT_LT(distance(frame.objects[j]->mean(), batch.at(k, j + 1)), 2e-5) << k;
      const Matrix6d relative =
          frame.camera.mean().adjoint_congruence(frame.relative[j]->covariance());
      EXPECT_LT(difference(relative, batch.covariance(k, 0, j + 1)), 0.01) << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(CameraShare, SmoothingAgainstBatch, ::testing::Values(1.0, 0.2));

TEST(Smoothing, IsConsistentAndBetterThanTheFilter) {
  // One frame per run, for the errors of frames depend on each other.
  constexpr int kRuns = 150;
  constexpr std::size_t kAt = 10;
  const auto models = models_with(DetectorNoise({{1.0, kR}}), 2);
  const PoseDensity prior(kStart, kStartCovariance);
  double camera = 0.0;
  double relative = 0.0;
  double causal = 0.0;
  double smooth = 0.0;
  for (int run_index = 0; run_index < kRuns; ++run_index) {
    const Sequence sequence = drawn_sequence(static_cast<std::uint64_t>(run_index), 2);
    const auto smoothed = run_smoothed(sequence, prior, models, plain_settings(), {});
    const auto filtered = run(sequence, prior, models, plain_settings());
    camera += squared_normalized_error(smoothed.frames[kAt].camera, *sequence.camera_truth[kAt]);
    const SE3d truth = *true_relative_pose(sequence, 1, kAt);
    relative += squared_normalized_error(*smoothed.frames[kAt].relative[1], truth);
    smooth += std::pow(distance(smoothed.frames[kAt].relative[1]->mean(), truth), 2);
    causal += std::pow(distance(filtered.frames[kAt].relative[1]->mean(), truth), 2);
  }
  const boost::math::chi_squared expected(6.0 * kRuns);
  for (const double sum : {camera, relative}) {
    EXPECT_GT(sum, boost::math::quantile(expected, 0.001));
    EXPECT_LT(sum, boost::math::quantile(expected, 0.999));
  }
  // With 20 further frames of which 13 show the object, the variance more than halves.
  EXPECT_LT(smooth, 0.5 * causal);
}

/// The prototype's simulation in small: correlated errors, gross ones in runs, flips.
SimulationConfig hard_config() {
  SimulationObject object = testing::object_with(
      {{.sd = testing::sd_of(Eigen::Vector3d::Constant(5.0), Eigen::Vector3d::Constant(0.01))}});
  object.correlation_s = 0.1;
  object.outliers.runs = {0.2, 0.8};
  object.flips = {
      {0.15, 0.5}, Eigen::Vector3d(0.0, 0.0, std::numbers::pi), Eigen::Vector3d::Zero()};
  SimulationConfig config = testing::config_with({object}, 200);
  return config;
}

TEST(Smoothing, IsBetterThanTheFilterOnDisturbedDetections) {
  double causal = 0.0;
  double smooth = 0.0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const SimulatedSequence simulated = simulate(hard_config(), seed);
    const Sequence sequence = simulated.sequence();
    ObjectSlamSettings settings;
    settings.motion = motion_settings(hard_config());
    const PoseDensity prior = camera_prior(hard_config(), simulated);
    const std::vector<ObjectModel> models{{"mug"}};
    const auto error = [&](const SlamRun& result) {
      const PoseErrors errors = evaluate(sequence, result).objects[0].relative;
      return std::log(*errors.rotation_rmse_deg) + std::log(*errors.position_rmse_m);
    };
    causal += error(run(sequence, prior, models, settings));
    smooth += error(run_smoothed(sequence, prior, models, settings, {}));
  }
  EXPECT_LT(smooth, causal - 12 * std::log(1.2));
}

/// Twenty wrong detections, all alike, then sixty right ones.
Sequence wrong_at_first() {
  RandomStream stream(9, 1);
  Sequence sequence;
  sequence.objects.push_back({"0", {}, {}, {}});
  SE3d camera = kStart;
  const SE3d turned = pose(0.0, 2.0, 0.0, 0.0, 0.0, 0.0);
  for (int k = 0; k < 80; ++k) {
    sequence.stamps.push_back(0.1 * k);
    sequence.odometry.emplace_back(kStart.inverse() * camera);
    sequence.camera_truth.emplace_back(camera);
    ObjectRecording& object = sequence.objects[0];
    object.world_truth.emplace_back(kObjects[0]);
    object.detections.emplace_back(camera.inverse() * kObjects[0] * (k < 20 ? turned : SE3d()) *
                                   SE3d::exp(draw(isotropic(2.0, 0.005), stream)));
    camera = camera * pose(0.004, 0.002, 0.0, 0.002, 0.0, 0.004);
  }
  return sequence;
}

constexpr double kRight = 0.1;  ///< 6 deg or 10 cm
constexpr double kWrong = 1.0;

TEST(Smoothing, TheModeOfTheEndHoldsFromTheBeginning) {
  const Sequence sequence = wrong_at_first();
  const PoseDensity prior(kStart, kStartCovariance);
  const std::vector<ObjectModel> models{{"0"}};
  const SlamRun causal = run(sequence, prior, models, {});
  const SlamRun smoothed =
      run_smoothed(sequence, prior, models, {}, {}, {.record_hypotheses = true, .progress = {}});
  EXPECT_GT(distance(causal.frames[5].objects[0]->mean(), kObjects[0]), kWrong);
  for (const FrameEstimate& frame : smoothed.frames) {
    EXPECT_LT(distance(frame.objects[0]->mean(), kObjects[0]), kRight);
    EXPECT_EQ(frame.mode_probabilities, causal.frames.back().mode_probabilities);
  }
  // The wrong one is among the alternatives, with its last weight.
  ASSERT_EQ(smoothed.alternatives[0].size(), causal.alternatives[0].size());
  const auto& first = smoothed.frames.front().alternatives[0];
  ASSERT_FALSE(first.empty());
  for (const ObjectAlternative& each : first) {
    EXPECT_LE(each.probability, 1.0);
    EXPECT_GE(each.probability, SmoothingSettings().least_weight);
  }
  EXPECT_TRUE(run_smoothed(sequence, prior, models, {}, {}).frames[0].alternatives.empty());
}

TEST(Smoothing, AlternativesAreSmoothedInPlaceOfTheLeadingMode) {
  // Right and wrong in turn: both hypotheses live.
  Sequence sequence = wrong_at_first();
  const SE3d turned = pose(0.0, 2.0, 0.0, 0.0, 0.0, 0.0);
  for (std::size_t k = 0; k < sequence.stamps.size(); ++k) {
    sequence.objects[0].detections[k] =
        sequence.camera_truth[k]->inverse() * kObjects[0] * (k % 2 == 0 ? turned : SE3d());
  }
  SmoothingSettings settings;
  settings.least_weight = 1e-300;
  const SlamRun smoothed = run_smoothed(sequence, PoseDensity(kStart, kStartCovariance), {{"0"}},
                                        {}, settings, {.record_hypotheses = true, .progress = {}});
  for (const FrameEstimate& frame : smoothed.frames) {
    double right = kWrong;
    double wrong = kWrong;
    for (const ObjectAlternative& each : frame.alternatives[0]) {
      right = std::min(right, distance(each.pose, kObjects[0]));
      wrong = std::min(wrong, distance(each.pose, kObjects[0] * turned));
    }
    EXPECT_LT(right, kRight);
    EXPECT_LT(wrong, kRight);
  }
}

TEST(FixedLag, AsLongAsTheRecordingIsFullSmoothing) {
  const Sequence sequence = drawn_sequence(3, 2);
  const PoseDensity prior(kStart, kStartCovariance);
  const auto models = models_with(default_detector_noise(), 2);
  const SlamRun full = run_smoothed(sequence, prior, models, {}, {});
  const SlamRun lag = run_smoothed(sequence, prior, models, {}, {.lag_frames = kFrames});
  for (std::size_t k = 0; k < kFrames; ++k) {
    EXPECT_EQ(full.frames[k].camera.mean().matrix(), lag.frames[k].camera.mean().matrix());
    EXPECT_EQ(full.frames[k].camera.covariance(), lag.frames[k].camera.covariance());
    EXPECT_EQ(full.frames[k].relative[0]->covariance(), lag.frames[k].relative[0]->covariance());
  }
}

TEST(FixedLag, ReportsEveryFrameOnceAndInTime) {
  const Sequence sequence = drawn_sequence(3, 2);
  const auto models = models_with(DetectorNoise({{1.0, kR}}), 2);
  FixedLagSmoother smoother(PoseDensity(kStart, kStartCovariance), models, plain_settings(),
                            {.lag_frames = 5});
  std::vector<FrameEstimate> frames;
  for (std::size_t k = 0; k < kFrames; ++k) {
    const std::vector<std::optional<SE3d>> seen{sequence.objects[0].detections[k],
                                                sequence.objects[1].detections[k]};
    auto frame = k == 0 ? smoother.start(seen)
                        : smoother.step({0.1, pose(0.02, 0.01, 0.0, 0.01, 0.0, 0.02), seen});
    ASSERT_EQ(frame.has_value(), k >= 5);
    if (frame) frames.push_back(*frame);
  }
  EXPECT_EQ(frames.size(), kFrames - 5);
  for (FrameEstimate& frame : smoother.finish()) frames.push_back(std::move(frame));
  EXPECT_TRUE(smoother.finish().empty());
  ASSERT_EQ(frames.size(), kFrames);
  for (std::size_t k = 0; k < kFrames; ++k) {
    EXPECT_LT(distance(frames[k].camera.mean(), *sequence.camera_truth[k]), 0.05) << k;
    EXPECT_EQ(frames[k].report.fates[0], k == 0 ? DetectionFate::started : DetectionFate::used);
    EXPECT_EQ(frames[k].pose_indices[1].has_value(), k >= 4);
  }
}

TEST(FixedLag, LooksAheadJustSoFar) {
  // The right mode leads from some frame on; its lag earlier it is what is reported.
  const Sequence sequence = wrong_at_first();
  const PoseDensity prior(kStart, kStartCovariance);
  const std::vector<ObjectModel> models{{"0"}};
  const auto first_right = [](const SlamRun& result) {
    std::size_t k = 0;
    while (distance(result.frames[k].objects[0]->mean(), kObjects[0]) > kRight) ++k;
    return k;
  };
  constexpr std::size_t kLag = 15;
  const std::size_t causal = first_right(run(sequence, prior, models, {}));
  ASSERT_GT(causal, 20U);
  EXPECT_LE(first_right(run_smoothed(sequence, prior, models, {}, {.lag_frames = kLag})),
            causal - kLag);
}

TEST(Smoothing, MotionWithoutOdometry) {
  // Steady motion: smoothing pays most at the start, where the velocity is not known.
  Sequence sequence = drawn_sequence(4, 1);
  sequence.odometry.clear();
  const PoseDensity prior(kStart, kStartCovariance);
  const auto models = models_with(DetectorNoise({{1.0, kR}}), 1);
  for (const MotionModel model : {MotionModel::constant_velocity, MotionModel::random_walk}) {
    ObjectSlamSettings settings = plain_settings();
    settings.motion.model = model;
    const auto error = [&](const SlamRun& result) {
      double sum = 0.0;
      for (std::size_t k = 0; k < kFrames; ++k)
        sum += std::pow(
            distance(result.frames[k].relative[0]->mean(), *true_relative_pose(sequence, 0, k)), 2);
      return sum;
    };
    const SlamRun causal = run(sequence, prior, models, settings);
    const SlamRun smoothed = run_smoothed(sequence, prior, models, settings, {});
    const SlamRun lagged = run_smoothed(sequence, prior, models, settings, {.lag_frames = 8});
    EXPECT_LT(error(smoothed), error(causal));
    EXPECT_LT(error(lagged), error(causal));
    for (const FrameEstimate& frame : smoothed.frames) {
      const Matrix6d p = frame.camera.covariance();
      EXPECT_GT(p.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
    }
  }
}

TEST(Smoothing, RefusesWhatItCannotSmooth) {
  const Sequence sequence = drawn_sequence(3, 1);
  const PoseDensity prior(kStart, kStartCovariance);
  const auto models = models_with(default_detector_noise(), 1);
  ObjectSlamSettings gaussian_sum;
  gaussian_sum.kind = SlamFilter::gaussian_sum;
  EXPECT_THROW(run_smoothed(sequence, prior, models, gaussian_sum, {}), InvalidInput);
  ObjectSlamSettings considered;
  considered.multi_object.camera_gain_noise = std::numeric_limits<double>::infinity();
  EXPECT_THROW(run_smoothed(sequence, prior, models, considered, {}), InvalidInput);
  EXPECT_THROW(run_smoothed(sequence, prior, models, {}, {.passes = 0}), InvalidInput);
  EXPECT_THROW(run_smoothed(sequence, prior, {}, {}, {}), InvalidInput);
}

TEST(Smoothing, CanBeStopped) {
  const Sequence sequence = drawn_sequence(3, 1);
  const RunOptions options{.record_hypotheses = false,
                           .progress = [](std::size_t done, std::size_t) { return done < 7; }};
  const SlamRun stopped = run_smoothed(sequence, PoseDensity(kStart, kStartCovariance),
                                       models_with(default_detector_noise(), 1), {}, {}, options);
  EXPECT_EQ(stopped.frames.size(), 7U);
}

}  // namespace
}  // namespace posemix
