// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "posemix/detector/detector_noise.hpp"

/// Settings of studies as JSON, every number with all its digits.
namespace posemix {

inline nlohmann::ordered_json matrix_json(const Eigen::MatrixXd& matrix) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto& row : matrix.rowwise()) {
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return rows;
}

inline nlohmann::ordered_json noise_json(const DetectorNoise& noise) {
  nlohmann::ordered_json components = nlohmann::ordered_json::array();
  for (const NoiseComponent& component : noise.components()) {
    nlohmann::ordered_json& entry = components.emplace_back(
        nlohmann::ordered_json{{"weight", component.weight},
                               {"frame", word_of(component.frame)},
                               {"covariance", matrix_json(component.covariance)},
                               {"offset", matrix_json(component.offset.matrix())}});
    if (component.run_length != 1.0) entry["run_length"] = component.run_length;
  }
  if (noise.clutter().weight > 0.0) {
    components.push_back(
        {{"clutter",
          {{"weight", noise.clutter().weight}, {"volume_m3", noise.clutter().volume_m3}}}});
  }
  return components;
}

}  // namespace posemix
