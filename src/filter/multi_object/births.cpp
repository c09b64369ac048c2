// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <numbers>

#include "multi_object_state.hpp"
#include "object_merge.hpp"
#include "posemix/filter/update.hpp"

namespace posemix::internal {
namespace {

/// Offsets nearer to each other than this are one mode.
constexpr double kSameMode = 1e-9;

/// A mode of a detector's noise: the components with the same offset.
struct NoiseMode {
  const NoiseComponent* first;
  double log_weight;  ///< log of the summed weights
};

bool same_mode(const NoiseComponent& a, const NoiseComponent& b) {
  return (a.offset.inverse() * b.offset).log().norm() < kSameMode;
}

/// The modes of the noise, every weight times exp(log_factor).
KeptVector<NoiseMode> modes_of(const DetectorNoise& noise, double log_factor) {
  KeptVector<NoiseMode> modes;
  for (const NoiseComponent& component : noise.components()) {
    const auto mode = std::find_if(modes.begin(), modes.end(), [&](const NoiseMode& other) {
      return same_mode(*other.first, component);
    });
    if (mode == modes.end()) {
      modes.push_back({&component, log_factor + std::log(component.weight)});
    } else {
      // log(exp(a) + w exp(d)) = a + log(1 + w / exp(a - d)).
      mode->log_weight += std::log1p(component.weight / std::exp(mode->log_weight - log_factor));
    }
  }
  return modes;
}

/// Covariance of the white error of a mode: the moments of its components.
Matrix6d mode_covariance(const DetectionState& state, const ObservationComponent& seen,
                         const NoiseComponent& mode, const ObjectSensor& sensor) {
  Matrix6d sum = Matrix6d::Zero();
  double weight = 0.0;
  for (const NoiseComponent& component : sensor.noise.components()) {
    if (!same_mode(mode, component)) continue;
    sum += component.weight * white_covariance(state, seen, component, sensor);
    weight += component.weight;
  }
  return sum / weight;
}

/// Covariance of the widest of a mode's components.
Matrix6d widest_covariance(const DetectionState& state, const ObservationComponent& seen,
                           const NoiseComponent& mode, const ObjectSensor& sensor) {
  Matrix6d widest = white_covariance(state, seen, mode, sensor);
  for (const NoiseComponent& component : sensor.noise.components()) {
    if (!same_mode(mode, component)) continue;
    const Matrix6d other = white_covariance(state, seen, component, sensor);
    if (other.determinant() > widest.determinant()) widest = other;
  }
  return widest;
}

/// The components that may start hypotheses, the heaviest first.
KeptVector<const ObservationComponent*> heaviest_first(const WeighedObservation& observation,
                                                       const Starters& may_start) {
  KeptVector<const ObservationComponent*> starting;
  for (std::size_t k = 0; k < may_start.size(); ++k)
    if (may_start[k]) starting.push_back(&observation.components[k]);
  std::stable_sort(starting.begin(), starting.end(),
                   [](const auto* a, const auto* b) { return a->weight > b->weight; });
  return starting;
}

}  // namespace

/// The covariance is the camera's plus that of the mode, with the slow error in place.
Alternative MultiObjectState::birth_at(const TrackedObject& object,
                                       const WeighedObservation& observation,
                                       const ObservationComponent& seen,
                                       const NoiseComponent& mode) const {
  const ObjectSensor& sensor = object.detectors[observation.source.detector].sensor();
  const SE3d camera = joint.seeing_camera(observation.source);
  Matrix6d camera_covariance = joint.covariance(kCamera, kCamera);
  ConditionalPose born{{}, {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
  born.cross_covariance.topRows<6>() = camera_covariance;
  if (joint.extrinsics() > 0) {
    // The error of the camera that sees is M [xi_C; xi_E ...].
    const Eigen::MatrixXd m = joint.seen_by(observation.source);
    const Eigen::MatrixXd with_rig = m * joint.rig();
    camera_covariance = with_rig * m.transpose();
    born.cross_covariance.topRows<6>() = with_rig.leftCols<6>();
    born.extrinsics.setZero(12, with_rig.cols() - 6);
    born.extrinsics.topRows<6>() = with_rig.rightCols(with_rig.cols() - 6);
  }
  // xi_O = xi_C - A b - n, with the error xi_C of the camera that sees.
  DetectionState there{.camera = camera, .object = camera * seen.pose * mode.offset.inverse()};
  // A gross error at the birth would make all right detections after it look like a run.
  const bool wide =
      object.put_down && object.put_down->detectors[observation.source.detector].count() == 1;
  Matrix6d covariance = camera_covariance + (wide ? widest_covariance(there, seen, mode, sensor)
                                                  : mode_covariance(there, seen, mode, sensor));
  born.pose = there.object;
  if (const auto slow = sensor.slow_covariance()) {
    const Matrix6d a = slow_error_map(there, mode, sensor);
    const Matrix6d a_b = a * *slow;
    born.slow = Vector6d::Zero();
    covariance += a_b * a.transpose();
    born.covariance.topRightCorner<6, 6>() = -a_b;
    born.covariance.bottomLeftCorner<6, 6>() = -a_b.transpose();
    born.covariance.bottomRightCorner<6, 6>() = *slow;
  }
  born.covariance.topLeftCorner<6, 6>() = covariance;
  return {{.score = settings.birth_score, .detections = 1}, born};
}

/// Hypotheses at components that no hypothesis explains, one for each mode of the noise, the
/// heaviest components first, as many as an object may have. Their weight is that of absence times
/// those of component and mode and the density of clutter ("Births"). Of components that agree the
/// heaviest takes the weight of all.
Alternatives MultiObjectState::births_of(const TrackedObject& object,
                                         const WeighedObservation& observation,
                                         const Starters& may_start, double share,
                                         BirthPlaces* put_down) {
  constexpr double kPi = std::numbers::pi;
  if (!std::isfinite(object.belief.log_absent())) return {};
  const auto starting = heaviest_first(observation, may_start);
  const ObjectSensor& sensor = object.detectors[observation.source.detector].sensor();
  const Matrix6d camera_covariance = joint.covariance(kCamera, kCamera);
  const double log_density = object.belief.log_absent() + std::log(observation.object_weight) -
                             std::log(8.0 * kPi * kPi * sensor.noise.clutter().volume_m3);
  Alternatives births;
  for (const ObservationComponent* seen : starting) {
    const auto index = static_cast<std::size_t>(seen - observation.components.data());
    KeptVector<NoiseMode> modes = modes_of(sensor.noise, log_density + std::log(seen->weight));
    for (std::size_t m = 0; m < modes.size(); ++m) {
      NoiseMode& mode = modes[m];
      if (put_down) mode.log_weight = put_down->log_modes[m] + std::log(seen->weight);
      if (!std::isfinite(mode.log_weight)) continue;
      Alternative born = birth_at(object, observation, *seen, *mode.first);
      born.standing.log_weight = mode.log_weight;
      if (put_down) born.standing.shown = object.belief.shown_at_birth(put_down->detector, m);
      const auto same = std::find_if(births.begin(), births.end(), [&](const Alternative& other) {
        return starting.size() > 1 &&
               agree(camera_covariance, sensor.symmetries, merge_bounds, other.pose, born.pose);
      });
      if (same != births.end()) {
        same->standing.log_weight +=
            std::log1p(std::exp(mode.log_weight - same->standing.log_weight));
        if (put_down && m == 0) put_down->places[index] = place_of(same->standing.id);
      } else if (starting.size() == 1 || births.size() < settings.max_hypotheses) {
        born.standing.id = next_id++;
        if (put_down && m == 0) put_down->places[index] = place_of(born.standing.id);
        births.push_back(born);
      }
    }
  }
  for (Alternative& born : births) {
    born.standing.log_probability = object.belief.log_absence_probability() +
                                    share * (born.standing.log_weight - object.belief.log_absent());
  }
  return births;
}

}  // namespace posemix::internal
