// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report.hpp"

#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "draw/picture_colours.hpp"
#include "posemix/base/random.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/draw/flags.hpp"
#include "posemix/io/mixture_file.hpp"
#include "study/engine/table.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

double root_mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

StudyTable stage_table(const Json& example) {
  StudyTable table({"stage", "components", "log_evidence", "rotation_std_deg", "translation_std_m",
                    "rotation_std_x_deg", "rotation_std_y_deg", "rotation_std_z_deg",
                    "translation_std_x_m", "translation_std_y_m", "translation_std_z_m"});
  for (const Json& stage : example.at("stages")) {
    const auto rotation = stage.at("rotation_sd").get<std::vector<double>>();
    const auto translation = stage.at("translation_sd").get<std::vector<double>>();
    const Json& evidence = stage.at("log_evidence");
    table.add({stage.at("stage").get<std::string>(), stage.at("components").get<std::int64_t>(),
               evidence.is_null() ? Cell{} : Cell{evidence.get<double>()},
               degrees(root_mean_square(rotation)), root_mean_square(translation),
               degrees(rotation[0]), degrees(rotation[1]), degrees(rotation[2]), translation[0],
               translation[1], translation[2]});
  }
  return table;
}

StudyTable reduction_table(const Json& example) {
  StudyTable table({"rule", "components", "kl", "kl_error", "dropped", "merged_kl_bound",
                    "total_variation_bound"});
  for (const Json& row : example.at("reductions")) {
    table.add({row.at("rule").get<std::string>(), row.at("components").get<std::int64_t>(),
               row.at("kl").get<double>(), row.at("kl_error").get<double>(),
               row.at("dropped").get<double>(), row.at("merged_kl_bound").get<double>(),
               row.at("total_variation_bound").get<double>()});
  }
  return table;
}

/// Root mean square errors and mean normalised squared errors over the trials.
StudyTable trial_table(std::span<const std::string> results) {
  using Key = std::pair<std::string, std::int64_t>;
  std::map<Key, std::map<std::string, std::vector<double>>> values;
  for (const std::string& text : results) {
    const Json trial = Json::parse(text);
    for (const auto& [tilts, rows] : trial.items()) {
      for (const Json& row : rows) {
        auto& of_row = values[{tilts, row.at("features").get<std::int64_t>()}];
        for (const auto& [name, value] : row.items()) {
          of_row[name].push_back(value.get<double>());
        }
      }
    }
  }
  StudyTable table({"tilts", "features", "trials", "rotation_rms_deg", "translation_rms_m",
                    "nees_per_dof", "rotation_nees_per_dof"});
  for (auto& [key, of_row] : values) {
    table.add({key.first, key.second, static_cast<std::int64_t>(results.size()),
               degrees(root_mean_square(of_row.at("rotation_error"))),
               root_mean_square(of_row.at("translation_error")), mean(of_row.at("squared")),
               mean(of_row.at("squared_rotation"))});
  }
  return table;
}

FlagGroup flags_of(const SaltBoxSettings& settings, const SaltBoxStage& stage, std::string label,
                   std::string colour, std::uint64_t stream_index) {
  FlagGroup group{std::move(label), std::move(colour), {}};
  RandomStream stream(settings.seed, stream_index);
  for (std::size_t i = 0; i < settings.flags; ++i) {
    group.poses.push_back(stage.mixture.sample(stream));
  }
  return group;
}

/// The number of an estimate's colour, which no feature has.
constexpr std::size_t kOfEstimate = 8;

