// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "simulation_sight.hpp"

#include <cmath>

#include <fmt/format.h>

#include "simulation_paths.hpp"

namespace posemix::internal::simulation {
namespace {

/// A number of events with a mean, by the product of uniform deviates.
std::size_t draw_count(Real mean, RandomStream& random) {
  const Real least = std::exp(-mean);
  std::size_t count = 0;
  for (Real product = random.uniform(); product > least; product *= random.uniform()) ++count;
  return count;
}

}  // namespace

bool is_in_view(const std::optional<SimulationView>& view, const Vector3& point) {
  if (!view) return true;
  const Real z = point.z();
  if (!(z >= view->least_range_m && z <= view->largest_range_m)) return false;
  const Real focal = view->focal_length_px;
  return 2 * focal * std::abs(point.x()) <= z * static_cast<Real>(view->width_px) &&
         2 * focal * std::abs(point.y()) <= z * static_cast<Real>(view->height_px);
}

Vector6 draw_error(const SimulationSd& sd, RandomStream& random) {
  Vector6 error = draw_normal(random);
  error.head<3>().array() *= sd.rotation_rad.cast<Real>().array();
  error.tail<3>().array() *= sd.translation_m.cast<Real>().array();
  return error;
}

StickyChain run_chain(const SimulationRuns& runs, double period_s, RandomStream random) {
  const Real off = 1 - static_cast<Real>(runs.fraction);
  const bool independent = !(runs.mean_run_s * off > period_s);
  const Real keep = independent ? Real(0) : 1 - period_s / (runs.mean_run_s * off);
  return {{1.0 - runs.fraction, runs.fraction}, keep, random};
}

ClutterSource::ClutterSource(const SimulationClutter& clutter,
                             const std::optional<SimulationView>& view, std::size_t index,
                             double period_s, std::uint64_t seed)
    : clutter_(clutter),
      view_(view),
      random_(named_stream(seed, fmt::format("clutter:{}", index))) {
  for (std::size_t i = 0; i < clutter.places.size(); ++i) {
    const std::string name = fmt::format("clutter:{}/{}", index, i);
    places_.push_back(run_chain(clutter.runs, period_s, named_stream(seed, name)));
    errors_.push_back(named_stream(seed, name + "/error"));
  }
}

/// Uniform over the volume in view: over the pixels, and in the cube of the range.
Pose ClutterSource::anywhere() {
  const auto cube = [](Real x) { return x * x * x; };
  const Real least = cube(view_->least_range_m);
  const Real z = std::cbrt(least + random_.uniform() * (cube(view_->largest_range_m) - least));
  const Real width = static_cast<Real>(view_->width_px) / view_->focal_length_px;
  const Real height = static_cast<Real>(view_->height_px) / view_->focal_length_px;
  const Real x = (random_.uniform() - Real(0.5)) * width * z;
  const Real y = (random_.uniform() - Real(0.5)) * height * z;
  return {draw_rotation(random_), Vector3(x, y, z)};
}

std::vector<Pose> ClutterSource::next(const Pose& world_camera) {
  std::vector<Pose> poses;
  const std::size_t count =
      clutter_.rate_per_image > 0.0 ? draw_count(clutter_.rate_per_image, random_) : 0;
  poses.reserve(count);
  for (std::size_t i = 0; i < count; ++i) poses.push_back(anywhere());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const SimulationPlace& place = clutter_.places[i];
    const Pose seen = world_camera.inverse() * pose_of(place.rotation_rad, place.position_m);
    const bool on = places_[i].next() == 1;
    const Vector6 error = draw_error(clutter_.sd, errors_[i]);
    if (on && is_in_view(view_, seen.translation())) poses.push_back(seen * Pose::exp(error));
  }
  return poses;
}

}  // namespace posemix::internal::simulation
