// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "filters.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "precision.hpp"

/// The multi-object filter over any stream of detections, odometry, times and models.
namespace posemix::fuzzing {
namespace {

template <class Do>
void for_each_pose(const MultiObjectFilter& filter, const Do& act) {
  act(filter.camera().mean(), filter.camera().covariance());
  for (std::size_t object = 0; object < filter.object_count(); ++object) {
    for (const ObjectHypothesis& hypothesis : filter.hypotheses(object))
      act(hypothesis.pose, hypothesis.covariance);
  }
}

/// What is known before a detection, which the origin of the filter's world follows.
void begin_detection(const MultiObjectFilter& filter, Precision& precision) {
  precision.move_to(filter.camera().mean().translation());
  for_each_pose(filter,
                [&](const SE3d&, const Matrix6d& covariance) { precision.widen(covariance); });
}

void end_step(const MultiObjectFilter& filter, Precision& precision) {
  for (std::size_t object = 0; object < filter.object_count(); ++object)
    precision.see(filter.sensor(object).noise);
  for_each_pose(filter, [&](const SE3d& pose, const Matrix6d& covariance) {
    precision.widen_at(pose, covariance);
  });
}

void expect_sound(const MultiObjectFilter& filter, const Precision& precision) {
  const auto expect_of = [&](const auto& covariance, const std::string& what) {
    if (precision.is_left()) return expect_covariance(covariance, what, precision.rounding());
    expect(covariance.allFinite(), what + ": a covariance that is not finite");
  };
  expect_pose(filter.camera().mean());
  expect_of(filter.camera().covariance(), "the camera");
  for (std::size_t object = 0; object < filter.object_count(); ++object) {
    double sum = std::exp(filter.log_absent(object));
    for (const ObjectHypothesis& hypothesis : filter.hypotheses(object)) {
      expect_pose(hypothesis.pose);
      expect_of(hypothesis.covariance, "a hypothesis");
      expect(hypothesis.probability >= 0.0 && hypothesis.probability <= 1.0 + 1e-9,
             "a probability that is none");
      sum += std::exp(hypothesis.log_weight);
    }
    expect(std::abs(sum - 1.0) < 1e-6, "weights of an object and its absence whose sum is not one");
    expect(filter.noise_scale(object).allFinite(), "a scale of noise that is not finite");
  }
  expect_of(filter.joint().covariance(), "the joint Gaussian");
}

MultiObjectSettings multi_object_settings(Input& input) {
  MultiObjectSettings settings;
  settings.max_hypotheses = 1 + input.below(4);
  settings.protected_hypotheses = input.below(3);
  settings.max_global_hypotheses = 1 + input.below(3);
  settings.has_odometry = input.flag();
  if (input.flag()) settings.camera_gain = std::abs(input.number());
  if (input.flag()) settings.default_clutter = std::abs(input.number());
  if (input.flag()) settings.split_loss = std::abs(input.number());
  return settings;
}

void step(MultiObjectFilter& filter, Input& input, Precision& precision) {
  const double dt = input.scale(0.1);
  switch (input.below(8)) {
    case 0:
      return filter.predict_with_odometry(input.pose(0.1), input.covariance(0.01, 0.01), dt);
    case 1:
      return filter.predict_random_walk(input.covariance(0.05, 0.05), dt);
    case 2:
      return filter.predict_constant_velocity(input.scale(1.0), input.covariance(0.01, 0.01),
                                              input.covariance(0.01, 0.01),
                                              input.covariance(0.1, 0.1), dt);
    case 3:
      filter.set_camera(ConcentratedGaussian<SE3d>(input.pose(), input.covariance(0.01, 0.01)), dt);
      return begin_detection(filter, precision);
    case 4:
      filter.forget(input.below(4));
      return;
    case 5:
      if (filter.object_count() < 4) filter.add_object({noise_from(input)});
      return;
    case 6:
      begin_detection(filter, precision);
      filter.update(input.below(4), input.pose());
      return;
    default:
      begin_detection(filter, precision);
      const std::size_t object = input.below(4);
      const Observation observation = observation_from(input);
      const SE3d body_camera = input.flag() ? input.pose(0.1) : SE3d();
      filter.update(object, observation, {.body_camera = body_camera});
      precision.see(observation);
  }
}

}  // namespace

POSEMIX_FUZZ_TARGET(multi_object) {
  Input input(bytes);
  try {
    const ConcentratedGaussian<SE3d> camera(input.pose(), input.covariance(0.05, 0.05));
    MultiObjectFilter filter(camera, {{noise_from(input)}, {noise_from(input)}},
                             multi_object_settings(input));
    Precision precision(internal::kLargestVarianceRatio);
    for (int k = 0; k < kMostSteps && !input.empty(); ++k) {
      Precision next = precision;
      if (!does([&] { return bits_of(filter); }, [&] { step(filter, input, next); })) continue;
      end_step(filter, next);
      precision = next;
      expect_sound(filter, precision);
    }
  } catch (const InvalidInput&) {
    return;  // settings, models or a prior that were refused
  }
}

}  // namespace posemix::fuzzing
