// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Requirements on the recording YCB-Video 0022 with configs/ycbv-0022.toml, damaged in known ways.
#include <gtest/gtest.h>

#include <cstdio>

#include "posemix/base/random.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/slam/evaluation.hpp"
#include "posemix/testing/data.hpp"

namespace posemix {
namespace {

constexpr std::size_t kMug = 3;
constexpr std::size_t kLate = 199;  // frame 200, counted from one

SlamJob read_job(const std::vector<std::string>& overrides = {}) {
  TomlDocument document = TomlDocument::load(POSEMIX_SOURCE_DIR "/configs/ycbv-0022.toml");
  for (const std::string& assignment : overrides) document.apply_override(assignment);
  return read_slam_job(document, {*testing::data_dir()});
}

SlamRun run_job(const SlamJob& job) {
  return run(job.sequence, job.camera_prior, job.models, job.settings);
}

/// Rms of the mug's relative rotation error [deg] over the frames from `first` on.
double mug_rotation_rmse(const SlamJob& job, const SlamRun& result, std::size_t first) {
  double squared = 0.0;
  std::size_t count = 0;
  for (std::size_t k = first; k < result.frames.size(); ++k) {
    const SO3d error = result.frames[k].relative[kMug]->mean().rotation() *
                       true_relative_pose(job.sequence, kMug, k)->rotation().inverse();
    squared += error.log().squaredNorm();
    ++count;
  }
  return degrees(std::sqrt(squared / static_cast<double>(count)));
}

template <class Value>
void drop_front(std::vector<Value>& values, std::size_t count) {
  if (!values.empty())
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
}

/// The recording from frame `first` on, the camera starting from its true pose there.
SlamJob cropped(SlamJob job, std::size_t first) {
  drop_front(job.sequence.stamps, first);
  drop_front(job.sequence.odometry, first);
  drop_front(job.sequence.camera_truth, first);
  for (ObjectRecording& object : job.sequence.objects) {
    drop_front(object.detections, first);
    drop_front(object.relative_truth, first);
    drop_front(object.world_truth, first);
  }
  job.camera_prior = PoseDensity(*job.sequence.camera_truth.front(), job.camera_prior.covariance());
  return job;
}

/// Rms [deg] of the mug when it is hidden until kLate, and when the recording begins there.
std::pair<double, double> late_and_fresh(const SlamJob& job) {
  SlamJob late = job;
  for (std::size_t k = 0; k < kLate; ++k) late.sequence.objects[kMug].detections[k].reset();
  const double hidden = mug_rotation_rmse(late, run_job(late), kLate);
  const SlamJob fresh = cropped(job, kLate);
  const double started = mug_rotation_rmse(fresh, run_job(fresh), 0);
  std::printf("mug, relative rotation: hidden until frame 200 %.3f deg, started there %.3f deg\n",
              hidden, started);
  return {hidden, started};
}

TEST(Ycbv0022, AnObjectThatAppearsLateIsAsGoodAsOneStartedFromTheTrueCamera) {
  POSEMIX_REQUIRE_DATA();
  const auto [hidden, started] = late_and_fresh(read_job());
  EXPECT_LT(hidden, started + 0.5);
}

TEST(Ycbv0022, AnObjectThatAppearsLateIsAsGoodInTheGaussianSumFilter) {
  POSEMIX_REQUIRE_DATA();
  const auto [hidden, started] = late_and_fresh(read_job(
      {"filter={method=\"gm-iekf\", gate_probability=0.9999}", "objects.0.noise=gaussian",
       "objects.1.noise=gaussian", "objects.2.noise=gaussian", "objects.3.noise=gaussian"}));
  EXPECT_LT(hidden, started + 0.3);
}

TEST(Ycbv0022, FortyGrossOutliersAreGatedAway) {
  POSEMIX_REQUIRE_DATA();
  const SlamJob job = read_job();
  SlamJob damaged = job;
  RandomStream stream(40);
  for (int i = 0; i < 40; ++i) {
    const auto frame = static_cast<std::size_t>(20 + 1100 * stream.uniform());
    Eigen::Vector3d axis(stream.normal(), stream.normal(), stream.normal());
    const SO3d turn = SO3d::exp(axis.normalized() * radians(60.0 + 120.0 * stream.uniform()));
    const Eigen::Vector3d shift(0.3 * stream.normal(), 0.3 * stream.normal(),
                                0.3 * stream.normal());
    auto& detection = damaged.sequence.objects[kMug].detections[frame];
    detection = *job.sequence.objects[kMug].detections[frame] * SE3d(turn, shift);
  }
  const double clean = mug_rotation_rmse(job, run_job(job), 0);
  const SlamRun result = run_job(damaged);
  const double with_outliers = mug_rotation_rmse(damaged, result, 0);
  const Metrics metrics = evaluate(damaged.sequence, result);
  std::printf("mug, relative rotation: %.3f deg, with 40 outliers %.3f deg, %zu unexplained\n",
              clean, with_outliers, metrics.objects[kMug].unexplained);
  EXPECT_LT(std::abs(with_outliers - clean), 0.2);
  EXPECT_GE(metrics.objects[kMug].unexplained, 38U);
}

}  // namespace
}  // namespace posemix
