// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "mixture.hpp"

#include <nanobind/stl/vector.h>

#include "generic.hpp"
#include "posemix/mixture/moments.hpp"
#include "posemix/mixture/projected_mixture.hpp"
#include "record.hpp"
#include "rules.hpp"
#include "settings.hpp"
#include "words.hpp"

namespace posemix::python {
namespace {

template <class D>
nb::class_<Mixture<D>> bind_mixture_of(nb::module_& m, const char* name) {
  using M = Mixture<D>;
  nb::class_<M> cls(m, name);
  cls.def(
      "__init__",
      [](Unmade<M> self, const std::vector<double>& log_weights, const std::vector<D>& densities) {
        new (self.place) M(M::from_stored(components_of(log_weights, densities)));
      },
      "log_weights"_a, "densities"_a);
  cls.def("__len__", &M::size);
  cls.def_prop_ro(
      "log_weights",
      [](const M& self) {
        NewArray out({self.size()});
        for (std::size_t i = 0; i < self.size(); ++i) out.data[i] = self[i].log_weight;
        return std::move(out.array);
      },
      nb::rv_policy::move);
  cls.def(
      "density",
      [](const M& self, std::size_t i) {
        if (i >= self.size()) throw nb::index_error();
        return self[i].density;
      },
      "index"_a);
  cls.def(
      "prune",
      [](const M& self, double threshold) {
        M pruned = self;
        const double dropped = pruned.prune(threshold);
        return nb::make_tuple(std::move(pruned), dropped);
      },
      "threshold"_a);
  m.def(
      "moments",
      [](const M& mixture, const std::optional<MomentSettings>& settings) {
        const auto result = moments(mixture, settings.value_or(MomentSettings{}));
        return AnyMoments{nb::cast(result.density), result.converged, result.iterations,
                          result.residual};
      },
      "mixture"_a, "settings"_a.none());
  return cls;
}

/// Binds a mixture over one element, with the methods that a mixture over a stack does not have.
template <class D>
nb::class_<Mixture<D>> bind_element_mixture(nb::module_& m, const char* name) {
  using M = Mixture<D>;
  using G = typename D::Group;
  return bind_mixture_of<D>(m, name)
      .def("log_density", &log_densities_at<M>, "points"_a)
      .def(
          "sample",
          [](const M& self, std::size_t count, RandomStream& stream) {
            return drawn(self, count, stream);
          },
          "count"_a, "stream"_a)
      .def(
          "component_log_densities",
          [](const M& self, const Rows& points) {
            require_columns(points, Wire<G>::kSize, "points");
            NewArray out({points.shape(0), self.size()});
            {
              const nb::gil_scoped_release unlocked;
              const std::vector<G> elements = elements_of<G>(points, "points");
              std::ranges::copy(component_log_densities(self, std::span<const G>(elements)),
                                out.data);
            }
            return std::move(out.array);
          },
          "points"_a);
}

/// `Given` is the type of the settings in Python; `settings_of` converts them to those of C++.
template <class D, class Given, class SettingsOf>
void bind_mixture_operations(nb::module_& m, SettingsOf settings_of) {
  using M = Mixture<D>;
  bind_composition<M>(m);
  m.def(
      "fuse",
      [settings_of](const M& p, const M& q, const std::optional<Given>& settings) {
        auto fusion = fuse(p, q, settings_of(settings));
        return AnyFusion{nb::cast(std::move(fusion.density)), fusion.log_overlap, fusion.converged,
                         std::nullopt, std::nullopt};
      },
      "p"_a, "q"_a, "settings"_a.none());
}

template <class G>
void bind_concentrated_operations(nb::module_& m) {
  bind_mixture_operations<ConcentratedGaussian<G>, FuseSettings>(
      m, [](const auto& given) { return given.value_or(FuseSettings{}); });
}

template <class G>
void bind_projected_mixture_operations(nb::module_& m) {
  using Whole = ProjectedMixtureFuseSettings;
  using Given = std::variant<ProjectedFuseSettings, Whole>;
  bind_mixture_operations<ProjectedGaussian<G>, Given>(m, [](const std::optional<Given>& given) {
    if (!given) return Whole{};
    if (const auto* whole = std::get_if<Whole>(&*given)) return *whole;
    Whole settings;
    settings.pair = std::get<ProjectedFuseSettings>(*given);
    return settings;
  });
}

void bind_settings(nb::module_& m) {
  Settings<MomentSettings>(m, "MomentSettings", "Settings of `moments`.")
      .field("max_iterations", &MomentSettings::max_iterations, "int", "Updates of the mean.")
      .field("tolerance", &MomentSettings::tolerance, "float",
             "The mean's last step, or rounding [rad, m].")
      .done();
  Words<PairWeight>(m, "PairWeight", "Weight of a pair in the fusion of projected mixtures.")
      .value(PairWeight::overlap, "The integral of the product of the two densities.")
      .value(PairWeight::alpha_delta, "alpha delta of the MPG paper, eq. 19; not a probability.");
  Settings<ProjectedMixtureFuseSettings>(m, "ProjectedMixtureFuseSettings",
                                         "Settings of `fuse` for mixtures of projected Gaussians.")
      .field("pair", &ProjectedMixtureFuseSettings::pair, "ProjectedFuseSettings",
             "Settings for the fusion of two components.")
      .field("weight", &ProjectedMixtureFuseSettings::weight, "PairWeight", "Weight of a pair.")
      .done();
  Settings<ProjectedMixtureComposeSettings>(
      m, "ProjectedMixtureComposeSettings",
      "Settings of `compose`, `between` and `inverse` for mixtures of projected Gaussians.")
      .field("rule", &ProjectedMixtureComposeSettings::rule, "CompositionRule",
             "Rule by which two components are composed.")
      .field("split_above", &ProjectedMixtureComposeSettings::split_above, "float",
             "A left factor wider in rotation than this standard deviation is split first [rad].")
      .done();
}

void bind_moments(nb::module_& m) {
  m.attr("D") = nb::type_var("D");
  Record<AnyMoments>(m, "Moments", "Mean and covariance of a mixture on its group.",
                     nb::is_generic(), nb::sig("class Moments(typing.Generic[D])"))
      .field("density", &AnyMoments::density, "D", "The density with these moments.")
      .field("converged", &AnyMoments::converged, "bool", "Whether the mean's iteration converged.")
      .field("iterations", &AnyMoments::iterations, "int", "Updates of the mean.")
      .field("residual", &AnyMoments::residual, "float",
             "Norm of the mean's tangent vector at the end [rad, m].")
      .done();
}

}  // namespace

void bind_mixture(nb::module_& m) {
  bind_settings(m);
  bind_moments(m);
  bind_element_mixture<ConcentratedSO3>(m, "MixtureConcentratedSO3");
  bind_element_mixture<ConcentratedSE3>(m, "MixtureConcentratedSE3");
  bind_element_mixture<ProjectedSO3>(m, "MixtureProjectedSO3");
  bind_element_mixture<ProjectedSE3>(m, "MixtureProjectedSE3");
  bind_mixture_of<ConcentratedStack>(m, "MixtureConcentratedStack")
      .def(
          "marginal",
          [](const Mixture<ConcentratedStack>& self, std::size_t i) { return marginal(self, i); },
          "index"_a)
      .def(
          "relative_pose",
          [](const Mixture<ConcentratedStack>& self, std::size_t from, std::size_t to) {
            return relative_pose(self, from, to);
          },
          "from_index"_a, "to_index"_a);
  bind_concentrated_operations<SO3d>(m);
  bind_concentrated_operations<SE3d>(m);
  bind_projected_mixture_operations<SO3d>(m);
  bind_projected_mixture_operations<SE3d>(m);
}

}  // namespace posemix::python
