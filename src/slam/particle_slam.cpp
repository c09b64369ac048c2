// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/particle_slam.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/base/stopwatch.hpp"
#include "posemix/lie/pose_checks.hpp"
#include "posemix/slam/moving_objects.hpp"
#include "slam/frames.hpp"
#include "slam/particles.hpp"

namespace posemix {
namespace {

const ParticleFilterSettings& checked(const ParticleFilterSettings& settings) {
  require(settings.particles > 0, "particle filter: there are 0 particles, expected at least 1");
  internal::check_count(settings.particles, "particle filter: the number of particles");
  require(settings.hypotheses > 0, "particle filter: hypotheses is 0, expected at least 1");
  if (!(settings.resample_below >= 0.0 && settings.resample_below <= 1.0)) {
    throw InvalidInput(
        fmt::format("particle filter: resample_below is {}, expected a number in [0, 1]",
                    settings.resample_below));
  }
  check_noise(settings.object_walk.covariance, "particle filter: object_walk");
  checked_covariance(settings.kernel, 6, "particle filter: kernel");
  return settings;
}

/// The heaviest components, the first of equals before the others.
Posterior heaviest_of(const Posterior& posterior, std::size_t count) {
  std::vector<Component<Hypothesis>> components = posterior.components();
  std::stable_sort(components.begin(), components.end(),
                   [](const auto& a, const auto& b) { return a.log_weight > b.log_weight; });
  if (components.size() > count)
    components.erase(components.begin() + static_cast<std::ptrdiff_t>(count), components.end());
  return Posterior(std::move(components));
}

/// The particle filter takes successive errors for independent.
std::vector<ObjectModel> as_white(std::vector<ObjectModel> models) {
  for (ObjectModel& model : models) model.noise = model.noise.as_white();
  return models;
}

}  // namespace

ParticleSlam::ParticleSlam(const PoseDensity& camera, std::vector<ObjectModel> objects,
                           const ParticleFilterSettings& settings, const MotionSettings& motion,
                           bool record_hypotheses)
    : objects_(as_white(std::move(objects))),
      settings_(checked(settings)),
      record_hypotheses_(record_hypotheses),
      cloud_(std::make_unique<internal::ParticleCloud>(camera, objects_.models(), settings,
                                                       internal::checked(motion))),
      indices_(objects_.size()),
      counts_(objects_.size()),
      estimate_(internal::camera_hypothesis(camera, motion)) {
  require_static(objects_.models(), "the particle filter");
  internal::require_not_given(motion, "the particle filter");
}

ParticleSlam::ParticleSlam(const ParticleSlam& other)
    : objects_(other.objects_),
      settings_(other.settings_),
      record_hypotheses_(other.record_hypotheses_),
      cloud_(std::make_unique<internal::ParticleCloud>(*other.cloud_)),
      indices_(other.indices_),
      counts_(other.counts_),
      estimate_(other.estimate_) {}

ParticleSlam::ParticleSlam(ParticleSlam&& other) noexcept = default;
ParticleSlam& ParticleSlam::operator=(ParticleSlam&& other) noexcept = default;
ParticleSlam::~ParticleSlam() = default;

ParticleSlam& ParticleSlam::operator=(const ParticleSlam& other) {
  return *this = ParticleSlam(other);
}

FrameEstimate ParticleSlam::step(const FrameInput& input) {
  internal::require_plain_detections(input, "the particle filter");
  const bool is_first = objects_.frames() == 0;
  objects_.begin(input);
  const Stopwatch frame;
  if (!is_first) cloud_->predict(input);
  const auto detections = internal::all_detections(input, objects_.size());
  FrameReport report = cloud_->observe(detections);
  for (std::size_t object = 0; object < objects_.size(); ++object)
    counts_[object] += detections[object] ? 1 : 0;
  indices_ = cloud_->pose_indices();
  const Posterior posterior = cloud_->posterior();
  estimate_ =
      merge<PoseStackd>(std::span(posterior.components()), settings_.merge).component.density;
  report.seconds = frame.seconds();
  FrameEstimate estimate =
      internal::frame_estimate(estimate_, indices_, objects_.ids(), std::move(report));
  if (record_hypotheses_)
    estimate.hypotheses = internal::snapshots(heaviest_of(posterior, settings_.hypotheses));
  return estimate;
}

Posterior ParticleSlam::posterior() const {
  return heaviest_of(cloud_->posterior(), settings_.hypotheses);
}

}  // namespace posemix
