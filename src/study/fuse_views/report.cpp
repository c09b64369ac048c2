// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "posemix/base/statistics.hpp"
#include "run.hpp"
#include "study/engine/table.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<Json>;
using Cells = std::vector<std::pair<std::string, Cell>>;

double total_of(const Rows& rows, const std::string& key) {
  double sum = 0.0;
  for (const Json& row : rows) sum += row.at(key).get<double>();
  return sum;
}

std::vector<double> all_of(const Rows& rows, const std::string& key) {
  std::vector<double> values;
  for (const Json& row : rows) {
    for (const Json& value : row.at(key)) values.push_back(value.get<double>());
  }
  return values;
}

Cell share_of(double part, double whole) { return whole > 0.0 ? Cell(part / whole) : Cell(); }

Cell middle_of(const std::vector<double>& values) {
  return values.empty() ? Cell() : Cell(median(values));
}

Cell mean_of(const std::vector<double>& values) {
  return values.empty() ? Cell() : Cell(mean(values));
}

/// NEES per degree of freedom, and the share within the 95 % band of a single one.
void add_consistency(const Rows& rows, Cells& cells) {
  std::vector<double> nees = all_of(rows, "nees");
  const std::vector<double> dof = all_of(rows, "dof");
  double inside = 0.0;
  double below = 0.0;
  for (std::size_t i = 0; i < nees.size(); ++i) {
    const auto count = static_cast<std::size_t>(dof[i]);
    const bool is_below = nees[i] < chi_square_quantile(0.025, count);
    below += is_below ? 1.0 : 0.0;
    inside += !is_below && nees[i] <= chi_square_quantile(0.975, count) ? 1.0 : 0.0;
    nees[i] /= dof[i];
  }
  std::vector<double> rotation = all_of(rows, "rotation_nees");
  std::vector<double> position = all_of(rows, "position_nees");
  std::vector<double> rotation_per_dof;
  for (std::size_t i = 0; i < rotation.size(); ++i) {
    if (dof[i] > 3.0) rotation_per_dof.push_back(rotation[i] / (dof[i] - 3.0));
  }
  for (double& value : position) value /= 3.0;
  const auto count = static_cast<double>(nees.size());
  cells.insert(cells.end(), {{"anees", mean_of(nees)},
                             {"median_nees", middle_of(nees)},
                             {"rotation_anees", mean_of(rotation_per_dof)},
                             {"position_anees", mean_of(position)},
                             {"within_band", share_of(inside, count)},
                             {"below_band", share_of(below, count)}});
}

Cells figures_of_case(const Rows& rows) {
  Cells cells{{"pairs", static_cast<std::int64_t>(total_of(rows, "pairs"))}};
  const double pairs = total_of(rows, "pairs");
  for (const std::string source : {"single_", "fused_"}) {
    for (const std::string name : {"found", "within_20deg_5cm", "within_10deg_2cm", "mssd_recall"})
      cells.emplace_back(source + name, share_of(total_of(rows, source + name), pairs));
    for (const std::string name : {"rotation_deg", "translation_m", "mssd_m"})
      cells.emplace_back(source + name, middle_of(all_of(rows, source + name)));
  }
  const double instances = total_of(rows, "instances");
  const double found = total_of(rows, "instances_found");
  cells.insert(
      cells.end(),
      {{"instances", static_cast<std::int64_t>(instances)},
       {"instances_found", share_of(found, instances)},
       {"right_mode", share_of(total_of(rows, "right_mode"), found)},
       {"mode_probability", mean_of(all_of(rows, "mode_probability"))},
       {"rows_false", share_of(total_of(rows, "rows_false"), total_of(rows, "rows"))},
       {"reported", static_cast<std::int64_t>(total_of(rows, "reported"))},
       {"reported_false", share_of(total_of(rows, "reported_false"), total_of(rows, "reported"))},
       {"output_true", share_of(total_of(rows, "output_true"), total_of(rows, "output"))},
       {"probability", share_of(total_of(rows, "probability"), total_of(rows, "output"))}});
  add_consistency(rows, cells);
  return cells;
}

const std::vector<std::string> kCaseKeys{"dataset", "groups_of", "input", "symmetries", "noise"};

StudyTable table_of(const std::vector<std::pair<std::vector<Cell>, Cells>>& rows,
                    std::vector<std::string> columns) {
  for (const auto& [name, value] : rows.front().second) columns.push_back(name);
  StudyTable table(columns);
  for (const auto& [head, cells] : rows) {
    std::vector<Cell> row = head;
    for (const auto& [name, value] : cells) row.push_back(value);
    table.add(std::move(row));
  }
  return table;
}

