// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// One frame of the Gaussian-sum filter: ten predictions by odometry, one detection of every object
// under two noise components, the merge of the most distant pairs down to four hypotheses after
// each object, and the summary. With one object this is the setting of the Monte-Carlo study of the
// midway-merge paper (section VII-A). Compare the lines of one run; machines and their load differ.
#include <benchmark/benchmark.h>

#include <numbers>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"

namespace posemix {
namespace {

constexpr std::size_t kFrames = 200;
constexpr std::size_t kStepsPerFrame = 10;

Matrix6d covariance(double rotation_sd_deg, double translation_sd_m) {
  return pose_covariance(Eigen::Vector3d::Constant(radians(rotation_sd_deg)),
                         Eigen::Vector3d::Constant(translation_sd_m));
}

Vector6d draw(const Matrix6d& covariance, RandomStream& stream) {
  Eigen::VectorXd white(6);
  stream.fill_normal(white);
  return Eigen::LLT<Matrix6d>(covariance).matrixL() * white;
}

/// The camera on a circle of 3 m about the objects, looking at them.
SE3d camera_at(double turn) {
  const double angle = 2.0 * std::numbers::pi * turn;
  const Eigen::Vector3d position(3.0 * std::cos(angle), 3.0 * std::sin(angle), 1.2);
  const Eigen::Vector3d z = -position.normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return {SO3d::from_matrix(axes), position};
}

/// The input of the filter.
struct Recording {
  /// Drift of the odometry as a multiple of the drift of the study's level 0.
  static constexpr double kDrift = 30.0;

  Matrix6d step_noise = kDrift * kDrift * 0.15 * covariance(0.026, 0.002);
  DetectorNoise noise{{{0.7, covariance(4.0, 0.01)},
                       {0.3, pose_covariance({radians(4.0), radians(4.0), radians(12.0)},
                                             Eigen::Vector3d::Constant(0.01))}}};
  Hypothesis prior;
  std::vector<SE3d> steps;
  std::vector<std::vector<Detection>> detections;

  explicit Recording(std::size_t objects)
      : prior(PoseStackd(std::vector<SE3d>{camera_at(0.0)}), covariance(0.35, 0.01)) {
    RandomStream stream(1, objects);
    std::vector<SE3d> poses;
    for (std::size_t i = 0; i < objects; ++i) {
      poses.emplace_back(SO3d(), Eigen::Vector3d(0.2 * static_cast<double>(i), 0.0, 0.0));
      const SE3d start = poses.back() * SE3d::exp(draw(covariance(4.0, 0.01), stream));
      prior = with_independent_pose(prior, start, covariance(4.0, 0.01));
    }
    SE3d before = camera_at(0.0);
    for (std::size_t step = 1; step <= kFrames * kStepsPerFrame; ++step) {
      const SE3d camera = camera_at(1e-4 * static_cast<double>(step));
      steps.push_back(SE3d::exp((before.inverse() * camera).log() + draw(step_noise, stream)));
      before = camera;
      if (step % kStepsPerFrame == 0) detect(camera, poses, stream);
    }
  }

  void detect(const SE3d& camera, const std::vector<SE3d>& poses, RandomStream& stream) {
    detections.emplace_back();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const NoiseComponent& component = noise.components()[stream.uniform() < 0.7 ? 0 : 1];
      const SE3d error = SE3d::exp(draw(component.covariance, stream));
      detections.back().push_back({i + 1, camera.inverse() * poses[i] * error, &noise});
    }
  }
};

GaussianSumSettings settings(UpdateRule update, MergeRule merge) {
  GaussianSumSettings settings;
  settings.update = update;
  settings.summary = Summary::merge_two_largest;
  settings.reduction.max_components = 4;
  settings.reduction.pair = PairRule::most_distant;
  settings.reduction.merge.rule = merge;
  return settings;
}

template <UpdateRule kUpdate, MergeRule kMerge>
void frame(benchmark::State& state) {
  const Recording recording(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    GaussianSumFilter filter(Posterior({{0.0, recording.prior}}), settings(kUpdate, kMerge));
    auto step = recording.steps.begin();
    for (const auto& detections : recording.detections) {
      for (std::size_t i = 0; i < kStepsPerFrame; ++i, ++step) {
        filter.predict([&](Hypothesis hypothesis) {
          return predict_with_odometry(std::move(hypothesis), *step, recording.step_noise);
        });
      }
      filter.update(detections);
      benchmark::DoNotOptimize(filter.summarise());
    }
  }
  state.counters["frame"] = benchmark::Counter(
      static_cast<double>(kFrames),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// The published filter's frame (midway-merge paper, section VII-B): five objects detected at once
/// under two noise components by each of twelve hypotheses, the merge of the 24 children to twelve,
/// and the summary.
void joint_frame(benchmark::State& state) {
  const Recording recording(5);
  GaussianSumSettings published;
  published.update = UpdateRule::linearized;
  published.noise_use = NoiseUse::joint;
  published.summary = Summary::merge_two_largest;
  published.reduction = {.prune_below = 0.0, .max_components = 12};
  RandomStream stream(2, 0);
  std::vector<Component<Hypothesis>> hypotheses;
  for (int i = 0; i < 12; ++i) {
    Eigen::VectorXd xi(recording.prior.dof());
    stream.fill_normal(xi);
    hypotheses.push_back(
        {0.1 * i, Hypothesis::trusted(PoseStackd::exp(0.01 * xi) * recording.prior.mean(),
                                      recording.prior.covariance())});
  }
  GaussianSumFilter filter(Posterior(std::move(hypotheses)), published);
  filter.update(recording.detections.front());
  for (auto _ : state) {
    GaussianSumFilter copy = filter;
    copy.predict([&](Hypothesis hypothesis) {
      return predict_with_odometry(std::move(hypothesis), SE3d(), recording.step_noise);
    });
    copy.update(recording.detections.front());
    benchmark::DoNotOptimize(copy.summarise());
  }
  state.counters["hypotheses"] = static_cast<double>(filter.posterior().size());
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("objects")->Arg(1)->Arg(5)->Unit(benchmark::kMillisecond);
}

BENCHMARK(frame<UpdateRule::linearized, MergeRule::midway>)->Name("frame_linearized")->Apply(sizes);
BENCHMARK(frame<UpdateRule::linearized, MergeRule::tangent_of_larger>)
    ->Name("frame_linearized_tangent_of_larger")
    ->Apply(sizes);
BENCHMARK(frame<UpdateRule::linearized, MergeRule::moment_matched>)
    ->Name("frame_linearized_moment_matched")
    ->Apply(sizes);
BENCHMARK(frame<UpdateRule::iterated, MergeRule::midway>)->Name("frame_iterated")->Apply(sizes);

BENCHMARK(joint_frame)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace posemix
