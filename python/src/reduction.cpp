// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/reduction/reduce.hpp"

#include <nanobind/stl/vector.h>
#include <nanobind/typing.h>

#include "generic.hpp"
#include "mixture.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

void bind_rules(nb::module_& m) {
  Words<MergeRule>(m, "MergeRule", "Rule by which components become one.")
      .value(MergeRule::midway,
             "Moments in the tangent space at the midway point (midway-merge paper, eq. 12-19).")
      .value(MergeRule::tangent_of_larger,
             "Moments in the tangent space of the heaviest (Cesic et al. 2017).")
      .value(MergeRule::moment_matched, "Moments on the group, by cubature.");
  Words<TransportJacobian>(m, "TransportJacobian", "Jacobian with which a component is moved.")
      .value(TransportJacobian::exact, "The closed form.")
      .value(TransportJacobian::bernoulli, "The truncated series of the midway authors.");
  Words<PairRule>(m, "PairRule", "Rule that chooses the two components that are merged next.")
      .value(PairRule::largest_with_smallest, "The heaviest with the lightest.")
      .value(PairRule::most_distant, "The largest distance between means.")
      .value(PairRule::runnalls, "The smallest of Runnalls' bounds.")
      .value(PairRule::symmetric_kl, "The smallest symmetric divergence.")
      .value(
          PairRule::weighted_symmetric_kl,
          "The smallest symmetric divergence times w_a w_b / (w_a + w_b) (MPG paper, eq. 23-24).");
  Words<DistanceMetric>(m, "DistanceMetric", "Distance of two means.")
      .value(DistanceMetric::tangent_norm, "Norm of the logarithm.")
      .value(DistanceMetric::rotation, "Angle [rad].")
      .value(DistanceMetric::translation, "Translation part [m].")
      .value(DistanceMetric::mahalanobis, "Distance in standard deviations of both.");
}

void bind_settings(nb::module_& m) {
  Settings<MergeSettings>(m, "MergeSettings", "Settings of `merge`.")
      .field("rule", &MergeSettings::rule, "MergeRule", "Rule by which components become one.")
      .field("jacobian", &MergeSettings::jacobian, "TransportJacobian",
             "Jacobian with which a component is moved to the common tangent space.")
      .field("max_iterations", &MergeSettings::max_iterations, "int",
             "Largest number of updates of the mean.")
      .field("tolerance", &MergeSettings::tolerance, "float",
             "Norm of the last step of the mean [rad, m].")
      .done();
  Settings<ReductionSettings>(m, "ReductionSettings", "Settings of `reduce`.")
      .field("prune_below", &ReductionSettings::prune_below, "float",
             "Weight below which components are dropped first.")
      .field("drop_smallest", &ReductionSettings::drop_smallest, "int",
             "Number of the lightest components that are dropped after pruning.")
      .field("keep_heaviest", &ReductionSettings::keep_heaviest, "int",
             "Number of components that are kept, without merging; 0: all.")
      .field("max_components", &ReductionSettings::max_components, "int",
             "Number of components at which merging ends.")
      .field("merge_from", &ReductionSettings::merge_from, "int",
             "Number of components at which merging starts; 0: as soon as there are more than "
             "max_components.")
      .field("pair", &ReductionSettings::pair, "PairRule",
             "Rule that chooses the two components that are merged next.")
      .field("distance", &ReductionSettings::distance, "DistanceMetric",
             "Distance of two means for PairRule.most_distant.")
      .field("merge", &ReductionSettings::merge, "MergeSettings",
             "Settings for the merge of two components.")
      .field("bound_loss", &ReductionSettings::bound_loss, "bool",
             "Whether the report holds bounds on the loss.")
      .done();
}

nb::list destinations(const std::vector<std::size_t>& destination) {
  nb::list all;
  for (const std::size_t to : destination)
    all.append(to == kDropped ? nb::object(nb::none()) : nb::object(nb::int_(to)));
  return all;
}

