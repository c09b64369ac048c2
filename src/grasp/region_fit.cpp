// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <map>
#include <stdexcept>

#include <nlopt.hpp>

#include "grasp/region_parameters.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"
#include "posemix/base/statistics.hpp"

namespace posemix {
namespace {

using namespace internal;

/// An outcome in degrees and millimetres.
struct Sample {
  Eigen::Vector3d rotation;
  Eigen::Vector3d translation;
  bool success;
};

std::vector<Sample> samples_of(std::span<const ErrorOutcome> outcomes) {
  std::vector<Sample> samples;
  samples.reserve(outcomes.size());
  for (const ErrorOutcome& o : outcomes) {
    samples.push_back(
        {o.error.rotation().log() / kRadPerDeg, o.error.translation() / kMillimetre, o.success});
  }
  return samples;
}

struct Normal {
  RegionParameters mean;
  RegionParameters sd;
};

Normal prior_of(const RegionPriors& p) {
  Normal prior{RegionParameters::Zero(), RegionParameters::Zero()};
  prior.sd.segment<3>(kCentre).setConstant(p.centre_rotation_sd_deg);
  prior.sd.segment<3>(kCentre + 3).setConstant(p.centre_translation_sd_m / kMillimetre);
  prior.mean.segment<3>(kLogWidth).setConstant(std::log(p.half_width_deg));
  prior.mean.segment<3>(kLogWidth + 3).setConstant(std::log(p.half_width_m / kMillimetre));
  prior.sd.segment<6>(kLogWidth).setConstant(p.log_half_width_sd);
  prior.mean[kLogSoftness] = std::log(p.softness);
  prior.sd[kLogSoftness] = p.log_softness_sd;
  prior.mean[kLogitInside] = p.logit_inside;
  prior.sd[kLogitInside] = p.logit_inside_sd;
  prior.mean[kLogitRatio] = p.logit_outside_ratio;
  prior.sd[kLogitRatio] = p.logit_outside_ratio_sd;
  prior.sd.segment<3>(kLever).setConstant(p.lever_sd_m / kMillimetre);
  return prior;
}

/// P(success) of samples as a function of the parameters.
class Model {
 public:
  explicit Model(const RegionParameters& theta)
      : centre_(theta.segment<6>(kCentre)),
        width_(theta.segment<6>(kLogWidth).array().exp()),
        softness_(std::exp(theta[kLogSoftness])),
        inside_(logistic(theta[kLogitInside])),
        ratio_(logistic(theta[kLogitRatio])),
        lever_(theta.segment<3>(kLever)) {}

  /// P(success), and its gradient.
  double probability(const Sample& sample, RegionParameters& gradient) const {
    Vector6d x;
    x << sample.rotation, sample.translation + kRadPerDeg * sample.rotation.cross(lever_);
    double box = 1.0;
    gradient.setZero();
    for (Eigen::Index k = 0; k < 6; ++k) {
      const double scale = 1.0 / (softness_ * width_[k]);
      const double offset = (x[k] - centre_[k]) * scale;
      const double low = offset + 1.0 / softness_;
      const double high = 1.0 / softness_ - offset;
      const double beyond_low = logistic(-low);  // slope of log logistic(low)
      const double beyond_high = logistic(-high);
      box *= (1.0 - beyond_low) * (1.0 - beyond_high);
      gradient[kCentre + k] = (beyond_high - beyond_low) * scale;
      gradient[kLogWidth + k] = (beyond_high - beyond_low) * offset;
      gradient[kLogSoftness] -= beyond_low * low + beyond_high * high;
    }
    const Eigen::Vector3d by_displacement = -gradient.segment<3>(kCentre + 3);
    gradient.segment<3>(kLever) = kRadPerDeg * by_displacement.cross(sample.rotation);
    gradient *= inside_ * (1.0 - ratio_) * box;
    const double p = inside_ * (ratio_ + (1.0 - ratio_) * box);
    gradient[kLogitInside] = (1.0 - inside_) * p;
    gradient[kLogitRatio] = inside_ * (1.0 - box) * ratio_ * (1.0 - ratio_);
    return p;
  }

