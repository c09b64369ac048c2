// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report.hpp"

#include <map>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "draw/method_colours.hpp"
#include "posemix/draw/chart.hpp"
#include "study/engine/table.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

/// Values of one rule over the angles.
using Curves = std::map<std::string, std::vector<double>>;

struct Part {
  std::vector<std::string> rules;  ///< rules in their order
  std::map<std::string, Curves> values;
};

/// The numbers of one part of all items.
Part collect(std::span<const std::string> results, const char* part) {
  Part collected;
  for (const std::string& text : results) {
    const Json item = Json::parse(text);
    for (const Json& row : item.at(part)) {
      const auto rule = row.at("rule").get<std::string>();
      if (!collected.values.contains(rule)) collected.rules.push_back(rule);
      for (const auto& [key, value] : row.items()) {
        if (value.is_number()) collected.values[rule][key].push_back(value.get<double>());
      }
    }
  }
  return collected;
}

StudyTable table_of(const DivergenceStudySettings& settings, const Part& part,
                    const std::vector<std::string>& quantities) {
  std::vector<std::string> columns{"phi_deg", "rule"};
  columns.insert(columns.end(), quantities.begin(), quantities.end());
  StudyTable table(columns);
  for (std::size_t i = 0; i < settings.phi_deg.size(); ++i) {
    for (const std::string& rule : part.rules) {
      std::vector<Cell> row{settings.phi_deg[i], rule};
      for (const std::string& quantity : quantities) {
        row.emplace_back(part.values.at(rule).at(quantity)[i]);
      }
      table.add(std::move(row));
    }
  }
  return table;
}

ChartSeries curve(const DivergenceStudySettings& settings, const std::string& rule,
                  std::vector<double> y) {
  ChartSeries series = internal::method_series(rule);
  series.x = settings.phi_deg;
  series.y = std::move(y);
  return series;
}

/// Fig. 3: the loss of each rule in excess of the midway merge, and the losses themselves.
std::string figure(const DivergenceStudySettings& settings, const Part& part) {
  const auto chart = [](const char* y_label) {
    return Chart{.x_label = "phi [deg]", .y_label = y_label};
  };
  std::vector<Chart> charts{chart("KL - KL of midway [nats]"),
                            chart("ISD - ISD of midway [rad^-3]"), chart("KL [nats]"),
                            chart("ISD [rad^-3]")};
  constexpr std::array<std::string_view, 2> kQuantities{"kl", "isd"};
  for (const std::string& rule : part.rules) {
    for (std::size_t q = 0; q < kQuantities.size(); ++q) {
      const std::string key(kQuantities[q]);
      const std::vector<double>& values = part.values.at(rule).at(key);
      std::vector<double> differences = values;
      for (std::size_t i = 0; i < values.size(); ++i) {
        differences[i] -= part.values.at("midway").at(key)[i];
      }
      charts[q].series.push_back(curve(settings, rule, std::move(differences)));
      charts[q + 2].series.push_back(curve(settings, rule, values));
    }
  }
  return draw_charts("Loss by merging two components on SO(3)", charts, 2);
}

constexpr std::string_view kDivergenceQuestion =
    "What does merging two components on SO(3) into one lose, by the rule of the merge and the "
    "angle between the components?";

/// The losses at the widest angle, least first.
std::vector<std::string> divergence_notes(const DivergenceStudySettings& settings,
                                          const Part& part) {
  if (settings.phi_deg.empty()) return {};
  std::vector<std::pair<double, std::string>> losses;
  losses.reserve(part.rules.size());
  for (const std::string& rule : part.rules)
    losses.emplace_back(part.values.at(rule).at("kl").back(), rule);
  std::sort(losses.begin(), losses.end());
  std::string note =
      fmt::format("KL divergence that is lost at {:g} deg [nats]:", settings.phi_deg.back());
  for (const auto& [loss, rule] : losses)
    note += fmt::format("{} {} {:.4g}", rule == losses.front().second ? "" : ",", rule, loss);
  return {note + "."};
}

}  // namespace

StudyReport report_divergence(const DivergenceStudySettings& settings,
                              std::span<const std::string> results) {
  const Part exact = collect(results, "rows");
  const StudyTable table = table_of(settings, exact, {"kl", "kl_error", "isd", "isd_error"});
  const std::vector<std::string> notes = divergence_notes(settings, exact);
  StudyReport report{
      {{"study.json", format_study({"divergence", kDivergenceQuestion, notes}, table)},
       {"divergence.csv", table.csv()},
       {"divergence.svg", figure(settings, exact)}},
      table_of(settings, exact, {"kl", "isd"}).text(9),
      notes};
  if (const Part grid = collect(results, "grid"); !grid.rules.empty()) {
    report.files.push_back(
        {"paper-grid.csv", table_of(settings, grid, {"kl", "isd", "mass"}).csv()});
  }
  return report;
}

}  // namespace posemix
