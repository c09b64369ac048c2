// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/divergence/monte_carlo.hpp"

#include <optional>

#include <nanobind/typing.h>

#include "generic.hpp"
#include "mixture.hpp"
#include "posemix/divergence/conversion.hpp"
#include "posemix/divergence/gaussian.hpp"
#include "posemix/divergence/projected.hpp"
#include "posemix/divergence/wasserstein.hpp"
#include "record.hpp"
#include "settings.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

/// Binds the estimates between mixtures of two kinds.
template <class P, class Q>
void bind_pair(nb::module_& m) {
  using Sampling = DivergenceSamplingSettings;
  const auto def = [&](const char* name, auto function) {
    m.def(
        name,
        [function](const Mixture<P>& p, const Mixture<Q>& q, RandomStream& stream,
                   const Sampling& settings) {
          std::optional<DivergenceEstimate> estimate;
          {
            const nb::gil_scoped_release unlocked;
            estimate = function(p, q, stream, settings);
          }
          return *estimate;
        },
        "p"_a, "q"_a, "stream"_a, "settings"_a);
  };
  def("kl_monte_carlo", [](const Mixture<P>& p, const Mixture<Q>& q, RandomStream& r,
                           const Sampling& s) { return kl_monte_carlo(p, q, r, s); });
  def("symmetric_kl_monte_carlo",
      [](const Mixture<P>& p, const Mixture<Q>& q, RandomStream& r, const Sampling& s) {
        return symmetric_kl_monte_carlo(p, q, r, s);
      });
  def("isd_monte_carlo", [](const Mixture<P>& p, const Mixture<Q>& q, RandomStream& r,
                            const Sampling& s) { return isd_monte_carlo(p, q, r, s); });
}

template <class G>
void bind_concentrated(nb::module_& m) {
  using C = ConcentratedGaussian<G>;
  bind_pair<C, C>(m);
  m.def("gaussian_kl", [](const C& p, const C& q) { return gaussian_kl(p, q); });
  m.def("gaussian_wasserstein", [](const C& p, const C& q, double length_scale) {
    return gaussian_wasserstein(p, q, length_scale);
  });
  m.def("mixture_wasserstein", [](const Mixture<C>& p, const Mixture<C>& q, double length_scale) {
    return mixture_wasserstein(p, q, length_scale);
  });
  m.def("runnalls_bound", [](double log_a, const C& a, double log_b, const C& b) {
    return runnalls_bound(Component<C>{log_a, a}, Component<C>{log_b, b});
  });
}

template <class G>
void bind_group(nb::module_& m) {
  using C = ConcentratedGaussian<G>;
  using P = ProjectedGaussian<G>;
  bind_concentrated<G>(m);
  bind_pair<C, P>(m);
  bind_pair<P, C>(m);
  bind_pair<P, P>(m);
  m.def("gaussian_kl", [](const P& p, const P& q) { return gaussian_kl(p, q); });
  m.def("exact_kl", [](const P& p, const P& q) { return exact_kl(p, q); });
  m.def("runnalls_bound", [](double log_a, const P& a, double log_b, const P& b) {
    return runnalls_bound(Component<P>{log_a, a}, Component<P>{log_b, b});
  });
  using Settings = ConversionSettings;
  const auto converted = [](auto&& conversion) {
    return AnyConversion{nb::cast(std::move(conversion.mixture)),
                         conversion.kl_lost,
                         conversion.kl_error,
                         conversion.largest_component_kl,
                         conversion.components_split,
                         conversion.converged,
                         conversion.within_limit};
  };
  m.def("to_projected", [converted](const Mixture<C>& x, RandomStream& r, const Settings& s) {
    return converted(to_projected(x, r, s));
  });
  m.def("to_concentrated", [converted](const Mixture<P>& x, RandomStream& r, const Settings& s) {
    return converted(to_concentrated(x, r, s));
  });
}

void bind_results(nb::module_& m) {
  using E = DivergenceEstimate;
  Record<E>(m, "DivergenceEstimate", "A sampled divergence.")
      .field("value", &E::value, "float",
             "The divergence [nats], or the integral square distance [rad^-3 m^-3].")
      .field("error", &E::error, "float", "One standard error.")
      .field("evaluations", &E::evaluations, "int", "Points at which the densities were evaluated.")
      .field("converged", &E::converged, "bool",
             "Whether a tolerance was met; always true for sampling.")
      .done();
  using C = AnyConversion;
  Record<C>(m, "Conversion", "A mixture of the other kind.", nb::is_generic(),
            nb::sig("class Conversion(typing.Generic[D])"))
      .field("mixture", &C::mixture, "posemix.mixture.Mixture[D]", "The converted mixture.")
      .field("kl_lost", &C::kl_lost, "float", "D(original || converted) [nats].")
      .field("kl_error", &C::kl_error, "float", "Standard error of `kl_lost` [nats].")
      .field("largest_component_kl", &C::largest_component_kl, "float",
             "The largest of the components' own divergences [nats].")
      .field("components_split", &C::components_split, "int", "Components that became several.")
      .field("converged", &C::converged, "bool", "Whether every iterated mean converged.")
      .field("within_limit", &C::within_limit, "bool",
             "Whether every component's loss meets the limit.")
      .done();
}

void bind_settings(nb::module_& m) {
  using Sampling = DivergenceSamplingSettings;
  Settings<Sampling>(m, "DivergenceSamplingSettings", "Settings of the sampled divergences.")
      .field("samples", &Sampling::samples, "int", "Points in all.")
      .field("replicates", &Sampling::replicates, "int",
             "Independent randomisations, for the standard error.")
      .done();
  Words<ConversionRule>(m, "ConversionRule", "Rule by which one kind of density becomes the other.")
      .value(ConversionRule::linear, "The linearisation at the mean.")
      .value(ConversionRule::cubature, "Moments in the other chart, degree five.")
      .value(ConversionRule::maximum_likelihood, "The least divergence.");
  Words<LargeLoss>(m, "LargeLoss", "Treatment of a component that converts badly.")
      .value(LargeLoss::split, "The component is split until its loss meets the limit.")
      .value(LargeLoss::refuse, "An error.")
      .value(LargeLoss::accept, "The component is converted all the same.");
  Settings<ConversionSettings>(m, "ConversionSettings",
                               "Settings of `to_projected` and `to_concentrated`.")
      .field("rule", &ConversionSettings::rule, "ConversionRule",
             "Rule by which a component is converted.")
      .field("max_kl", &ConversionSettings::max_kl, "float",
             "Divergence that a component may lose [nats].")
      .field("on_large_loss", &ConversionSettings::on_large_loss, "LargeLoss",
             "Treatment of a component that loses more.")
      .field("max_pieces", &ConversionSettings::max_pieces, "int",
             "Largest number of pieces of one component.")
      .field("sampling", &ConversionSettings::sampling, "DivergenceSamplingSettings",
             "Sampling by which the loss is measured.")
      .done();
}

}  // namespace

void bind_divergence(nb::module_& m) {
  bind_settings(m);
  bind_results(m);
  bind_group<SO3d>(m);
  bind_group<SE3d>(m);
  bind_concentrated<PoseStackd>(m);
}

}  // namespace posemix::python
