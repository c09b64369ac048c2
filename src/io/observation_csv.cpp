// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/observation_csv.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "covariance_columns.hpp"
#include "csv_table.hpp"
#include "observation_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/gzip.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr const char* kWhere = "stamp_s,camera,detector,id,class,sighting,weight";

/// A column that may be missing must not be missed because of its spelling.
void refuse_other_case(const CsvTable& table) {
  std::set<std::string> known{"clutter", "score"};
  known.insert(covariance_columns().begin(), covariance_columns().end());
  for (const auto& [name, index] : table.columns()) {
    std::string lower = name;
    for (char& c : lower)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (lower != name && known.contains(lower))
      table.reader().fail("column " + in_quotes(name), in_quotes(lower));
  }
}

void require_sighting_columns(const CsvTable& table) {
  refuse_other_case(table);
  for (const std::string_view column : split_fields(kWhere, ','))
    table.require_column(std::string(column));
  for (const char* column : kPoseFields) table.require_column(column);
  const auto& columns = covariance_columns();
  const bool any = std::any_of(columns.begin(), columns.end(),
                               [&](const std::string& column) { return table.has(column); });
  if (!any) return;
  for (const std::string& column : columns) table.require_column(column);
}

/// Throws with the row and the column unless `wrong`, which is empty for a good one, is.
void check(const CsvTable& table, const std::string& column, std::string_view wrong) {
  if (wrong.empty()) return;
  table.reader().fail(fmt::format("{} = {}", column, in_quotes(table.field(column))), wrong);
}

std::optional<double> optional_number(const CsvTable& table, const std::string& column) {
  if (!table.has(column) || table.field(column).empty()) return std::nullopt;
  return table.number(column);
}

/// What all rows of a sighting share.
Observation observation_of_row(const CsvTable& table) {
  Observation row;
  for (const char* column : {"id", "class", "camera", "detector"}) {
    // Written, it would be a line break.
    if (table.field(column).find('\r') != std::string_view::npos)
      table.reader().fail(fmt::format("a carriage return in {}", column), "none");
  }
  row.object = table.field("id");
  row.class_id = table.field("class");
  if (row.object.empty() == row.class_id.empty())
    table.reader().fail(row.object.empty() ? "neither id nor class" : "both id and class",
                        "one of the two");
  row.camera = table.field("camera");
  row.detector = table.field("detector");
  row.stamp_s = table.number("stamp_s");
  check(table, "stamp_s", wrong_stamp(row.stamp_s));
  row.clutter = optional_number(table, "clutter");
  if (row.clutter) check(table, "clutter", wrong_clutter(*row.clutter));
  row.score = optional_number(table, "score");
  return row;
}

ObservationComponent component_of_row(const CsvTable& table) {
  ObservationComponent row{.weight = table.number("weight")};
  check(table, "weight", wrong_weight(row.weight));
  for (const char* column : {"tx_m", "ty_m", "tz_m"})
    check(table, column, wrong_position(table.number(column)));
  row.pose = pose_in(table);
  row.covariance = covariance_in(table);
  if (!row.covariance) return row;
  if (const auto fault = fault_of(*row.covariance))
    table.reader().fail(fault->got, fault->expected);
  return row;
}

bool is_same_sighting(const Observation& a, const Observation& b) {
  return a.object == b.object && a.class_id == b.class_id && a.camera == b.camera &&
         a.detector == b.detector && a.stamp_s == b.stamp_s && a.clutter == b.clutter &&
         a.score == b.score;
}

/// Collects the rows of one sighting after the other.
class Collector {
 public:
  explicit Collector(CsvTable& table) : table_(table) {}

