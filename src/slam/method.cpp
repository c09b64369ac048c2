// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/method.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

/// The Gaussian-sum filter with the library's own settings.
constexpr std::string_view kOwnGaussianSum = "gm-iekf";

void use_one_hypothesis(GaussianSumSettings& settings) {
  settings.update = UpdateRule::linearized;
  settings.reduction.max_components = 1;
  settings.reduction.merge_from = 0;
}

void use_most_likely_component(GaussianSumSettings& settings) {
  settings.noise_use = NoiseUse::most_likely;
  use_one_hypothesis(settings);
}

SlamMethod multi_object() {
  return {.name = "multi_object",
          .description = "hypotheses of every object for itself, with births and clutter",
          .tracker = MultiObjectSlamSettings{}};
}

SlamMethod smoothed(const char* name, const char* description, std::size_t lag_frames) {
  SlamMethod method = multi_object();
  method.name = name;
  method.description = description;
  method.smoothing = SmoothingSettings{.lag_frames = lag_frames};
  return method;
}

SlamMethod gm_iekf() {
  return {.name = std::string(kOwnGaussianSum),
          .description = "Gaussian-sum filter over all poses, iterated updates",
          .tracker = GaussianSumSettings{}};
}

/// The midway-merge paper's filter.
SlamMethod paper(const char* name, const char* description, MergeRule rule, UpdateRule update) {
  GaussianSumSettings settings;
  settings.noise_use = NoiseUse::joint;
  settings.update = update;
  settings.gate_probability = 1.0;
  settings.summary = Summary::merge_two_largest;
  settings.reduction.max_components = 12;
  settings.reduction.merge_from = 0;
  settings.reduction.prune_below = 5e-6;
  settings.reduction.pair = PairRule::largest_with_smallest;
  settings.reduction.merge = {.rule = rule, .jacobian = TransportJacobian::exact};
  return {.name = name, .description = description, .tracker = settings};
}

/// As the program that the paper's authors published.
SlamMethod published() {
  SlamMethod method = paper("published", "midway as in the paper's published program",
                            MergeRule::midway, UpdateRule::linearized);
  ReductionSettings& reduction = std::get<GaussianSumSettings>(method.tracker).reduction;
  reduction.merge_from = 16;
  reduction.merge.jacobian = TransportJacobian::bernoulli;
  return method;
}

SlamMethod riekf(const char* name, const char* description) {
  GaussianSumSettings settings;
  use_one_hypothesis(settings);
  return {.name = name,
          .description = description,
          .tracker = settings,
          .single_gaussian = true,
          .restore = use_one_hypothesis};
}

SlamMethod riekf_gated() {
  SlamMethod method = riekf("riekf_gated", "riekf with a gate of 0.999");
  std::get<GaussianSumSettings>(method.tracker).gate_probability = 0.999;
  return method;
}

SlamMethod riekf_cauchy() {
  SlamMethod method = riekf("riekf_cauchy", "riekf with a Cauchy loss");
  std::get<GaussianSumSettings>(method.tracker).robust_loss = RobustLoss::cauchy;
  return method;
}

SlamMethod max_mixture() {
  GaussianSumSettings settings;
  use_most_likely_component(settings);
  return {.name = "max_mixture",
          .description = "one hypothesis, the likeliest noise component of every detection",
          .tracker = settings,
          .restore = use_most_likely_component};
}

SlamMethod rbpf() {
  return {.name = "rbpf",
          .description = "Rao-Blackwellised particle filter",
          .tracker = ParticleFilterSettings{}};
}

std::string title_of(MergeRule rule) {
  std::string title(word_of(rule));
  std::replace(title.begin(), title.end(), '_', ' ');
  return title;
}

std::string title_of(const SlamMethod& method, const MultiObjectSlamSettings& /*tracker*/) {
  if (!method.smoothing) return "multi-object";
  if (method.smoothing->lag_frames == 0) return "multi-object, smoothed";
  return fmt::format("multi-object, smoothed by {} frames", method.smoothing->lag_frames);
}

/// What a baseline of one hypothesis does with detections that are far off.
std::string riekf_title(const GaussianSumSettings& tracker) {
  std::vector<std::string> words;
  if (tracker.robust_loss == RobustLoss::cauchy)
    words.push_back(fmt::format("Cauchy, c = {:g}", tracker.cauchy_scale));
  if (tracker.gate_probability < 1.0)
    words.push_back(fmt::format("gate {:g}", tracker.gate_probability));
  return words.empty() ? "riekf" : fmt::format("riekf ({})", fmt::join(words, ", "));
}

