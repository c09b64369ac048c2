// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <variant>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/variant.h>
#include <nanobind/typing.h>

#include "mixture.hpp"

namespace posemix::python {

using AnyCompositionRule =
    std::optional<std::variant<CompositionRule, ProjectedMixtureComposeSettings>>;

template <class X>
constexpr bool kIsProjected = false;
template <class G>
constexpr bool kIsProjected<ProjectedGaussian<G>> = true;

/// The rule or the settings for the composition of densities or mixtures of type X.
template <class X>
auto composition_of(const AnyCompositionRule& given) {
  const auto* settings = given ? std::get_if<ProjectedMixtureComposeSettings>(&*given) : nullptr;
  const auto* rule = given ? std::get_if<CompositionRule>(&*given) : nullptr;
  if constexpr (kIsProjected<X>) {
    if (settings != nullptr) return settings->rule;
    return rule != nullptr ? *rule : CompositionRule::cubature;
  } else {
    if (settings != nullptr) return *settings;
    ProjectedMixtureComposeSettings made;
    if (rule != nullptr) made.rule = *rule;
    return made;
  }
}

template <class X>
struct TakesRule : std::bool_constant<kIsProjected<X>> {};
template <class D>
struct TakesRule<Mixture<D>> : std::bool_constant<kIsProjected<D>> {};

inline void refuse_rule(const AnyCompositionRule& given) {
  if (given) throw InvalidInput("concentrated Gaussians are composed without settings");
}

/// Binds `compose`, `inverse` and `between` of one type of density or mixture.
template <class X>
void bind_composition(nb::module_& m) {
  const auto def = [&](const char* name, auto operation) {
    m.def(
        name,
        [operation](const X& x, const X& y, const AnyCompositionRule& settings) {
          return operation(settings, x, y);
        },
        "x"_a, "y"_a, "settings"_a.none());
  };
  // Calls f with the arguments and, if X takes a rule, with that.
  const auto with_rule = [](auto f) {
    return [f](const AnyCompositionRule& settings, const auto&... xs) {
      if constexpr (TakesRule<X>::value) {
        return f(xs..., composition_of<X>(settings));
      } else {
        refuse_rule(settings);
        return f(xs...);
      }
    };
  };
  const auto inverted = with_rule([](const auto&... a) { return inverse(a...); });
  def("compose", with_rule([](const auto&... a) { return compose(a...); }));
  def("between", with_rule([](const auto&... a) { return between(a...); }));
  m.def(
      "inverse",
      [inverted](const X& x, const AnyCompositionRule& settings) { return inverted(settings, x); },
      "x"_a, "settings"_a.none());
}

}  // namespace posemix::python
