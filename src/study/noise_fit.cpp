// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "noise_parts.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/mixture/em.hpp"
#include "posemix/study/noise_statistics.hpp"
#include "settings_json.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;
using Density = ConcentratedGaussian<SE3d>;

/// Least standard deviation of a component by the greatest.
constexpr double kLeastSdShare = 5e-4;

/// Residuals of all recordings, frame by frame, and without the gross errors.
struct Residuals {
  std::array<std::vector<ResidualTrack>, 6> axes;
  std::array<std::vector<ResidualTrack>, 6> inliers;
  std::vector<SE3d> samples;  ///< Exp of every residual
  std::size_t gross = 0;
};

bool is_gross(const Vector6d& residual, const NoiseStudySettings& settings) {
  return degrees(residual.head<3>().norm()) > settings.gross_rotation_deg ||
         SE3d::exp(residual).translation().norm() > settings.gross_translation_m;
}

Residuals collect(const NoiseGroup& group, const NoiseStudySettings& settings) {
  Residuals result;
  for (const ResidualSet& set : group.sets) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      result.axes[axis].emplace_back(set.truth.size());
      result.inliers[axis].emplace_back(set.truth.size());
    }
    for (std::size_t frame = 0; frame < set.truth.size(); ++frame) {
      if (!set.truth[frame] || !set.detected[frame]) continue;
      const Vector6d n =
          detection_residual(*set.truth[frame], *set.detected[frame], settings.frame);
      const bool gross = is_gross(n, settings);
      if (gross) ++result.gross;
      for (std::size_t axis = 0; axis < 6; ++axis) {
        const double value = n[static_cast<Eigen::Index>(axis)];
        const double in_unit = axis < 3 ? degrees(value) : value;
        result.axes[axis].back()[frame] = in_unit;
        if (!gross) result.inliers[axis].back()[frame] = in_unit;
      }
      result.samples.push_back(SE3d::exp(n));
    }
  }
  return result;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// Counts in even bins from -reach to reach, which holds 99 % of the values.
Json histogram(std::span<const ResidualTrack> tracks, std::size_t bins) {
  std::vector<double> values;
  for (const ResidualTrack& track : tracks) {
    for (const auto& value : track) {
      if (value) values.push_back(*value);
    }
  }
  std::vector<double> sizes = values;
  for (double& size : sizes) size = std::abs(size);
  const auto at = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), sizes.begin() + at, sizes.end());
  const double reach = std::max(1.1 * sizes[static_cast<std::size_t>(at)], 1e-9);
  const double width = 2.0 * reach / static_cast<double>(bins);
  std::vector<std::size_t> counts(bins, 0);
  for (const double value : values) {
    const double place = std::floor((value + reach) / width);
    if (place >= 0.0 && place < static_cast<double>(bins))
      ++counts[static_cast<std::size_t>(place)];
  }
  return {{"reach", reach}, {"counts", counts}};
}

Json axis_json(const Residuals& residuals, std::size_t axis, const NoiseStudySettings& settings) {
  const AxisStatistics s = axis_statistics(residuals.axes[axis]);
  const Autocorrelation time = autocorrelation(residuals.axes[axis]);
  const AxisStatistics inlier = axis_statistics(residuals.inliers[axis]);
  const Autocorrelation inlier_time = autocorrelation(residuals.inliers[axis]);
  return {{"count", s.count},
          {"mean", number(s.mean)},
          {"sd", number(s.sd)},
          {"rms", number(s.rms)},
          {"median", number(s.median)},
          {"robust_sd", number(s.robust_sd)},
          {"skewness", number(s.skewness)},
          {"kurtosis", number(s.kurtosis)},
          {"lag1_autocorrelation", number(time.lag1)},
          {"correlation_frames", number(time.correlation_frames)},
          {"effective_count", number(time.effective_count)},
          {"inlier_sd", number(inlier.sd)},
          {"inlier_lag1_autocorrelation", number(inlier_time.lag1)},
          {"inlier_correlation_frames", number(inlier_time.correlation_frames)},
          {"inlier_sd_of_recordings", number(spread_of_means(residuals.inliers[axis]))},
          {"histogram", histogram(residuals.axes[axis], settings.bins)}};
}

