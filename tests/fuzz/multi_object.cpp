// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "filters.hpp"
#include "posemix/filter/multi_object_filter.hpp"

/// The multi-object filter over any stream of detections, odometry, times and models.
namespace posemix::fuzzing {
namespace {

void expect_sound(const MultiObjectFilter& filter) {
  expect_density(filter.camera(), "the camera");
  for (std::size_t object = 0; object < filter.object_count(); ++object) {
    double sum = std::exp(filter.log_absent(object));
    for (const ObjectHypothesis& hypothesis : filter.hypotheses(object)) {
      expect_pose(hypothesis.pose);
      expect_covariance(hypothesis.covariance, "a hypothesis");
      expect(hypothesis.probability >= 0.0 && hypothesis.probability <= 1.0 + 1e-9,
             "a probability that is none");
      sum += std::exp(hypothesis.log_weight);
    }
    expect(std::abs(sum - 1.0) < 1e-6, "weights of an object and its absence whose sum is not one");
    expect(filter.noise_scale(object).allFinite(), "a scale of noise that is not finite");
  }
  expect_covariance(filter.joint().covariance(), "the joint Gaussian");
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

void step(MultiObjectFilter& filter, Input& input) {
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
      return;
    case 4:
      filter.forget(input.below(4));
      return;
    case 5:
      if (filter.object_count() < 4) filter.add_object({noise_from(input)});
      return;
    case 6:
      filter.update(input.below(4), input.pose());
      return;
    default:
      filter.update(input.below(4), observation_from(input),
                    {.body_camera = input.flag() ? input.pose(0.1) : SE3d()});
  }
}

}  // namespace

POSEMIX_FUZZ_TARGET(multi_object) {
  Input input(bytes);
  try {
    const ConcentratedGaussian<SE3d> camera(input.pose(), input.covariance(0.05, 0.05));
    MultiObjectFilter filter(camera, {{noise_from(input)}, {noise_from(input)}},
                             multi_object_settings(input));
    for (int k = 0; k < kMostSteps && !input.empty(); ++k) {
      if (does([&] { return bits_of(filter); }, [&] { step(filter, input); })) expect_sound(filter);
    }
  } catch (const InvalidInput&) {
    return;  // settings, models or a prior that were refused
  }
}

}  // namespace posemix::fuzzing