/// The summary turned, as a few columns fit a terminal.
std::string summary_text(const StudyTable& summary) {
  std::vector<std::string> columns{"figure"};
  const std::size_t keys = kCaseKeys.size();
  std::vector<std::size_t> shown;
  for (std::size_t r = 0; r < summary.rows().size(); ++r) {
    const auto& row = summary.rows()[r];
    if (std::get<std::string>(row[1]) != "random") continue;
    shown.push_back(r);
    columns.push_back(std::get<std::string>(row[0]) + ":" + std::get<std::string>(row[2]) + ":" +
                      std::get<std::string>(row[3]) + ":" + std::get<std::string>(row[4]));
  }
  StudyTable turned(columns);
  for (std::size_t c = keys; c < summary.columns().size(); ++c) {
    std::vector<Cell> row{summary.columns()[c]};
    for (const std::size_t r : shown) row.push_back(summary.rows()[r][c]);
    turned.add(std::move(row));
  }
  return turned.text(3);
}

/// For every dataset the noise learned for its first scene, for use beyond the study.
std::map<std::string, std::string> learned_noises(
    const std::map<std::vector<std::string>, Rows>& cases) {
  std::map<std::string, std::string> noises;
  for (const auto& [key, rows] : cases) {
    const Json& row = rows.front();
    if (!row.contains(kLearnedNoise)) continue;
    noises.try_emplace(key.front(), "# Learned without scene " +
                                        std::to_string(row.at("scene").get<std::int64_t>()) +
                                        " and those that were judged with it.\n" +
                                        row.at(kLearnedNoise).get<std::string>());
  }
  return noises;
}

constexpr std::string_view kFuseViewsQuestion =
    "How much better are poses that are fused from several views than those of single views, and "
    "are they consistent?";

/// Single against fused views for every case with random groups.
std::vector<std::string> fuse_views_notes(const StudyTable& summary) {
  const auto column = [&](std::string_view name) {
    const auto found = std::find(summary.columns().begin(), summary.columns().end(), name);
    return static_cast<std::size_t>(found - summary.columns().begin());
  };
  const std::size_t single = column("single_mssd_recall");
  const std::size_t fused = column("fused_mssd_recall");
  std::vector<std::string> notes;
  for (const auto& row : summary.rows()) {
    const auto* const before = std::get_if<double>(&row[single]);
    const auto* const after = std::get_if<double>(&row[fused]);
    if (std::get<std::string>(row[1]) != "random" || before == nullptr || after == nullptr)
      continue;
    notes.push_back(
        fmt::format("{}, {}, symmetries {}, noise {}: recall by MSSD {:.3g} of single "
                    "views, {:.3g} fused.",
                    std::get<std::string>(row[0]), std::get<std::string>(row[2]),
                    std::get<std::string>(row[3]), std::get<std::string>(row[4]), *before, *after));
  }
  return notes;
}

}  // namespace

StudyReport report_fuse_views(std::span<const std::string> results) {
  std::vector<std::pair<std::vector<Cell>, Cells>> rows;
  std::vector<std::vector<std::string>> order;
  std::map<std::vector<std::string>, Rows> cases;
  for (const std::string& text : results) {
    for (const Json& row : Json::parse(text)) {
      std::vector<std::string> key;
      key.reserve(kCaseKeys.size());
      for (const std::string& name : kCaseKeys) key.push_back(row.at(name));
      if (!cases.contains(key)) order.push_back(key);
      cases[key].push_back(row);
      std::vector<Cell> head(key.begin(), key.end());
      head.insert(head.begin() + 1, Cell(row.at("scene").get<std::int64_t>()));
      rows.emplace_back(std::move(head), figures_of_case({row}));
    }
  }
  std::vector<std::pair<std::vector<Cell>, Cells>> sums;
  sums.reserve(order.size());
  for (const auto& key : order)
    sums.emplace_back(std::vector<Cell>(key.begin(), key.end()), figures_of_case(cases[key]));
  std::vector<std::string> scene_keys = kCaseKeys;
  scene_keys.insert(scene_keys.begin() + 1, "scene");
  const StudyTable table = table_of(rows, scene_keys);
  const StudyTable summary = table_of(sums, kCaseKeys);
  StudyReport report;
  report.notes = fuse_views_notes(summary);
  report.files = {{"study.json",
                   format_study({"fuse-views", kFuseViewsQuestion, report.notes}, table, summary)},
                  {"fuse-views.csv", table.csv()},
                  {"summary.csv", summary.csv()}};
  for (auto& [dataset, noise] : learned_noises(cases))
    report.files.push_back({"noise-" + dataset + ".toml", std::move(noise)});
  report.summary = summary_text(summary);
  return report;
}

}  // namespace posemix
