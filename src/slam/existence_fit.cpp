// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlopt.hpp>

#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/slam/existence.hpp"

namespace posemix {
namespace {

/// The instances that a given birth probability counts as.
constexpr double kPriorInstances = 2.0;

/// Parameters of a beta distribution lie within these.
constexpr double kLeastParameter = 0.05;
constexpr double kMostParameter = 200.0;

double log_beta(double a, double b) { return std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b); }

struct RateProblem {
  std::vector<InstanceCounts> counts;
  BetaDistribution prior;
};

/// Log of the beta-binomial probability of the counts after a first detection, which makes a larger
/// by one, and of the prior: normal with a deviation of one in log a and log b.
double log_posterior(const RateProblem& problem, const BetaDistribution& rate) {
  double sum = -0.5 * (std::pow(std::log(rate.a / problem.prior.a), 2) +
                       std::pow(std::log(rate.b / problem.prior.b), 2));
  for (const InstanceCounts& one : problem.counts) {
    sum += log_beta(rate.a + 1.0 + one.detections, rate.b + one.images - one.detections) -
           log_beta(rate.a + 1.0, rate.b);
  }
  return sum;
}

double negative(const std::vector<double>& x, std::vector<double>& /*gradient*/, void* data) {
  const auto& problem = *static_cast<const RateProblem*>(data);
  return -log_posterior(problem, {std::exp(x[0]), std::exp(x[1])});
}

BetaDistribution fit_rate(RateProblem problem) {
  const auto within = [](double value) {
    return std::log(std::clamp(value, kLeastParameter, kMostParameter));
  };
  std::vector<double> x = {within(problem.prior.a), within(problem.prior.b)};
  nlopt::opt optimizer(nlopt::LN_BOBYQA, 2);
  optimizer.set_min_objective(negative, &problem);
  optimizer.set_lower_bounds(std::log(kLeastParameter));
  optimizer.set_upper_bounds(std::log(kMostParameter));
  optimizer.set_xtol_abs(1e-5);
  optimizer.set_maxeval(500);
  double value = 0.0;
  try {
    optimizer.optimize(x, value);
  } catch (const std::runtime_error&) {  // rounding ended the search at the best point so far
  }
  return {std::exp(x[0]), std::exp(x[1])};
}

void check(const InstanceCounts& one, std::size_t index) {
  const std::string name = fmt::format("counts[{}].", index);
  kNotNegative.check(one.images, name + "images");
  NumberRange{.lowest = 0.0, .highest = one.images}.check(one.detections, name + "detections");
}

}  // namespace

ExistenceSettings fit_existence(std::span<const InstanceCounts> counts,
                                const ExistenceSettings& settings) {
  validate(settings);
  RateProblem objects{{}, settings.object_rate};
  RateProblem clutter{{}, settings.clutter_rate};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    check(counts[i], i);
    (counts[i].is_object ? objects : clutter).counts.push_back(counts[i]);
  }
  const auto number = static_cast<double>(objects.counts.size());
  if (objects.counts.size() < 2 || clutter.counts.size() < 2) {
    throw InvalidInput(fmt::format(
        "counts hold {} instances of objects and {} that are none, expected two of each",
        objects.counts.size(), clutter.counts.size()));
  }
  ExistenceSettings fitted = settings;
  fitted.birth_probability = (number + kPriorInstances * settings.birth_probability) /
                             (static_cast<double>(counts.size()) + kPriorInstances);
  fitted.object_rate = fit_rate(std::move(objects));
  fitted.clutter_rate = fit_rate(std::move(clutter));
  return fitted;
}

}  // namespace posemix
