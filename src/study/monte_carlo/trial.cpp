// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "trial.hpp"

#include <cmath>
#include <numbers>

#include "posemix/base/draw_index.hpp"

namespace posemix {
namespace {

/// Purposes of random numbers. Each has a stream of its own, so that a change in one does not
/// affect the numbers of the others.
enum class Purpose : std::size_t { start, odometry, detection, count };

RandomStream stream_of(const MonteCarloStudySettings& settings, std::size_t run, Purpose purpose) {
  return RandomStream(settings.seed, run * static_cast<std::size_t>(Purpose::count) +
                                         static_cast<std::size_t>(purpose));
}

/// T_object_camera at s.
SE3d camera_on_path(const MonteCarloPath& path, double s) {
  const double a = 2.0 * std::numbers::pi * static_cast<double>(path.turns) * s;
  const Eigen::Vector3d p(path.radius_m * std::cos(a), path.radius_m * std::sin(a),
                          path.height_m + path.height_swing_m * std::sin(2.0 * a));
  const Eigen::Vector3d z = -p.normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return SE3d(SO3d::from_matrix(axes), p);
}

Vector6d draw(const Matrix6d& factor, RandomStream& stream) {
  Vector6d white;
  for (double& value : white) value = stream.normal();
  return factor * white;
}

Matrix6d factor_of(const Matrix6d& covariance) {
  return Eigen::LLT<Matrix6d>(covariance).matrixL();
}

/// Draws detections Y = T_camera_object offset Exp(n).
class Detector {
 public:
  explicit Detector(const DetectorNoise& noise) : noise_(noise) {
    for (const NoiseComponent& component : noise.components()) {
      factors_.push_back(factor_of(component.covariance));
    }
  }

  SE3d detect(const SE3d& camera_object, RandomStream& stream) const {
    const std::size_t chosen = index_at_sum(
        stream.uniform(), factors_.size(),
        [&](std::size_t i) { return noise_.components()[i].weight; }, factors_.size() - 1);
    const NoiseComponent& component = noise_.components()[chosen];
    const SE3d mode = camera_object * component.offset;
    const Vector6d n = draw(factors_[chosen], stream);
    if (component.frame == NoiseFrame::object) return mode * SE3d::exp(n);
    const SE3d axes(SO3d(), mode.translation());
    return axes * SE3d::exp(n) * axes.inverse() * mode;
  }

 private:
  const DetectorNoise& noise_;
  std::vector<Matrix6d> factors_;
};

/// A prior with independent camera and object, each off the truth by a draw from its covariance.
Hypothesis draw_prior(const MonteCarloStudySettings& settings, const SE3d& true_object,
                      RandomStream stream) {
  const SE3d camera = SE3d::exp(draw(factor_of(settings.camera_start), stream));
  const SE3d object = true_object * SE3d::exp(draw(factor_of(settings.object_start), stream));
  return with_independent_pose(
      Hypothesis(PoseStackd(std::vector<SE3d>{camera}), settings.camera_start), object,
      object.adjoint_congruence(settings.object_start));
}

}  // namespace

MonteCarloTrial simulate_trial(const MonteCarloStudySettings& settings, double noise_exponent,
                               std::size_t run) {
  const MonteCarloPath& path = settings.path;
  RandomStream odometry_stream = stream_of(settings, run, Purpose::odometry);
  RandomStream detection_stream = stream_of(settings, run, Purpose::detection);
  const auto per_detection = static_cast<double>(path.odometry_per_detection);
  const Matrix6d noise =
      std::pow(10.0, noise_exponent) * path.detection_period_s / per_detection * settings.odometry;
  const Matrix6d noise_factor = factor_of(noise);
  const Detector detector(settings.detector);

  SE3d camera = camera_on_path(path, 0.0);
  const SE3d object = camera.inverse();
  MonteCarloTrial trial{
      noise, object, draw_prior(settings, object, stream_of(settings, run, Purpose::start)), {}};
  const double steps = static_cast<double>(path.detections) * per_detection;
  std::size_t i = 0;
  for (std::size_t k = 0; k < path.detections; ++k) {
    MonteCarloStep& step = trial.steps.emplace_back();
    for (std::size_t j = 0; j < path.odometry_per_detection; ++j) {
      const SE3d next = camera_on_path(path, static_cast<double>(++i) / steps);
      const Vector6d u =
          (camera.inverse() * next).log() + draw(noise_factor, odometry_stream);  // eq. 31
      step.odometry.push_back(SE3d::exp(u));
      camera = next;
    }
    step.true_camera = object * camera;
    step.detection = detector.detect(camera.inverse(), detection_stream);  // eq. 32
  }
  return trial;
}

}  // namespace posemix
