// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <variant>

#include <nanobind/stl/variant.h>

#include "density.hpp"
#include "each_pose.hpp"
#include "posemix/detector/symmetry.hpp"
#include "posemix/grasp/success_probability.hpp"
#include "poses.hpp"
#include "record.hpp"
#include "seed.hpp"
#include "settings.hpp"
#include "sides.hpp"

namespace posemix::python {
namespace {

void bind_results(nb::module_& m) {
  using E = SuccessEstimate;
  Record<E>(m, "SuccessEstimate", "A probability by randomised quasi-Monte Carlo.")
      .field("probability", &E::probability, "float", "The estimate.")
      .field("error", &E::error, "float", "One standard error, from the replicates.")
      .field("evaluations", &E::evaluations, "int", "Points at which the density was evaluated.")
      .done();
  using C = GraspCandidate;
  Record<C>(m, "GraspCandidate", "The end that one start of `best_grasp` reached.")
      .field("start", &C::start, "posemix.lie.SE3", "Frame of the grasp at the start.")
      .field("pose", &C::pose, "posemix.lie.SE3", "Frame of the grasp at the end.")
      .field("success", &C::success, "SuccessEstimate", "Probability at the end.")
      .done();
  using B = BestGrasp;
  Record<B>(m, "BestGrasp", "The pose that maximises the probability.")
      .field("pose", &B::pose, "posemix.lie.SE3", "Frame of the grasp.")
      .field("success", &B::success, "SuccessEstimate", "Probability of success at that pose.")
      .field("candidates", &B::candidates, "list[GraspCandidate]",
             "Ends of all starts, best first.")
      .field("evaluations", &B::evaluations, "int",
             "Number of evaluations of the probability during the search.")
      .done();
}

constexpr const char* kBoxDoc =
    R"(The box of poses X = (R, t), in the frame of the grasp, that the grasp tolerates.

It is ``|u_i|`` <= tan(rotation_i / 2), ``|t_i|`` <= translation_i, where R = R(u) in the gnomonic chart
at the identity.)";

void bind_box(nb::module_& m) {
  using B = ToleranceBox;
  Record<B>(m, "ToleranceBox", kBoxDoc)
      .field<Sides>(
          "rotation", &B::rotation, "numpy.typing.ArrayLike",
          "Shape (3,) or (): largest rotation about each axis, at most pi, any turn [rad].")
      .field<Sides>("translation", &B::translation, "numpy.typing.ArrayLike",
                    "Shape (3,) or (): largest translation along each axis [m].")
      .constructible(2)
      .done("\nReferences\n----------\nMPG paper, section V.\n");
}

constexpr const char* kSuccessDoc =
    R"(An unbiased estimate of the probability that a pose lies in m(B) = {m X : X in B}.

Parameters
----------
mixture : Mixture
    Mixture over poses, concentrated or projected.
box : ToleranceBox
    The box B.
m : SE3
    Frame of the grasp in the reference frame of the mixture.
seed : int or RandomStream
    Seed of the randomised points.
settings : SuccessSettings, optional
    Number of points.

Raises
------
ValueError
    For a box with a side that is not positive or a rotation of more than pi, fewer than 2 replicates, or
    no points.

References
----------
MPG paper, section V; Genz, Numerical Computation of Multivariate Normal Probabilities (1992).

Examples
--------
>>> import numpy as np
>>> from posemix import SE3, ConcentratedGaussian, Mixture, ToleranceBox, success_probability
>>> mixture = Mixture([ConcentratedGaussian(SE3(), np.diag([0.01] * 3 + [1e-4] * 3))])
>>> box = ToleranceBox(rotation=1.0, translation=[0.01, 1.0, 1.0])
>>> round(success_probability(mixture, box, SE3(), seed=1).probability, 3)
0.683
)";

constexpr const char* kBestDoc =
    R"(The m that maximises the probability that a pose lies in m(B); the search starts at the heaviest modes.

Parameters
----------
mixture : Mixture
    Mixture over poses.
box : ToleranceBox
    The box B.
seed : int or RandomStream
    Seed of the randomised points.
settings : BestGraspSettings, optional
    Number of starts and of points, stopping criteria.

Raises
------
ValueError
    As for `success_probability`, and for no starts.
)";

using AnyPoseMixture = std::variant<Mixture<ConcentratedSE3>, Mixture<ProjectedSE3>>;

void bind_criterion(nb::module_& m) {
  m.def(
      "success_probability",
      [](const AnyPoseMixture& any, const ToleranceBox& box, const SE3d& at, const Seed& seed,
         const std::optional<SuccessSettings>& settings) {
        const nb::gil_scoped_release unlocked;
        return std::visit(
            [&](const auto& mixture) {
              return success_probability(mixture, box, at, seed.stream(),
                                         settings.value_or(SuccessSettings{}));
            },
            any);
      },
      "mixture"_a, "box"_a, "m"_a, "seed"_a, "settings"_a = nb::none(), kSuccessDoc);
  m.def(
      "best_grasp",
      [](const AnyPoseMixture& any, const ToleranceBox& box, const Seed& seed,
         const std::optional<BestGraspSettings>& settings) {
        const nb::gil_scoped_release unlocked;
        return std::visit(
            [&](const auto& mixture) {
              return best_grasp(mixture, box, seed.stream(),
                                settings.value_or(BestGraspSettings{}));
            },
            any);
      },
      "mixture"_a, "box"_a, "seed"_a, "settings"_a = nb::none(), kBestDoc);
}

void bind_settings(nb::module_& m) {
  Settings<SuccessSettings>(m, "SuccessSettings", "Settings of `success_probability`.")
      .field("points", &SuccessSettings::points, "int",
             "Number of points for every component in every replicate.")
      .field("replicates", &SuccessSettings::replicates, "int",
             "Independent randomisations, at least 2.")
      .done();
  Settings<BestGraspSettings>(m, "BestGraspSettings", "Settings of `best_grasp`.")
      .field("starts", &BestGraspSettings::starts, "int",
             "Number of the heaviest components from whose modes the search starts.")
      .field("points", &BestGraspSettings::points, "int",
             "Number of points per component during the search.")
      .field("max_evaluations", &BestGraspSettings::max_evaluations, "int",
             "Largest number of evaluations of the gradient from every start.")
      .field("tolerance", &BestGraspSettings::tolerance, "float",
             "Relative gain of an iteration that ends the search.")
      .field("final", &BestGraspSettings::final, "SuccessSettings",
             "Sampling of the probabilities that are reported.")
      .done();
}

}  // namespace

void bind_grasp(nb::module_& m) {
  bind_settings(m);
  bind_results(m);
  bind_box(m);
  bind_criterion(m);
  m.def(
      "reduced_error",
      [](const PoseArray& errors, const SymmetryGroup& symmetries) {
        return each_pose(errors, errors, [&](const SE3d& error, const SE3d&) {
          return symmetries.reduced_error(error);
        });
      },
      "error"_a, "symmetry"_a,
      "Errors T_truth^-1 T_estimate, shape (...), against the equivalent truths with the least "
      "rotation.");
  m.def(
      "nearest_equivalent",
      [](const PoseArray& poses, const PoseArray& references, const SymmetryGroup& symmetries) {
        return each_pose(poses, references, [&](const SE3d& pose, const SE3d& reference) {
          return symmetries.nearest_rotation(pose, reference);
        });
      },
      "pose"_a, "reference"_a, "symmetry"_a,
      "The poses equivalent to `pose` whose rotations are nearest to those of `reference`; a "
      "single "
      "one of either stands for all.");
}

}  // namespace posemix::python
