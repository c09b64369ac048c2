// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/grasp_outcomes.hpp"

#include <algorithm>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "csv_table.hpp"
#include "paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

namespace fs = std::filesystem;

constexpr std::string_view kSource = "consensus-driven-uncertainty";
constexpr std::string_view kGrasp = "grasp_";

/// The names of the grippers of a table, from its columns grasp_GRIPPER.
std::vector<std::string> grippers_of(const CsvTable& table) {
  std::vector<std::string> names;
  for (const auto& [column, index] : table.columns()) {
    if (column.size() > kGrasp.size() && column.starts_with(kGrasp)) {
      names.push_back(column.substr(kGrasp.size()));
    }
  }
  return names;
}

std::optional<bool> outcome(const CsvTable& table, const std::string& gripper) {
  const std::string column = std::string(kGrasp) + gripper;
  const std::string_view word = table.field(column);
  if (word.empty()) return std::nullopt;
  const auto number = parse_number(word);
  if (number == 0.0 || number == 1.0) return number == 1.0;
  table.reader().fail(fmt::format("{} = {}", column, in_quotes(word)), "0, 1 or nothing");
}

/// The indices of the table's grippers among all grippers; new ones are appended.
std::vector<std::size_t> gripper_places(const std::vector<std::string>& names,
                                        GraspOutcomes& outcomes) {
  std::vector<std::string>& all = outcomes.grippers;
  std::vector<std::size_t> places;
  for (const std::string& name : names) {
    const auto found = std::find(all.begin(), all.end(), name);
    places.push_back(static_cast<std::size_t>(found - all.begin()));
    if (found == all.end()) all.push_back(name);
  }
  for (GraspTrial& trial : outcomes.trials) trial.outcomes.resize(all.size());
  return places;
}

void require_outcome_columns(const CsvTable& table) {
  for (const char* column : {"scene_id", "im_id", "obj_id", "score"}) table.require_column(column);
  table.require_pose("est_");
  table.require_pose("gt_");
}

}  // namespace

void parse_grasp_outcomes(std::string_view text, const std::string& name,
                          const std::string& dataset, const std::string& estimator,
                          GraspOutcomes& outcomes) {
  CsvTable table(text, name);
  require_outcome_columns(table);
  const std::vector<std::string> grippers = grippers_of(table);
  const std::vector<std::size_t> places = gripper_places(grippers, outcomes);
  std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> seen;
  while (table.next()) {
    GraspTrial trial{.dataset = dataset,
                     .estimator = estimator,
                     .scene = table.index("scene_id"),
                     .image = table.index("im_id"),
                     .object = table.index("obj_id"),
                     .score = table.number("score"),
                     .estimate = table.pose("est_"),
                     .truth = table.pose("gt_"),
                     .outcomes = {}};
    trial.outcomes.resize(outcomes.grippers.size());
    for (std::size_t i = 0; i < grippers.size(); ++i) {
      trial.outcomes[places[i]] = outcome(table, grippers[i]);
    }
    if (!seen.emplace(trial.scene, trial.image, trial.object).second) {
      table.reader().fail(fmt::format("object {} in image {} of scene {} again", trial.object,
                                      trial.image, trial.scene),
                          "one estimate per object and image");
    }
    outcomes.trials.push_back(std::move(trial));
  }
}

GraspOutcomes read_grasp_outcomes(const fs::path& folder) {
  const fs::path below = folder / kSource;
  const fs::path source = internal::is_folder(below) ? below : folder;
  if (!internal::is_folder(source)) {
    throw InvalidInput(fmt::format("{}: no such folder, expected one with tables of grasp outcomes",
                                   folder.string()));
  }
  std::vector<fs::path> files = internal::entries_of(source);
  std::erase_if(files, [](const fs::path& file) { return file.extension() != ".csv"; });
  GraspOutcomes outcomes;
  for (const fs::path& file : files) {
    const std::string stem = file.stem().string();
    const std::size_t split = stem.find('_');
    if (split == std::string::npos || split == 0 || split + 1 == stem.size()) {
      throw InvalidInput(
          fmt::format("{}: got this file name, expected DATASET_ESTIMATOR.csv", file.string()));
    }
    parse_grasp_outcomes(read_file(file), file.string(), stem.substr(0, split),
                         stem.substr(split + 1), outcomes);
  }
  if (outcomes.trials.empty()) {
    throw InvalidInput(
        fmt::format("{}: got no estimate, expected tables DATASET_ESTIMATOR.csv", source.string()));
  }
  return outcomes;
}

}  // namespace posemix
