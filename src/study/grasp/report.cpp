// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/grasp/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "draw/picture_colours.hpp"
#include "posemix/base/units.hpp"
#include "posemix/draw/chart.hpp"
#include "posemix/grasp/scores.hpp"
#include "study/engine/table.hpp"
#include "study/grasp/methods.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

/// A predicted grasp, as an item reports it.
struct Grasp {
  std::string split, fold, object, gripper, estimator;
  std::int64_t scene, image;
  std::string region;
  bool success;
  std::vector<double> probabilities;  ///< by method
  std::size_t group;                  ///< object and gripper
};

std::vector<Grasp> grasps_of(const std::vector<Json>& items) {
  std::vector<Grasp> grasps;
  std::map<std::pair<std::string, std::string>, std::size_t> groups;
  for (const Json& item : items) {
    for (const Json& g : item["grasps"]) {
      const std::size_t group = groups.try_emplace({g[0], g[1]}, groups.size()).first->second;
      grasps.push_back({item["split"], item["fold"], g[0], g[1], g[2], g[3], g[4], g[5],
                        g[6].get<int>() == 1, g[7], group});
    }
  }
  return grasps;
}

/// All objects that have a region of their own.
constexpr const char* kLearnt = "learnt";
/// The grasps that a row is about; empty names stand for all.
struct Selection {
  std::string split, object, gripper, estimator;

  /// A row about all objects leaves out those whose outcomes are of one kind: there is nothing to
  /// predict.
  bool holds(const Grasp& g) const {
    return (split.empty() || g.split == split) && holds_object(g) &&
           (gripper.empty() || g.gripper == gripper) &&
           (estimator.empty() || g.estimator == estimator);
  }

  bool holds_object(const Grasp& g) const {
    if (object.empty()) return g.region != "base_rate";
    return object == kLearnt ? g.region == "own" : g.object == object;
  }
};

/// What rows are about: everything, by gripper, by estimator, by object and gripper, by all three;
/// for every split, and for all splits together where there are several.
std::vector<Selection> selections_of(const std::vector<Grasp>& grasps) {
  std::array<std::set<std::array<std::string, 4>>, 5> levels;
  std::set<std::string> splits;
  for (const Grasp& g : grasps) splits.insert(g.split);
  for (const Grasp& g : grasps) {
    levels[0].insert({g.split, "", "", ""});
    levels[1].insert({g.split, "", g.gripper, ""});
    levels[2].insert({g.split, "", "", g.estimator});
    levels[3].insert({g.split, g.object, g.gripper, ""});
    levels[4].insert({g.split, g.object, g.gripper, g.estimator});
    if (g.region == "pooled") {
      levels[0].insert({g.split, kLearnt, "", ""});
      levels[1].insert({g.split, kLearnt, g.gripper, ""});
    }
    if (splits.size() < 2) continue;
    levels[0].insert({"", "", "", ""});
    levels[1].insert({"", "", g.gripper, ""});
    levels[2].insert({"", "", "", g.estimator});
  }
  std::vector<Selection> selections;
  for (const auto& level : levels) {
    for (const auto& [split, object, gripper, estimator] : level) {
      selections.push_back({split, object, gripper, estimator});
    }
  }
  std::stable_sort(selections.begin(), selections.end(),
                   [](const auto& a, const auto& b) { return a.split > b.split; });
  return selections;
}

std::vector<ScoredPrediction> scored(const std::vector<const Grasp*>& grasps, std::size_t method) {
  std::vector<ScoredPrediction> predictions;
  predictions.reserve(grasps.size());
  for (const Grasp* g : grasps) {
    predictions.push_back({g->probabilities[method], g->success, g->group});
  }
  return predictions;
}

std::string region_of(const std::vector<const Grasp*>& grasps) {
  const std::string first = grasps.front()->region;
  const bool same =
      std::all_of(grasps.begin(), grasps.end(), [&](const Grasp* g) { return g->region == first; });
  return same ? first : "mixed";
}

std::string or_all(const std::string& name) { return name.empty() ? "all" : name; }

