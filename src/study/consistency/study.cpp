// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"
#include "posemix/draw/chart.hpp"
#include "study/engine/table.hpp"
#include "trial.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 3> kPoses{"camera", "object", "relative"};

Json consistency_json(const PoseConsistency& pose) {
  return {{"nees", pose.nees}, {"covered", pose.covered}, {"count", pose.count}};
}

std::string item_text(const ConsistencyCell& cell, std::uint64_t seed, std::uint64_t run) {
  const ConsistencyTrial trial = run_consistency_trial(cell, seed, run);
  return Json{{"camera", consistency_json(trial.camera)},
              {"object", consistency_json(trial.object)},
              {"relative", consistency_json(trial.relative)},
              {"mode_probability", trial.mode_probability},
              {"right_mode", trial.right_mode},
              {"rotation_deg", trial.rotation_deg},
              {"position_m", trial.position_m},
              {"duplicates", trial.duplicates},
              {"instances", trial.instances}}
      .dump();
}

/// Mean over recordings, and the standard error from their scatter.
struct Estimate {
  double mean = 0.0;
  double error = 0.0;
};

Estimate estimate_of(const std::vector<double>& values) {
  if (values.empty()) return {std::nan(""), std::nan("")};
  const auto n = static_cast<double>(values.size());
  Estimate result;
  double squares = 0.0;
  for (const double value : values) result.mean += value / n;
  for (const double value : values) squares += std::pow(value - result.mean, 2);
  result.error = values.size() > 1 ? std::sqrt(squares / (n - 1.0) / n) : std::nan("");
  return result;
}

std::vector<std::string> columns() {
  std::vector<std::string> names{"cell", "runs"};
  for (const char* pose : kPoses) {
    for (const char* of :
         {"anees", "anees_error", "within_1_sigma", "within_2_sigma", "within_3_sigma"})
      names.push_back(fmt::format("{}_{}", pose, of));
  }
  for (const char* name : {"mode_probability", "right_mode", "right_mode_error", "rotation_deg",
                           "position_m", "duplicates", "instances"})
    names.emplace_back(name);
  return names;
}

/// The recordings of one cell as a row.
std::vector<Cell> row_of(const std::string& name, const std::vector<Json>& trials) {
  std::vector<Cell> row{name, static_cast<std::int64_t>(trials.size())};
  for (const char* pose : kPoses) {
    std::vector<double> nees;
    std::array<std::vector<double>, 3> covered;
    for (const Json& trial : trials) {
      const Json& values = trial.at(pose);
      if (values.at("count") == 0) continue;
      nees.push_back(values.at("nees"));
      for (std::size_t i = 0; i < 3; ++i) covered[i].push_back(values.at("covered")[i]);
    }
    const Estimate anees = estimate_of(nees);
    row.emplace_back(anees.mean);
    row.emplace_back(anees.error);
    for (const auto& shares : covered) row.emplace_back(estimate_of(shares).mean);
  }
  const auto mean = [&](const char* key) {
    std::vector<double> values;
    values.reserve(trials.size());
    for (const Json& trial : trials) values.push_back(trial.at(key));
    return estimate_of(values);
  };
  row.emplace_back(mean("mode_probability").mean);
  row.emplace_back(mean("right_mode").mean);
  row.emplace_back(mean("right_mode").error);
  row.emplace_back(mean("rotation_deg").mean);
  row.emplace_back(mean("position_m").mean);
  for (const char* key : {"duplicates", "instances"}) {
    std::int64_t sum = 0;
    for (const Json& trial : trials) sum += trial.at(key).get<std::int64_t>();
    row.emplace_back(sum);
  }
  return row;
}