  void add() {
    const std::int64_t sighting = table_.index("sighting");
    Observation row = observation_of_row(table_);
    if (current_ != sighting) {
      finish();
      if (!known_.insert(sighting).second) fail_as_split(sighting);
      current_ = sighting;
      placed_.lines.push_back(table_.reader().number());
      placed_.observations.push_back(std::move(row));
    } else if (!is_same_sighting(placed_.observations.back(), row)) {
      table_.reader().fail(
          fmt::format("other values for sighting {}", sighting),
          "one stamp, camera, detector, id, class, clutter and score in all rows of a sighting");
    }
    placed_.observations.back().components.push_back(component_of_row(table_));
  }

  /// Checks the sighting whose rows have all been read.
  void finish() {
    if (placed_.observations.empty()) return;
    try {
      validate(placed_.observations.back());
    } catch (const InvalidInput& error) {
      const std::string first_line = fmt::format("{}", placed_.lines.back());
      // What is missing may be in rows further down.
      while (table_.next())
        if (table_.index("sighting") == *current_) fail_as_split(*current_);
      throw InvalidInput(fmt::format("{}:{}: in sighting {}, which begins here: {}",
                                     table_.reader().name(), first_line, *current_, error.what()));
    }
  }

  PlacedObservations take() { return std::move(placed_); }

 private:
  [[noreturn]] void fail_as_split(std::int64_t sighting) const {
    table_.reader().fail(fmt::format("sighting {} again", sighting),
                         "the rows of a sighting one after the other");
  }

  CsvTable& table_;
  PlacedObservations placed_;
  std::set<std::int64_t> known_;
  std::optional<std::int64_t> current_;
};

std::string checked_name(const std::string& name, const char* column) {
  if (name.find_first_of(",\n\r") != std::string::npos || trimmed(name) != name ||
      name.starts_with('#')) {
    throw InvalidInput(fmt::format(
        "the {} of an observation is {}, expected one without commas, line breaks and blanks at "
        "its ends",
        column, in_quotes(name)));
  }
  return name;
}

void require_one_name(const Observation& observation) {
  if (observation.object.empty() != observation.class_id.empty()) return;
  throw InvalidInput(fmt::format(
      "an observation at stamp {} s has {}, expected one of the two", observation.stamp_s,
      observation.object.empty() ? "neither id nor class" : "both id and class"));
}

std::string optional_field(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : std::string();
}

}  // namespace

namespace internal {

PlacedObservations parse_placed_table(std::string_view text, const std::string& name) {
  CsvTable table(text, name);
  require_sighting_columns(table);
  Collector collector(table);
  while (table.next()) collector.add();
  collector.finish();
  PlacedObservations placed = collector.take();
  if (placed.observations.empty())
    throw InvalidInput(fmt::format("{}: got no rows, expected at least one", name));
  return placed;
}

}  // namespace internal

std::vector<Observation> parse_observations(std::string_view text, const std::string& name) {
  return parse_placed_table(text, name).observations;
}

std::vector<Observation> read_observations(const std::filesystem::path& path) {
  return parse_observations(read_file_or_gzip(path), path.string());
}

std::string format_observations(std::span<const Observation> observations) {
  bool clutter = false;
  bool score = false;
  for (const Observation& observation : observations) {
    validate(observation);
    require_one_name(observation);
    clutter = clutter || observation.clutter.has_value();
    score = score || observation.score.has_value();
  }
  std::string text = fmt::format("{},{},{}{}{}\n", kWhere, pose_header(), covariance_header(),
                                 clutter ? ",clutter" : "", score ? ",score" : "");
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Observation& o = observations[i];
    const std::string begin =
        fmt::format("{},{},{},{},{},{}", o.stamp_s, checked_name(o.camera, "camera"),
                    checked_name(o.detector, "detector"), checked_name(o.object, "id"),
                    checked_name(o.class_id, "class"), i);
    std::string end;
    if (clutter) end += "," + optional_field(o.clutter);
    if (score) end += "," + optional_field(o.score);
    for (const ObservationComponent& component : o.components) {
      text += fmt::format("{},{},{},{}{}\n", begin, component.weight, pose_fields(component.pose),
                          covariance_fields(component.covariance), end);
    }
  }
  return text;
}

}  // namespace posemix