StudyTable score_table(const std::vector<Grasp>& grasps, std::size_t bins) {
  StudyTable table({"method", "split", "object", "gripper", "estimator", "region", "grasps",
                    "successes", "brier", "log_loss", "auc", "calibration_error", "accuracy"});
  for (const Selection& selection : selections_of(grasps)) {
    std::vector<const Grasp*> chosen;
    for (const Grasp& g : grasps) {
      if (selection.holds(g)) chosen.push_back(&g);
    }
    if (chosen.empty()) continue;
    const auto successes =
        std::count_if(chosen.begin(), chosen.end(), [](const Grasp* g) { return g->success; });
    for (std::size_t method = 0; method < kGraspMethods.size(); ++method) {
      const std::vector<ScoredPrediction> p = scored(chosen, method);
      table.add({kGraspMethods[method], or_all(selection.split), or_all(selection.object),
                 or_all(selection.gripper), or_all(selection.estimator), region_of(chosen),
                 static_cast<std::int64_t>(p.size()), std::int64_t{successes}, brier_score(p),
                 log_loss(p), auc_within_groups(p), calibration_error(p, bins), accuracy(p)});
    }
  }
  return table;
}

StudyTable prediction_table(const std::vector<Grasp>& grasps) {
  std::vector<std::string> columns{"split",    "fold",  "object", "gripper", "estimator",
                                   "scene_id", "im_id", "region", "success"};
  columns.insert(columns.end(), kGraspMethods.begin(), kGraspMethods.end());
  StudyTable table(columns);
  for (const Grasp& g : grasps) {
    std::vector<Cell> row{g.split,   g.fold,      g.object,
                          g.gripper, g.estimator, g.scene,
                          g.image,   g.region,    std::int64_t{g.success ? 1 : 0}};
    for (const double p : g.probabilities) row.emplace_back(p);
    table.add(std::move(row));
  }
  return table;
}

constexpr double kMetresPerMillimetre = 1e-3;

constexpr std::array kAxisNames{"rotation_x_deg",   "rotation_y_deg",   "rotation_z_deg",
                                "translation_x_mm", "translation_y_mm", "translation_z_mm"};

std::vector<std::string> region_columns() {
  std::vector<std::string> columns{"split", "fold", "object", "gripper", "successes", "failures"};
  for (const std::string part : {"centre_", "half_width_", "identified_"}) {
    for (const std::string axis : kAxisNames) {
      columns.push_back(part + (part == "identified_" ? axis.substr(0, axis.rfind('_')) : axis));
    }
  }
  for (const char* column : {"softness", "lever_x_mm", "lever_y_mm", "lever_z_mm", "success_inside",
                             "success_outside", "converged"}) {
    columns.emplace_back(column);
  }
  return columns;
}

void add_region(const Json& region, std::vector<Cell>& row) {
  const auto flag = [](const Json& value) { return std::int64_t{value.get<bool>() ? 1 : 0}; };
  for (const char* part : {"centre", "half_width"}) {
    for (std::size_t k = 0; k < 6; ++k) {
      row.emplace_back(region[part][k].get<double>() / (k < 3 ? kRadPerDeg : kMetresPerMillimetre));
    }
  }
  for (const Json& identified : region["identified"]) row.emplace_back(flag(identified));
  row.emplace_back(region["softness"].get<double>());
  for (const Json& p : region["lever"]) row.emplace_back(p.get<double>() / kMetresPerMillimetre);
  row.emplace_back(region["inside"].get<double>());
  row.emplace_back(region["outside"].get<double>());
  row.emplace_back(flag(region["converged"]));
}

StudyTable region_table(const std::vector<Json>& items) {
  const std::vector<std::string> columns = region_columns();
  StudyTable table(columns);
  for (const Json& item : items) {
    for (const Json& region : item["regions"]) {
      std::vector<Cell> row{
          item["split"].get<std::string>(),        item["fold"].get<std::string>(),
          region["object"].get<std::string>(),     region["gripper"].get<std::string>(),
          region["successes"].get<std::int64_t>(), region["failures"].get<std::int64_t>()};
      if (region.contains("centre")) add_region(region, row);
      row.resize(columns.size());
      table.add(std::move(row));
    }
  }
  return table;
}

