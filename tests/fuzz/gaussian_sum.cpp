// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "filters.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"
#include "posemix/filter/predict.hpp"
#include "posemix/lie/pose_blocks.hpp"
#include "precision.hpp"

/// The Gaussian-sum filter over any stream of detections and odometry.
namespace posemix::fuzzing {
namespace {

std::string bits_of_posterior(const Posterior& posterior) {
  std::vector<std::pair<double, Hypothesis>> components;
  for (const auto& [log_weight, density] : posterior.components())
    components.emplace_back(log_weight, density);
  return bits_of(components);
}

/// Calls act(pose, covariance).
template <class Do>
void for_each_pose(const Posterior& posterior, const Do& act) {
  for (const auto& component : posterior.components()) {
    const Hypothesis& hypothesis = component.density;
    for (std::size_t i = 0; i < hypothesis.mean().size(); ++i)
      act(hypothesis.mean()[i], Matrix6d(block(hypothesis.covariance(), i, i)));
  }
}

/// What is known before a detection.
void begin_detection(const Posterior& posterior, Precision& precision) {
  precision.move_to(posterior[0].density.mean()[kCamera].translation());
  for_each_pose(posterior,
                [&](const SE3d&, const Matrix6d& covariance) { precision.widen(covariance); });
}

void end_step(const Posterior& posterior, Precision& precision) {
  for_each_pose(posterior, [&](const SE3d& pose, const Matrix6d& covariance) {
    precision.widen_at(pose, covariance);
  });
}

void expect_sound(const Posterior& posterior, const Precision& precision) {
  expect_weights(posterior, "the posterior");
  for (const auto& component : posterior.components()) {
    for (const SE3d& pose : component.density.mean().poses()) expect_pose(pose);
    if (precision.is_left())
      expect_covariance(component.density.covariance(), "a hypothesis", precision.rounding());
    expect(component.density.covariance().allFinite(), "a covariance that is not finite");
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

void step(GaussianSumFilter& filter, const DetectorNoise& noise, Input& input,
          Precision& precision) {
  const std::size_t poses = filter.posterior()[0].density.mean().size();
  switch (input.below(4)) {
    case 0: {
      const SE3d motion = input.pose(0.1);
      const Matrix6d q = input.covariance(0.01, 0.01);
      return filter.predict(
          [&](Hypothesis h) { return predict_with_odometry(std::move(h), motion, q); });
    }
    case 1:
      if (poses < 4) {
        const SE3d seen = input.pose();
        begin_detection(filter.posterior(), precision);
        precision.see(noise, seen.translation().norm());
        filter.add_object(seen, noise);
      }
      return;
    default: {
      std::vector<Detection> detections;
      begin_detection(filter.posterior(), precision);
      for (std::size_t k = input.below(3) + 1; k > 0; --k) {
        detections.push_back({input.below(5), input.pose(), &noise});
        precision.see(noise, detections.back().camera_object.translation().norm());
      }
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
    Precision precision(1e10, 100.0);
    precision.see(Matrix6d(prior[0].density.covariance()));
    for (int k = 0; k < kMostSteps && !input.empty(); ++k) {
      Precision next = precision;
      if (does([&] { return bits_of_posterior(filter.posterior()); },
               [&] { step(filter, noise, input, next); })) {
        end_step(filter.posterior(), next);
        precision = next;
        expect_sound(filter.posterior(), precision);
      }
      expect_pose(filter.summarise().mean().poses()[0]);
    }
  } catch (const InvalidInput&) {
    return;  // settings, noise or a prior that were refused
  }
}

}  // namespace posemix::fuzzing