std::string settings_title(const GaussianSumSettings& tracker) {
  return fmt::format("{}{}{}", title_of(tracker.reduction.merge.rule),
                     tracker.update == UpdateRule::iterated ? ", iterated" : "",
                     tracker.robust_loss == RobustLoss::cauchy ? ", Cauchy" : "");
}

std::string title_of(const SlamMethod& method, const GaussianSumSettings& tracker) {
  if (method.name == "max_mixture") return "max-mixture";
  if (method.single_gaussian) return riekf_title(tracker);
  const std::string settings = settings_title(tracker);
  // A filter of the paper goes by its name alone where its settings are those of the table.
  const auto is_preset = [&](const SlamMethod& known) {
    const auto* preset = std::get_if<GaussianSumSettings>(&known.tracker);
    return preset != nullptr && known.name == method.name && settings == settings_title(*preset);
  };
  const std::vector<SlamMethod>& methods = slam_methods();
  const bool by_name =
      method.name != kOwnGaussianSum && std::any_of(methods.begin(), methods.end(), is_preset);
  return by_name ? method.name : fmt::format("{} ({})", method.name, settings);
}

std::string title_of(const SlamMethod& /*method*/, const ParticleFilterSettings& tracker) {
  return fmt::format("rbpf ({} particles)", tracker.particles);
}

}  // namespace

ObjectSlam SlamMethod::live(const PoseDensity& camera, std::vector<ObjectModel> objects,
                            const MotionSettings& motion) const {
  if (smoothing) {
    throw InvalidInput(fmt::format(
        "method '{}' looks ahead, which ObjectSlam does not; expected a FixedLagSmoother", name));
  }
  return {camera, models(std::move(objects)), settings(motion)};
}

FixedLagSmoother SlamMethod::smoother(const PoseDensity& camera, std::vector<ObjectModel> objects,
                                      const MotionSettings& motion) const {
  if (!smoothing) {
    throw InvalidInput(fmt::format(
        "method '{}' does not look ahead, as a FixedLagSmoother does; expected an ObjectSlam",
        name));
  }
  return {camera, models(std::move(objects)), settings(motion), *smoothing};
}

ObjectSlamSettings SlamMethod::settings(const MotionSettings& motion) const {
  return {.motion = motion, .tracker = tracker};
}

std::vector<ObjectModel> SlamMethod::models(std::vector<ObjectModel> models) const {
  if (single_gaussian) {
    for (ObjectModel& model : models) model.noise = model.noise.single_gaussian();
  }
  return models;
}

std::string SlamMethod::title() const {
  return std::visit([this](const auto& settings) { return title_of(*this, settings); }, tracker);
}

const std::vector<SlamMethod>& slam_methods() {
  using enum MergeRule;
  static const std::vector<SlamMethod> methods{
      multi_object(),
      smoothed("smoothed", "multi_object with smoothing by all frames", 0),
      smoothed("fixed_lag", "multi_object smoothed by the 20 frames that follow", kSmoothLag),
      gm_iekf(),
      paper("tangent_of_larger", "midway-merge paper: merges in the tangent space of the larger",
            tangent_of_larger, UpdateRule::linearized),
      paper("midway", "midway-merge paper: midway merges", midway, UpdateRule::linearized),
      paper("midway_iterated", "midway with iterated updates", midway, UpdateRule::iterated),
      published(),
      riekf("riekf", "right-invariant extended Kalman filter, one Gaussian of noise"),
      riekf_gated(),
      riekf_cauchy(),
      max_mixture(),
      rbpf()};
  return methods;
}

const SlamMethod& find_slam_method(std::string_view name) {
  const std::vector<SlamMethod>& methods = slam_methods();
  const auto found = std::find_if(methods.begin(), methods.end(),
                                  [&](const SlamMethod& method) { return method.name == name; });
  if (found != methods.end()) return *found;
  std::vector<std::string_view> names;
  names.reserve(methods.size());
  for (const SlamMethod& method : methods) names.push_back(method.name);
  throw InvalidInput(fmt::format("method '{}', expected one of: {}", name, fmt::join(names, ", ")));
}

}  // namespace posemix
