// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <variant>

#include <nanobind/stl/array.h>
#include <nanobind/stl/variant.h>

#include "array_like.hpp"
#include "density.hpp"
#include "posemix/detector/error_mixture.hpp"
#include "posemix/grasp/consensus.hpp"
#include "posemix/grasp/tolerance_region.hpp"
#include "poses.hpp"
#include "record.hpp"
#include "seed.hpp"
#include "settings.hpp"

namespace posemix::python {
namespace {

void bind_region_settings(nb::module_& m) {
  using P = RegionPriors;
  Settings<P>(m, "RegionPriors", "Priors of `fit_tolerance_region`: independent normals.")
      .field("centre_rotation_sd_deg", &P::centre_rotation_sd_deg, "float",
             "Standard deviation of the centre about each axis [deg].")
      .field("centre_translation_sd_m", &P::centre_translation_sd_m, "float",
             "Standard deviation of the centre along each axis [m].")
      .field("half_width_deg", &P::half_width_deg, "float",
             "Median of the half widths about the axes [deg].")
      .field("half_width_m", &P::half_width_m, "float",
             "Median of the half widths along the axes [m].")
      .field("log_half_width_sd", &P::log_half_width_sd, "float", "Standard deviation of ln w.")
      .field("softness", &P::softness, "float", "Median of the softness.")
      .field("log_softness_sd", &P::log_softness_sd, "float",
             "Standard deviation of the softness's logarithm.")
      .field("logit_inside", &P::logit_inside, "float", "Mean of logit c1.")
      .field("logit_inside_sd", &P::logit_inside_sd, "float", "Standard deviation of logit c1.")
      .field("logit_outside_ratio", &P::logit_outside_ratio, "float", "Mean of logit(c0 / c1).")
      .field("logit_outside_ratio_sd", &P::logit_outside_ratio_sd, "float",
             "Standard deviation of logit(c0 / c1).")
      .field("lever_sd_m", &P::lever_sd_m, "float",
             "Standard deviation of the lever along each axis [m].")
      .done();
  using F = RegionFitSettings;
  Settings<F>(m, "RegionFitSettings", "Settings of `fit_tolerance_region`.")
      .field("priors", &F::priors, "RegionPriors", "Priors, which hold without outcomes.")
      .field("starts", &F::starts, "int",
             "Number of starts; the first is at the prior's modes, the second at the successes' "
             "median.")
      .field("max_evaluations", &F::max_evaluations, "int",
             "Largest number of evaluations from every start.")
      .field("tolerance", &F::tolerance, "float",
             "Relative gain of the log posterior that ends the search.")
      .done();
}

void bind_region(nb::module_& m) {
  using R = ToleranceRegion;
  Settings<R>(
      m, "ToleranceRegion",
      "Errors of a pose estimate that a grasp forgives: a box with soft walls.\n\n"
      "The error is E = T_truth^-1 T_estimate, with rotation vector phi and translation t in the\n"
      "true object's axes; the box is one in x = (phi, t + phi x lever).")
      .field("centre", &R::centre, "numpy.typing.ArrayLike", "Shape (6,) [rad, m].")
      .field("half_width", &R::half_width, "numpy.typing.ArrayLike",
             "Shape (6,), positive [rad, m]; infinite where everything is forgiven.")
      .field("softness", &R::softness, "float",
             "Softness of the walls, not negative; 0: hard walls.")
      .field("lever", &R::lever, "numpy.typing.ArrayLike",
             "Shape (3,): the point where the fingers meet, true object frame [m].")
      .field("success_inside", &R::success_inside, "float", "Probability well inside.")
      .field("success_outside", &R::success_outside, "float", "Probability far outside.")
      .done()
      .def(
          "success_probability",
          [](const R& self, const PoseArray& errors) {
            validate(self);
            NewArray out(errors.shape);
            for (std::size_t i = 0; i < errors.size(); ++i)
              out.data[i] = self.success_probability(errors[i]);
            return std::move(out.array);
          },
          "errors"_a,
          "Probabilities that grasps with errors T_truth^-1 T_estimate succeed.\n\n"
          "Parameters\n----------\nerrors : SE3, shape (...)\n    Errors.\n\n"
          "Returns\n-------\nndarray, shape (...)\n");
}

std::vector<ErrorOutcome> outcomes_of(const PoseArray& errors, const ArrayLike& results) {
  const std::vector<bool> successes = results.flags();
  if (errors.size() != successes.size()) {
    throw InvalidInput(fmt::format("{} errors and {} successes; expected as many of both",
                                   errors.size(), successes.size()));
  }
  std::vector<ErrorOutcome> outcomes;
  for (std::size_t i = 0; i < errors.size(); ++i) outcomes.push_back({errors[i], successes[i]});
  return outcomes;
}

constexpr const char* kFitDoc =
    R"(The maximum a posteriori region of errors that a grasp tolerates, given outcomes.

Parameters
----------
errors : SE3, shape (n,)
    T_truth^-1 T_estimate of the estimates that the grasps were planned with.
successes : array_like of bool, shape (n,)
    Outcomes of the grasps.
seed : int or RandomStream
    Seed of the starts.
settings : RegionFitSettings, optional
    Priors, number of starts, limits of the search.

Raises
------
ValueError
    For numbers of errors and outcomes that differ, and when there is no start.
)";

constexpr const char* kBootstrapDoc =
    R"(Regions fitted to bootstrap samples of the outcomes, drawn by whole groups.

Parameters
----------
errors, successes, seed, settings
    As for `fit_tolerance_region`.
groups : array_like of int, shape (n,)
    Groups of dependent outcomes, such as those of one image.
count : int
    Number of regions.

Raises
------
ValueError
    As for `fit_tolerance_region`.
)";

