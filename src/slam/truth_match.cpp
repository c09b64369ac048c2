// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/truth_match.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"

namespace posemix {
namespace {

template <class Stamped>
void check_stamps(std::span<const Stamped> series, const char* name) {
  if (series.empty()) throw InvalidInput(fmt::format("{}: got no poses, expected some", name));
  for (std::size_t k = 0; k < series.size(); ++k) {
    const double stamp = series[k].stamp_s;
    if (std::isfinite(stamp) && (k == 0 || stamp > series[k - 1].stamp_s)) continue;
    throw InvalidInput(
        fmt::format("{}: stamp {} is {}, expected finite stamps that increase "
                    "strictly",
                    name, k, stamp));
  }
}

/// The index of the first entry with this stamp or a later one.
template <class Stamped>
std::size_t first_from(std::span<const Stamped> series, double stamp) {
  const auto found =
      std::lower_bound(series.begin(), series.end(), stamp,
                       [](const Stamped& entry, double value) { return entry.stamp_s < value; });
  return static_cast<std::size_t>(found - series.begin());
}

/// The least distance of a stamp to those of a series.
template <class Stamped>
double least_distance(std::span<const Stamped> series, double stamp) {
  const std::size_t at = first_from(series, stamp);
  double least = std::numeric_limits<double>::infinity();
  if (at < series.size()) least = series[at].stamp_s - stamp;
  if (at > 0) least = std::min(least, stamp - series[at - 1].stamp_s);
  return least;
}

/// A difference between distances of stamps that is due to their rounding.
double rounding_of(std::span<const StampedEstimate> estimates,
                   std::span<const StampedTruth> truth) {
  constexpr double kRoundings = 4.0;
  double largest = 0.0;
  for (const double stamp : {estimates.front().stamp_s, estimates.back().stamp_s,
                             truth.front().stamp_s, truth.back().stamp_s}) {
    largest = std::max(largest, std::abs(stamp));
  }
  return kRoundings * std::numeric_limits<double>::epsilon() * largest;
}

/// Pairs of which each is as near as any other to either. In order of time, each estimate takes the
/// earliest of its nearest that is left, so that equal distances leave as few as possible alone.
std::vector<EstimateWithTruth> nearest_pairs(std::span<const StampedEstimate> estimates,
                                             std::span<const StampedTruth> truth,
                                             double max_difference_s) {
  const double rounding = rounding_of(estimates, truth);
  std::vector<EstimateWithTruth> pairs;
  std::size_t left = 0;
  for (const StampedEstimate& estimate : estimates) {
    const double stamp = estimate.stamp_s;
    const double least = least_distance(truth, stamp);
    if (least > max_difference_s) continue;
    std::size_t at = std::max(left, first_from(truth, stamp - least - rounding));
    for (; at < truth.size() && truth[at].stamp_s <= stamp + least + rounding; ++at) {
      const double distance = std::abs(truth[at].stamp_s - stamp);
      if (distance > least + rounding || distance > max_difference_s) continue;
      if (distance > least_distance(estimates, truth[at].stamp_s) + rounding) continue;
      pairs.push_back({stamp, estimate.estimate, truth[at].pose});
      left = at + 1;
      break;
    }
  }
  return pairs;
}

/// The rigid motion that moves the estimated positions onto the true ones (Umeyama 1991).
SE3d positions_onto_truth(std::span<const EstimateWithTruth> pairs) {
  const auto count = static_cast<Eigen::Index>(pairs.size());
  Eigen::Matrix3Xd from(3, count);
  Eigen::Matrix3Xd onto(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const EstimateWithTruth& pair = pairs[static_cast<std::size_t>(i)];
    from.col(i) = pair.estimate.mean().translation();
    onto.col(i) = pair.truth.translation();
  }
  for (const Eigen::Matrix3Xd* positions : {&from, &onto}) {
    constexpr double kLeast = 1e-6;  // of the longest extent
    const Eigen::Matrix3Xd centred = positions->colwise() - positions->rowwise().mean();
    const Eigen::Vector3d extents =
        Eigen::JacobiSVD<Eigen::Matrix3d>(centred * centred.transpose()).singularValues();
    if (extents[1] > kLeast * kLeast * extents[0]) continue;
    throw InvalidInput(
        "alignment se3: the positions are on a line, which leaves the turn about it open; expected "
        "a path that bends, or the alignment first");
  }
  return SE3d::from_matrix(Eigen::umeyama(from, onto, false));
}

void move_by(const SE3d& motion, std::vector<EstimateWithTruth>& pairs) {
  for (EstimateWithTruth& pair : pairs) {
    pair.estimate = PoseDensity::trusted(motion * pair.estimate.mean(),
                                         motion.adjoint_congruence(pair.estimate.covariance()));
  }
}

}  // namespace

std::vector<EstimateWithTruth> match_to_truth(std::span<const StampedEstimate> estimates,
                                              std::span<const StampedTruth> truth,
                                              const MatchSettings& settings) {
  kNotNegative.check(settings.max_difference_s, "max_difference_s");
  check_stamps(estimates, "estimates");
  check_stamps(truth, "truth");
  std::vector<EstimateWithTruth> pairs = nearest_pairs(estimates, truth, settings.max_difference_s);
  const std::size_t least = settings.alignment == Alignment::first ? 3 : 2;
  if (pairs.size() < least) {
    throw InvalidInput(fmt::format(
        "{} pairs of estimate and truth are within {} s of one another, expected at least {}: the "
        "estimates are from {} to {} s, the truth from {} to {} s",
        pairs.size(), settings.max_difference_s, least, estimates.front().stamp_s,
        estimates.back().stamp_s, truth.front().stamp_s, truth.back().stamp_s));
  }
  if (settings.alignment == Alignment::se3) move_by(positions_onto_truth(pairs), pairs);
  if (settings.alignment == Alignment::first) {
    move_by(pairs.front().truth * pairs.front().estimate.mean().inverse(), pairs);
    pairs.erase(pairs.begin());
  }
  return pairs;
}

}  // namespace posemix