/// X = Exp(xi) M is M Exp(n) with n in the axes of M: the component's offset and covariance.
DetectorNoise noise_of(const Mixture<Density>& mixture, const NoiseStudySettings& settings) {
  std::vector<NoiseComponent> components;
  for (std::size_t k = 0; k < mixture.size(); ++k) {
    const Density& density = mixture[k].density;
    components.push_back(
        {.weight = mixture.weight(k),
         .covariance = settings.free_means ? density.body_covariance() : density.covariance(),
         .frame = settings.frame,
         .offset = density.mean()});
  }
  std::sort(components.begin(), components.end(),
            [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return DetectorNoise(std::move(components));
}

EmSettings em_settings(const NoiseStudySettings& settings) {
  EmSettings em{.components = settings.max_components,
                .restarts = settings.restarts,
                .fixed_means = !settings.free_means,
                .diagonal = !settings.full_covariance,
                .unit = Eigen::VectorXd(6),
                .min_sd = kLeastSdShare,
                .max_sd = 1.0};
  em.unit.head<3>().setConstant(radians(settings.max_rotation_sd_deg));
  em.unit.tail<3>().setConstant(settings.max_translation_sd_m);
  return em;
}

const char* name_of(EmStatus status) {
  if (status == EmStatus::converged) return "converged";
  return status == EmStatus::degenerate ? "degenerate" : "max_iterations";
}

/// Fits of 1, 2, ... components; `dependent` frames count as one in bic_effective.
Json models_json(const Residuals& residuals, double dependent, const NoiseStudySettings& settings,
                 std::size_t item) {
  RandomStream stream(settings.seed, item);
  const auto selection =
      fit_mixture_by_bic<Density>(residuals.samples, {}, em_settings(settings), stream);
  const auto count = static_cast<double>(residuals.samples.size());
  Json models = Json::array();
  std::size_t chosen = selection.best;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& fit : selection.fits) {
    const double effective = static_cast<double>(fit.parameters) * std::log(count / dependent) -
                             2.0 * fit.log_likelihood / dependent;
    models.push_back({{"components", fit.mixture.size()},
                      {"parameters", fit.parameters},
                      {"log_likelihood", fit.log_likelihood},
                      {"bic", fit.bic},
                      {"bic_effective", effective},
                      {"iterations", fit.history.size() - 1},
                      {"status", name_of(fit.status)},
                      {"chosen", false},
                      {"noise", noise_to_json(noise_of(fit.mixture, settings))}});
    if (settings.count_frames || effective >= least || fit.status == EmStatus::degenerate) continue;
    least = effective;
    chosen = fit.mixture.size() - 1;
  }
  models[chosen]["chosen"] = true;
  return models;
}

}  // namespace

nlohmann::ordered_json noise_to_json(const DetectorNoise& noise) { return noise_json(noise); }

DetectorNoise noise_from_json(const nlohmann::ordered_json& json) {
  std::vector<NoiseComponent> components;
  for (const auto& entry : json) {
    Eigen::Matrix4d offset;
    NoiseComponent component{
        .weight = entry.at("weight").get<double>(),
        .frame = entry.at("frame") == "object" ? NoiseFrame::object : NoiseFrame::camera};
    for (Eigen::Index row = 0; row < 6; ++row) {
      for (Eigen::Index column = 0; column < 6; ++column) {
        component.covariance(row, column) = entry.at("covariance").at(row).at(column);
        if (row < 4 && column < 4) offset(row, column) = entry.at("offset").at(row).at(column);
      }
    }
    component.offset = SE3d::from_matrix(offset);
    components.push_back(component);
  }
  return DetectorNoise(std::move(components));
}

nlohmann::ordered_json study_noise(const NoiseGroup& group, const NoiseStudySettings& settings,
                                   std::size_t item) {
  const Residuals residuals = collect(group, settings);
  constexpr std::size_t kFewest = 20;
  if (residuals.samples.size() < kFewest) {
    throw InvalidInput(fmt::format("study noise: {} detections of {} with a truth, expected {}",
                                   residuals.samples.size(), group.object, kFewest));
  }
  Json result = {{"detector", group.detector},
                 {"object", group.object},
                 {"recordings", group.sets.size()},
                 {"proxy", std::any_of(group.sets.begin(), group.sets.end(),
                                       [](const ResidualSet& set) { return set.proxy; })},
                 {"gross_errors", static_cast<double>(residuals.gross) /
                                      static_cast<double>(residuals.samples.size())}};
  std::vector<double> dependent;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    Json& entry = result["axes"].emplace_back(axis_json(residuals, axis, settings));
    if (entry["correlation_frames"].is_number()) dependent.push_back(entry["correlation_frames"]);
  }
  std::sort(dependent.begin(), dependent.end());
  const double middle = dependent.empty() ? 1.0 : dependent[dependent.size() / 2];
  result["models"] = models_json(residuals, middle, settings, item);
  return result;
}

}  // namespace posemix
