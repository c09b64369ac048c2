// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "posemix/density/pose_stack.hpp"
#include "posemix/slam/evaluation.hpp"
#include "report.hpp"
#include "study/engine/thread_time.hpp"
#include "trial.hpp"

namespace posemix {
namespace {

constexpr std::size_t kObject = 1;

double squared_rotation(const SE3d& estimate, const SE3d& truth) {
  return (estimate * truth.inverse()).log().head<3>().squaredNorm();
}

/// Sums over the frames of a run.
struct Sums {
  double robot = 0.0;
  double object = 0.0;
  double anees = 0.0;
  double relative_nees = 0.0;

  void add(const Hypothesis& estimate, const SE3d& camera, const SE3d& object_pose) {
    robot += squared_rotation(estimate.mean()[kCamera], camera);
    object += squared_rotation(estimate.mean()[kObject], object_pose);
    const PoseStackd truth(std::vector<SE3d>{camera, object_pose});
    anees += squared_normalized_error(estimate, truth) / 12.0;  // eq. 35
    relative_nees += squared_normalized_error(relative_pose(estimate, kCamera, kObject),
                                              camera.inverse() * object_pose) /
                     6.0;
  }
};

MonteCarloErrors filter_trial(const MonteCarloTrial& trial, const MonteCarloMethod& method,
                              const DetectorNoise& noise) {
  GaussianSumFilter filter(Posterior({{0.0, trial.prior}}), method.filter);
  Sums sums;
  double seconds = 0.0;
  for (const MonteCarloStep& step : trial.steps) {
    const double start = internal::thread_seconds();
    for (const SE3d& motion : step.odometry) {
      filter.predict([&](Hypothesis h) {
        return predict_with_odometry(std::move(h), motion, trial.odometry_noise);
      });
    }
    const Detection detection{kObject, step.detection, &noise};
    filter.update(std::span(&detection, 1));
    const Hypothesis estimate = filter.summarise();
    seconds += internal::thread_seconds() - start;
    sums.add(estimate, step.true_camera, trial.true_object);
  }
  const auto frames = static_cast<double>(trial.steps.size());
  return {degrees(std::sqrt(sums.robot / frames)), degrees(std::sqrt(sums.object / frames)),
          sums.anees / frames, sums.relative_nees / frames, seconds};
}

std::string item_text(const std::vector<MonteCarloErrors>& errors) {
  nlohmann::json rows = nlohmann::json::array();
  for (const MonteCarloErrors& e : errors) {
    rows.push_back({e.robot_rotation_rmse_deg, e.object_rotation_rmse_deg, e.anees, e.relative_nees,
                    e.seconds});
  }
  return rows.dump();
}

}  // namespace

std::vector<MonteCarloErrors> run_monte_carlo(const MonteCarloStudySettings& settings,
                                              double noise_exponent, std::size_t run) {
  const MonteCarloTrial trial = simulate_trial(settings, noise_exponent, run);
  const DetectorNoise single = settings.detector.single_gaussian();
  std::vector<MonteCarloErrors> errors;
  for (const std::string& name : settings.methods) {
    const MonteCarloMethod method = monte_carlo_method(name, settings);
    errors.push_back(
        filter_trial(trial, method, method.single_gaussian ? single : settings.detector));
  }
  return errors;
}

Study make_monte_carlo_study(const MonteCarloStudySettings& settings) {
  check_monte_carlo_settings(settings);
  const auto run_item = [settings](std::size_t item) {
    const double exponent = settings.noise_exponents[item / settings.runs];
    return item_text(run_monte_carlo(settings, exponent, item % settings.runs));
  };
  const auto report = [settings](std::span<const std::string> results) {
    return report_monte_carlo(settings, results);
  };
  return {"monte-carlo", monte_carlo_settings_json(settings),
          settings.noise_exponents.size() * settings.runs, run_item, report};
}

}  // namespace posemix
