// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "posemix/mixture/em_start.hpp"

namespace posemix {
namespace internal {

/// @throws InvalidInput naming the setting that is out of range
void check_em_settings(const EmSettings& settings, Eigen::Index dof);
/// Checks the weights and that enough of them are positive for the components; returns their sum.
/// @throws InvalidInput
double checked_em_weights(std::span<const double> weights, std::size_t samples, std::size_t needed);
/// The number of positive weights that a fit of `components` components needs.
std::size_t needed_samples(std::size_t components, Eigen::Index dof, const EmSettings& settings);

/// Whether an element's coordinates are all finite.
template <LieGroup G>
bool is_finite_element(const G& element) {
  return element.log().allFinite();
}
inline bool is_finite_element(const SO3d& element) {
  return element.quaternion().coeffs().allFinite();
}
inline bool is_finite_element(const SE3d& element) {
  return is_finite_element(element.rotation()) && element.translation().allFinite();
}

/// EM from one start.
template <EmDensity D>
class EmRun {
 public:
  using Samples = typename EmModel<D>::Samples;

  EmRun(const Samples& samples, std::span<const double> weights, double total,
        const EmSettings& settings)
      : samples_(samples), weights_(weights), total_(total), settings_(settings) {}

  EmResult<D> run(Mixture<D> mixture) const {
    Pass pass = evaluate(mixture);
    std::vector<double> history{pass.log_likelihood};
    EmStatus status = EmStatus::max_iterations;
    for (int iteration = 0; iteration < settings_.max_iterations; ++iteration) {
      const double before = pass.log_likelihood;
      if (!advance(mixture, pass)) {
        status = EmStatus::converged;
        break;
      }
      history.push_back(pass.log_likelihood);
      if (pass.log_likelihood - before <= settings_.tolerance * total_) {
        status = EmStatus::converged;
        break;
      }
    }
    if (is_degenerate(mixture, pass)) status = EmStatus::degenerate;
    const std::size_t k = mixture.size();
    const std::size_t parameters = k * EmModel<D>::parameters(mixture.dof(), settings_) + k - 1;
    const double log_likelihood = pass.log_likelihood;
    return {std::move(mixture),
            log_likelihood,
            std::move(history),
            status,
            parameters,
            static_cast<double>(parameters) * std::log(total_) - 2.0 * log_likelihood,
            1};
  }

 private:
  struct Pass {
    double log_likelihood = 0.0;
    std::vector<typename EmModel<D>::Worker> workers;
  };

  Pass evaluate(const Mixture<D>& mixture) const {
    Pass pass;
    pass.workers.reserve(mixture.size());
    for (const auto& component : mixture.components()) {
      pass.workers.emplace_back(component.density, settings_);
    }
    EmRow weights;
    std::vector<EmRow> terms(mixture.size());
    for (std::size_t begin = 0; begin < samples_.size(); begin += kEmBlock) {
      const std::size_t count = std::min(kEmBlock, samples_.size() - begin);
      for (std::size_t k = 0; k < mixture.size(); ++k) {
        pass.workers[k].log_density(samples_, begin, count, terms[k]);
        for (std::size_t i = 0; i < count; ++i) terms[k][i] += mixture[k].log_weight;
      }
      const auto block = weights_.subspan(begin, count);
      std::fill(std::copy(block.begin(), block.end(), weights.values.begin()), weights.values.end(),
                0.0);
      pass.log_likelihood += shares_from_log_terms(weights, count, terms);
      for (std::size_t k = 0; k < mixture.size(); ++k) pass.workers[k].accumulate(terms[k]);
    }
    return pass;
  }

  /// Takes one step that does not lower the log-likelihood; false if there is none.
  bool advance(Mixture<D>& mixture, Pass& pass) const {
    const double slack = 1e-13 * (std::abs(pass.log_likelihood) + total_);
    for (const double step : {1.0, 0.5, 0.25, 0.0}) {
      Mixture<D> next = stepped(mixture, pass, step);
      Pass next_pass = evaluate(next);
      if (next_pass.log_likelihood >= pass.log_likelihood - slack) {
        mixture = std::move(next);
        pass = std::move(next_pass);
        return true;
      }
      if (settings_.fixed_means) break;
    }
    return false;
  }

  Mixture<D> stepped(const Mixture<D>& mixture, const Pass& pass, double step) const {
    std::vector<Component<D>> components;
    for (std::size_t k = 0; k < mixture.size(); ++k) {
      const double weight = pass.workers[k].weight();
      const bool lost = weight <= kLostShare * total_;
      components.push_back(
          {std::log(weight / total_), lost ? mixture[k].density : pass.workers[k].update(step)});
    }
    return Mixture<D>(std::move(components));
  }

