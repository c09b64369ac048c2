// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/fiducial/corner_noise.hpp"

#include <algorithm>
#include <cmath>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

constexpr int kMostIterations = 200;
constexpr int kSearchSteps = 100;
constexpr double kConverged = 1e-7;    ///< of the logarithms of scale and degrees of freedom
constexpr double kLeastScale = 1e-12;  ///< of the squared error [px^2], for corners without noise

/// Squared errors and the probabilities that they are those of the true minima.
struct WeightedErrors {
  std::vector<double> error;   ///< [px^2]
  std::vector<double> weight;  ///< those of a sighting sum to one
  double sightings = 0.0;
};

/// E has the density a / s (1 + E / s)^-(a + 1) (Lomax) with a = dof / 2 and s = dof sd^2. For a
/// given s the best a is in closed form.
struct Lomax {
  double a = 1.0;
  double s = 1.0;
  double log_likelihood = 0.0;
};

Lomax lomax_at(const WeightedErrors& data, double s) {
  double total = 0.0;
  for (std::size_t i = 0; i < data.error.size(); ++i)
    total += data.weight[i] * std::log1p(data.error[i] / s);
  Lomax out;
  out.s = s;
  out.a = std::clamp(data.sightings / total, kLeastCornerDof / 2.0, kMostCornerDof / 2.0);
  out.log_likelihood = data.sightings * std::log(out.a / s) - (out.a + 1.0) * total;
  return out;
}

/// The most likely one, by golden section over log s: the likelihood has one maximum.
Lomax fit_lomax(const WeightedErrors& data) {
  double mean = 0.0;
  for (std::size_t i = 0; i < data.error.size(); ++i)
    mean += data.weight[i] * data.error[i] / data.sightings;
  mean = std::max(mean, kLeastScale);
  constexpr double kGolden = 0.6180339887498949;
  double low = std::log(mean * 1e-6);
  double high = std::log(mean * kMostCornerDof);
  const auto at = [&](double log_s) { return lomax_at(data, std::exp(log_s)); };
  double left = high - kGolden * (high - low);
  double right = low + kGolden * (high - low);
  Lomax at_left = at(left);
  Lomax at_right = at(right);
  for (int i = 0; i < kSearchSteps && high - low > 0.1 * kConverged; ++i) {
    if (at_left.log_likelihood > at_right.log_likelihood) {
      high = right;
      right = left;
      at_right = at_left;
      at_left = at(left = high - kGolden * (high - low));
    } else {
      low = left;
      left = right;
      at_left = at_right;
      at_right = at(right = low + kGolden * (high - low));
    }
  }
  return at_left.log_likelihood > at_right.log_likelihood ? at_left : at_right;
}

CornerNoise noise_of(const Lomax& lomax) {
  return {.sd_px = std::sqrt(lomax.s / (2.0 * lomax.a)), .dof = 2.0 * lomax.a};
}

/// The probabilities of the minima of every sighting.
void weigh(std::span<const std::vector<TagMinimum>> sightings, const CornerNoise& noise,
           WeightedErrors& data) {
  std::size_t next = 0;
  for (const std::vector<TagMinimum>& minima : sightings) {
    double best = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < minima.size(); ++k)
      best = std::max(best, data.weight[next + k] = log_evidence(minima[k], noise));
    double total = 0.0;
    for (std::size_t k = 0; k < minima.size(); ++k)
      total += data.weight[next + k] = std::exp(data.weight[next + k] - best);
    for (std::size_t k = 0; k < minima.size(); ++k) data.weight[next + k] /= total;
    next += minima.size();
  }
}

/// The minima of least error as the true ones.
WeightedErrors first_guess(std::span<const std::vector<TagMinimum>> sightings) {
  WeightedErrors data;
  for (const std::vector<TagMinimum>& minima : sightings) {
    if (minima.empty()) continue;
    data.sightings += 1.0;
    for (std::size_t k = 0; k < minima.size(); ++k) {
      data.error.push_back(std::max(minima[k].squared_error, kLeastScale));
      data.weight.push_back(k == 0 ? 1.0 : 0.0);
    }
  }
  return data;
}

}  // namespace

CornerNoiseFit fit_corner_noise(std::span<const std::vector<TagMinimum>> sightings) {
  WeightedErrors data = first_guess(sightings);
  if (data.error.empty())
    throw InvalidInput("no sighting has a pose, expected at least one to learn the noise from");
  CornerNoiseFit fit;
  fit.sightings = static_cast<std::size_t>(data.sightings);
  fit.noise = noise_of(fit_lomax(data));
  for (int i = 0; i < kMostIterations && !fit.converged; ++i) {
    weigh(sightings, fit.noise, data);
    const CornerNoise next = noise_of(fit_lomax(data));
    fit.converged = std::abs(std::log(next.sd_px / fit.noise.sd_px)) < 100.0 * kConverged &&
                    std::abs(std::log(next.dof / fit.noise.dof)) < 100.0 * kConverged;
    fit.noise = next;
  }
  return fit;
}

}  // namespace posemix