void bind_report(nb::module_& m) {
  using L = BoundedLoss;
  Record<L>(m, "BoundedLoss", "Bounds on the loss of a reduction.")
      .field("dropped", &L::dropped, "float", "Weight of the components that were dropped.")
      .field("merged_kl", &L::merged_kl, "float",
             "Bound on the divergence that merging caused [nats].")
      .field("merged_symmetric_kl", &L::merged_symmetric_kl, "float",
             "Bound on the symmetric divergence that merging caused [nats].")
      .field("total_variation", &L::total_variation, "float",
             "Bound on the change of the probability of any set, of the whole reduction.")
      .field("kl_from_reduced", &L::kl_from_reduced, "float",
             "Bound on the divergence from the reduced mixture to the full one [nats].")
      .done();
  using M = MergeRecord;
  Record<M>(m, "MergeRecord", "One merge; weights are fractions of the mixture.")
      .field("weight_a", &M::weight_a, "float", "Weight of the first component.")
      .field("weight_b", &M::weight_b, "float", "Weight of the second component.")
      .field("distance", &M::distance, "float", "Distance of the means before the merge [rad, m].")
      .done();
  using R = ReductionReport;
  Record<R>(m, "ReductionReport", "Report of `reduce`.")
      .field("components_before", &R::components_before, "int", "Number of components before.")
      .field("components_pruned", &R::components_pruned, "int",
             "Number of components that were dropped.")
      .field("components_after", &R::components_after, "int", "Number of components after.")
      .field("weight_pruned", &R::weight_pruned, "float", "Weight that was dropped.")
      .field("weight_moved", &R::weight_moved, "float",
             "Sum over the merges of the smaller of both weights.")
      .field("merges", &R::merges, "list[MergeRecord]", "Merges in their order.")
      .field(
          "destination", &R::destination, "list[int | None]",
          "Index, for every component before, of the component after that holds it; None where it "
          "was dropped.",
          &destinations)
      .field("bounded_loss", &R::bounded_loss, "BoundedLoss | None",
             "Bounds on the loss, where they were asked for.")
      .field("converged", &R::converged, "bool", "Whether every merge converged.")
      .done();
}

void bind_results(nb::module_& m) {
  bind_report(m);
  using Merge = AnyMerge;
  Record<Merge>(m, "MergeResult", "Result of `merge`: one component in place of several.",
                nb::is_generic(), nb::sig("class MergeResult(typing.Generic[D])"))
      .field("density", &Merge::density, "D", "The density of the component.")
      .field("log_weight", &Merge::log_weight, "float", "Logarithm of the summed weight.")
      .field("converged", &Merge::converged, "bool", "Whether the mean's iteration converged.")
      .done();
  Record<AnyReduction>(m, "Reduction", "Result of `reduce`.", nb::is_generic(),
                       nb::sig("class Reduction(typing.Generic[D])"))
      .field("mixture", &AnyReduction::mixture, "posemix.mixture.Mixture[D]",
             "The mixture with fewer components.")
      .field("report", &AnyReduction::report, "ReductionReport", "Report of the reduction.")
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
        return AnyReduction{nb::cast(std::move(result->mixture)), std::move(result->report)};
      },
      "mixture"_a, "settings"_a);
  m.def(
      "merge",
      [](const std::vector<double>& log_weights, const std::vector<D>& densities,
         const MergeSettings& settings) {
        const std::vector<Component<D>> components = components_of(log_weights, densities);
        auto merged = merge(std::span<const Component<D>>(components), settings);
        return AnyMerge{nb::cast(std::move(merged.component.density)), merged.component.log_weight,
                        merged.converged};
      },
      "log_weights"_a, "densities"_a, "settings"_a);
}

}  // namespace

void bind_reduction(nb::module_& m) {
  bind_rules(m);
  bind_settings(m);
  bind_results(m);
  bind_reduce<ConcentratedSO3>(m);
  bind_reduce<ConcentratedSE3>(m);
  bind_reduce<ConcentratedStack>(m);
  bind_reduce<ProjectedSO3>(m);
  bind_reduce<ProjectedSE3>(m);
}

}  // namespace posemix::python
