// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// One frame of the multi-object filter: odometry and one detection of every object, each of which
// keeps three modes alive, with eight hypotheses per object. The time grows with the number of
// hypotheses and, through the joint Gaussian, a little faster than linearly in the number of
// objects; a filter with joint hypotheses would need 3^objects of them. For comparison, one pair
// update per hypothesis: the minimum for any filter.
#include <benchmark/benchmark.h>

#include <limits>
#include <numbers>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/base/units.hpp"
#include "posemix/filter/multi_object_filter.hpp"

namespace posemix {
namespace {

constexpr int kFrames = 100;
constexpr int kModes = 3;

Vector6d white(RandomStream& stream) {
  Eigen::VectorXd values(6);
  stream.fill_normal(values);
  return values;
}

ObjectSensor sensor() {
  const Matrix6d sharp =
      pose_covariance({radians(7.5), radians(7.5), radians(2.0)}, {0.007, 0.007, 0.045});
  return {DetectorNoise({{.weight = 0.65, .covariance = sharp, .frame = NoiseFrame::ray},
                         {.weight = 0.12, .covariance = 7.29 * sharp, .frame = NoiseFrame::ray}},
                        {.weight = 0.23, .volume_m3 = 1.0})};
}

/// Detections of objects in front of a camera that moves a little, in three modes by turns.
struct Recording {
  explicit Recording(std::size_t objects) {
    RandomStream stream(1, objects);
    const Vector6d sd = 0.5 * (Vector6d() << 0.1, 0.1, 0.03, 0.005, 0.005, 0.03).finished();
    for (int frame = 0; frame < kFrames; ++frame) {
      detections.emplace_back();
      for (std::size_t j = 0; j < objects; ++j) {
        const SE3d object(SO3d(), Eigen::Vector3d(0.1 * static_cast<double>(j), 0.05, 0.9));
        const double turn = 2.0 * std::numbers::pi / kModes * (frame % kModes);
        const SE3d mode(SO3d::exp({0.0, 0.0, turn}), Eigen::Vector3d::Zero());
        detections.back().push_back(object * mode * SE3d::exp(sd.cwiseProduct(white(stream))));
      }
    }
  }

  SE3d motion = SE3d(SO3d::exp({1e-3, 0.0, 0.0}), {1e-3, 0.0, 0.0});
  Matrix6d q =
      pose_covariance(Eigen::Vector3d::Constant(radians(0.05)), Eigen::Vector3d::Constant(6e-4));
  std::vector<std::vector<SE3d>> detections;
};

void multi_object_frame(benchmark::State& state) {
  const auto objects = static_cast<std::size_t>(state.range(0));
  const Recording recording(objects);
  const ConcentratedGaussian<SE3d> start(SE3d(), recording.q);
  MultiObjectSettings settings;
  settings.max_hypotheses = static_cast<std::size_t>(state.range(1));
  std::size_t hypotheses = 0;
  for (auto _ : state) {
    MultiObjectFilter filter(start, std::vector<ObjectSensor>(objects, sensor()), settings);
    for (const auto& detections : recording.detections) {
      filter.predict_with_odometry(recording.motion, recording.q, 0.1);
      for (std::size_t j = 0; j < objects; ++j) filter.update(j, detections[j]);
    }
    hypotheses = filter.hypotheses(0).size();
    benchmark::DoNotOptimize(filter.camera());
  }
  state.counters["hypotheses"] = static_cast<double>(hypotheses);
  state.counters["frame"] = benchmark::Counter(
      kFrames, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(multi_object_frame)
    ->ArgNames({"objects", "most"})
    ->ArgsProduct({{1, 2, 3, 5, 8, 10}, {8}})
    ->Args({5, 4})
    ->Args({5, 16})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace posemix
