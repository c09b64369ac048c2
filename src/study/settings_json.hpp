// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "posemix/filter/detector_noise.hpp"

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
    components.push_back({{"weight", component.weight},
                          {"frame", component.frame == NoiseFrame::object ? "object" : "camera"},
                          {"covariance", matrix_json(component.covariance)},
                          {"offset", matrix_json(component.offset.matrix())}});
  }
  return components;
}

}  // namespace posemix
