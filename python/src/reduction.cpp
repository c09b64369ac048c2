// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/reduction/reduce.hpp"

#include <nanobind/stl/vector.h>

#include "filter.hpp"
#include "mixture.hpp"
#include "settings.hpp"

namespace posemix::python {
namespace {

nb::object loss_dict(const std::optional<BoundedLoss>& loss) {
  if (!loss) return nb::none();
  nb::dict dict;
  dict["dropped"] = loss->dropped;
  dict["merged_kl"] = loss->merged_kl;
  dict["merged_symmetric_kl"] = loss->merged_symmetric_kl;
  dict["total_variation"] = loss->total_variation;
  dict["kl_from_reduced"] = loss->kl_from_reduced;
  return dict;
}

}  // namespace

nb::dict report_dict(const ReductionReport& report) {
  nb::list merges;
  for (const MergeRecord& merge : report.merges)
    merges.append(nb::make_tuple(merge.weight_a, merge.weight_b, merge.distance));
  nb::list destination;
  for (const std::size_t to : report.destination)
    destination.append(to == kDropped ? nb::object(nb::none()) : nb::object(nb::int_(to)));
  nb::dict dict;
  dict["components_before"] = report.components_before;
  dict["components_pruned"] = report.components_pruned;
  dict["components_after"] = report.components_after;
  dict["weight_pruned"] = report.weight_pruned;
  dict["weight_moved"] = report.weight_moved;
  dict["merges"] = merges;
  dict["destination"] = destination;
  dict["bounded_loss"] = loss_dict(report.bounded_loss);
  dict["converged"] = report.converged;
  return dict;
}

namespace {

void bind_rules(nb::module_& m) {
  nb::enum_<MergeRule>(m, "MergeRule", "How components become one.")
      .value("midway", MergeRule::midway,
             "Moments in the tangent space at the midway point (midway-merge paper, eq. 12-19).")
      .value("tangent_of_larger", MergeRule::tangent_of_larger,
             "Moments in the tangent space of the heaviest (Cesic et al. 2017).")
      .value("moment_matched", MergeRule::moment_matched, "Moments on the group, by cubature.");
  nb::enum_<TransportJacobian>(m, "TransportJacobian", "How a component is moved.")
      .value("exact", TransportJacobian::exact, "Closed form.")
      .value("bernoulli", TransportJacobian::bernoulli, "Truncated series of the midway authors.");
  nb::enum_<PairRule>(m, "PairRule", "Which two components are merged next.")
      .value("largest_with_smallest", PairRule::largest_with_smallest, "By weight.")
      .value("most_distant", PairRule::most_distant, "The largest distance between means.")
      .value("runnalls", PairRule::runnalls, "The smallest of Runnalls' bounds.")
      .value("symmetric_kl", PairRule::symmetric_kl, "The smallest symmetric divergence.")
      .value("weighted_symmetric_kl", PairRule::weighted_symmetric_kl,
             "The same times w_a w_b / (w_a + w_b) (MPG paper, eq. 23-24).");
  nb::enum_<DistanceMetric>(m, "DistanceMetric", "Distance of two means.")
      .value("tangent_norm", DistanceMetric::tangent_norm, "Norm of the logarithm.")
      .value("rotation", DistanceMetric::rotation, "Angle [rad].")
      .value("translation", DistanceMetric::translation, "Translation part [m].")
      .value("mahalanobis", DistanceMetric::mahalanobis, "In standard deviations of both.");
}

void bind_settings(nb::module_& m) {
  Settings<MergeSettings>(m, "MergeSettings", "Settings of `merge`.")
      .field("rule", &MergeSettings::rule, "MergeRule", "How components become one.")
      .field("jacobian", &MergeSettings::jacobian, "TransportJacobian",
             "How a component is moved to the common tangent space.")
      .field("max_iterations", &MergeSettings::max_iterations, "int", "Updates of the mean.")
      .field("tolerance", &MergeSettings::tolerance, "float", "Norm of its last step [rad, m].")
      .done();
  Settings<ReductionSettings>(m, "ReductionSettings", "Settings of `reduce`.")
      .field("prune_below", &ReductionSettings::prune_below, "float",
             "Components with a smaller weight are dropped first.")
      .field("drop_smallest", &ReductionSettings::drop_smallest, "int",
             "So many of the lightest are dropped after pruning.")
      .field("keep_heaviest", &ReductionSettings::keep_heaviest, "int",
             "Only so many are kept, without merging; 0: all.")
      .field("max_components", &ReductionSettings::max_components, "int",
             "Merging goes on until no more are left.")
      .field("merge_from", &ReductionSettings::merge_from, "int",
             "Merging starts at this many; 0: as soon as there are more than max_components.")
      .field("pair", &ReductionSettings::pair, "PairRule", "Which two are merged next.")
      .field("distance", &ReductionSettings::distance, "DistanceMetric",
             "For PairRule.most_distant.")
      .field("merge", &ReductionSettings::merge, "MergeSettings", "How two become one.")
      .field("bound_loss", &ReductionSettings::bound_loss, "bool",
             "Whether the report holds bounds on the loss.")
      .done();
}

template <class D>
void bind_reduce(nb::module_& m) {
  m.def(
      "reduce",
      [](const Mixture<D>& mixture, const ReductionSettings& settings) {
        std::optional<Reduction<D>> result;
        {
          const nb::gil_scoped_release unlocked;
          result = reduce(mixture, settings);
        }
        return nb::make_tuple(std::move(result->mixture), report_dict(result->report));
      },
      "mixture"_a, "settings"_a);
  m.def(
      "merge",
      [](const std::vector<double>& log_weights, const std::vector<D>& densities,
         const MergeSettings& settings) {
        const std::vector<Component<D>> components = components_of(log_weights, densities);
        auto merged = merge(std::span<const Component<D>>(components), settings);
        return nb::make_tuple(merged.component.log_weight, std::move(merged.component.density),
                              merged.converged);
      },
      "log_weights"_a, "densities"_a, "settings"_a);
}

}  // namespace

void bind_reduction(nb::module_& m) {
  bind_rules(m);
  bind_settings(m);
  bind_reduce<ConcentratedSO3>(m);
  bind_reduce<ConcentratedSE3>(m);
  bind_reduce<ConcentratedStack>(m);
  bind_reduce<ProjectedSO3>(m);
  bind_reduce<ProjectedSE3>(m);
}

}  // namespace posemix::python
