// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "filters.hpp"
#include "posemix/filter/moving_object_filter.hpp"
#include "precision.hpp"

/// The filter of one moving object over any stream of observations, times, cameras and models.
namespace posemix::fuzzing {
namespace {

MotionModels models_from(Input& input) {
  MotionModels models;
  models.models.clear();
  const std::size_t count = 1 + input.below(3);
  for (std::size_t k = 0; k < count; ++k) {
    const auto frame = static_cast<MotionFrame>(input.below(2));
    switch (input.below(4)) {
      case 0:
        models.models.emplace_back(StaticMotion{});
        break;
      case 1:
        models.models.emplace_back(RandomWalkMotion{Vector6d::Constant(input.scale(0.1)), frame});
        break;
      case 2:
        models.models.emplace_back(
            ConstantVelocityMotion{Vector6d::Constant(input.scale(1.0)), frame});
        break;
      default:
        models.models.emplace_back(AttachedMotion{0, Vector6d::Constant(input.scale(0.01))});
    }
  }
  const auto n = static_cast<Eigen::Index>(count);
  if (input.flag()) models.rates = Eigen::MatrixXd::Constant(n, n, input.scale(0.3));
  return models;
}

/// What is known before a detection by the camera, and what it sees.
void begin_detection(const MovingObjectFilter& filter, const Observation& observation,
                     const KnownCamera& camera, Precision& precision) {
  precision.move_to(camera.frame.pose.translation());
  precision.see(filter.sensor().noise);
  precision.see(observation);
  if (filter.observation_count() == 0) return;
  for (const MovingObjectHypothesis& hypothesis : filter.estimate().hypotheses)
    precision.widen(hypothesis.world.covariance());
}

void end_step(const MovingObjectFilter& filter, Precision& precision) {
  if (filter.observation_count() == 0) return;
  for (const MovingObjectHypothesis& hypothesis : filter.estimate().hypotheses)
    precision.widen_at(hypothesis.world.mean(), hypothesis.world.covariance());
}

void expect_sound(const MovingObjectFilter& filter, const Precision& precision) {
  if (filter.observation_count() == 0) return;
  const MovingObjectEstimate estimate = filter.estimate();
  double sum = estimate.lost_probability;
  for (const MovingObjectHypothesis& hypothesis : estimate.hypotheses) {
    expect_pose(hypothesis.world.mean());
    if (precision.is_left())
      expect_covariance(hypothesis.world.covariance(), "a hypothesis", precision.rounding());
    expect(hypothesis.world.covariance().allFinite(), "a covariance that is not finite");
    expect(hypothesis.twist.allFinite() && hypothesis.twist_covariance.allFinite(),
           "a twist that is not finite");
    sum += hypothesis.probability;
  }
  expect(std::abs(sum - 1.0) < 1e-6, "probabilities whose sum is not one");
  if (!estimate.hypotheses.empty()) expect_weights(filter.object_mixture(), "the object");
}

void step(MovingObjectFilter& filter, Input& input, Precision& precision) {
  const double time_s = filter.time_s().value_or(0.0) + input.number();
  const std::vector<KnownFrame> frames{{input.pose()}};
  if (input.below(4) == 0) return filter.predict(time_s, frames);
  Observation observation = observation_from(input);
  observation.stamp_s = time_s;
  KnownCamera camera = exact_camera(input.pose());
  if (input.flag()) camera.frame.covariance = input.covariance(0.01, 0.01);
  if (input.flag()) camera.constant_covariance = input.covariance(0.01, 0.01);
  MovingObjectFilter before = filter;
  before.predict(time_s, frames);
  begin_detection(before, observation, camera, precision);
  filter.update(observation, camera, frames);
}

}  // namespace

POSEMIX_FUZZ_TARGET(moving_object) {
  Input input(bytes);
  try {
    MovingObjectSettings settings;
    settings.max_hypotheses = 1 + input.below(4);
    const ObjectSensor sensor{noise_from(input)};
    MovingObjectFilter filter(sensor, models_from(input), settings);
    Precision precision(internal::kLargestVarianceRatio);
    for (int k = 0; k < kMostSteps && !input.empty(); ++k) {
      Precision next = precision;
      if (!does([&] { return bits_of(filter); }, [&] { step(filter, input, next); })) continue;
      end_step(filter, next);
      precision = next;
      expect_sound(filter, precision);
    }
  } catch (const InvalidInput&) {
    return;  // settings, models or noise that were refused
  }
}

}  // namespace posemix::fuzzing
