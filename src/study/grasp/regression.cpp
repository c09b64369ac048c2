// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/grasp/regression.hpp"

#include <array>
#include <cmath>

#include "posemix/base/units.hpp"

namespace posemix {
namespace {

constexpr double kLeastAngle = radians(0.5);
constexpr double kLeastDistance = 1e-3;

}  // namespace

ScoreRegression::ScoreRegression(const GraspData& data, const GraspKnowledge& knowledge,
                                 const std::vector<GraspCase>& cases)
    : data_(data), knowledge_(knowledge) {
  std::map<std::pair<std::string, std::string>, std::array<double, 3>> sums;
  for (const GraspCase& grasp : cases) {
    const GraspTrial& trial = data.outcomes.trials[grasp.trial];
    auto& sum = sums[{trial.dataset, trial.estimator}];
    sum[0] += 1.0;
    sum[1] += trial.score;
    sum[2] += trial.score * trial.score;
  }
  for (const auto& [key, sum] : sums) {
    const double mean = sum[1] / sum[0];
    scores_[key] = {mean, std::sqrt(std::max(0.0, sum[2] / sum[0] - mean * mean))};
  }
  Eigen::MatrixXd design(static_cast<Eigen::Index>(cases.size()), 5);
  std::vector<bool> outcomes;
  for (const GraspCase& grasp : cases) {
    design.row(static_cast<Eigen::Index>(outcomes.size())) = features(grasp).transpose();
    outcomes.push_back(grasp.success);
  }
  model_ = fit_logistic(design, outcomes);
}

/// Logit of the object's success rate, standardised score, log distances to the other estimates of
/// the detection (mean; rotation and translation), whether there are none.
Eigen::VectorXd ScoreRegression::features(const GraspCase& grasp) const {
  const GraspTrial& trial = data_.outcomes.trials[grasp.trial];
  const double rate = knowledge_.base_rate(data_.object(grasp.trial), grasp.gripper);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(5);
  x[0] = std::log(rate / (1.0 - rate));
  const auto score = scores_.find({trial.dataset, trial.estimator});
  if (score != scores_.end() && score->second.second > 0.0) {
    x[1] = (trial.score - score->second.first) / score->second.second;
  }
  const auto& members = data_.members[data_.detections[grasp.trial]];
  x[4] = members.size() == 1 ? 1.0 : 0.0;
  if (members.size() == 1) return x;
  double angle = 0.0;
  double distance = 0.0;
  for (const std::size_t other : members) {
    if (other == grasp.trial) continue;
    const SE3d offset = data_.symmetries[grasp.trial].reduced_error(
        data_.outcomes.trials[other].estimate.inverse() * trial.estimate);
    angle += offset.rotation().log().norm();
    distance += offset.translation().norm();
  }
  const auto others = static_cast<double>(members.size() - 1);
  x[2] = std::log(angle / others + kLeastAngle) - std::log(radians(5.0));
  x[3] = std::log(distance / others + kLeastDistance) - std::log(1e-2);
  return x;
}

double ScoreRegression::probability(const GraspCase& grasp) const {
  return model_.probability(features(grasp));
}

}  // namespace posemix
