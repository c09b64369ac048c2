// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "metric.hpp"

namespace posemix {

/// Recall of one source over the objects of images.
struct FuseViewsRecall {
  std::int64_t found = 0;
  std::int64_t within_wide = 0;
  std::int64_t within_narrow = 0;
  double mssd = 0.0;
  std::vector<double> rotation_deg, translation_m, mssd_m;  ///< where both sources found it

  void add(const std::optional<FuseViewsErrors>& errors, bool both) {
    if (!errors) return;
    ++found;
    within_wide += errors->within(20.0, 0.05) ? 1 : 0;
    within_narrow += errors->within(10.0, 0.02) ? 1 : 0;
    mssd += errors->mssd_recall;
    if (!both) return;
    rotation_deg.push_back(errors->rotation_deg);
    translation_m.push_back(errors->translation_m);
    mssd_m.push_back(errors->mssd_m);
  }
  void write(nlohmann::ordered_json& row, const std::string& prefix) const {
    row[prefix + "found"] = found;
    row[prefix + "within_20deg_5cm"] = within_wide;
    row[prefix + "within_10deg_2cm"] = within_narrow;
    row[prefix + "mssd_recall"] = mssd;
    row[prefix + "rotation_deg"] = rotation_deg;
    row[prefix + "translation_m"] = translation_m;
    row[prefix + "mssd_m"] = mssd_m;
  }
};

/// What is counted of one kind of run over one scene.
struct FuseViewsCounts {
  std::int64_t groups = 0, pairs = 0, instances = 0, instances_found = 0, right_mode = 0;
  std::int64_t reported = 0, reported_false = 0, rows = 0, rows_false = 0;
  FuseViewsRecall single, fused;
  std::vector<double> nees, rotation_nees, position_nees, dof;  ///< of instances in the right mode
  std::vector<double> mode_probability;                         ///< of all that are found
  double probability = 0.0;  ///< sum over all instances that are output
  std::int64_t output = 0, output_true = 0;

  nlohmann::ordered_json json() const {
    nlohmann::ordered_json row = {{"groups", groups},
                                  {"pairs", pairs},
                                  {"instances", instances},
                                  {"instances_found", instances_found},
                                  {"right_mode", right_mode},
                                  {"reported", reported},
                                  {"reported_false", reported_false},
                                  {"rows", rows},
                                  {"rows_false", rows_false},
                                  {"output", output},
                                  {"output_true", output_true},
                                  {"probability", probability}};
    single.write(row, "single_");
    fused.write(row, "fused_");
    row["nees"] = nees;
    row["rotation_nees"] = rotation_nees;
    row["position_nees"] = position_nees;
    row["dof"] = dof;
    row["mode_probability"] = mode_probability;
    return row;
  }
};

}  // namespace posemix