/// One picture per stage, all with the same view. Features and the objects composed from them are
/// shown together, as in Figs. 2 and 3 of the paper.
std::vector<StudyFile> pictures(const SaltBoxSettings& settings,
                                const std::vector<SaltBoxStage>& stages) {
  std::vector<FlagGroup> features, objects;
  std::vector<std::pair<std::string, FlagGroup>> estimates;
  std::vector<FlagGroup> all;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const SaltBoxStage& stage = stages[i];
    if (stage.name.starts_with("feature_")) {
      features.push_back(
          flags_of(settings, stage, stage.name, internal::object_colour(features.size()), i));
      all.push_back(features.back());
    } else if (stage.name.starts_with("object_")) {
      objects.push_back(
          flags_of(settings, stage, stage.name, internal::object_colour(objects.size()), i));
      all.push_back(objects.back());
    } else {
      const std::string label = fmt::format("{}, {} components", stage.name, stage.mixture.size());
      estimates.emplace_back(
          stage.name, flags_of(settings, stage, label, internal::object_colour(kOfEstimate), i));
    }
  }
  const FlagView view = view_of(all);
  const OutlinedBox box{salt_box_truth(), {0.095, 0.155, 0.055}};
  std::vector<StudyFile> files{
      {"flags_features.svg", draw_flags("Features", features, view, box)},
      {"flags_objects.svg", draw_flags("The box, from each feature", objects, view, box)}};
  for (const auto& [name, group] : estimates) {
    files.push_back(
        {"flags_" + name + ".svg", draw_flags(group.label, std::span(&group, 1), view, box)});
  }
  return files;
}

/// mixture_<stage>.json: poses of features, then of the box.
std::vector<StudyFile> mixture_files(const std::vector<SaltBoxStage>& stages) {
  std::vector<StudyFile> files;
  for (const SaltBoxStage& stage : stages) {
    const std::string of = stage.name.starts_with("feature_") ? stage.name : "box";
    files.push_back({fmt::format("mixture_{}.json", stage.name),
                     format_mixture({{"camera", of}, stage.mixture})});
  }
  return files;
}

constexpr std::string_view kSaltBoxQuestion =
    "What is known of the pose of a box from three features that are seen on it, each of which "
    "leaves several poses?";

/// What fusing does, and the trap in it.
std::vector<std::string> salt_box_notes(const StudyTable& stages, bool has_trials) {
  const auto text = [&](const std::vector<Cell>& row) {
    return fmt::format("{:.3g} deg and {:.3g} mm ({})", std::get<double>(row[3]),
                       1e3 * std::get<double>(row[4]), std::get<std::string>(row[0]));
  };
  std::vector<std::string> notes{
      fmt::format("Three features together lower the standard deviation of the pose from {} to {}.",
                  text(stages.rows()[1]), text(stages.rows().back()))};
  if (!has_trials) return notes;
  notes.emplace_back(
      "Features seen in one view share one tilt: fused as if independent they are overconfident "
      "(trials.csv, shared_view).");
  notes.emplace_back("Fuse features of different views, or one of each view.");
  return notes;
}

}  // namespace

StudyReport report_salt_box(const SaltBoxSettings& settings, std::span<const std::string> results) {
  const Json example = Json::parse(results.front());
  const StudyTable stages = stage_table(example);
  const StudyTable reductions = reduction_table(example);
  const std::vector<SaltBoxStage> run = run_salt_box(settings);
  StudyReport report;
  report.notes = salt_box_notes(stages, results.size() > 1);
  report.files.push_back(
      {"study.json", format_study({"salt-box", kSaltBoxQuestion, report.notes}, stages)});
  report.files.push_back({"stages.csv", stages.csv()});
  report.files.push_back({"reductions.csv", reductions.csv()});
  report.summary = stages.text() + "\n" + reductions.text();
  if (results.size() > 1) {
    const StudyTable trials = trial_table(results.subspan(1));
    report.files.push_back({"trials.csv", trials.csv()});
    report.summary += "\n" + trials.text();
  }
  report.files.push_back(
      {"posterior.json", format_mixture({{"camera", "box"}, run.back().mixture})});
  for (StudyFile& file : mixture_files(run)) report.files.push_back(std::move(file));
  for (StudyFile& file : pictures(settings, run)) report.files.push_back(std::move(file));
  return report;
}

}  // namespace posemix
