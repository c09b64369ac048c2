// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/grasp/fold.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "study/grasp/estimator_errors.hpp"
#include "study/grasp/knowledge.hpp"
#include "study/grasp/methods.hpp"
#include "study/grasp/regression.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kCalibrationGrasps = 1500;  ///< about as many are enough for two numbers
constexpr std::size_t kResampled = 128;           ///< draws that a region is averaged over

/// Probabilities by the consensus methods, before calibration.
using RawProbabilities = std::array<double, kConsensusMethods>;

class Predictor {
 public:
  Predictor(const GraspData& data, const GraspKnowledge& knowledge, const EstimatorErrors& errors,
            const GraspStudySettings& settings)
      : data_(data), knowledge_(knowledge), errors_(errors), settings_(settings) {}

  /// Of grasps that follow each other by detection; empty where no region is known.
  std::vector<std::optional<RawProbabilities>> raw(const std::vector<GraspCase>& cases) const {
    std::map<std::size_t, std::vector<std::size_t>> by_detection;
    for (std::size_t i = 0; i < cases.size(); ++i) {
      by_detection[data_.detections[cases[i].trial]].push_back(i);
    }
    std::vector<std::optional<RawProbabilities>> result(cases.size());
    for (const auto& [detection, places] : by_detection) {
      for (std::size_t method = 0; method < kConsensusMethods; ++method) {
        predict(detection, places, method, cases, result);
      }
    }
    return result;
  }

 private:
  void predict(std::size_t detection, const std::vector<std::size_t>& places, std::size_t method,
               const std::vector<GraspCase>& cases,
               std::vector<std::optional<RawProbabilities>>& result) const {
    std::optional<PoseConsensus> consensus;
    for (const std::size_t place : places) {
      const GraspCase& grasp = cases[place];
      const auto* regions = knowledge_.region(data_.object(grasp.trial), grasp.gripper).first;
      if (regions == nullptr) continue;
      if (!consensus) consensus = fuse(detection, method);
      if (!result[place]) result[place].emplace();
      (*result[place])[method] =
          success_probability(*consensus, data_.outcomes.trials[grasp.trial].estimate, *regions,
                              data_.symmetries[grasp.trial]);
    }
  }

  PoseConsensus fuse(std::size_t detection, std::size_t method) const {
    const std::vector<std::size_t>& trials = data_.members[detection];
    const SE3d& first = data_.outcomes.trials[trials.front()].estimate;
    std::vector<ConsensusMember> members;
    for (const std::size_t trial : trials) {
      const SE3d estimate =
          data_.symmetries[trial].nearest_rotation(data_.outcomes.trials[trial].estimate, first);
      members.push_back({estimate, &errors_.models[errors_.model_of[trial]].methods[method]});
    }
    RandomStream stream(settings_.seed, (std::uint64_t{1} << 32) + detection);
    return fuse_estimates(members, settings_.consensus, stream).resampled(kResampled);
  }

  const GraspData& data_;
  const GraspKnowledge& knowledge_;
  const EstimatorErrors& errors_;
  const GraspStudySettings& settings_;
};

/// About every n-th grasp, so that the calibration's number of them is left.
std::vector<GraspCase> thinned(const GraspData& data, const std::vector<GraspCase>& cases) {
  const std::size_t step = std::max<std::size_t>(1, cases.size() / kCalibrationGrasps);
  std::vector<GraspCase> kept;
  std::copy_if(cases.begin(), cases.end(), std::back_inserter(kept),
               [&](const GraspCase& grasp) { return data.detections[grasp.trial] % step == 0; });
  return kept;
}

using Calibrations = std::array<PlattCalibration, kConsensusMethods>;

/// Platt's calibration of every consensus method from grasps of a dataset that were learnt from; of
/// all datasets where it has none.
Calibrations calibrate(const GraspData& data, const std::vector<GraspCase>& cases,
                       const std::vector<std::optional<RawProbabilities>>& raw,
                       const std::string& dataset) {
  std::array<std::vector<ScoredPrediction>, kConsensusMethods> own;
  std::array<std::vector<ScoredPrediction>, kConsensusMethods> all;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (!raw[i]) continue;
    const bool same = data.outcomes.trials[cases[i].trial].dataset == dataset;
    for (std::size_t method = 0; method < kConsensusMethods; ++method) {
      const ScoredPrediction prediction{(*raw[i])[method], cases[i].success};
      all[method].push_back(prediction);
      if (same) own[method].push_back(prediction);
    }
  }
  Calibrations calibrations;
  for (std::size_t method = 0; method < kConsensusMethods; ++method) {
    calibrations[method] = fit_platt(own[method].empty() ? all[method] : own[method]);
  }
  return calibrations;
}