StudyTable summary_of(const StudyTable& table) {
  const std::vector<std::string> shown{"cell",
                                       "camera_anees",
                                       "camera_anees_error",
                                       "object_anees",
                                       "object_anees_error",
                                       "relative_anees",
                                       "relative_anees_error",
                                       "relative_within_2_sigma",
                                       "mode_probability",
                                       "right_mode",
                                       "rotation_deg",
                                       "position_m",
                                       "duplicates"};
  StudyTable summary(shown);
  for (const auto& row : table.rows()) {
    std::vector<Cell> cells;
    for (const std::string& name : shown) {
      const auto at = std::find(table.columns().begin(), table.columns().end(), name);
      cells.push_back(row[static_cast<std::size_t>(at - table.columns().begin())]);
    }
    summary.add(std::move(cells));
  }
  return summary;
}

/// ANEES by cell, with the band of what is asked.
std::string figure(const StudyTable& table) {
  Chart chart{.x_label = "cell, in the order of the table", .y_label = "ANEES"};
  for (std::size_t pose = 0; pose < kPoses.size(); ++pose) {
    ChartSeries series{.label = kPoses[pose], .markers = true};
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
      series.x.push_back(static_cast<double>(i + 1));
      series.y.push_back(std::get<double>(table.rows()[i][2 + 5 * pose]));
    }
    chart.series.push_back(std::move(series));
  }
  return draw_charts("Consistency of the defaults on simulated recordings",
                     std::span<const Chart>(&chart, 1), 1);
}

StudyReport report(const std::vector<ConsistencyCell>& cells, std::size_t runs,
                   std::span<const std::string> results) {
  StudyTable table(columns());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::vector<Json> trials;
    for (std::size_t run = 0; run < runs; ++run)
      trials.push_back(Json::parse(results[i * runs + run]));
    table.add(row_of(cells[i].name, trials));
  }
  return {{{"study.json", format_study("consistency", table)},
           {"consistency.csv", table.csv()},
           {"consistency.svg", figure(table)}},
          summary_of(table).text(3)};
}

std::vector<ConsistencyCell> chosen_cells(const std::vector<std::string>& names) {
  const auto& all = consistency_cells();
  if (names.empty()) return all;
  std::vector<ConsistencyCell> chosen;
  for (const std::string& name : names) {
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const ConsistencyCell& cell) { return cell.name == name; });
    if (found == all.end()) {
      std::vector<std::string> known;
      known.reserve(all.size());
      for (const ConsistencyCell& cell : all) known.push_back(cell.name);
      throw InvalidInput(
          fmt::format("cell '{}', expected some of: {}", name, fmt::join(known, ", ")));
    }
    chosen.push_back(*found);
  }
  return chosen;
}

}  // namespace

ConsistencyStudySettings read_consistency_settings(const TomlTable& table) {
  ConsistencyStudySettings settings;
  settings.runs = static_cast<std::size_t>(table.get_integer_or(
      "runs", static_cast<std::int64_t>(settings.runs), {.lowest = 1, .highest = 1000000}));
  settings.seed = static_cast<std::uint64_t>(table.get_integer_or(
      "seed", static_cast<std::int64_t>(settings.seed), {.lowest = 0, .highest = 1000000000}));
  settings.cells = table.get_strings_or("cells", settings.cells);
  try {
    chosen_cells(settings.cells);
  } catch (const InvalidInput& error) {
    table.fail("cells", fmt::format("names a {}", error.what()));
  }
  return settings;
}

Study make_consistency_study(const ConsistencyStudySettings& settings) {
  require(settings.runs > 0, "consistency: runs is 0, expected at least 1");
  const std::vector<ConsistencyCell> cells = chosen_cells(settings.cells);
  Json names = Json::array();
  for (const ConsistencyCell& cell : cells) names.push_back(cell.name);
  const Json json{{"runs", settings.runs}, {"seed", settings.seed}, {"cells", names}};
  const std::size_t runs = settings.runs;
  return {
      "consistency", json.dump(), cells.size() * runs,
      [cells, settings](std::size_t item) {
        return item_text(cells[item / settings.runs], settings.seed, item % settings.runs);
      },
      [cells, runs](std::span<const std::string> results) { return report(cells, runs, results); }};
}

}  // namespace posemix
