// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "posemix/grasp/calibration.hpp"
#include "study/grasp/knowledge.hpp"

namespace posemix {

/// Logistic regression on the estimator's score and its distance to the other estimators.
class ScoreRegression {
 public:
  ScoreRegression(const GraspData& data, const GraspKnowledge& knowledge,
                  const std::vector<GraspCase>& cases);
  double probability(const GraspCase& grasp) const;

 private:
  Eigen::VectorXd features(const GraspCase& grasp) const;

  const GraspData& data_;
  const GraspKnowledge& knowledge_;
  std::map<std::pair<std::string, std::string>, std::pair<double, double>> scores_;
  LogisticModel model_;
};

}  // namespace posemix
