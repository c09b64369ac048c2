// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "consistency_findings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "posemix/base/units.hpp"

namespace posemix::internal {
namespace {

constexpr std::array kNames{"rotation x", "rotation y", "rotation z",
                            "position x", "position y", "position z"};
constexpr double kFewFrames = 10.0;
constexpr double kMuchConstant = 0.5;
/// A mean that is so many standard errors from zero is a bias where it makes errors larger than
/// they should be; six axes are looked at.
constexpr double kSignificant = 4.0;
constexpr double kTooLarge = 1.2;  ///< root mean square of normalised errors
/// And so many standard deviations: no consistent series has that, however slow its errors.
constexpr double kBeyondAnySeries = 2.64;

std::string anees_text(const NeesSummary& part) {
  return fmt::format("ANEES {:.3g}, 95 % interval {:.3g} to {:.3g}", part.anees, part.interval.low,
                     part.interval.high);
}

const char* word_for(ConsistencyVerdict verdict) {
  switch (verdict) {
    case ConsistencyVerdict::overconfident:
      return "overconfident";
    case ConsistencyVerdict::cautious:
      return "too cautious";
    case ConsistencyVerdict::consistent:
      break;
  }
  return "consistent";
}

std::string verdict_text(const ConsistencyReport& report) {
  const NeesSummary& pose = report.pose;
  const double factor = std::sqrt(pose.anees);
  if (report.verdict != pose.verdict) {
    return fmt::format("{} in part, {} as a whole ({})", word_for(report.verdict),
                       word_for(pose.verdict), anees_text(pose));
  }
  switch (report.verdict) {
    case ConsistencyVerdict::overconfident:
      return fmt::format(
          "overconfident: standard deviations are too small by a factor of {:.3g} ({})", factor,
          anees_text(pose));
    case ConsistencyVerdict::cautious:
      return fmt::format(
          "too cautious: standard deviations are too large by a factor of {:.3g} ({})",
          1.0 / factor, anees_text(pose));
    case ConsistencyVerdict::consistent:
      break;
  }
  return fmt::format("consistent: nothing speaks against the covariances ({})", anees_text(pose));
}

/// What a part says that the pose as a whole does not.
void add_part(const char* name, const NeesSummary& part, ConsistencyVerdict whole,
              std::vector<std::string>& findings) {
  if (part.verdict == whole || part.verdict == ConsistencyVerdict::consistent) return;
  const double factor = std::sqrt(part.anees);
  findings.push_back(fmt::format(
      "the {} is {} by a factor of {:.3g} ({})", name, word_for(part.verdict),
      part.verdict == ConsistencyVerdict::overconfident ? factor : 1.0 / factor, anees_text(part)));
}

std::string error_text(const AxisConsistency& axis) {
  return axis.axis.starts_with("rotation") ? fmt::format("{:.3g} deg", degrees(axis.mean_error))
                                           : fmt::format("{:.3g} mm", 1e3 * axis.mean_error);
}

void add_directions(const ConsistencyReport& report, std::vector<std::string>& findings) {
  const ErrorDirection& most = report.most_overconfident;
  if (most.ratio > most.limit) {
    findings.push_back(
        fmt::format("most overconfident along {}: by a factor of {:.3g} in standard deviation",
                    most.name, std::sqrt(most.ratio)));
  }
  const ErrorDirection& least = report.most_cautious;
  if (least.ratio < least.limit) {
    const std::string factor = least.ratio > 0.0
                                   ? fmt::format("by a factor of {:.3g} in standard deviation",
                                                 1.0 / std::sqrt(least.ratio))
                                   : "without any error";
    findings.push_back(fmt::format("most cautious along {}: {}", least.name, factor));
  }
}

void add_bias(const ConsistencyReport& report, std::vector<std::string>& findings) {
  for (const AxisConsistency& axis : report.axes) {
    const double size = std::abs(axis.normalized_mean);
    const double share = size * size / std::max(1e-300, axis.normalized_rms * axis.normalized_rms);
    const bool is_bias =
        size > kBeyondAnySeries || (axis.bias_significance > kSignificant &&
                                    share > kMuchConstant && axis.normalized_rms > kTooLarge);
    if (!is_bias) continue;
    findings.push_back(
        fmt::format("mean error along {}: {}, {:.3g} standard deviations, {:.0f} % of the squared "
                    "error: a bias, or an error slower than the series",
                    axis.axis, error_text(axis), axis.normalized_mean, 100.0 * share));
  }
}

}  // namespace

std::string direction_name(const Vector6d& correlation) {
  constexpr double kWorthNaming = 0.3;
  constexpr double kAlone = 0.95;
  std::array<Eigen::Index, 6> order{};
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::abs(correlation[a]) > std::abs(correlation[b]) + 1e-9;
  });
  const Eigen::Index first = order[0];
  const double largest = std::abs(correlation[first]);
  if (largest > kAlone) return kNames[static_cast<std::size_t>(first)];
  // A direction that the covariance has hardly any variance along, such as the difference of two
  // axes that it takes for one, is alike to none of the axes: its shape names it.
  if (largest < kWorthNaming && largest > 0.0) return direction_name(correlation.normalized());
  // The sign of a direction has no meaning; its largest part is positive.
  const double sign = correlation[first] < 0.0 ? -1.0 : 1.0;
  std::string name;
  for (const Eigen::Index i : order) {
    const double part = sign * correlation[i];
    if (std::abs(part) < kWorthNaming) break;
    const char* const joint = part < 0.0 ? " - " : " + ";
    name += fmt::format("{}{:.2g} {}", name.empty() ? "" : joint, std::abs(part),
                        kNames[static_cast<std::size_t>(i)]);
  }
  return name;
}

std::vector<std::string> findings_of(const ConsistencyReport& report) {
  std::vector<std::string> findings{verdict_text(report)};
  if (report.rotation) add_part("rotation", *report.rotation, report.pose.verdict, findings);
  add_part("position", report.position, report.pose.verdict, findings);
  add_directions(report, findings);
  add_bias(report, findings);
  if (static_cast<double>(report.frames.size()) < kFewFrames) {
    findings.push_back(
        fmt::format("{} frames are too few to tell how alike successive errors are, and too few "
                    "for a sharp verdict",
                    report.frames.size()));
  } else if (report.pose.effective_frames < kFewFrames) {
    findings.push_back(fmt::format(
        "successive errors are alike: the {} frames are worth {:.2g} independent ones, too few for "
        "a sharp verdict",
        report.frames.size(), report.pose.effective_frames));
  }
  return findings;
}

}  // namespace posemix::internal