 private:
  Vector6d centre_;
  Vector6d width_;
  double softness_;
  double inside_;
  double ratio_;
  Eigen::Vector3d lever_;
};

double log_posterior(const RegionParameters& theta, const std::vector<Sample>& samples,
                     const Normal& prior, RegionParameters* gradient) {
  const RegionParameters z = (theta - prior.mean).cwiseQuotient(prior.sd);
  double value = -0.5 * z.squaredNorm();
  if (gradient != nullptr) *gradient = -z.cwiseQuotient(prior.sd);
  const Model model(theta);
  RegionParameters slope;
  for (const Sample& sample : samples) {
    const double p = model.probability(sample, slope);
    const double q = 1.0 - p;
    value += std::log(sample.success ? p : q);
    if (gradient != nullptr) *gradient += (sample.success ? 1.0 / p : -1.0 / q) * slope;
  }
  return value;
}

RegionParameters start_at(int start, const std::vector<Sample>& samples, const Normal& prior,
                          RandomStream& stream) {
  RegionParameters theta = prior.mean;
  if (start == 0) return theta;
  for (Eigen::Index k = 0; k < 6; ++k) {
    std::vector<double> values;
    for (const Sample& s : samples) {
      if (s.success) values.push_back(k < 3 ? s.rotation[k] : s.translation[k - 3]);
    }
    if (!values.empty()) {
      const double reach = 2.0 * prior.sd[kCentre + k];
      theta[kCentre + k] = std::clamp(upper_median(std::move(values)), -reach, reach);
    }
  }
  if (start == 1) return theta;
  for (int k = 0; k < 3; ++k) theta[kLever + k] = prior.sd[kLever + k] * stream.normal();
  for (int k = 0; k < 6; ++k)
    theta[kLogWidth + k] += 0.5 * prior.sd[kLogWidth + k] * stream.normal();
  return theta;
}

struct Search {
  const std::vector<Sample>* samples;
  const Normal* prior;
  RegionParameters best;
  double value = -std::numeric_limits<double>::infinity();
};

double objective(const std::vector<double>& x, std::vector<double>& gradient, void* data) {
  auto& search = *static_cast<Search*>(data);
  const RegionParameters theta = RegionParameters::Map(x.data());
  RegionParameters slope;
  const double value =
      log_posterior(theta, *search.samples, *search.prior, gradient.empty() ? nullptr : &slope);
  if (!gradient.empty()) RegionParameters::Map(gradient.data()) = slope;
  if (value > search.value) {
    search.value = value;
    search.best = theta;
  }
  return value;
}

/// Climbs from a start; true when it converged.
bool climb(const RegionParameters& start, const RegionFitSettings& settings, Search& search) {
  nlopt::opt optimizer(nlopt::LD_LBFGS, kRegionParameters);
  optimizer.set_max_objective(objective, &search);
  optimizer.set_ftol_rel(settings.tolerance);
  optimizer.set_maxeval(settings.max_evaluations);
  std::vector<double> x(start.begin(), start.end());
  double value = 0.0;
  try {
    return optimizer.optimize(x, value) != nlopt::MAXEVAL_REACHED;
  } catch (const nlopt::roundoff_limited&) {
    return true;
  } catch (const std::runtime_error&) {  // a line search that found nothing better
    return false;
  }
}

/// Whether Fisher's information on ln w exceeds that of the prior.
std::array<bool, 6> identified_widths(const RegionParameters& theta,
                                      const std::vector<Sample>& samples, const Normal& prior) {
  const Model model(theta);
  Vector6d information = Vector6d::Zero();
  RegionParameters slope;
  for (const Sample& sample : samples) {
    const double p = model.probability(sample, slope);
    if (p <= 0.0 || p >= 1.0) continue;
    information += slope.segment<6>(kLogWidth).cwiseAbs2() / (p * (1.0 - p));
  }
  std::array<bool, 6> identified{};
  for (int k = 0; k < 6; ++k) {
    const double sd = prior.sd[kLogWidth + k];
    identified[static_cast<std::size_t>(k)] = information[k] > 1.0 / (sd * sd);
  }
  return identified;
}

}  // namespace

double region_log_posterior(const RegionParameters& parameters,
                            std::span<const ErrorOutcome> outcomes, const RegionPriors& priors,
                            RegionParameters* gradient) {
  return log_posterior(parameters, samples_of(outcomes), prior_of(priors), gradient);
}

RegionFit fit_tolerance_region(std::span<const ErrorOutcome> outcomes,
                               const RegionFitSettings& settings, RandomStream& stream) {
  require(settings.starts > 0, "fit of a tolerance region without a start");
  kNotNegative.check(settings.tolerance, "fit of a tolerance region: tolerance");
  const std::vector<Sample> samples = samples_of(outcomes);
  const Normal prior = prior_of(settings.priors);
  Search best{&samples, &prior, prior.mean};
  bool converged = false;
  for (int start = 0; start < settings.starts; ++start) {
    Search search{&samples, &prior, prior.mean};
    const bool ended = climb(start_at(start, samples, prior, stream), settings, search);
    if (!(search.value > best.value)) continue;
    best = search;
    converged = ended;
  }
  const auto successes = static_cast<std::size_t>(
      std::count_if(samples.begin(), samples.end(), [](const Sample& s) { return s.success; }));
  return {.region = region_of(best.best),
          .log_posterior = best.value,
          .converged = converged,
          .successes = successes,
          .failures = samples.size() - successes,
          .identified = identified_widths(best.best, samples, prior)};
}

std::vector<ToleranceRegion> bootstrap_regions(std::span<const ErrorOutcome> outcomes,
                                               std::span<const std::size_t> groups,
                                               std::size_t count, const RegionFitSettings& settings,
                                               RandomStream& stream) {
  require(groups.size() == outcomes.size(), "bootstrap of outcomes without a group for each");
  internal::check_count(count, "count");
  std::map<std::size_t, std::vector<ErrorOutcome>> by_group;
  for (std::size_t i = 0; i < groups.size(); ++i) by_group[groups[i]].push_back(outcomes[i]);
  std::vector<const std::vector<ErrorOutcome>*> all;
  all.reserve(by_group.size());
  for (const auto& [group, members] : by_group) all.push_back(&members);
  std::vector<ToleranceRegion> regions;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<ErrorOutcome> drawn;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto place =
          static_cast<std::size_t>(stream.uniform() * static_cast<double>(all.size()));
      drawn.insert(drawn.end(), all[place]->begin(), all[place]->end());
    }
    regions.push_back(fit_tolerance_region(drawn, settings, stream).region);
  }
  return regions;
}

}  // namespace posemix
