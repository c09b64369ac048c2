// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/consistency_files.hpp"

#include <fmt/format.h>

#include "io/json_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"

namespace posemix {
namespace {

using namespace internal;

Json interval_json(const Interval& interval) { return {interval.low, interval.high}; }

Json coverage_json(const Coverage& coverage) {
  return {{"shares", coverage.shares}, {"nominal", coverage.nominal}};
}

Json summary_json(const NeesSummary& summary) {
  return {{"dof", summary.dof},
          {"verdict", word_of(summary.verdict)},
          {"anees", json_number(summary.anees)},
          {"interval", interval_json(summary.interval)},
          {"band", interval_json(summary.band)},
          {"independent_band", interval_json(summary.independent_band)},
          {"effective_frames", summary.effective_frames},
          {"median", json_number(summary.median)},
          {"worst", json_number(summary.worst)},
          {"worst_stamp_s", summary.worst_stamp_s},
          {"frame_band", interval_json(summary.frame_band)},
          {"within_frame_band", summary.within_frame_band},
          {"coverage", coverage_json(summary.coverage)}};
}

Json axis_json(const AxisConsistency& axis) {
  return {{"axis", axis.axis},
          {"mean_error", json_number(axis.mean_error)},
          {"rms_error", json_number(axis.rms_error)},
          {"rms_sd", json_number(axis.rms_sd)},
          {"normalized_mean", json_number(axis.normalized_mean)},
          {"normalized_rms", json_number(axis.normalized_rms)},
          {"bias_significance", json_number(axis.bias_significance)},
          {"coverage", coverage_json(axis.coverage)}};
}

Json direction_json(const ErrorDirection& direction) {
  Json correlation = Json::array();
  for (const double part : direction.correlation) correlation.push_back(part);
  return {{"name", direction.name},
          {"ratio", json_number(direction.ratio)},
          {"limit", direction.limit},
          {"correlation", std::move(correlation)}};
}

Json series_json(const std::vector<FrameConsistency>& frames) {
  Json json = {{"stamps_s", Json::array()},
               {"nees", Json::array()},
               {"rotation_nees", Json::array()},
               {"position_nees", Json::array()}};
  for (const FrameConsistency& frame : frames) {
    json["stamps_s"].push_back(frame.stamp_s);
    json["nees"].push_back(frame.nees);
    json["rotation_nees"].push_back(frame.rotation_nees);
    json["position_nees"].push_back(frame.position_nees);
  }
  return json;
}

Json pose_json(const NamedConsistency& pose) {
  const ConsistencyReport& report = pose.report;
  Json axes = Json::array();
  for (const AxisConsistency& axis : report.axes) axes.push_back(axis_json(axis));
  return {{"name", pose.name},
          {"frames", report.frames.size()},
          {"verdict", word_of(report.verdict)},
          {"findings", report.findings},
          {"pose", summary_json(report.pose)},
          {"rotation", report.rotation ? summary_json(*report.rotation) : Json(nullptr)},
          {"position", summary_json(report.position)},
          {"axes", std::move(axes)},
          {"most_overconfident", direction_json(report.most_overconfident)},
          {"most_cautious", direction_json(report.most_cautious)},
          {"constant_share", report.constant_share},
          {"series", series_json(report.frames)}};
}

std::string summary_row(const char* name, const NeesSummary& s) {
  return fmt::format(
      "  {:<10} {:>3}  {:>8.3g}  {:>8.3g} {:>8.3g}  {:>8.3g} {:>8.3g}  {:>8.3g}  {:>8.3g} {:>9.6g} "
      " {:>6.3f}\n",
      name, s.dof, s.anees, s.interval.low, s.interval.high, s.band.low, s.band.high, s.median,
      s.worst, s.worst_stamp_s, s.within_frame_band);
}

std::string coverage_text(const Coverage& coverage) {
  std::string text;
  for (std::size_t i = 0; i < 3; ++i)
    text += fmt::format("  {:>5.3f} ({:.3f})", coverage.shares[i], coverage.nominal[i]);
  return text;
}

std::string axis_row(const AxisConsistency& axis) {
  const bool rotation = axis.axis.starts_with("rotation");
  const double unit = rotation ? degrees(1.0) : 1e3;
  return fmt::format("  {:<10}  {:>9.3g} {:>9.3g} {:>9.3g} {:>3}  {:>8.3g} {:>8.3g}{}\n", axis.axis,
                     unit * axis.mean_error, unit * axis.rms_error, unit * axis.rms_sd,
                     rotation ? "deg" : "mm", axis.normalized_mean, axis.normalized_rms,
                     coverage_text(axis.coverage));
}

/// How many independent frames there are, which two do not tell.
std::string worth_text(std::size_t frames, double effective_frames) {
  if (frames == 2) return "counted as one";
  return fmt::format("worth {:.3g} independent ones", effective_frames);
}

std::string pose_text(const NamedConsistency& pose, ErrorAxes axes) {
  const ConsistencyReport& report = pose.report;
  const std::vector<FrameConsistency>& frames = report.frames;
  std::string text = fmt::format("{}: {} frames, {:.6g} to {:.6g} s, {}\n", pose.name,
                                 frames.size(), frames.front().stamp_s, frames.back().stamp_s,
                                 worth_text(frames.size(), report.pose.effective_frames));
  for (const std::string& finding : report.findings) text += fmt::format("  {}\n", finding);
  text += fmt::format("\n  {:<10} {:>3}  {:>8}  {:>17}  {:>17}  {:>8}  {:>8} {:>9}  {:>6}\n",
                      "NEES / dof", "dof", "mean", "95 % interval", "if consistent", "median",
                      "worst", "at s", "inside");
  text += summary_row("pose", report.pose);
  if (report.rotation) text += summary_row("rotation", *report.rotation);
  text += summary_row("position", report.position);
  text += fmt::format("\n  {:<10}  {:>9} {:>9} {:>9} {:>3}  {:>8} {:>8}  {:>13}  {:>13}  {:>13}\n",
                      fmt::format("{} axes", word_of(axes)), "mean", "rms", "sd", "", "mean/sd",
                      "rms/sd", "in 1 sigma", "in 2 sigma", "in 3 sigma");
  for (const AxisConsistency& axis : report.axes) text += axis_row(axis);
  text += fmt::format("  {:<64}{}\n", "ellipsoid of the pose", coverage_text(report.pose.coverage));
  const auto direction = [](const ErrorDirection& found) {
    return fmt::format("{:.3g} along {} (limit {:.3g})", found.ratio, found.name, found.limit);
  };
  text += fmt::format("\n  mean squared error over mean variance: most {}\n  {:>38} least {}\n",
                      direction(report.most_overconfident), "", direction(report.most_cautious));
  return text;
}

std::string alignment_text(Alignment alignment) {
  switch (alignment) {
    case Alignment::none:
      break;
    case Alignment::first:
      return "Aligned at the first pair, which is left out: what follows is of the poses relative "
             "to it, and so\nshould be the covariances.\n";
    case Alignment::se3:
      return "Aligned by the rigid motion that brings the positions nearest: it absorbs a part of "
             "the error that the\ncovariances count, so the estimate looks more cautious than it "
             "is.\n";
  }
  return "";
}

}  // namespace

std::string format_consistency(const ConsistencyResults& results) {
  Json poses = Json::array();
  for (const NamedConsistency& pose : results.poses) poses.push_back(pose_json(pose));
  const Json json = {{"schema", kConsistencySchema},  {"type", "posemix.consistency"},
                     {"title", results.title},        {"alignment", word_of(results.alignment)},
                     {"axes", word_of(results.axes)}, {"poses", std::move(poses)}};
  return json_text(json, 1);
}

std::string format_consistency_text(const ConsistencyResults& results) {
  std::string text = fmt::format("{}\n{}", results.title, alignment_text(results.alignment));
  for (const NamedConsistency& pose : results.poses) {
    if (pose.report.frames.empty())
      throw InvalidInput(fmt::format("consistency: pose '{}' has no frame", pose.name));
    text += fmt::format("\n{}", pose_text(pose, results.axes));
  }
  return text;
}

std::string format_consistency_table(const ConsistencyResults& results) {
  std::string text = "pose,stamp_s,nees_per_dof,rotation_nees_per_dof,position_nees_per_dof\n";
  for (const auto& [name, report] : results.poses) {
    for (const FrameConsistency& frame : report.frames) {
      const auto per_dof = [](double nees, const NeesSummary& of) {
        return nees / static_cast<double>(of.dof);
      };
      text += fmt::format(
          "{},{},{},{},{}\n", name, frame.stamp_s, per_dof(frame.nees, report.pose),
          report.rotation ? fmt::format("{}", per_dof(frame.rotation_nees, *report.rotation)) : "",
          per_dof(frame.position_nees, report.position));
    }
  }
  return text;
}

std::vector<NamedText> format_consistency_files(const ConsistencyResults& results) {
  return {{"consistency.json", format_consistency(results)},
          {"consistency.csv", format_consistency_table(results)},
          {"consistency.svg", draw_consistency(results.title, results.poses)},
          {"consistency.md", format_consistency_text(results)}};
}

}  // namespace posemix
