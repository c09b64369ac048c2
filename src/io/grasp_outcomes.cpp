// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/grasp_outcomes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSource = "consensus-driven-uncertainty";
constexpr std::string_view kGrasp = "grasp_";
constexpr std::array<std::string_view, 7> kPoseColumns{"tx", "ty", "tz", "qx", "qy", "qz", "qw"};

/// The rows of a table, by the names of its columns.
class Table {
 public:
  Table(std::string_view text, const std::string& name) : reader_(text, name) {
    if (!reader_.next_content()) {
      throw InvalidInput(fmt::format("{}: got no line, expected the names of the columns", name));
    }
    for (const std::string_view column : split_fields(reader_.line(), ',')) {
      const std::string word(trimmed(column));
      if (!columns_.emplace(word, columns_.size()).second) {
        reader_.fail(fmt::format("column {} again", in_quotes(word)), "every column once");
      }
    }
  }

  bool next() {
    if (!reader_.next_content()) return false;
    fields_ = split_fields(reader_.line(), ',');
    if (fields_.size() == columns_.size()) return true;
    reader_.fail(fmt::format("{} columns", fields_.size()), fmt::format("{}", columns_.size()));
  }

  std::vector<std::string> grippers() const {
    std::vector<std::string> names;
    for (const auto& [column, index] : columns_) {
      if (column.size() > kGrasp.size() && column.starts_with(kGrasp)) {
        names.push_back(column.substr(kGrasp.size()));
      }
    }
    return names;
  }

  void require_column(const std::string& column) const {
    if (columns_.count(column) == 0) reader_.fail("no column " + column, "one of that name");
  }

  std::string_view field(const std::string& column) const {
    return trimmed(fields_[columns_.at(column)]);
  }
  double number(const std::string& column) const {
    return reader_.number_from(field(column), column);
  }
  std::int64_t index(const std::string& column) const {
    return reader_.index_from(field(column), column);
  }

  SE3d pose(const std::string& prefix) const {
    PoseNumbers numbers;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] = number(prefix + std::string(kPoseColumns[i]));
    }
    const double norm =
        Eigen::Map<const Eigen::Vector4d>(numbers.data() + 3).stableNorm();  // qx qy qz qw
    if (!(std::abs(norm - 1.0) <= kQuaternionNormTolerance)) {
      reader_.fail(
          fmt::format("a quaternion of norm {:.6g} in {}qx ... {}qw", norm, prefix, prefix),
          fmt::format("norm 1 within {:g}", kQuaternionNormTolerance));
    }
    return pose_from_numbers(numbers, reader_);
  }

  std::optional<bool> outcome(const std::string& gripper) const {
    const std::string column = std::string(kGrasp) + gripper;
    const std::string_view word = field(column);
    if (word.empty()) return std::nullopt;
    const auto number = parse_number(word);
    if (number == 0.0 || number == 1.0) return number == 1.0;
    reader_.fail(fmt::format("{} = {}", column, in_quotes(word)), "0, 1 or nothing");
  }

  const LineReader& reader() const { return reader_; }

 private:
  LineReader reader_;
  std::map<std::string, std::size_t> columns_;
  std::vector<std::string_view> fields_;
};

/// Places of the table's grippers among all; new ones come last.
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

void require_columns(const Table& table) {
  for (const char* column : {"scene_id", "im_id", "obj_id", "score"}) table.require_column(column);
  for (const std::string prefix : {"est_", "gt_"}) {
    for (const std::string_view column : kPoseColumns) {
      table.require_column(prefix + std::string(column));
    }
  }
}

}  // namespace

void parse_grasp_outcomes(std::string_view text, const std::string& name,
                          const std::string& dataset, const std::string& estimator,
                          GraspOutcomes& outcomes) {
  Table table(text, name);
  require_columns(table);
  const std::vector<std::string> grippers = table.grippers();
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
      trial.outcomes[places[i]] = table.outcome(grippers[i]);
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
  const fs::path source = fs::is_directory(below) ? below : folder;
  if (!fs::is_directory(source)) {
    throw InvalidInput(fmt::format("{}: no such folder, expected one with tables of grasp outcomes",
                                   folder.string()));
  }
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(source)) {
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
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
