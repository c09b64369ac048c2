// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em.hpp"

#include <optional>

#include "mixture.hpp"
#include "settings.hpp"

namespace posemix::python {
namespace {

template <class D>
nb::tuple result_tuple(const EmResult<D>& fit) {
  return nb::make_tuple(fit.mixture, fit.log_likelihood, fit.history, fit.status, fit.parameters,
                        fit.bic, fit.starts);
}

template <class D>
void bind_fit(nb::module_& m, const char* name) {
  using G = typename D::Group;
  m.def((std::string("fit_") + name).c_str(),
        [](const Rows& samples, const std::vector<double>& weights, const EmSettings& settings,
           RandomStream& stream, const std::optional<Mixture<D>>& start) {
          const std::vector<G> elements = elements_of<G>(samples, "samples");
          std::optional<EmResult<D>> fit;
          {
            const nb::gil_scoped_release unlocked;
            fit = fit_mixture<D>(elements, weights, settings, stream, start);
          }
          return result_tuple(*fit);
        },
        "samples"_a, "weights"_a, "settings"_a, "stream"_a, "start"_a.none());
  m.def((std::string("fit_by_bic_") + name).c_str(),
        [](const Rows& samples, const std::vector<double>& weights, const EmSettings& settings,
           RandomStream& stream) {
          const std::vector<G> elements = elements_of<G>(samples, "samples");
          std::optional<BicSelection<D>> selection;
          {
            const nb::gil_scoped_release unlocked;
            selection = fit_mixture_by_bic<D>(elements, weights, settings, stream);
          }
          nb::list fits;
          for (const auto& fit : selection->fits) fits.append(result_tuple(fit));
          return nb::make_tuple(fits, selection->best);
        },
        "samples"_a, "weights"_a, "settings"_a, "stream"_a);
}

}  // namespace

void bind_em(nb::module_& m) {
  nb::enum_<EmStatus>(m, "EmStatus", "How an EM run ended.")
      .value("converged", EmStatus::converged, "An iteration gained less than the tolerance.")
      .value("max_iterations", EmStatus::max_iterations, "Stopped before that.")
      .value("degenerate", EmStatus::degenerate, "A component lost its samples or collapsed.");
  Settings<EmSettings>(m, "EmSettings", "Settings of `fit_mixture`.")
      .field("components", &EmSettings::components, "int", "Number of components.")
      .field("max_iterations", &EmSettings::max_iterations, "int", "Iterations at most.")
      .field("tolerance", &EmSettings::tolerance, "float",
             "Of the log-likelihood's gain per unit of weight [nats].")
      .field("restarts", &EmSettings::restarts, "int", "Starts, of which the best end is kept.")
      .field("fixed_means", &EmSettings::fixed_means, "bool", "Whether means stay at the start.")
      .field("diagonal", &EmSettings::diagonal, "bool", "Whether covariances are diagonal.")
      .field("min_sd", &EmSettings::min_sd, "float", "Least standard deviation [rad, m].")
      .field("max_sd", &EmSettings::max_sd, "float", "Largest standard deviation [rad, m].")
      .done();
  bind_fit<ConcentratedSO3>(m, "concentrated_so3");
  bind_fit<ConcentratedSE3>(m, "concentrated_se3");
  bind_fit<ProjectedSO3>(m, "projected_so3");
  bind_fit<ProjectedSE3>(m, "projected_se3");
}

}  // namespace posemix::python
