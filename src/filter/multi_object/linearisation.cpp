// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <Eigen/LU>

#include "detection_update.hpp"
#include "transport.hpp"

/// Detections are linearised where they take camera and object: eq. (33) and (34) of
/// docs/many-objects.md.
namespace posemix::internal {
namespace {

/// Of K, where turns are so large that the coordinates nearly fold.
constexpr double kLeastDeterminant = 0.05;

/// Squared standard deviations of the white error that the map of the slow error may change by.
constexpr double kSmallChange = 0.1;

/// Where a detection takes the camera and the object, in the tangent spaces before it.
struct Corrections {
  Vector6d camera;
  Vector6d object;
};

Corrections corrections(const DetectionState& state, const Innovation& seen) {
  const Vector6d pull = Cholesky6(seen.covariance).solved(seen.residual);
  const Vector18d by = times_ht(state.covariance, seen.slow_map) * pull;
  return {by.segment<6>(kCameraRow), by.segment<6>(kObjectRow)};
}

/// What detections of an object did not tell of its slow error they do not tell by another
/// linearisation either: A becomes another one only where it has to.
void take_slow_map(const DetectionState& state, const Matrix6d& slow_map, Innovation& seen) {
  const Matrix6d change = slow_map - seen.slow_map;
  const Matrix6d spread =
      change * state.covariance.block<6, 6>(kSlowRow, kSlowRow) * change.transpose();
  if (Cholesky6(seen.noise).solved_rows(spread).trace() > kSmallChange) seen.slow_map = slow_map;
}

/// Where a correction takes camera and object.
DetectionState moved(const DetectionState& state, const Corrections& by) {
  DetectionState there = state;
  there.camera = SE3d::exp(by.camera) * state.camera;
  there.object = SE3d::exp(by.object) * state.object;
  return there;
}

/// A component of a detection, its noise, and G of eq. (33).
struct Seen {
  const ObservationComponent& observed;
  const NoiseComponent& component;
  const ObjectSensor& sensor;
  Matrix6d common_part;
};

/// Eq. (34) at `by`; false where turns are too large for it.
bool linearise_at(const DetectionState& state, const Corrections& by, const Seen& given,
                  Innovation& seen) {
  const Matrix6d of_camera = SE3d::left_jacobian(by.camera);
  const Matrix6d k = of_camera + (SE3d::left_jacobian(by.object) - of_camera) * given.common_part;
  const Eigen::PartialPivLU<Matrix6d> factor(k);
  if (!(factor.determinant() > kLeastDeterminant)) return false;
  const Matrix6d back = factor.inverse();
  const Innovation again =
      innovation_of(moved(state, by), given.observed, given.component, given.sensor);
  seen.noise = back * again.noise * back.transpose();
  symmetrize(seen.noise);
  seen.residual = back * (again.residual + again.slow_map * state.slow) + by.object - by.camera;
  if (state.has_slow) take_slow_map(state, back * again.slow_map, seen);
  seen.residual -= seen.slow_map * state.slow;
  seen.axes = again.axes;
  seen.white = again.white;
  seen.covariance = seen.noise + state.seen_covariance(seen.slow_map);
  return true;
}

void linearise_there(const DetectionState& state, const ObservationComponent& observed,
                     const NoiseComponent& component, const ObjectSensor& sensor,
                     Innovation& seen) {
  constexpr int kSteps = 4;
  if (!is_far_less_certain(state.difference(), seen.noise, state.object.translation())) return;
  const LinearRange range(seen.white);
  const double rotation = seen.white.diagonal().head<3>().maxCoeff();
  const Seen given{observed, component, sensor, state.common_part(seen.noise)};
  Corrections by = corrections(state, seen);
  const DetectionState there = moved(state, by);
  if (range.has(state.camera, there.camera, rotation) &&
      range.has(state.object, there.object, rotation))
    return;
  for (int step = 0; step < kSteps && linearise_at(state, by, given, seen); ++step)
    by = corrections(state, seen);
}

}  // namespace

Matrix6d DetectionState::common_part(const Matrix6d& noise) const {
  constexpr double kRegular = 1e-3;
  const Matrix6d apart = covariance.block<6, 6>(kObjectRow, kObjectRow) -
                         covariance.block<6, 6>(kObjectRow, kCameraRow);
  return Cholesky6(difference() + kRegular * noise).solved_rows(apart);
}

void linearise_there(const DetectionState& state, const WeighedObservation& observation,
                     const ObjectSensor& sensor, Explanation& explanation) {
  if (!std::isfinite(explanation.log_evidence)) return;
  const auto& noise = sensor.noise.components();
  for (std::size_t i = 0; i < explanation.innovations.size(); ++i) {
    Innovation& seen = explanation.innovations[i];
    if (!(seen.weight > 0.0)) continue;
    linearise_there(state, observation.components[i / noise.size()], noise[i % noise.size()],
                    sensor, seen);
  }
}

}  // namespace posemix::internal
