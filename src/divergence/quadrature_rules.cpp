// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "quadrature_rules.hpp"

#include <algorithm>
#include <numbers>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/special_functions/legendre.hpp>

namespace posemix::internal {
namespace {

KronrodRule make_kronrod() {
  using Rule = boost::math::quadrature::gauss_kronrod<double, 15>;
  using Coarse = boost::math::quadrature::gauss<double, 7>;
  KronrodRule rule{};
  std::size_t next = 0;
  for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
    const double at = Rule::abscissa()[i];
    const double weight = Rule::weights()[i];
    const double difference = i % 2 == 0 ? weight - Coarse::weights()[i / 2] : weight;
    rule.nodes[next++] = {at, weight, difference};
    if (i > 0) rule.nodes[next++] = {-at, weight, difference};
  }
  return rule;
}

template <std::size_t kSize>
std::array<PatchRules::Node, kSize> make_gauss() {
  using Rule = boost::math::quadrature::gauss<double, kSize>;
  std::array<PatchRules::Node, kSize> nodes{};
  std::size_t next = 0;
  for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
    const double at = Rule::abscissa()[i];
    nodes[next++] = {at, Rule::weights()[i]};
    if (at != 0.0) nodes[next++] = {-at, Rule::weights()[i]};
  }
  return nodes;
}

PatchRules make_patch() {
  PatchRules rules{make_gauss<PatchRules::kFine>(), make_gauss<PatchRules::kCoarse>(), {}};
  std::ranges::transform(rules.fine, rules.top_mode.begin(), [](const auto& node) {
    return boost::math::legendre_p(static_cast<int>(PatchRules::kFine) - 2, node.at);
  });
  return rules;
}

DiscRule make_disc() {
  DiscRule rule{};
  int k = 0;
  for (auto& node : rule.nodes) {
    const double zero = boost::math::cyl_bessel_j_zero(0.0, ++k);
    const double slope = boost::math::cyl_bessel_j(1, zero);
    node = {zero / std::numbers::pi, 4.0 / (std::numbers::pi * slope * slope)};
  }
  return rule;
}

}  // namespace

const KronrodRule& KronrodRule::instance() {
  static const KronrodRule rule = make_kronrod();
  return rule;
}

const PatchRules& PatchRules::instance() {
  static const PatchRules rules = make_patch();
  return rules;
}

const DiscRule& DiscRule::instance() {
  static const DiscRule rule = make_disc();
  return rule;
}

}  // namespace posemix::internal
