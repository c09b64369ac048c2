// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "filters.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"
#include "posemix/filter/predict.hpp"

/// The Gaussian-sum filter over any stream of detections and odometry.
namespace posemix::fuzzing {
namespace {

std::string bits_of_posterior(const Posterior& posterior) {
  std::vector<std::pair<double, Hypothesis>> components;
  for (const auto& [log_weight, density] : posterior.components())
    components.emplace_back(log_weight, density);
  return bits_of(components);
}

void expect_sound(const Posterior& posterior) {
  expect_weights(posterior, "the posterior");
  for (const auto& component : posterior.components()) {
    for (const SE3d& pose : component.density.mean().poses()) expect_pose(pose);
    expect_covariance(component.density.covariance(), "a hypothesis");
  }
}

GaussianSumSettings gaussian_sum_settings(Input& input) {
  GaussianSumSettings settings;
  settings.update = static_cast<UpdateRule>(input.below(2));
  settings.robust_loss = static_cast<RobustLoss>(input.below(2));
  settings.summary = static_cast<Summary>(input.below(3));
  settings.noise_use = static_cast<NoiseUse>(input.below(2));
  settings.reduction.max_components = 1 + input.below(4);
  if (input.flag()) settings.gate_probability = std::abs(input.number());
  return settings;
}

void step(GaussianSumFilter& filter, const DetectorNoise& noise, Input& input) {
  const std::size_t poses = filter.posterior()[0].density.mean().size();
  switch (input.below(4)) {
    case 0: {
      const SE3d motion = input.pose(0.1);
      const Matrix6d q = input.covariance(0.01, 0.01);
      return filter.predict(
          [&](Hypothesis h) { return predict_with_odometry(std::move(h), motion, q); });
    }
    case 1:
      if (poses < 4) filter.add_object(input.pose(), noise);
      return;
    default: {
      std::vector<Detection> detections;
      for (std::size_t k = input.below(3) + 1; k > 0; --k)
        detections.push_back({input.below(5), input.pose(), &noise});
      filter.update(detections);
    }
  }
}

}  // namespace

POSEMIX_FUZZ_TARGET(gaussian_sum) {
  Input input(bytes);
  try {
    const DetectorNoise noise = noise_from(input).as_white();
    const Posterior prior({{0.0, Hypothesis(PoseStackd(std::vector<SE3d>{input.pose()}),
                                            input.covariance(0.05, 0.05))}});
    GaussianSumFilter filter(prior, gaussian_sum_settings(input));
    for (int k = 0; k < kMostSteps && !input.empty(); ++k) {
      if (does([&] { return bits_of_posterior(filter.posterior()); },
               [&] { step(filter, noise, input); }))
        expect_sound(filter.posterior());
      expect_pose(filter.summarise().mean().poses()[0]);
    }
  } catch (const InvalidInput&) {
    return;  // settings, noise or a prior that were refused
  }
}

}  // namespace posemix::fuzzing
