// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>

#include <nanobind/stl/array.h>

#include "density.hpp"
#include "dict.hpp"
#include "posemix/detector/error_mixture.hpp"
#include "posemix/grasp/consensus.hpp"
#include "posemix/grasp/tolerance_region.hpp"
#include "poses.hpp"
#include "record.hpp"
#include "settings.hpp"

namespace posemix::python {
namespace {

void bind_region_settings(nb::module_& m) {
  using P = RegionPriors;
  Settings<P>(m, "RegionPriors", "Priors of `fit_tolerance_region`: independent normals.")
      .field("centre_rotation_sd_deg", &P::centre_rotation_sd_deg, "float", "About each axis.")
      .field("centre_translation_sd_m", &P::centre_translation_sd_m, "float", "Along each axis.")
      .field("half_width_deg", &P::half_width_deg, "float", "Median.")
      .field("half_width_m", &P::half_width_m, "float", "Median.")
      .field("log_half_width_sd", &P::log_half_width_sd, "float", "Of ln w.")
      .field("softness", &P::softness, "float", "Median.")
      .field("log_softness_sd", &P::log_softness_sd, "float", "Of its logarithm.")
      .field("logit_inside", &P::logit_inside, "float", "Mean of logit c1.")
      .field("logit_inside_sd", &P::logit_inside_sd, "float", "Its standard deviation.")
      .field("logit_outside_ratio", &P::logit_outside_ratio, "float", "Mean of logit(c0 / c1).")
      .field("logit_outside_ratio_sd", &P::logit_outside_ratio_sd, "float",
             "Its standard deviation.")
      .field("lever_sd_m", &P::lever_sd_m, "float", "Along each axis.")
      .done();
  using F = RegionFitSettings;
  Settings<F>(m, "RegionFitSettings", "Settings of `fit_tolerance_region`.")
      .field("priors", &F::priors, "RegionPriors", "What is known without outcomes.")
      .field("starts", &F::starts, "int",
             "The first at the prior's modes, the second at the successes' median.")
      .field("max_evaluations", &F::max_evaluations, "int", "For every start.")
      .field("tolerance", &F::tolerance, "float", "Relative, of the log posterior.")
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
      .field("softness", &R::softness, "float", "Of the walls, not negative; 0: hard walls.")
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

std::vector<ErrorOutcome> outcomes_of(const PoseArray& errors, const std::vector<bool>& successes) {
  if (errors.size() != successes.size()) {
    throw InvalidInput(fmt::format("{} errors and {} successes; expected as many of both",
                                   errors.size(), successes.size()));
  }
  std::vector<ErrorOutcome> outcomes;
  for (std::size_t i = 0; i < errors.size(); ++i) outcomes.push_back({errors[i], successes[i]});
  return outcomes;
}

void bind_region_fit(nb::module_& m) {
  using R = RegionFit;
  Record<R>(m, "RegionFit", "A fitted region.")
      .field("region", &R::region, "ToleranceRegion", "The most probable one.")
      .field("log_posterior", &R::log_posterior, "float",
             "Up to a constant that depends on the settings only [nats].")
      .field("converged", &R::converged, "bool", "Of the start that was kept.")
      .field("successes", &R::successes, "int", "Number of successful outcomes.")
      .field("failures", &R::failures, "int", "Number of failed outcomes.")
      .field("identified", &R::identified, "list[bool]",
             "For every width, whether the outcomes say more about it than the prior does.")
      .done();
  m.def("fit_tolerance_region", [](const PoseArray& errors, const std::vector<bool>& successes,
                                   const RegionFitSettings& settings, RandomStream& stream) {
    const std::vector<ErrorOutcome> outcomes = outcomes_of(errors, successes);
    std::optional<RegionFit> fit;
    {
      const nb::gil_scoped_release unlocked;
      fit = fit_tolerance_region(outcomes, settings, stream);
    }
    return *fit;
  });
  m.def("bootstrap_regions", [](const PoseArray& errors, const std::vector<bool>& successes,
                                const std::vector<std::size_t>& groups, std::size_t count,
                                const RegionFitSettings& settings, RandomStream& stream) {
    const std::vector<ErrorOutcome> outcomes = outcomes_of(errors, successes);
    const nb::gil_scoped_release unlocked;
    return bootstrap_regions(outcomes, groups, count, settings, stream);
  });
}

std::vector<const ErrorMixture*> pointers(const nb::sequence& mixtures) {
  std::vector<const ErrorMixture*> all;
  for (const nb::handle mixture : mixtures) all.push_back(nb::cast<const ErrorMixture*>(mixture));
  return all;
}

void bind_consensus(nb::module_& m) {
  Settings<ConsensusSettings>(m, "ConsensusSettings", "Settings of `fuse_estimates`.")
      .field("draws_per_member", &ConsensusSettings::draws_per_member, "int", "Of the truth.")
      .field("correlation", &ConsensusSettings::correlation, "float",
             "Of the members' errors, in [0, 1].")
      .done();
  m.def("fuse_estimates", [](const PoseArray& estimates, const nb::sequence& errors,
                             const ConsensusSettings& settings, RandomStream& stream) {
    const std::vector<const ErrorMixture*> mixtures = pointers(errors);
    if (mixtures.size() != estimates.size()) {
      throw InvalidInput(fmt::format("{} estimates and {} error mixtures; expected as many of both",
                                     estimates.size(), mixtures.size()));
    }
    std::vector<ConsensusMember> members;
    for (std::size_t i = 0; i < mixtures.size(); ++i)
      members.push_back({estimates[i], mixtures[i]});
    std::optional<PoseConsensus> consensus;
    {
      const nb::gil_scoped_release unlocked;
      consensus = fuse_estimates(members, settings, stream);
    }
    return nb::make_tuple(PoseArray::of(consensus->truths), vector_array(consensus->weights));
  });
}

void bind_consensus_uses(nb::module_& m) {
  m.def("resample_consensus",
        [](const PoseArray& truths, const Eigen::VectorXd& weights, std::size_t count) {
          const PoseConsensus drawn = PoseConsensus{truths.poses(), weights}.resampled(count);
          return nb::make_tuple(PoseArray::of(drawn.truths), vector_array(drawn.weights));
        });
  m.def(
      "consensus_success",
      [](const PoseArray& truths, const Eigen::VectorXd& weights, const PoseArray& estimates,
         const std::vector<ToleranceRegion>& regions, const SymmetryGroup& symmetries) {
        for (const ToleranceRegion& region : regions) validate(region);
        const PoseConsensus consensus{truths.poses(), weights};
        NewArray out(estimates.shape);
        const nb::gil_scoped_release unlocked;
        for (std::size_t i = 0; i < estimates.size(); ++i)
          out.data[i] = success_probability(consensus, estimates[i], regions, symmetries);
        return std::move(out.array);
      },
      "truths"_a, "weights"_a, "estimates"_a, "regions"_a, "symmetries"_a);
}

}  // namespace

void bind_tolerance(nb::module_& m) {
  bind_region_settings(m);
  bind_region(m);
  bind_region_fit(m);
  bind_consensus(m);
  bind_consensus_uses(m);
}

}  // namespace posemix::python
