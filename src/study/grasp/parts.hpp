// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <nlohmann/json.hpp>

#include "posemix/grasp/calibration.hpp"
#include "study.hpp"

namespace posemix {

/// The methods that are compared, in the order of the report.
inline constexpr std::array<const char*, 6> kGraspMethods{
    "base_rate", "logistic", "gaussian", "trimmed_gaussian", "mixture", "region_at_true_error"};
inline constexpr std::size_t kFirstConsensus = 2;  ///< gaussian
inline constexpr std::size_t kConsensusMethods = 3;

/// One grasp.
struct GraspCase {
  std::size_t trial;
  std::size_t gripper;
  bool success;
};

/// Trials to learn from, and grasps to predict.
struct GraspFold {
  std::string split;
  std::string name;
  std::vector<bool> learn;  ///< by trial
  std::vector<GraspCase> test;
};

/// Dataset and object.
using ObjectKey = std::pair<std::string, std::int64_t>;

/// All trials, those to learn from after those to predict, and what follows from them alone.
struct GraspData {
  GraspOutcomes outcomes;
  std::size_t predicted = 0;                            ///< trials before this one are `data`
  std::vector<std::optional<AxisSymmetry>> symmetries;  ///< by trial
  std::vector<bool> symmetric;                          ///< by trial
  std::vector<SE3d> errors;             ///< by trial, T_truth^-1 T_estimate reduced by the symmetry
  std::vector<std::size_t> detections;  ///< by trial: an object in an image
  std::vector<std::vector<std::size_t>> members;  ///< by detection: its trials
  std::vector<GraspFold> folds;

  ObjectKey object(std::size_t trial) const {
    return {outcomes.trials[trial].dataset, outcomes.trials[trial].object};
  }
  std::vector<GraspCase> cases(const std::vector<bool>& chosen) const;
};

/// @throws InvalidInput when no grasp can be predicted
GraspData grasp_data(const GraspOutcomes& data, const std::optional<GraspOutcomes>& train,
                     const GraspStudySettings& settings);

/// How often grasps of an object with a gripper succeed, and its region.
struct GraspRegion {
  std::size_t successes = 0;
  std::size_t failures = 0;
  std::optional<RegionFit> fit = {};          ///< where there are enough outcomes of both kinds
  std::vector<ToleranceRegion> regions = {};  ///< by bootstrap; what predicts
};

/// What a fold learns about grasps.
struct GraspKnowledge {
  std::map<std::pair<ObjectKey, std::size_t>, GraspRegion> regions;  ///< by object and gripper
  std::vector<GraspRegion> pooled;                                   ///< by gripper: all objects

  /// Region and name of what is used for a grasp: "own", "pooled" or "base_rate" (no region).
  std::pair<const std::vector<ToleranceRegion>*, const char*> region(const ObjectKey& object,
                                                                     std::size_t gripper) const;
  /// Success rate of the object, of the gripper where the object was never grasped.
  double base_rate(const ObjectKey& object, std::size_t gripper) const;
};

GraspKnowledge learn_regions(const GraspData& data, const GraspFold& fold,
                             const GraspStudySettings& settings, std::uint64_t stream);

/// How estimators err in a fold: for every trial, its estimator's model by each consensus method.
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

/// The result of one work item.
nlohmann::ordered_json run_grasp_fold(const GraspData& data, std::size_t fold,
                                      const GraspStudySettings& settings);

StudyReport report_grasp(std::span<const std::string> results, std::size_t bins);

}  // namespace posemix