void bind_region_fit(nb::module_& m) {
  using R = RegionFit;
  Record<R>(m, "RegionFit", "A fitted region.")
      .field("region", &R::region, "ToleranceRegion", "The most probable region.")
      .field("log_posterior", &R::log_posterior, "float",
             "Log posterior, up to a constant that depends on the settings only [nats].")
      .field("converged", &R::converged, "bool", "Whether the start that was kept converged.")
      .field("successes", &R::successes, "int", "Number of successful outcomes.")
      .field("failures", &R::failures, "int", "Number of failed outcomes.")
      .field("identified", &R::identified, "list[bool]",
             "Whether the outcomes say more about each width than the prior does.")
      .done();
  using S = std::optional<RegionFitSettings>;
  m.def(
      "fit_tolerance_region",
      [](const PoseArray& errors, const ArrayLike& successes, const Seed& seed, const S& settings) {
        const std::vector<ErrorOutcome> outcomes = outcomes_of(errors, successes);
        const nb::gil_scoped_release unlocked;
        return fit_tolerance_region(outcomes, settings.value_or(RegionFitSettings{}),
                                    seed.stream());
      },
      "errors"_a, "successes"_a, "seed"_a, "settings"_a = nb::none(), kFitDoc);
  m.def(
      "bootstrap_regions",
      [](const PoseArray& errors, const ArrayLike& successes, const ArrayLike& groups,
         std::size_t count, const Seed& seed, const S& settings) {
        const std::vector<ErrorOutcome> outcomes = outcomes_of(errors, successes);
        const std::vector<std::size_t> members = groups.indices();
        const nb::gil_scoped_release unlocked;
        return bootstrap_regions(outcomes, members, count, settings.value_or(RegionFitSettings{}),
                                 seed.stream());
      },
      "errors"_a, "successes"_a, "groups"_a, "count"_a, "seed"_a, "settings"_a = nb::none(),
      kBootstrapDoc);
}

constexpr const char* kFuseDoc =
    R"(The normalised product of several estimators' densities of the true pose, by importance sampling.

Parameters
----------
estimates : SE3, shape (n,) or ()
    T_camera_object by every estimator.
errors : ErrorMixture or sequence of n
    Error mixtures of the estimators; a single one is used for all.
seed : int or RandomStream
    Seed of the draws.
settings : ConsensusSettings, optional
    Number of draws, and correlation of the estimators' errors.

