// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <variant>

#include "posemix/base/units.hpp"
#include "sequence_parts.hpp"

namespace posemix::internal {
namespace {

constexpr std::string_view kDefaultMethod = "multi_object";

constexpr IntegerRange kComponents{.lowest = 1, .highest = 100000};
constexpr IntegerRange kKeepHeaviest{.lowest = 0, .highest = 100000};
constexpr IntegerRange kMergeFrom{.lowest = 0, .highest = 100000};
constexpr IntegerRange kParticles{.lowest = 1, .highest = 1000000};
constexpr IntegerRange kLag{.lowest = 1, .highest = 1000000};
constexpr IntegerRange kPasses{.lowest = 1, .highest = 100};
constexpr IntegerRange kSeed{.lowest = 0, .highest = std::int64_t{1} << 53};

ReductionSettings read_reduction(const TomlTable& filter, ReductionSettings r) {
  const auto integer = [&](std::string_view key, std::size_t otherwise, const IntegerRange& range) {
    return static_cast<std::size_t>(
        filter.get_integer_or(key, static_cast<std::int64_t>(otherwise), range));
  };
  r.drop_smallest = integer("drop_smallest", r.drop_smallest, kKeepHeaviest);
  r.keep_heaviest = integer("keep_heaviest", r.keep_heaviest, kKeepHeaviest);
  r.max_components = integer("max_components", r.max_components, kComponents);
  r.merge_from = integer("merge_from", r.merge_from, kMergeFrom);
  r.prune_below =
      filter.get_double_or("prune_below", r.prune_below, ReductionSettings::kPruneBelow);
  r.pair = filter.get_enum_or("pair_rule", r.pair);
  r.distance = filter.get_enum_or("distance", r.distance);
  r.merge.rule = filter.get_enum_or("merge_rule", r.merge.rule);
  r.merge.jacobian = filter.get_enum_or("transport_jacobian", r.merge.jacobian);
  return r;
}

ParticleFilterSettings read_particles(const TomlTable& filter, ParticleFilterSettings p) {
  p.particles = static_cast<std::size_t>(
      filter.get_integer_or("particles", static_cast<std::int64_t>(p.particles), kParticles));
  p.seed = static_cast<std::uint64_t>(
      filter.get_integer_or("particle_seed", static_cast<std::int64_t>(p.seed), kSeed));
  p.resample_below =
      filter.get_double_or("resample_below", p.resample_below, {.lowest = 0, .highest = 1});
  const Vector6d sd = p.object_walk.covariance.diagonal().cwiseSqrt();
  const auto deviation = [&](std::string_view key, const Eigen::Vector3d& otherwise,
                             const NumberRange& range, double unit) {
    return filter.has(key) ? read_sd(filter, key, range, unit) : otherwise;
  };
  p.object_walk.covariance = pose_covariance(
      deviation("particle_walk_rotation_sd_deg", sd.head<3>(), kSdOrZero, kRadPerDeg),
      deviation("particle_walk_translation_sd_m", sd.tail<3>(), kSdOrZero, 1.0));
  const Vector6d kernel = p.kernel.diagonal().cwiseSqrt();
  constexpr std::string_view kKernelRotation = "particle_kernel_rotation_sd_deg";
  constexpr std::string_view kKernelTranslation = "particle_kernel_translation_sd_m";
  if (filter.has(kKernelRotation) || filter.has(kKernelTranslation)) {
    p.kernel = pose_covariance(deviation(kKernelRotation, kernel.head<3>(), kSd, kRadPerDeg),
                               deviation(kKernelTranslation, kernel.tail<3>(), kSd, 1.0));
  }
  p.hypotheses = static_cast<std::size_t>(filter.get_integer_or(
      "particle_hypotheses", static_cast<std::int64_t>(p.hypotheses), kParticles));
  return p;
}

enum class Smoothing { none, fixed_lag, full };

std::optional<SmoothingSettings> read_smoothing(const TomlTable& filter,
                                                const std::optional<SmoothingSettings>& preset) {
  const Smoothing otherwise = !preset                   ? Smoothing::none
                              : preset->lag_frames == 0 ? Smoothing::full
                                                        : Smoothing::fixed_lag;
  const auto kind = filter.get_enum_or<Smoothing>(
      "smooth", otherwise,
      {{"none", Smoothing::none}, {"fixed_lag", Smoothing::fixed_lag}, {"full", Smoothing::full}});
  SmoothingSettings settings;
  const auto lag = static_cast<std::size_t>(
      filter.get_integer_or("smooth_lag", static_cast<std::int64_t>(kSmoothLag), kLag));
  settings.passes = static_cast<std::size_t>(
      filter.get_integer_or("smooth_passes", static_cast<std::int64_t>(settings.passes), kPasses));
  settings.least_probability = filter.get_double_or(
      "smooth_least_probability", settings.least_probability, {.lowest = 0, .highest = 1});
  if (kind == Smoothing::none) return std::nullopt;
  if (kind == Smoothing::fixed_lag) settings.lag_frames = lag;
  return settings;
}

/// The keys of smoothing do not count as known thereby: other methods do not have them.
void refuse_smoothing(const TomlTable& filter) {
  for (const std::string& key : filter.keys()) {
    if (key == "smooth" || key.starts_with("smooth_"))
      filter.fail(key, "is for filter.method = \"multi_object\"; no other filter is smoothed");
  }
}

GaussianSumSettings read_gaussian_sum(const TomlTable& filter, GaussianSumSettings settings) {
  settings.noise_use = filter.get_enum_or("noise_use", settings.noise_use);
  settings.update = filter.get_enum_or("update", settings.update);
  settings.robust_loss = filter.get_enum_or("robust_loss", settings.robust_loss);
  settings.cauchy_scale =
      filter.get_double_or("cauchy_scale", settings.cauchy_scale, {.lowest = 1e-3, .highest = 1e6});
  settings.gate_probability =
      filter.get_double_or("gate_probability", settings.gate_probability,
                           {.lowest = 0, .highest = 1, .without_lowest = true});
  settings.summary = filter.get_enum_or("summary", settings.summary);
  settings.reduction = read_reduction(filter, settings.reduction);
  return settings;
}

/// The method under the key `method`, with its settings from the table of methods.
const SlamMethod& read_method(const TomlTable& filter) {
  if (!filter.has("method")) return find_slam_method(kDefaultMethod);
  std::vector<std::string_view> names;
  for (const SlamMethod& method : slam_methods()) names.push_back(method.name);
  return slam_methods()[filter.get_word("method", names)];
}

/// The keys of the Gaussian-sum filter and of the particle filter are read for both, so that one
/// file fits all baselines.
void read_baseline(const TomlTable& filter, SlamMethod& method) {
  if (auto* particles = std::get_if<ParticleFilterSettings>(&method.tracker)) {
    particles->merge = read_gaussian_sum(filter, {}).reduction.merge;
    *particles = read_particles(filter, *particles);
    return;
  }
  auto& settings = std::get<GaussianSumSettings>(method.tracker);
  settings = read_gaussian_sum(filter, settings);
  read_particles(filter, {});
  if (method.restore != nullptr) method.restore(settings);
}

}  // namespace

SlamMethod read_filter(const TomlTable& root) {
  const auto filter = root.find_table("filter");
  SlamMethod method = filter ? read_method(*filter) : find_slam_method(kDefaultMethod);
  auto* tracker = std::get_if<MultiObjectSlamSettings>(&method.tracker);
  if (tracker != nullptr) read_association(root, *tracker);
  if (!filter) return method;
  if (tracker != nullptr) {
    tracker->filter = read_multi_object(*filter, tracker->filter);
    tracker->moving = read_moving_objects(*filter);
    tracker->existence = read_existence(*filter);
    tracker->health = read_health(*filter);
    method.smoothing = read_smoothing(*filter, method.smoothing);
  } else {
    refuse_smoothing(*filter);
    read_baseline(*filter, method);
  }
  return method;
}

}  // namespace posemix::internal