double mean_probability(const std::vector<ToleranceRegion>& regions, const SE3d& error) {
  double sum = 0.0;
  for (const ToleranceRegion& region : regions) sum += region.success_probability(error);
  return sum / static_cast<double>(regions.size());
}

Json region_json(const std::string& object, const std::string& gripper, const GraspRegion& r) {
  Json json = {{"object", object},
               {"gripper", gripper},
               {"successes", r.successes},
               {"failures", r.failures}};
  if (!r.fit) return json;
  const ToleranceRegion& region = r.fit->region;
  const auto list = [](const Eigen::VectorXd& v) {
    return std::vector<double>(v.begin(), v.end());
  };
  json["centre"] = list(region.centre);
  json["half_width"] = list(region.half_width);
  json["identified"] = r.fit->identified;
  json["softness"] = region.softness;
  json["lever"] = list(region.lever);
  json["inside"] = region.success_inside;
  json["outside"] = region.success_outside;
  json["converged"] = r.fit->converged;
  return json;
}

std::string object_name(const ObjectKey& object) {
  return object.first + "/" + std::to_string(object.second);
}

Json knowledge_json(const GraspData& data, const GraspKnowledge& knowledge,
                    const EstimatorErrors& errors) {
  Json json;
  for (const auto& [key, region] : knowledge.regions) {
    json["regions"].push_back(
        region_json(object_name(key.first), data.outcomes.grippers[key.second], region));
  }
  for (std::size_t g = 0; g < knowledge.pooled.size(); ++g) {
    json["regions"].push_back(region_json("all", data.outcomes.grippers[g], knowledge.pooled[g]));
  }
  for (const EstimatorErrors::Model& model : errors.models) {
    json["errors"].push_back(
        {model.dataset, model.estimator, model.errors, model.components, model.outlier_weight});
  }
  return json;
}

}  // namespace

Json run_grasp_fold(const GraspData& data, std::size_t fold_index,
                    const GraspStudySettings& settings) {
  const GraspFold& fold = data.folds[fold_index];
  const GraspKnowledge knowledge = learn_regions(data, fold, settings, 2 * fold_index);
  const EstimatorErrors errors = learn_errors(data, fold, settings, 2 * fold_index + 1);
  const std::vector<GraspCase> learnt = data.cases(fold.learn);
  const ScoreRegression regression(data, knowledge, learnt);
  const Predictor predictor(data, knowledge, errors, settings);
  const std::vector<GraspCase> chosen = thinned(data, learnt);
  const auto chosen_raw = predictor.raw(chosen);
  std::map<std::string, Calibrations> calibrations;
  const auto raw = predictor.raw(fold.test);
  Json json = knowledge_json(data, knowledge, errors);
  json["split"] = fold.split;
  json["fold"] = fold.name;
  for (std::size_t i = 0; i < fold.test.size(); ++i) {
    const GraspCase& grasp = fold.test[i];
    const GraspTrial& trial = data.outcomes.trials[grasp.trial];
    const ObjectKey object = data.object(grasp.trial);
    const auto [place, fresh] = calibrations.try_emplace(trial.dataset);
    if (fresh) place->second = calibrate(data, chosen, chosen_raw, trial.dataset);
    const auto [regions, kind] = knowledge.region(object, grasp.gripper);
    const double rate = knowledge.base_rate(object, grasp.gripper);
    std::vector<double> p{rate, regression.probability(grasp)};
    for (std::size_t method = 0; method < kConsensusMethods; ++method) {
      p.push_back(raw[i] ? place->second[method]((*raw[i])[method]) : rate);
    }
    p.push_back(regions != nullptr ? mean_probability(*regions, data.errors[grasp.trial]) : rate);
    json["grasps"].push_back({object_name(object), data.outcomes.grippers[grasp.gripper],
                              trial.estimator, trial.scene, trial.image, kind,
                              grasp.success ? 1 : 0, p, raw[i] ? Json(*raw[i]) : Json()});
  }
  return json;
}

}  // namespace posemix
