// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "density.hpp"
#include "posemix/detector/symmetry.hpp"
#include "posemix/grasp/success_probability.hpp"
#include "poses.hpp"
#include "record.hpp"
#include "settings.hpp"

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
  Record<C>(m, "GraspCandidate", "Where one start of `best_grasp` ended.")
      .field("start", &C::start, "posemix.lie.SE3", "Frame of the grasp at the start.")
      .field("pose", &C::pose, "posemix.lie.SE3", "Frame of the grasp at the end.")
      .field("success", &C::success, "SuccessEstimate", "Probability at the end.")
      .done();
  using B = BestGrasp;
  Record<B>(m, "BestGrasp", "The pose that maximises the probability.")
      .field("pose", &B::pose, "posemix.lie.SE3", "Frame of the grasp.")
      .field("success", &B::success, "SuccessEstimate", "Its probability.")
      .field("candidates", &B::candidates, "list[GraspCandidate]",
             "What every start found, best first.")
      .field("evaluations", &B::evaluations, "int", "Of the probability while searching.")
      .done();
}

template <class D>
void bind_criterion(nb::module_& m) {
  m.def("success_probability", [](const Mixture<D>& mixture, const Eigen::Vector3d& rotation,
                                  const Eigen::Vector3d& translation, const SE3d& at,
                                  RandomStream& stream, const SuccessSettings& settings) {
    std::optional<SuccessEstimate> estimate;
    {
      const nb::gil_scoped_release unlocked;
      estimate = success_probability(mixture, {rotation, translation}, at, stream, settings);
    }
    return *estimate;
  });
  m.def("best_grasp", [](const Mixture<D>& mixture, const Eigen::Vector3d& rotation,
                         const Eigen::Vector3d& translation, RandomStream& stream,
                         const BestGraspSettings& settings) {
    std::optional<BestGrasp> best;
    {
      const nb::gil_scoped_release unlocked;
      best = best_grasp(mixture, {rotation, translation}, stream, settings);
    }
    return *best;
  });
}

void bind_settings(nb::module_& m) {
  Settings<SuccessSettings>(m, "SuccessSettings", "Settings of `success_probability`.")
      .field("points", &SuccessSettings::points, "int", "For every component in every replicate.")
      .field("replicates", &SuccessSettings::replicates, "int",
             "Independent randomisations, at least 2.")
      .done();
  Settings<BestGraspSettings>(m, "BestGraspSettings", "Settings of `best_grasp`.")
      .field("starts", &BestGraspSettings::starts, "int",
             "The modes of so many of the heaviest components.")
      .field("points", &BestGraspSettings::points, "int", "Per component while searching.")
      .field("max_evaluations", &BestGraspSettings::max_evaluations, "int",
             "Of the gradient, for every start.")
      .field("tolerance", &BestGraspSettings::tolerance, "float",
             "Stop when an iteration gains less, relative.")
      .field("final", &BestGraspSettings::final, "SuccessSettings",
             "For the probabilities reported.")
      .done();
}

/// f(x_i, y_i) for two arrays of poses; one of them may be a single pose.
template <class Function>
PoseArray each_pose(const PoseArray& x, const PoseArray& y, Function f) {
  if (x.shape != y.shape && !x.shape.empty() && !y.shape.empty())
    throw InvalidInput(fmt::format("{} poses and {}; expected one shape", x.size(), y.size()));
  const PoseArray& longer = x.shape.empty() ? y : x;
  NewArray out({longer.size(), 7});
  for (std::size_t i = 0; i < longer.size(); ++i) {
    const SE3d pose = f(x[x.shape.empty() ? 0 : i], y[y.shape.empty() ? 0 : i]);
    Wire<SE3d>::write(pose, out.data + 7 * i);
  }
  return PoseArray::of(std::move(out.array), longer.shape);
}

}  // namespace

void bind_grasp(nb::module_& m) {
  bind_settings(m);
  bind_results(m);
  bind_criterion<ConcentratedSE3>(m);
  bind_criterion<ProjectedSE3>(m);
  m.def("reduced_error", [](const PoseArray& errors, const SymmetryGroup& symmetries) {
    return each_pose(errors, errors, [&](const SE3d& error, const SE3d&) {
      return symmetries.reduced_error(error);
    });
  });
  m.def("nearest_equivalent",
        [](const PoseArray& poses, const PoseArray& references, const SymmetryGroup& symmetries) {
          return each_pose(poses, references, [&](const SE3d& pose, const SE3d& reference) {
            return symmetries.nearest_rotation(pose, reference);
          });
        });
}

}  // namespace posemix::python
