// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>

#include "detector/noise_sizes.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/detector/noise_fit.hpp"

namespace posemix {
namespace {

using Observations = std::vector<NoiseObservation>;

/// The observations of each fold.
std::vector<Observations> folds_of(std::span<const NoiseTrack> tracks, std::size_t count) {
  std::size_t recordings = 0;
  for (const NoiseObservation& each : observations_of(tracks))
    recordings = std::max(recordings, each.recording + 1);
  // Of more folds than frames, some would be empty.
  std::size_t frames = 1;
  for (const NoiseTrack& track : tracks) frames += track.size();
  count = std::min(count, frames);
  std::vector<Observations> folds(count);
  for (const NoiseTrack& track : tracks) {
    for (std::size_t frame = 0; frame < track.size(); ++frame) {
      if (!track[frame]) continue;
      const std::size_t fold =
          recordings >= count ? track[frame]->recording % count : frame * count / track.size();
      folds[fold].push_back(*track[frame]);
    }
  }
  std::erase_if(folds, [](const Observations& fold) { return fold.empty(); });
  return folds;
}

Observations all_but(const std::vector<Observations>& folds, std::size_t left_out) {
  Observations rest;
  for (std::size_t f = 0; f < folds.size(); ++f) {
    if (f != left_out) rest.insert(rest.end(), folds[f].begin(), folds[f].end());
  }
  return rest;
}

/// The sum of the log densities of each fold under models that were fitted to the others; one row
/// per number of components, one column per fold.
Eigen::ArrayXXd held_out(const std::vector<Observations>& folds, const NoiseFitSettings& settings,
                         NoiseFrame frame, const RandomStream& start) {
  Eigen::ArrayXXd sums = Eigen::ArrayXXd::Constant(
      static_cast<Eigen::Index>(settings.max_components), static_cast<Eigen::Index>(folds.size()),
      std::numeric_limits<double>::quiet_NaN());
  for (std::size_t f = 0; f < folds.size(); ++f) {
    RandomStream stream = start;
    const auto fits = internal::fit_noise_sizes(all_but(folds, f), settings, frame, stream);
    for (std::size_t k = 0; k < fits.size(); ++k) {
      sums(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(f)) =
          noise_log_density(fits[k].noise, folds[f]).sum();
    }
  }
  return sums;
}

void compare_with_best(std::vector<NoiseValidation>& rows) {
  if (rows.empty()) return;
  const NoiseValidation best =
      *std::max_element(rows.begin(), rows.end(),
                        [](const auto& a, const auto& b) { return a.log_density < b.log_density; });
  for (NoiseValidation& row : rows) {
    std::vector<double> differences;
    differences.reserve(row.by_fold.size());
    for (std::size_t f = 0; f < row.by_fold.size(); ++f)
      differences.push_back(best.by_fold[f] - row.by_fold[f]);
    row.below_best = best.log_density - row.log_density;
    row.standard_error = mean_with_error(differences).standard_error;
  }
}

}  // namespace

std::vector<NoiseValidation> cross_validate(std::span<const NoiseTrack> tracks,
                                            const NoiseFitSettings& settings,
                                            const RandomStream& stream) {
  if (settings.folds < 2) return {};
  const std::vector<Observations> folds = folds_of(tracks, settings.folds);
  std::vector<NoiseValidation> rows;
  if (folds.size() < 2) return rows;
  double count = 0.0;
  for (const Observations& fold : folds) count += static_cast<double>(fold.size());
  for (const NoiseFrame frame : {NoiseFrame::object, NoiseFrame::camera, NoiseFrame::ray}) {
    for (const bool clutter : {false, true}) {
      NoiseFitSettings of_kind = settings;
      of_kind.clutter = clutter;
      of_kind.free_means = false;
      const Eigen::ArrayXXd sums = held_out(folds, of_kind, frame, stream);
      for (Eigen::Index k = 0; k < sums.rows(); ++k) {
        std::vector<double> means;
        means.reserve(folds.size());
        for (std::size_t f = 0; f < folds.size(); ++f)
          means.push_back(sums(k, static_cast<Eigen::Index>(f)) /
                          static_cast<double>(folds[f].size()));
        rows.push_back({.frame = frame,
                        .clutter = clutter,
                        .components = static_cast<std::size_t>(k) + 1,
                        .log_density = sums.row(k).sum() / count,
                        .by_fold = std::move(means)});
      }
    }
  }
  std::erase_if(rows, [](const NoiseValidation& row) { return !std::isfinite(row.log_density); });
  compare_with_best(rows);
  return rows;
}

}  // namespace posemix
