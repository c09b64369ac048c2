// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "arrays.hpp"
#include "moving_object.hpp"

NB_MODULE(_core, m) {
  using namespace posemix::python;  // NOLINT(google-build-using-namespace)
  // Settings objects are default arguments of functions that take settings. These references are
  // still there when the interpreter ends, so nanobind would report leaks.
  nanobind::set_leak_warnings(false);
  m.doc() = "The compiled part of posemix. Its users are the modules of the package.";
  m.attr("version") = POSEMIX_VERSION;
  bind_random(m);
  bind_lie(m);
  bind_density(m);
  bind_density_batches(m);
  bind_mixture(m);
  bind_reduction(m);
  bind_divergence(m);
  bind_em(m);
  bind_report(m);
  bind_grasp(m);
  bind_errors(m);
  bind_error_fit(m);
  bind_scores(m);
  bind_tolerance(m);
  bind_symmetry(m);
  bind_noise(m);
  bind_noise_fit(m);
  bind_observation(m);
  bind_multi_object_settings(m);
  bind_multi_object_filter(m);
  bind_moving_object_settings(m);
  bind_moving_object(m);
  bind_gaussian_sum_filter(m);
  bind_existence(m);
  bind_slam_settings(m);
  bind_frame_estimate(m);
  bind_sequence(m);
  bind_odometry_noise(m);
  bind_frame_input(m);
  bind_slam(m);
  bind_smoother(m);
  bind_stamped_slam(m);
  bind_slam_state(m);
  bind_relocalise(m);
  bind_association(m);
  bind_fuse_views(m);
  bind_slam_run(m);
  bind_consistency(m);
  bind_evaluation(m);
  bind_simulation(m);
  bind_fiducials(m);
  bind_files(m);
  bind_mixture_files(m);
  bind_jobs(m);
}
