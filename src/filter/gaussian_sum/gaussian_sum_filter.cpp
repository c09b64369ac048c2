// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/gaussian_sum_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/kept_matrices.hpp"
#include "detections_of_frame.hpp"
#include "filter/precision.hpp"
#include "linearized_update.hpp"
#include "posemix/base/stopwatch.hpp"
#include "posemix/lie/pose_checks.hpp"
#include "scene_frame.hpp"

namespace posemix {
namespace {

using namespace internal;

using NoiseSpan = std::span<const NoiseComponent* const>;

/// One child of one hypothesis under one component of the noise.
UpdateResult child_of(const Hypothesis& parent, std::span<const Detection> detections,
                      NoiseSpan noise, const GaussianSumSettings& settings) {
  const auto update = [&](NoiseSpan components) {
    return settings.update == UpdateRule::iterated
               ? iterated_update(parent, detections, components, settings.first_object)
               : posemix::update(parent, detections, components);
  };
  if (settings.robust_loss == RobustLoss::none) return update(noise);
  return cauchy_update(parent, detections, noise, update, {.scale = settings.cauchy_scale});
}

/// The children of one hypothesis, one for each component of the noise.
KeptVector<UpdateResult> children_of(const Hypothesis& parent,
                                     std::span<const Detection> detections,
                                     const FrameNoises& noises,
                                     const GaussianSumSettings& settings) {
  if (settings.update == UpdateRule::linearized && settings.robust_loss == RobustLoss::none)
    return linearized_updates(parent, detections, noises);
  KeptVector<UpdateResult> children;
  const std::size_t count = detections.size();
  const NoiseSpan all(noises.components);
  for (std::size_t first = 0; first < all.size(); first += count)
    children.push_back(child_of(parent, detections, all.subspan(first, count), settings));
  return children;
}

/// Every common component of the noise, as that of each detection.
FrameNoises noises_of(std::span<const Detection> detections) {
  std::vector<const NoiseComponent*> components;
  for (std::size_t i = 0, count = common_components(detections); i < count; ++i) {
    for (const Detection& detection : detections)
      components.push_back(&detection.noise->components()[i]);
  }
  return FrameNoises(components);
}

Hypothesis copy_of(const Hypothesis& hypothesis) {
  return Hypothesis::trusted(hypothesis.mean(), kept_copy(hypothesis.covariance()));
}

/// A motion may be the caller's own.
void check_moved(const Hypothesis& hypothesis) {
  for (const SE3d& pose : hypothesis.mean().poses())
    check_pose(pose, "filter: what the motion returns");
  require(hypothesis.covariance().allFinite(),
          "filter: what the motion returns has a covariance that is not finite");
}

/// The hypotheses become others; memory of those before goes to the next ones.
void replace(Posterior& posterior, std::vector<Component<Hypothesis>> hypotheses) {
  Posterior before = std::exchange(posterior, Posterior(std::move(hypotheses)));
  for (Component<Hypothesis>& one : std::move(before).release()) reuse(std::move(one.density));
}

/// Keeps only the child of the largest weight among those from index `first` on.
void keep_most_likely(std::vector<Component<Hypothesis>>& children, std::size_t first) {
  const auto begin = children.begin() + static_cast<std::ptrdiff_t>(first);
  const auto best = std::max_element(begin, children.end(), [](const auto& a, const auto& b) {
    return a.log_weight < b.log_weight;
  });
  std::iter_swap(begin, best);
  children.erase(begin + 1, children.end());
}

}  // namespace

GaussianSumFilter::GaussianSumFilter(Posterior prior, GaussianSumSettings settings)
    : posterior_(std::move(prior)),
      settings_(settings),
      gate_(gate_threshold(settings.gate_probability)) {
  require(settings_.reduction.max_components > 0,
          "filter: max_components is 0, expected at least 1");
  ReductionSettings::kPruneBelow.check(settings_.reduction.prune_below, "filter: prune_below");
  if (!(settings_.cauchy_scale > 0.0)) {
    throw InvalidInput(fmt::format("filter: cauchy scale is {}, expected a positive number",
                                   settings_.cauchy_scale));
  }
  for (const auto& component : posterior_.components()) {
    for (const SE3d& pose : component.density.mean().poses()) {
      check_pose(pose, "filter: the prior");
      require_near_origin(pose, "filter: the prior");
    }
    for (std::size_t i = 0; i < component.density.mean().size(); ++i)
      check_variances(block(component.density.covariance(), i, i), "filter: the prior");
  }
}

void GaussianSumFilter::predict(const std::function<Hypothesis(Hypothesis)>& motion) {
  require(static_cast<bool>(motion), "filter: predict is given no motion");
  std::vector<Component<Hypothesis>> hypotheses;
  hypotheses.reserve(posterior_.size());
  for (const auto& before : posterior_.components()) {
    hypotheses.push_back({before.log_weight, motion(copy_of(before.density))});
    check_moved(hypotheses.back().density);
  }
  replace(posterior_, std::move(hypotheses));
}

void GaussianSumFilter::check(std::span<const Detection> detections) const {
  check_detections(detections, posterior_[0].density.mean().size());
  for (const Detection& detection : detections) {
    for (const std::size_t pose : {kCamera, detection.object})
      check_precision(posterior_, pose, *detection.noise);
  }
  if (settings_.noise_use == NoiseUse::joint && !detections.empty()) common_components(detections);
}

template <class Work, class Changed>
auto GaussianSumFilter::near_the_scene(const Work& work, const Changed& has_changed) {
  const auto origin = scene_origin(posterior_);
  if (!origin) return work();
  const auto move_by = [&](const WorldShift& shift) {
    auto hypotheses = std::move(posterior_).release();
    move_world(shift, settings_.first_object, hypotheses);
    posterior_ = Posterior(std::move(hypotheses));
  };
  const Posterior before = posterior_;
  try {
    const WorldShift to_world(*origin);
    move_by(to_world.inverse());
    auto result = work();
    // A round trip costs digits.
    if (has_changed(result)) {
      move_by(to_world);
    } else {
      posterior_ = before;
    }
    return result;
  } catch (...) {
    posterior_ = before;
    throw;
  }
}

UpdateReport GaussianSumFilter::update(std::span<const Detection> given) {
  check(given);
  const WhiteDetections white(given);
  const auto has_changed = [](const UpdateReport& report) {
    for (std::size_t i = 0; i < report.gated.size(); ++i)
      if (!report.gated[i] && !report.failed[i]) return true;
    return false;
  };
  return near_the_scene([&] { return updated_by(white.detections()); }, has_changed);
}

UpdateReport GaussianSumFilter::updated_by(std::span<const Detection> detections) {
  UpdateReport report;
  report.gated.assign(detections.size(), false);
  report.failed.assign(detections.size(), false);
  for (const Detection& detection : detections) report.nis.push_back(nis_of(posterior_, detection));
  for (std::size_t i = 0; i < detections.size(); ++i) {
    report.gated[i] = std::isfinite(gate_) && is_outlier(posterior_, detections[i], gate_);
  }
  if (settings_.noise_use == NoiseUse::joint) {
    std::vector<Detection> used;
    for (std::size_t i = 0; i < detections.size(); ++i) {
      if (!report.gated[i]) used.push_back(detections[i]);
    }
    if (used.empty()) return report;
    const bool ok = branch(used, report);
    for (std::size_t i = 0; i < detections.size(); ++i) report.failed[i] = !ok && !report.gated[i];
    reduce(report);
    return report;
  }
  for (std::size_t i = 0; i < detections.size(); ++i) {
    if (report.gated[i]) continue;
    if (i > 0) report.nis[i] = nis_of(posterior_, detections[i]);
    report.failed[i] = !branch(detections.subspan(i, 1), report);
    reduce(report);
  }
  return report;
}

bool GaussianSumFilter::branch(std::span<const Detection> detections, UpdateReport& report) {
  const Stopwatch stopwatch;
  const FrameNoises noises = noises_of(detections);
  std::vector<Component<Hypothesis>> children;
  std::vector<double> log_weights;
  children.reserve(posterior_.size() * (noises.components.size() / detections.size() + 1));
  log_weights.reserve(children.capacity());
  for (const auto& parent : posterior_.components()) {
    const std::size_t first_child = children.size();
    std::size_t i = 0;
    for (UpdateResult& child : children_of(parent.density, detections, noises, settings_)) {
      const double log_prior = std::log(noises.components[i]->weight);
      log_weights.push_back(parent.log_weight + log_prior + child.log_likelihood);
      children.push_back({log_weights.back(), std::move(child.posterior)});
      i += detections.size();
    }
    if (detections.front().noise->clutter().weight > 0.0) {
      log_weights.push_back(parent.log_weight + detections.front().noise->log_clutter_density());
      children.push_back({log_weights.back(), copy_of(parent.density)});
    }
    if (settings_.noise_use == NoiseUse::most_likely) keep_most_likely(children, first_child);
  }
  const double log_evidence = log_sum_exp(log_weights);
  const bool ok = std::isfinite(log_evidence);
  if (ok) {
    report.log_evidence += log_evidence;
    replace(posterior_, std::move(children));
  }
  report.update_seconds += stopwatch.seconds();
  return ok;
}

void GaussianSumFilter::reduce(UpdateReport& report) {
  const Stopwatch stopwatch;
  auto reduction = internal::reduced(std::move(posterior_), settings_.reduction);
  posterior_ = std::move(reduction.mixture);
  report.reductions.push_back(std::move(reduction.report));
  report.reduce_seconds += stopwatch.seconds();
}

std::size_t GaussianSumFilter::add_object(const SE3d& camera_object, const DetectorNoise& noise) {
  check_pose(camera_object, "detection");
  check_precision(posterior_, kCamera, noise);
  if (!noise.is_white()) return add_object(camera_object, noise.as_white());
  return near_the_scene([&] { return with_new_object(camera_object, noise); },
                        [](std::size_t) { return true; });
}

std::size_t GaussianSumFilter::with_new_object(const SE3d& camera_object,
                                               const DetectorNoise& noise) {
  const std::size_t index = posterior_[0].density.mean().size();
  std::vector<Component<Hypothesis>> children;
  for (const auto& parent : posterior_.components()) {
    const std::size_t first_child = children.size();
    for (const NoiseComponent& component : noise.components()) {
      children.push_back({parent.log_weight + std::log(component.weight),
                          with_detected_object(parent.density, camera_object, component)});
    }
    if (settings_.noise_use == NoiseUse::most_likely) keep_most_likely(children, first_child);
  }
  posterior_ = posemix::reduce(Posterior(std::move(children)), settings_.reduction).mixture;
  return index;
}

std::size_t GaussianSumFilter::add_independent_object(const SE3d& camera_object,
                                                      const Matrix6d& covariance) {
  check_pose(camera_object, "detection");
  const Matrix6d checked = checked_covariance(covariance, 6, "covariance of the new object");
  const std::size_t index = posterior_[0].density.mean().size();
  predict([&](const Hypothesis& hypothesis) {
    return with_independent_pose(hypothesis, hypothesis.mean()[kCamera] * camera_object, checked);
  });
  return index;
}

Hypothesis GaussianSumFilter::summarise() const {
  const auto& components = posterior_.components();
  if (settings_.summary == Summary::best || components.size() == 1) {
    return components[posterior_.heaviest()].density;
  }
  if (settings_.summary == Summary::whole_mixture) {
    return merge<PoseStackd>(std::span(components), settings_.reduction.merge).component.density;
  }
  std::vector<std::size_t> order(components.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return components[a].log_weight > components[b].log_weight;
  });
  const Component<Hypothesis>* const two[] = {&components[order[0]], &components[order[1]]};
  return merge<PoseStackd>(std::span<const Component<Hypothesis>* const>(two),
                           settings_.reduction.merge)
      .component.density;
}

}  // namespace posemix
