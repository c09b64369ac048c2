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
  for (const char* name : {"mode_probability", "mode_probability_error", "right_mode",
                           "right_mode_error", "rotation_deg", "rotation_standard_error_deg",
                           "position_m", "position_standard_error_m", "duplicates", "instances"})
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
  for (const char* key : {"mode_probability", "right_mode", "rotation_deg", "position_m"}) {
    const Estimate estimate = mean(key);
    row.insert(row.end(), {estimate.mean, estimate.error});
  }
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
    ChartSeries series{.label = kPoses[pose], .bars = true, .markers = true};
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
      const double anees = std::get<double>(table.rows()[i][2 + 5 * pose]);
      const double error = std::get<double>(table.rows()[i][3 + 5 * pose]);
      series.x.push_back(static_cast<double>(i + 1) + 0.12 * (static_cast<double>(pose) - 1.0));
      series.y.push_back(anees);
      series.lower.push_back(anees - error);
      series.upper.push_back(anees + error);
    }
    chart.series.push_back(std::move(series));
  }
  for (std::size_t i = 0; i < table.rows().size(); ++i)
    chart.x_ticks.push_back(static_cast<double>(i + 1));
  chart.marks = {{1.0, "consistent"}};
  return draw_charts("Consistency of the defaults on simulated recordings",
                     std::span<const Chart>(&chart, 1), 1,
                     "Bars: one standard error of the mean over the recordings.");
}

constexpr std::string_view kConsistencyQuestion =
    "Are the errors of the default filter as large as its covariances say, on simulated recordings "
    "of several kinds?";

/// Where the ANEES differs from 1 by more than two of its standard errors.
std::vector<std::string> consistency_notes(const StudyTable& table, std::size_t runs) {
  std::vector<std::string> notes{
      "ANEES is 1 when consistent, larger when overconfident, smaller when cautious."};
  if (runs < 2) return notes;
  for (std::size_t pose = 0; pose < kPoses.size(); ++pose) {
    std::vector<std::string> above;
    for (const auto& row : table.rows()) {
      const double anees = std::get<double>(row[2 + 5 * pose]);
      const double error = std::get<double>(row[3 + 5 * pose]);
      if (anees - 2.0 * error > 1.0)
        above.push_back(fmt::format("{} ({:.3g})", std::get<std::string>(row[0]), anees));
    }
    notes.push_back(above.empty()
                        ? fmt::format("{}: nowhere overconfident by more than two standard errors.",
                                      kPoses[pose])
                        : fmt::format("{}: overconfident by more than two standard errors in {}.",
                                      kPoses[pose], fmt::join(above, ", ")));
  }
  return notes;
}

StudyReport report(const std::vector<ConsistencyCell>& cells, std::size_t runs,
                   std::span<const std::string> results) {
  StudyTable table(columns());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::vector<Json> trials;
    trials.reserve(runs);
    for (std::size_t run = 0; run < runs; ++run)
      trials.push_back(Json::parse(results[i * runs + run]));
    table.add(row_of(cells[i].name, trials));
  }
  const std::vector<std::string> notes = consistency_notes(table, runs);
  return {{{"study.json", format_study({"consistency", kConsistencyQuestion, notes}, table)},
           {"consistency.csv", table.csv()},
           {"consistency.svg", figure(table)}},
          summary_of(table).text(3),
          notes};
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