  bool is_degenerate(const Mixture<D>& mixture, const Pass& pass) const {
    if (!std::isfinite(pass.log_likelihood)) return true;
    for (std::size_t k = 0; k < mixture.size(); ++k) {
      if (pass.workers[k].weight() <= kLostShare * total_) return true;
      if (EmModel<D>::on_lower_bound(mixture[k].density, settings_)) return true;
    }
    return false;
  }

  /// A component with a smaller share of the samples is no longer estimated.
  static constexpr double kLostShare = 1e-12;

  const Samples& samples_;
  std::span<const double> weights_;
  double total_;
  EmSettings settings_;
};

template <EmDensity D>
Mixture<D> prepared_start(const Mixture<D>& start, const EmSettings& settings) {
  if constexpr (requires { EmModel<D>::prepared(start[0].density, settings); }) {
    std::vector<Component<D>> components;
    for (const auto& [log_weight, density] : start.components()) {
      components.push_back({log_weight, EmModel<D>::prepared(density, settings)});
    }
    return Mixture<D>(std::move(components));
  } else {
    return start;
  }
}

/// Checks settings and samples; returns the degrees of freedom. @throws InvalidInput
template <EmDensity D>
Eigen::Index checked_em_samples(std::span<const typename D::Group> samples,
                                const EmSettings& settings) {
  require(!samples.empty(), "EM: there are no samples");
  const Eigen::Index dof = samples.front().dof();
  check_em_settings(settings, dof);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].dof() != dof || !is_finite_element(samples[i])) {
      throw InvalidInput(fmt::format(
          "EM: sample {} is not finite, or not of {} degrees of freedom as the first", i, dof));
    }
  }
  return dof;
}

}  // namespace internal

template <EmDensity D>
EmResult<D> fit_mixture(std::span<const typename D::Group> samples, std::span<const double> weights,
                        const EmSettings& settings, RandomStream& stream,
                        const std::optional<Mixture<D>>& start) {
  const Eigen::Index dof = internal::checked_em_samples<D>(samples, settings);
  const std::vector<double> ones(weights.empty() ? samples.size() : 0, 1.0);
  if (weights.empty()) weights = ones;
  const std::size_t needed = internal::needed_samples(settings.components, dof, settings);
  const double total = internal::checked_em_weights(weights, samples.size(), needed);
  const typename EmModel<D>::Samples stored(samples);
  const internal::EmRun<D> run(stored, weights, total, settings);
  if (start) {
    if (start->size() != settings.components || start->dof() != dof) {
      throw InvalidInput(
          fmt::format("EM: the start has {} components of {} degrees of freedom, expected {} of {}",
                      start->size(), start->dof(), settings.components, dof));
    }
    return run.run(internal::prepared_start<D>(*start, settings));
  }
  const internal::EmStart<D> starts(samples, weights, settings);
  std::optional<EmResult<D>> best;
  const int attempts = settings.components == 1 ? 1 : settings.restarts;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    EmResult<D> result = run.run(starts.draw(attempt, stream));
    const auto rank = [](const EmResult<D>& r) {
      return std::pair(r.status != EmStatus::degenerate, r.log_likelihood);
    };
    if (!best || rank(result) > rank(*best)) best = std::move(result);
  }
  best->starts = attempts;
  return *std::move(best);
}

template <EmDensity D>
BicSelection<D> fit_mixture_by_bic(std::span<const typename D::Group> samples,
                                   std::span<const double> weights, const EmSettings& settings,
                                   RandomStream& stream) {
  require(!samples.empty(), "EM: there are no samples");
  std::size_t positive = samples.size();
  if (!weights.empty()) {
    positive = static_cast<std::size_t>(
        std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0.0; }));
  }
  BicSelection<D> selection{{}, 0};
  EmSettings of_size = settings;
  for (std::size_t k = 1; k <= std::max<std::size_t>(settings.components, 1); ++k) {
    const std::size_t needed = internal::needed_samples(k, samples.front().dof(), settings);
    if (k > 1 && positive < needed) break;
    of_size.components = settings.components == 0 ? 0 : k;
    selection.fits.push_back(fit_mixture<D>(samples, weights, of_size, stream));
    const auto rank = [](const EmResult<D>& r) {
      return std::pair(r.status == EmStatus::degenerate, r.bic);
    };
    if (rank(selection.fits.back()) < rank(selection.fits[selection.best])) selection.best = k - 1;
  }
  return selection;
}

}  // namespace posemix
