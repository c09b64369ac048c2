// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/format.h>

#include "sequence_parts.hpp"

namespace posemix {
namespace {

enum class Method { gm_iekf, riekf };

constexpr IntegerRange kComponents{.lowest = 1, .highest = 100000};
constexpr IntegerRange kKeepHeaviest{.lowest = 0, .highest = 100000};
constexpr IntegerRange kMergeFrom{.lowest = 0, .highest = 100000};

ReductionSettings read_reduction(const TomlTable& filter) {
  ReductionSettings r;
  const auto integer = [&](std::string_view key, std::size_t otherwise, const IntegerRange& range) {
    return static_cast<std::size_t>(
        filter.get_integer_or(key, static_cast<std::int64_t>(otherwise), range));
  };
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

std::string method_name(Method method, const FilterSettings& settings) {
  const bool iterated = settings.update == UpdateRule::iterated;
  if (method == Method::riekf) return iterated ? "riekf (iterated)" : "riekf";
  return fmt::format("gm-iekf ({}{})", name_of(settings.reduction.merge.rule),
                     iterated ? ", iterated" : "");
}

}  // namespace

MethodSettings read_filter(const TomlTable& root) {
  MethodSettings result;
  Method method = Method::gm_iekf;
  FilterSettings& settings = result.filter;
  if (const auto filter = root.find_table("filter")) {
    method = filter->get_enum_or<Method>("method", method,
                                         {{"gm-iekf", Method::gm_iekf}, {"riekf", Method::riekf}});
    settings.noise_use = filter->get_enum_or<NoiseUse>(
        "noise_use", settings.noise_use,
        {{"per_object", NoiseUse::per_object}, {"joint", NoiseUse::joint}});
    settings.update = filter->get_enum_or<UpdateRule>(
        "update", settings.update,
        {{"linearized", UpdateRule::linearized}, {"iterated", UpdateRule::iterated}});
    settings.gate_probability =
        filter->get_double_or("gate_probability", settings.gate_probability,
                              {.lowest = 0, .highest = 1, .without_lowest = true});
    settings.summary =
        filter->get_enum_or<Summary>("summary", settings.summary,
                                     {{"best", Summary::best},
                                      {"merge_two_largest", Summary::merge_two_largest},
                                      {"whole_mixture", Summary::whole_mixture}});
    settings.reduction = read_reduction(*filter);
  }
  result.riekf = method == Method::riekf;
  result.name = method_name(method, settings);
  return result;
}

}  // namespace posemix
