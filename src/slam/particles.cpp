// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/particles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Eigenvalues>

#include "posemix/base/draw_index.hpp"
#include "posemix/base/stopwatch.hpp"
#include "posemix/density/pose_stack.hpp"

namespace posemix::internal {
namespace {

/// A with A A^T = covariance, which may be singular.
Matrix6d root_of(const Matrix6d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(covariance);
  return solver.eigenvectors() *
         solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal().toDenseMatrix();
}

/// Updates the camera by a detection of an object whose pose is known: z = -xi_R + noise, and so
/// H = [-I 0], K = P H^T S^-1, covariance in Joseph's form.
void condition_camera(Hypothesis& camera, const Innovation& seen) {
  const Eigen::MatrixXd& p = camera.covariance();
  const Matrix6d s = p.topLeftCorner<6, 6>() + seen.noise;
  const Eigen::Matrix<double, Eigen::Dynamic, 6> gain =
      -Eigen::LLT<Matrix6d>(s).solve(p.topRows<6>()).transpose();
  PoseStackd mean = camera.mean();
  for (std::size_t k = 0; k < mean.size(); ++k) {
    const auto rows = gain.middleRows<6>(6 * static_cast<Eigen::Index>(k));
    mean[k] = SE3d::exp(rows * seen.residual) * mean[k];
  }
  Eigen::MatrixXd kept = Eigen::MatrixXd::Identity(p.rows(), p.rows());
  kept.leftCols<6>() += gain;
  Eigen::MatrixXd covariance = kept * p * kept.transpose() + gain * seen.noise * gain.transpose();
  symmetrize(covariance);
  camera = Hypothesis::trusted(std::move(mean), std::move(covariance));
}

}  // namespace

std::vector<std::size_t> systematic_resample(const std::vector<double>& weights, double offset) {
  const auto count = static_cast<double>(weights.size());
  std::vector<std::size_t> chosen;
  chosen.reserve(weights.size());
  std::size_t i = 0;
  double reached = weights[0];
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double target = (static_cast<double>(k) + offset) / count;
    while (reached <= target && i + 1 < weights.size()) reached += weights[++i];
    chosen.push_back(i);
  }
  return chosen;
}

ParticleCloud::ParticleCloud(const PoseDensity& camera, const std::vector<ObjectModel>& models,
                             const ParticleFilterSettings& settings, const MotionSettings& motion)
    : models_(models),
      settings_(settings),
      motion_(motion),
      random_(settings.seed),
      particles_(settings.particles,
                 Particle{camera_hypothesis(camera, motion), {models.size(), std::nullopt}}),
      log_weights_(settings.particles, -std::log(static_cast<double>(settings.particles))) {}

void ParticleCloud::predict(const FrameInput& input) {
  const CameraStep step = camera_step(motion_, input);
  const Matrix6d walk = root_of(settings_.object_walk.over(input.dt));
  Eigen::VectorXd white(6);
  for (Particle& particle : particles_) {
    particle.camera = internal::predict(std::move(particle.camera), step);
    for (auto& object : particle.objects) {
      if (!object) continue;
      random_.fill_normal(white);
      object = *object * SE3d::exp(walk * white);
    }
  }
}

bool ParticleCloud::start(Particle& particle, double& log_weight, std::size_t object,
                          const SE3d& detected) {
  const DetectorNoise& noise = models_[object].noise;
  const double clutter = noise.clutter().weight;
  if (clutter > 0.0) {
    log_weight += noise.log_clutter_density() - std::log(clutter);
    if (random_.uniform() < clutter) return false;
  }
  std::vector<double> weights;
  for (const NoiseComponent& component : noise.components()) weights.push_back(component.weight);
  const NoiseComponent& component = noise.components()[draw_index(weights, 1.0 - clutter, random_)];
  const std::size_t last = particle.camera.mean().size();
  const auto& independent = models_[object].independent_start;
  const Hypothesis joint =
      independent ? with_independent_pose(particle.camera,
                                          particle.camera.mean()[kCamera] * detected, *independent)
                  : with_detected_object(particle.camera, detected, component);
  const SE3d drawn = marginal(joint, last).sample(random_);
  particle.camera = conditional(joint, {{last}}, {{drawn}});
  particle.objects[object] = drawn;
  return true;
}

