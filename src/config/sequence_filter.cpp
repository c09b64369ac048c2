// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/format.h>

#include "posemix/base/units.hpp"
#include "sequence_parts.hpp"

namespace posemix {
namespace {

constexpr IntegerRange kComponents{.lowest = 1, .highest = 100000};
constexpr IntegerRange kKeepHeaviest{.lowest = 0, .highest = 100000};
constexpr IntegerRange kMergeFrom{.lowest = 0, .highest = 100000};
constexpr IntegerRange kParticles{.lowest = 1, .highest = 1000000};
constexpr IntegerRange kLag{.lowest = 1, .highest = 1000000};
constexpr IntegerRange kPasses{.lowest = 1, .highest = 100};
constexpr IntegerRange kSeed{.lowest = 0, .highest = std::int64_t{1} << 53};

ReductionSettings read_reduction(const TomlTable& filter) {
  ReductionSettings r;
  const auto integer = [&](std::string_view key, std::size_t otherwise, const IntegerRange& range) {
    return static_cast<std::size_t>(
        filter.get_integer_or(key, static_cast<std::int64_t>(otherwise), range));
  };
  r.drop_smallest = integer("drop_smallest", r.drop_smallest, kKeepHeaviest);
  r.keep_heaviest = integer("keep_heaviest", r.keep_heaviest, kKeepHeaviest);
  r.max_components = integer("max_components", r.max_components, kComponents);
  r.merge_from = integer("merge_from", r.merge_from, kMergeFrom);
  r.prune_below = filter.get_double_or("prune_below", r.prune_below,
                                       {.lowest = 0, .highest = 1, .without_highest = true});
  r.pair =
      filter.get_enum_or<PairRule>("pair_rule", r.pair,
                                   {{"largest_with_smallest", PairRule::largest_with_smallest},
                                    {"most_distant", PairRule::most_distant},
                                    {"runnalls", PairRule::runnalls},
                                    {"symmetric_kl", PairRule::symmetric_kl},
                                    {"weighted_symmetric_kl", PairRule::weighted_symmetric_kl}});
  r.distance = filter.get_enum_or<DistanceMetric>("distance", r.distance,
                                                  {{"tangent_norm", DistanceMetric::tangent_norm},
                                                   {"rotation", DistanceMetric::rotation},
                                                   {"translation", DistanceMetric::translation},
                                                   {"mahalanobis", DistanceMetric::mahalanobis}});
  r.merge.rule = filter.get_enum_or<MergeRule>("merge_rule", r.merge.rule,
                                               {{"midway", MergeRule::midway},
                                                {"tangent_of_larger", MergeRule::tangent_of_larger},
                                                {"moment_matched", MergeRule::moment_matched}});
  r.merge.jacobian = filter.get_enum_or<TransportJacobian>(
      "transport_jacobian", r.merge.jacobian,
      {{"exact", TransportJacobian::exact}, {"bernoulli", TransportJacobian::bernoulli}});
  return r;
}

std::string_view name_of(MergeRule rule) {
  switch (rule) {
    case MergeRule::midway:
      return "midway";
    case MergeRule::tangent_of_larger:
      return "tangent of larger";
    case MergeRule::moment_matched:
      return "moment matched";
  }
  return "";
}

std::string method_name(const MethodSettings& settings) {
  const bool iterated = settings.filter.update == UpdateRule::iterated;
  switch (settings.method) {
    case FilterMethod::multi_object:
      if (!settings.smoothing) return "multi-object";
      return settings.smoothing->lag_frames == 0
                 ? "multi-object, smoothed"
                 : fmt::format("multi-object, smoothed by {} frames",
                               settings.smoothing->lag_frames);
    case FilterMethod::riekf:
      return "riekf";
    case FilterMethod::riekf_cauchy:
      return fmt::format("riekf (Cauchy, c = {:g})", settings.filter.cauchy_scale);
    case FilterMethod::max_mixture:
      return "max-mixture";
    case FilterMethod::rbpf:
      return fmt::format("rbpf ({} particles)", settings.particles.particles);
    case FilterMethod::gm_iekf:
      break;
  }
  return fmt::format("gm-iekf ({}{}{})", name_of(settings.filter.reduction.merge.rule),
                     iterated ? ", iterated" : "",
                     settings.filter.robust_loss == RobustLoss::cauchy ? ", Cauchy" : "");
}

ParticleFilterSettings read_particles(const TomlTable& filter) {
  ParticleFilterSettings p;
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

std::optional<SmoothingSettings> read_smoothing(const TomlTable& filter) {
  const auto kind = filter.get_enum_or<Smoothing>(
      "smooth", Smoothing::none,
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

void refuse_smoothing(const TomlTable& filter) {
  for (const std::string_view key :
       {"smooth", "smooth_lag", "smooth_passes", "smooth_least_probability"}) {
    if (filter.has(key))
      filter.fail(key, "is for filter.method = \"multi_object\"; no other filter is smoothed");
  }
}

GaussianSumSettings read_gaussian_sum(const TomlTable& filter, FilterMethod method) {
  GaussianSumSettings settings;
  settings.noise_use = filter.get_enum_or<NoiseUse>("noise_use", settings.noise_use,
                                                    {{"per_object", NoiseUse::per_object},
                                                     {"joint", NoiseUse::joint},
                                                     {"most_likely", NoiseUse::most_likely}});
  settings.update = filter.get_enum_or<UpdateRule>(
      "update", settings.update,
      {{"linearized", UpdateRule::linearized}, {"iterated", UpdateRule::iterated}});
  settings.robust_loss = filter.get_enum_or<RobustLoss>(
      "robust_loss",
      method == FilterMethod::riekf_cauchy ? RobustLoss::cauchy : settings.robust_loss,
      {{"none", RobustLoss::none}, {"cauchy", RobustLoss::cauchy}});
  settings.cauchy_scale =
      filter.get_double_or("cauchy_scale", settings.cauchy_scale, {.lowest = 1e-3, .highest = 1e6});
  settings.gate_probability =
      filter.get_double_or("gate_probability", settings.gate_probability,
                           {.lowest = 0, .highest = 1, .without_lowest = true});
  settings.summary = filter.get_enum_or<Summary>("summary", settings.summary,
                                                 {{"best", Summary::best},
                                                  {"merge_two_largest", Summary::merge_two_largest},
                                                  {"whole_mixture", Summary::whole_mixture}});
  settings.reduction = read_reduction(filter);
  return settings;
}

}  // namespace

MethodSettings read_filter(const TomlTable& root) {
  MethodSettings result;
  if (const auto filter = root.find_table("filter")) {
    result.method = filter->get_enum_or<FilterMethod>("method", result.method,
                                                      {{"multi_object", FilterMethod::multi_object},
                                                       {"gm-iekf", FilterMethod::gm_iekf},
                                                       {"riekf", FilterMethod::riekf},
                                                       {"riekf_cauchy", FilterMethod::riekf_cauchy},
                                                       {"max_mixture", FilterMethod::max_mixture},
                                                       {"rbpf", FilterMethod::rbpf}});
    if (result.method == FilterMethod::multi_object) {
      result.multi_object = read_multi_object(*filter);
      result.smoothing = read_smoothing(*filter);
    } else {
      refuse_smoothing(*filter);
      result.filter = read_gaussian_sum(*filter, result.method);
      result.particles = read_particles(*filter);
    }
  }
  if (result.method == FilterMethod::multi_object) read_association(root, result);
  result.name = method_name(result);
  return result;
}

}  // namespace posemix
