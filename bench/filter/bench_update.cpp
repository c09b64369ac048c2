// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// One hypothesis updated with M detections at once: the structured update (H = [-I I], Joseph's
// form) against the same filter written densely, as the midway authors' program does (H with
// adjoints, explicit products of full matrices).
#include <benchmark/benchmark.h>

#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/filter/update.hpp"

namespace {

using posemix::Matrix6d;
using posemix::SE3d;
using posemix::Vector6d;

struct Scene {
  posemix::Hypothesis prior;
  posemix::DetectorNoise noise;
  std::vector<posemix::Detection> detections;
  std::vector<const posemix::NoiseComponent*> components;

  explicit Scene(std::size_t objects)
      : prior(posemix::PoseStackd(1), Matrix6d(1e-4 * Matrix6d::Identity())),
        noise({{1.0, posemix::pose_covariance(Eigen::Vector3d::Constant(posemix::radians(4.0)),
                                              Eigen::Vector3d::Constant(0.005))}}) {
    for (std::size_t i = 1; i <= objects; ++i) {
      Vector6d xi;
      xi << 0.1, 0.2 * static_cast<double>(i), -0.3, 0.2, -0.1 * static_cast<double>(i), 1.0;
      prior = posemix::with_detected_object(prior, SE3d::exp(xi), noise.components().front());
      xi(1) += 0.02;
      detections.push_back({i, SE3d::exp(xi), &noise});
      components.push_back(&noise.components().front());
    }
  }
};

void structured(benchmark::State& state) {
  const Scene scene(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(posemix::update(scene.prior, scene.detections, scene.components));
  }
}

void dense(benchmark::State& state) {
  const Scene scene(static_cast<std::size_t>(state.range(0)));
  const auto n = scene.prior.dof();
  const auto m = n - 6;
  for (auto _ : state) {
    const auto& mean = scene.prior.mean();
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(m, n);
    Eigen::MatrixXd r = Eigen::MatrixXd::Zero(m, m);
    Eigen::VectorXd v(m);
    const Matrix6d to_camera = mean[0].inverse().adjoint();
    for (Eigen::Index j = 0; j < m; j += 6) {
      const auto& detection = scene.detections[static_cast<std::size_t>(j / 6)];
      const SE3d predicted = mean[0].inverse() * mean[detection.object];
      v.segment<6>(j) = (detection.camera_object * predicted.inverse()).log();
      h.block<6, 6>(j, 0) = -to_camera;
      h.block<6, 6>(j, j + 6) = to_camera;
      r.block<6, 6>(j, j) =
          predicted.adjoint() * scene.components[0]->covariance * predicted.adjoint().transpose();
    }
    const Eigen::MatrixXd& p = scene.prior.covariance();
    const Eigen::MatrixXd s = h * p * h.transpose() + r;
    const Eigen::MatrixXd k = p * h.transpose() * s.inverse();
    const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(n, n) - k * h;
    Eigen::MatrixXd posterior = rest * p * rest.transpose() + k * r * k.transpose();
    benchmark::DoNotOptimize(posterior.data());
    benchmark::DoNotOptimize(posemix::PoseStackd::exp(k * v) * mean);
  }
}

BENCHMARK(structured)->Arg(1)->Arg(2)->Arg(5)->Arg(10);
BENCHMARK(dense)->Arg(1)->Arg(2)->Arg(5)->Arg(10);

}  // namespace
