// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em.hpp"

#include <optional>
#include <type_traits>
#include <typeinfo>

#include <nanobind/typing.h>

#include "generic.hpp"
#include "mixture.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

template <class D>
AnyEmResult any_of(const EmResult<D>& fit) {
  return {nb::cast(fit.mixture),
          fit.log_likelihood,
          fit.history,
          fit.status,
          fit.parameters,
          fit.bic,
          fit.starts};
}

/// Calls f with the samples as rotations or poses, and with the type of density to be fitted.
template <class Function>
auto with_kind(const Rows& samples, bool projected, Function f) {
  if (samples.shape(1) == Wire<SO3d>::kSize) {
    const std::vector<SO3d> all = elements_of<SO3d>(samples, "samples");
    return projected ? f(all, std::type_identity<ProjectedSO3>())
                     : f(all, std::type_identity<ConcentratedSO3>());
  }
  const std::vector<SE3d> all = elements_of<SE3d>(samples, "samples");
  return projected ? f(all, std::type_identity<ProjectedSE3>())
                   : f(all, std::type_identity<ConcentratedSE3>());
}

AnyEmResult fit(const Rows& samples, bool projected, const std::vector<double>& weights,
                const EmSettings& settings, RandomStream& stream, const nb::object& start) {
  return with_kind(samples, projected, [&](const auto& all, auto kind) {
    using D = typename decltype(kind)::type;
    std::optional<Mixture<D>> from;
    try {
      from = nb::cast<std::optional<Mixture<D>>>(start);
    } catch (const std::bad_cast&) {
      throw nb::type_error("start is no mixture of the kind and on the group of the fit");
    }
    std::optional<EmResult<D>> found;
    {
      const nb::gil_scoped_release unlocked;
      found = fit_mixture<D>(all, weights, settings, stream, from);
    }
    return any_of(*found);
  });
}

AnyBicSelection fit_by_bic(const Rows& samples, bool projected, const std::vector<double>& weights,
                           const EmSettings& settings, RandomStream& stream) {
  return with_kind(samples, projected, [&](const auto& all, auto kind) {
    using D = typename decltype(kind)::type;
    std::optional<BicSelection<D>> found;
    {
      const nb::gil_scoped_release unlocked;
      found = fit_mixture_by_bic<D>(all, weights, settings, stream);
    }
    AnyBicSelection selection{{}, found->best};
    for (const EmResult<D>& one : found->fits) selection.fits.push_back(any_of(one));
    return selection;
  });
}

void bind_results(nb::module_& m) {
  using R = AnyEmResult;
  Record<R>(m, "EmResult", "A fitted mixture.", nb::is_generic(),
            nb::sig("class EmResult(typing.Generic[D])"))
      .field("mixture", &R::mixture, "posemix.mixture.Mixture[D]",
             "The most likely mixture that was found.")
      .field("log_likelihood", &R::log_likelihood, "float",
             "Sum of weight times log density over the samples [nats].")
      .field("history", &R::history, "list[float]",
             "Log-likelihood at the start and after every iteration.")
      .field("status", &R::status, "EmStatus", "Reason for which the run ended.")
      .field("parameters", &R::parameters, "int", "Free parameters.")
      .field("bic", &R::bic, "float", "Bayesian information criterion; smaller is better.")
      .field("starts", &R::starts, "int", "Starts that were tried.")
      .done();
  using B = AnyBicSelection;
  Record<B>(m, "BicSelection", "Fits of 1, 2, ... components.", nb::is_generic(),
            nb::sig("class BicSelection(typing.Generic[D])"))
      .field("fits", &B::fits, "list[EmResult[D]]", "Fits; entry k has k + 1 components.")
      .field("best", &B::best, "int", "Index of the fit with the smallest BIC.")
      .done()
      .def_prop_ro(
          "fit", [](const B& self) { return self.fits.at(self.best); },
          nb::sig("def fit(self, /) -> EmResult[D]"), "The best fit.");
}

}  // namespace

void bind_em(nb::module_& m) {
  Words<EmStatus>(m, "EmStatus", "Reason for which an EM run ended.")
      .value(EmStatus::converged, "An iteration gained less than the tolerance.")
      .value(EmStatus::max_iterations, "The limit of iterations was reached before that.")
      .value(EmStatus::degenerate, "A component lost its samples or collapsed.");
  Settings<EmSettings>(m, "EmSettings", "Settings of `fit_mixture`.")
      .field("components", &EmSettings::components, "int", "Number of components.")
      .field("max_iterations", &EmSettings::max_iterations, "int", "Iterations at most.")
      .field("tolerance", &EmSettings::tolerance, "float",
             "Gain of the log-likelihood per unit of weight that ends a run [nats].")
      .field("restarts", &EmSettings::restarts, "int", "Starts, of which the best end is kept.")
      .field("fixed_means", &EmSettings::fixed_means, "bool", "Whether means stay at the start.")
      .field("diagonal", &EmSettings::diagonal, "bool", "Whether covariances are diagonal.")
      .field("unit", &EmSettings::unit, "numpy.typing.ArrayLike",
             "Shape (dof,): one unit per coordinate, in which the two bounds are stated; empty: "
             "1 rad, 1 m.")
      .field("min_sd", &EmSettings::min_sd, "float", "Least standard deviation, in these units.")
      .field("max_sd", &EmSettings::max_sd, "float", "Largest standard deviation, in these units.")
      .done();
  bind_results(m);
  m.def("fit_mixture", &fit, "samples"_a, "projected"_a, "weights"_a, "settings"_a, "stream"_a,
        "start"_a.none());
  m.def("fit_mixture_by_bic", &fit_by_bic, "samples"_a, "projected"_a, "weights"_a, "settings"_a,
        "stream"_a);
}

}  // namespace posemix::python
