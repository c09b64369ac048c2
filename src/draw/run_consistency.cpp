// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "run_consistency.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/slam/evaluation.hpp"

namespace posemix::internal {
namespace {

std::optional<ConsistencyReport> report_of(std::span<const EstimateWithTruth> series,
                                           const SymmetryGroup& symmetries) {
  if (series.size() < 2) return std::nullopt;
  try {
    return consistency_of(series, {.symmetries = symmetries, .axes = ErrorAxes::reference});
  } catch (const InvalidInput&) {
    return std::nullopt;  // a pose that is known exactly in some direction
  }
}

double outside(const AxisConsistency& axis) { return 1.0 - axis.coverage.shares[2]; }

}  // namespace

std::optional<ConsistencyReport> relative_consistency(const SlamJob& job, const SlamRun& run,
                                                      std::size_t object) {
  std::vector<EstimateWithTruth> series;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const auto& estimate = run.frames[k].relative[object];
    const auto truth = true_relative_pose(job.sequence, object, k);
    if (estimate && truth) series.push_back({job.sequence.stamps[k], *estimate, *truth});
  }
  return report_of(series, job.models[object].symmetries);
}

std::optional<ConsistencyReport> camera_consistency(const SlamJob& job, const SlamRun& run) {
  std::vector<EstimateWithTruth> series;
  const std::size_t frames = std::min(run.frames.size(), job.sequence.camera_truth.size());
  for (std::size_t k = 0; k < frames; ++k) {
    const PoseDensity& estimate = run.frames[k].camera;
    const auto& truth = job.sequence.camera_truth[k];
    const bool is_exact = estimate.covariance().diagonal().minCoeff() <= 0.0;
    if (truth && !is_exact) series.push_back({job.sequence.stamps[k], estimate, *truth});
  }
  return report_of(series, {});
}

std::string fault_text(const ConsistencyReport& report) {
  if (report.verdict == ConsistencyVerdict::consistent) return "";
  if (report.verdict == ConsistencyVerdict::cautious)
    return "most along " + report.most_cautious.name;
  const auto worst = std::max_element(
      report.axes.begin(), report.axes.end(),
      [](const AxisConsistency& a, const AxisConsistency& b) { return outside(a) < outside(b); });
  const bool is_outside =
      worst != report.axes.end() && outside(*worst) > 2.0 * (1.0 - worst->coverage.nominal[2]);
  if (!is_outside) return "most along " + report.most_overconfident.name;
  const double percent = 100.0 * outside(*worst);
  return fmt::format("{:.{}f} % of {} outside 3 sigma", percent, percent < 10.0 ? 1 : 0,
                     worst->axis);
}

std::string nees_text(const NeesSummary& pose) {
  const auto text = [](double nees) { return fmt::format("{:.{}f}", nees, nees < 100.0 ? 2 : 0); };
  return fmt::format("mean NEES {} (1 expected), 95 % interval {} to {}", text(pose.anees),
                     text(pose.interval.low), text(pose.interval.high));
}

}  // namespace posemix::internal
