// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "study/grasp/data.hpp"

namespace posemix {

/// The errors of the estimators in a fold: for every trial, the model of its estimator by each
/// consensus method.
struct EstimatorErrors {
  struct Model {
    std::string dataset;
    std::string estimator;
    std::size_t errors;
    std::size_t components;
    double outlier_weight;
    std::vector<ErrorMixture> methods;  ///< gaussian, trimmed_gaussian, mixture
  };
  std::vector<Model> models;
  std::vector<std::size_t> model_of;  ///< by trial
};

EstimatorErrors learn_errors(const GraspData& data, const GraspFold& fold,
                             const GraspStudySettings& settings, std::uint64_t stream);

}  // namespace posemix