Raises
------
ValueError
    Without estimates or draws, for numbers of estimates and error mixtures that differ, and for a correlation
    outside [0, 1].
)";

constexpr const char* kConsensusSuccessDoc =
    R"(Probabilities that grasps planned with the estimates succeed, shape of `estimate`.

Parameters
----------
estimate : SE3, shape (...)
    T_camera_object for which a grasp is planned.
regions : ToleranceRegion or sequence of them
    Tolerance of the grasp; for several regions the mean probability is taken.
symmetry : SymmetryGroup, optional
    Symmetries of the object.

Raises
------
ValueError
    Without a region, and for a region whose widths or probabilities are out of range.
)";

/// One value, or one for each.
template <class Value>
using OneOrMany = std::variant<Value, std::vector<Value>>;

PoseConsensus fused(const PoseArray& estimates, const OneOrMany<ErrorMixture>& errors,
                    const Seed& seed, const std::optional<ConsensusSettings>& settings) {
  const auto* one = std::get_if<ErrorMixture>(&errors);
  const auto* many = std::get_if<std::vector<ErrorMixture>>(&errors);
  if (many != nullptr && many->size() != estimates.size()) {
    throw InvalidInput(fmt::format("{} estimates and {} error mixtures; expected as many of both",
                                   estimates.size(), many->size()));
  }
  std::vector<ConsensusMember> members;
  for (std::size_t i = 0; i < estimates.size(); ++i)
    members.push_back({estimates[i], one != nullptr ? one : &(*many)[i]});
  const nb::gil_scoped_release unlocked;
  return fuse_estimates(members, settings.value_or(ConsensusSettings{}), seed.stream());
}

Array consensus_success(const PoseConsensus& consensus, const PoseArray& estimates,
                        const OneOrMany<ToleranceRegion>& given,
                        const std::optional<SymmetryGroup>& symmetry) {
  const auto* one = std::get_if<ToleranceRegion>(&given);
  const std::vector<ToleranceRegion> regions =
      one != nullptr ? std::vector{*one} : std::get<std::vector<ToleranceRegion>>(given);
  for (const ToleranceRegion& region : regions) validate(region);
  NewArray out(estimates.shape);
  const nb::gil_scoped_release unlocked;
  for (std::size_t i = 0; i < estimates.size(); ++i)
    out.data[i] =
        success_probability(consensus, estimates[i], regions, symmetry.value_or(SymmetryGroup{}));
  return std::move(out.array);
}

void bind_consensus(nb::module_& m) {
  Settings<ConsensusSettings>(m, "ConsensusSettings", "Settings of `fuse_estimates`.")
      .field("draws_per_member", &ConsensusSettings::draws_per_member, "int",
             "Number of draws of the truth per member.")
      .field("correlation", &ConsensusSettings::correlation, "float",
             "Correlation of the members' errors, in [0, 1].")
      .done();
  using C = PoseConsensus;
  Record<C>(m, "PoseConsensus", "Weighted draws of the true pose.")
      .field("truths", &C::truths, "posemix.lie.SE3", "Draws of T_camera_object, shape (n,).")
      .field("weights", &C::weights, kFloatArray, "Weights, which sum to one; shape (n,).")
      .shown_as([](const C& self) {
        return fmt::format("<PoseConsensus of {} draws>", self.truths.size());
      })
      .constructible(2)
      .done()
      .def_prop_ro("effective_draws", &C::effective_draws,
                   "The effective number of draws, 1 / sum of the squared weights.")
      .def("resampled", &C::resampled, "count"_a,
           "`count` draws of equal weight, by systematic resampling.")
      .def("success_probability", &consensus_success, "estimate"_a, "regions"_a,
           "symmetry"_a = nb::none(), kConsensusSuccessDoc);
  m.def("fuse_estimates", &fused, "estimates"_a, "errors"_a, "seed"_a, "settings"_a = nb::none(),
        kFuseDoc);
}

}  // namespace

void bind_tolerance(nb::module_& m) {
  bind_region_settings(m);
  bind_region(m);
  bind_region_fit(m);
  bind_consensus(m);
}

}  // namespace posemix::python
