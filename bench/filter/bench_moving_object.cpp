// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// A frame of five objects that move, each with a filter of three motion models: still, calm and
// agile. Some detections are gross errors or wrong, so that there are several hypotheses for a
// place. Next to it one motion model, and the smoother's pass back over a recording. Compare the
// lines of one run; machines and their load differ.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/base/units.hpp"
#include "posemix/detector/default_noise.hpp"
#include "posemix/filter/moving_object_smoother.hpp"

namespace posemix {
namespace {

constexpr int kFrames = 300;
constexpr double kStep = 1.0 / 30.0;

MotionModels still_calm_or_agile() {
  MotionModels models = calm_and_agile();
  models.models.insert(models.models.begin(), PutDownMotion{});
  models.rates = (Eigen::MatrixXd(3, 3) << 0.0, 0.2, 0.1, 0.2, 0.0, 1.0, 0.2, 3.0, 0.0).finished();
  models.start = {0.5, 0.4, 0.1};
  return models;
}

/// An object that is moved to and fro, and detections that err by degrees and millimetres, of which
/// one in thirty is anywhere.
std::vector<MovingObjectStep> recording(std::uint64_t object) {
  RandomStream stream(1, object);
  std::vector<MovingObjectStep> steps;
  const auto draw = [&](double sd) {
    Eigen::VectorXd white(3);
    stream.fill_normal(white);
    return Eigen::Vector3d(sd * white);
  };
  for (int k = 0; k < kFrames; ++k) {
    const double t = kStep * k;
    const bool moves = k % 120 > 40;
    const Eigen::Vector3d place(moves ? 0.1 * std::sin(2.0 * t) : 0.0, 0.02 * t, 0.8);
    SE3d seen(SO3d::exp({0.3, moves ? 0.5 * std::sin(1.5 * t) : 0.0, 0.1}), place);
    seen = SE3d(SO3d::exp(draw(radians(2.0))) * seen.rotation(), seen.translation() + draw(0.004));
    if (stream.uniform() < 1.0 / 30.0)
      seen = SE3d(SO3d::exp(draw(1.0)), seen.translation() + draw(0.1));
    steps.push_back({.observation = observation_of(seen)});
    steps.back().observation.stamp_s = t;
  }
  return steps;
}

void frame(benchmark::State& state, const MotionModels& models) {
  constexpr std::size_t kObjects = 5;
  std::vector<std::vector<MovingObjectStep>> recordings;
  for (std::size_t j = 0; j < kObjects; ++j) recordings.push_back(recording(j));
  for (auto _ : state) {
    std::vector<MovingObjectFilter> filters(kObjects,
                                            MovingObjectFilter({default_detector_noise()}, models));
    for (int k = 0; k < kFrames; ++k) {
      for (std::size_t j = 0; j < kObjects; ++j) {
        const MovingObjectStep& step = recordings[j][static_cast<std::size_t>(k)];
        benchmark::DoNotOptimize(filters[j].update(step.observation, step.camera));
      }
    }
  }
  state.counters["frame"] = benchmark::Counter(
      static_cast<double>(kFrames),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void frame_three_models(benchmark::State& state) { frame(state, still_calm_or_agile()); }
void frame_one_model(benchmark::State& state) {
  frame(state, {.models = {ConstantVelocityMotion{}}});
}

void smoothed_step(benchmark::State& state) {
  MovingObjectSmoother smoother({default_detector_noise()}, still_calm_or_agile());
  for (const MovingObjectStep& step : recording(0)) smoother.update(step.observation, step.camera);
  for (auto _ : state) benchmark::DoNotOptimize(smoother.smoothed());
  state.counters["step"] = benchmark::Counter(
      static_cast<double>(kFrames),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(frame_three_models)->Unit(benchmark::kMillisecond);
BENCHMARK(frame_one_model)->Unit(benchmark::kMillisecond);
BENCHMARK(smoothed_step)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace posemix