void ParticleCloud::weigh(Particle& particle, double& log_weight, std::size_t object,
                          const SE3d& detected) {
  const DetectorNoise& noise = models_[object].noise;
  const PoseStackd poses({particle.camera.mean()[kCamera], *particle.objects[object]});
  const Detection detection{1, detected, &noise};
  const Matrix6d p = particle.camera.covariance().topLeftCorner<6, 6>();
  std::vector<double> terms;
  for (const NoiseComponent& component : noise.components()) {
    const Innovation seen = innovation(poses, detection, component);
    const Eigen::LLT<Matrix6d> s(p + seen.noise);
    terms.push_back(s.info() == Eigen::Success
                        ? std::log(component.weight) + log_normal(s, seen.residual)
                        : -std::numeric_limits<double>::infinity());
  }
  if (noise.clutter().weight > 0.0) terms.push_back(noise.log_clutter_density());
  const double total = log_sum_exp(terms);
  log_weight += total;
  if (!std::isfinite(total)) return;
  std::transform(terms.begin(), terms.end(), terms.begin(),
                 [total](double term) { return std::exp(term - total); });
  const std::size_t chosen = draw_index(terms, 1.0, random_);
  if (chosen == noise.components().size()) return;
  condition_camera(particle.camera, innovation(poses, detection, noise.components()[chosen]));
}

DetectionStatus ParticleCloud::observe(std::size_t object, const SE3d& detected,
                                       UpdateReport& report) {
  const Stopwatch stopwatch;
  const bool known = std::any_of(
      particles_.begin(), particles_.end(),
      [object](const Particle& particle) { return particle.objects[object].has_value(); });
  std::vector<Particle> particles = particles_;
  std::vector<double> log_weights = log_weights_;
  bool started = false;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (particles[i].objects[object]) {
      weigh(particles[i], log_weights[i], object, detected);
    } else {
      started |= start(particles[i], log_weights[i], object, detected);
    }
  }
  const double log_evidence = log_sum_exp(log_weights);
  const bool ok = std::isfinite(log_evidence);
  if (ok) {
    for (double& log_weight : log_weights) log_weight -= log_evidence;
    particles_ = std::move(particles);
    log_weights_ = std::move(log_weights);
    if (known) report.log_evidence += log_evidence;
  }
  report.update_seconds += stopwatch.seconds();
  if (!ok) return DetectionStatus::failed;
  return known || !started ? DetectionStatus::used : DetectionStatus::started;
}

bool ParticleCloud::resample_if_degenerate() {
  std::vector<double> weights(log_weights_.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = std::exp(log_weights_[i]);
    squares += weights[i] * weights[i];
  }
  const auto count = static_cast<double>(weights.size());
  if (1.0 / squares >= settings_.resample_below * count) return false;
  std::vector<Particle> drawn;
  drawn.reserve(particles_.size());
  for (const std::size_t i : systematic_resample(weights, random_.uniform()))
    drawn.push_back(particles_[i]);
  particles_ = std::move(drawn);
  std::fill(log_weights_.begin(), log_weights_.end(), -std::log(count));
  return true;
}

FrameReport ParticleCloud::observe(const std::vector<std::optional<SE3d>>& detections) {
  FrameReport report;
  report.statuses.assign(models_.size(), DetectionStatus::none);
  for (std::size_t object = 0; object < models_.size(); ++object) {
    if (!detections[object]) continue;
    report.statuses[object] = observe(object, *detections[object], report.update);
    report.update.gated.push_back(false);
    report.update.failed.push_back(report.statuses[object] == DetectionStatus::failed);
    const Stopwatch stopwatch;
    resample_if_degenerate();
    report.update.reduce_seconds += stopwatch.seconds();
  }
  return report;
}

std::vector<std::optional<std::size_t>> ParticleCloud::pose_indices() const {
  const auto objects_of = [](const Particle& particle) {
    return std::count_if(particle.objects.begin(), particle.objects.end(),
                         [](const auto& pose) { return pose.has_value(); });
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < particles_.size(); ++i) {
    const auto more = objects_of(particles_[i]) - objects_of(particles_[best]);
    if (more > 0 || (more == 0 && log_weights_[i] > log_weights_[best])) best = i;
  }
  std::vector<std::optional<std::size_t>> indices;
  std::size_t next = particles_[best].camera.mean().size();
  for (const auto& pose : particles_[best].objects)
    indices.push_back(pose ? std::optional(next++) : std::nullopt);
  return indices;
}

Posterior ParticleCloud::posterior() const {
  const auto indices = pose_indices();
  std::vector<Component<Hypothesis>> components;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const Particle& particle = particles_[i];
    Hypothesis joint = particle.camera;
    bool complete = true;
    for (std::size_t object = 0; object < indices.size() && complete; ++object) {
      if (!indices[object]) continue;
      const auto& pose = particle.objects[object];
      complete = pose.has_value();
      if (complete)
        joint = with_independent_pose(joint, *pose, pose->adjoint_congruence(settings_.kernel));
    }
    if (complete) components.push_back({log_weights_[i], std::move(joint)});
  }
  return Posterior(std::move(components));
}

}  // namespace posemix::internal