StudyTable error_table(const std::vector<Json>& items) {
  StudyTable table(
      {"split", "fold", "dataset", "estimator", "errors", "components", "outlier_weight"});
  for (const Json& item : items) {
    for (const Json& e : item["errors"]) {
      table.add({item["split"].get<std::string>(), item["fold"].get<std::string>(),
                 e[0].get<std::string>(), e[1].get<std::string>(), e[2].get<std::int64_t>(),
                 e[3].get<std::int64_t>(), e[4].get<double>()});
    }
  }
  return table;
}

std::string reliability_chart(const std::vector<Grasp>& grasps, std::size_t bins) {
  std::vector<Chart> charts;
  for (const Selection& selection : selections_of(grasps)) {
    if (!selection.object.empty() || !selection.gripper.empty() || !selection.estimator.empty()) {
      continue;
    }
    std::vector<const Grasp*> chosen;
    for (const Grasp& g : grasps) {
      if (selection.holds(g)) chosen.push_back(&g);
    }
    Chart chart{.title = "split " + or_all(selection.split),
                .x_label = "predicted probability",
                .y_label = "success rate",
                .x_range = std::pair{0.0, 1.0},
                .y_range = std::pair{0.0, 1.0}};
    chart.series.push_back({.label = "ideal",
                            .x = {0, 1},
                            .y = {0, 1},
                            .color = std::string(internal::kTruthColour),
                            .dash = "4 4"});
    std::size_t method = 0;
    for (const auto& name : kGraspMethods) {
      ChartSeries series{.label = name, .markers = true};
      for (const ReliabilityBin& bin : reliability(scored(chosen, method++), bins)) {
        if (bin.count == 0) continue;
        series.x.push_back(bin.mean_probability);
        series.y.push_back(bin.success_rate);
      }
      chart.series.push_back(std::move(series));
    }
    charts.push_back(std::move(chart));
  }
  return draw_charts("Predicted and observed success of grasps", charts, 2);
}

std::string mean_scores(const StudyTable& scores) {
  StudyTable table({"split", "gripper", "method", "grasps", "brier", "log_loss", "auc",
                    "calibration_error", "accuracy"});
  for (const std::vector<Cell>& row : scores.rows()) {
    if (row[2] != Cell("all") || row[4] != Cell("all")) continue;
    table.add({row[1], row[3], row[0], row[6], row[8], row[9], row[10], row[11], row[12]});
  }
  return table.text(3);
}

constexpr std::string_view kGraspQuestion =
    "How well is the success of a grasp predicted from the uncertainty of pose estimators?";

std::vector<std::string> grasp_notes(const StudyTable& scores) {
  const std::string bound = "region_at_true_error";
  std::pair best(std::numeric_limits<double>::infinity(), std::string());
  for (const std::vector<Cell>& row : scores.rows()) {
    const bool is_all = row[2] == Cell("all") && row[3] == Cell("all") && row[4] == Cell("all");
    const auto& name = std::get<std::string>(row[0]);
    if (is_all && name != bound) best = std::min(best, std::pair(std::get<double>(row[8]), name));
  }
  return {"Rows about all objects are of those whose outcomes are of both kinds.",
          bound + " knows the truth: it is a bound, not a method.",
          fmt::format("The least Brier score has {}: {:.3g}.", best.second, best.first)};
}

}  // namespace

StudyReport report_grasp(std::span<const std::string> results, std::size_t bins) {
  std::vector<Json> items;
  for (const std::string& result : results) items.push_back(Json::parse(result));
  const std::vector<Grasp> grasps = grasps_of(items);
  const StudyTable scores = score_table(grasps, bins);
  const std::vector<std::string> notes = grasp_notes(scores);
  return {{{"study.json", format_study({"grasp", kGraspQuestion, notes}, scores)},
           {"scores.csv", scores.csv()},
           {"predictions.csv", prediction_table(grasps).csv()},
           {"regions.csv", region_table(items).csv()},
           {"errors.csv", error_table(items).csv()},
           {"reliability.svg", reliability_chart(grasps, bins)}},
          mean_scores(scores),
          notes};
}

}  // namespace posemix
