// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/grasp/study.hpp"

#include <memory>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "study/engine/fingerprint.hpp"
#include "study/engine/settings_json.hpp"
#include "study/grasp/data.hpp"
#include "study/grasp/fold.hpp"
#include "study/grasp/report.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

/// A name for everything that the trials hold.
std::string fingerprint_of(const GraspOutcomes& outcomes) {
  Fingerprint print;
  for (const std::string& gripper : outcomes.grippers) print.add(gripper);
  for (const GraspTrial& trial : outcomes.trials) {
    print.add(trial.dataset);
    print.add(trial.estimator);
    for (const std::int64_t id : {trial.scene, trial.image, trial.object})
      print.add(static_cast<std::uint64_t>(id));
    print.add(trial.score);
    print.add(trial.estimate);
    print.add(trial.truth);
    for (const auto& outcome : trial.outcomes)
      print.add(std::uint64_t{outcome ? (*outcome ? 2U : 1U) : 0U});
  }
  return print.text();
}

Json settings_json(const GraspOutcomes& data, const std::optional<GraspOutcomes>& train,
                   const GraspStudySettings& s) {
  Json json = {{"seed", s.seed},
               {"max_components", s.errors.max_components},
               {"prior_count", s.errors.prior_count},
               {"outlier_rotation_sd_deg", s.errors.outlier_rotation_sd_deg},
               {"outlier_translation_sd_m", s.errors.outlier_translation_sd_m},
               {"trim", s.errors.trim},
               {"draws", s.consensus.draws_per_member},
               {"correlation", s.consensus.correlation},
               {"region_starts", s.region.starts},
               {"bootstrap_regions", s.bootstrap_regions},
               {"least_outcomes", s.least_outcomes},
               {"blocks", s.blocks},
               {"bins", s.bins}};
  for (const SymmetricObject& o : s.symmetric) {
    Json entry = {o.dataset, o.object};
    for (const SE3d& element : o.symmetry.elements())
      entry.push_back(matrix_json(element.matrix()));
    for (const SymmetryAxis& axis : o.symmetry.axes()) entry.push_back(matrix_json(axis.direction));
    json["symmetry"].push_back(std::move(entry));
  }
  json["data"] = fingerprint_of(data);
  if (train) json["train"] = fingerprint_of(*train);
  return json;
}

std::vector<SymmetricObject> read_symmetric(const TomlTable& table) {
  std::vector<SymmetricObject> objects;
  for (const TomlTable& entry : table.get_tables("symmetry")) {
    SymmetricObject object{entry.get_string("dataset"), entry.get_integer("object", {.lowest = 0})};
    if (entry.has("axis")) {
      const Eigen::Vector3d axis = entry.get_vector("axis", 3);
      if (!(axis.norm() > 0.0)) entry.fail("axis", "is zero, expected a direction");
      const auto fold = entry.get_integer_or("fold", 0, {.lowest = 0, .highest = 360});
      object.symmetry = SymmetryGroup::turns(axis, static_cast<int>(fold));
    }
    objects.push_back(object);
  }
  return objects;
}

}  // namespace

std::vector<SymmetricObject> GraspStudySettings::default_symmetric() {
  const SymmetryGroup half_turn = SymmetryGroup::turns(Eigen::Vector3d::UnitZ(), 2);
  const SymmetryGroup any_turn = SymmetryGroup::turns(Eigen::Vector3d::UnitZ(), 0);
  std::vector<SymmetricObject> objects{{"lmo", 10, half_turn},
                                       {"lmo", 11, half_turn},
                                       {"ycbv", 1, any_turn},
                                       {"ycbv", 4, any_turn},
                                       {"ycbv", 13, any_turn}};
  for (const std::int64_t object : {14, 16, 18, 19, 20, 21}) objects.push_back({"ycbv", object});
  return objects;
}

GraspStudySettings read_grasp_settings(const TomlTable& table) {
  GraspStudySettings s;
  const auto count = [&](const char* key, std::size_t otherwise, std::int64_t most) {
    return static_cast<std::size_t>(table.get_integer_or(key, static_cast<std::int64_t>(otherwise),
                                                         {.lowest = 1, .highest = most}));
  };
  const NumberRange positive{.lowest = 0.0, .without_lowest = true};
  s.seed = static_cast<std::uint64_t>(table.get_integer_or("seed", 1, {.lowest = 0}));
  s.errors.max_components = count("max_components", s.errors.max_components, 50);
  s.errors.prior_count = table.get_double_or("prior_count", s.errors.prior_count, positive);
  s.errors.outlier_rotation_sd_deg =
      table.get_double_or("outlier_rotation_sd_deg", s.errors.outlier_rotation_sd_deg, positive);
  s.errors.outlier_translation_sd_m =
      table.get_double_or("outlier_translation_sd_m", s.errors.outlier_translation_sd_m, positive);
  s.errors.trim = table.get_double_or("trim", s.errors.trim, positive);
  s.consensus.draws_per_member = count("draws", s.consensus.draws_per_member, 1000000);
  s.consensus.correlation =
      table.get_double_or("correlation", s.consensus.correlation, {.lowest = 0.0, .highest = 1.0});
  s.region.starts = static_cast<int>(count("region_starts", 4, 1000));
  s.least_outcomes = count("least_outcomes", s.least_outcomes, 1000000);
  s.bootstrap_regions = count("bootstrap_regions", s.bootstrap_regions, 10000);
  s.blocks = count("blocks", s.blocks, 1000);
  s.bins = count("bins", s.bins, 1000);
  if (table.has("symmetry")) s.symmetric = read_symmetric(table);
  return s;
}

Study make_grasp_study(const GraspOutcomes& data, const std::optional<GraspOutcomes>& train,
                       const GraspStudySettings& settings) {
  const std::string text = settings_json(data, train, settings).dump();
  const auto shared = std::make_shared<const GraspData>(grasp_data(data, train, settings));
  return {"grasp", text, shared->folds.size(),
          [shared, settings](std::size_t item) {
            return run_grasp_fold(*shared, item, settings).dump();
          },
          [bins = settings.bins](std::span<const std::string> results) {
            return report_grasp(results, bins);
          }};
}

}  // namespace posemix
