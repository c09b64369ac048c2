// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "detection_update.hpp"
#include "posemix/mixture/log_weights.hpp"

/// How well a detection fits a hypothesis: eq. (2) and (3) of docs/many-objects.md.
namespace posemix::internal {
namespace {

/// Log of the probability, relative to that of the most probable component, below which a component
/// is left out.
constexpr double kLeastLogRatio = -9.0;

/// The covariance with standard deviations times `scale`.
Matrix6d scaled(const Matrix6d& covariance, const Vector6d& scale) {
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

/// H D.
Matrix6d times_h(const Matrix18x6d& d, const Matrix6d& slow_map) {
  Matrix6d s = d.middleRows<6>(kObjectRow) - d.middleRows<6>(kCameraRow);
  s.noalias() += slow_map * d.middleRows<6>(kSlowRow);
  return s;
}

/// Log determinant of a covariance; its bound by the variances, where rounding leaves no factor.
double log_det_or_bound(const Matrix6d& covariance) {
  const Cholesky6 factor(covariance);
  return factor.ok() ? factor.log_det() : covariance.diagonal().array().log().sum();
}

/// The factor by which a component of the noise is wider than the first one; 1 where one of them is
/// exact in some direction.
double width(const NoiseAtPose& component, const NoiseAtPose& first) {
  const double ratio =
      std::exp((log_det_or_bound(component.covariance) - log_det_or_bound(first.covariance)) / 6.0);
  return std::isfinite(ratio) && ratio > 0.0 ? ratio : 1.0;
}

/// Covariance of the white error along the axes of the noise.
Matrix6d white_along(const NoiseAtPose& at, const SE3d& expected, const ObservationComponent& seen,
                     const NoiseComponent& component, const ObjectSensor& sensor) {
  const GivenCovariance use = sensor.noise.dependence().given_covariance;
  if (!seen.covariance || use == GivenCovariance::ignored)
    return scaled(at.covariance, sensor.noise_scale);
  // From the axes of the detected pose to those of the noise.
  const Eigen::Matrix3d turn = (at.axes.rotation().inverse() * seen.pose.rotation()).matrix();
  Matrix6d along = Matrix6d::Zero();
  along.topLeftCorner<3, 3>() = turn;
  along.bottomRightCorner<3, 3>() = turn;
  const NoiseComponent& first = sensor.noise.components().front();
  const double wider = &component == &first ? 1.0 : width(at, noise_at(first, expected));
  const Matrix6d given = wider * along * *seen.covariance * along.transpose();
  return use == GivenCovariance::as_given ? given : scaled(given, sensor.noise_scale);
}

/// A, from the slow error as it is carried to the world frame.
Matrix6d slow_map_of(const SE3d& axes, const NoiseAtPose& at, const ObjectSensor& sensor) {
  const Matrix6d map = axes.adjoint() * at.units.asDiagonal();
  return sensor.slow_units ? Matrix6d(map * *sensor.slow_units) : map;
}

/// A component of an observation under one of the noise as this state sees it, without its weight:
/// eq. (2).
Innovation innovation(const DetectionState& state, const ObservationComponent& observed,
                      const NoiseComponent& component, const ObjectSensor& sensor) {
  Innovation result;
  const SE3d expected = state.camera_object();
  const NoiseAtPose at = noise_at(component, expected);
  result.axes = state.camera * at.axes;
  result.white = white_along(at, expected, observed, component, sensor);
  result.noise = result.axes.adjoint_congruence(result.white);
  result.slow_map = state.has_slow ? slow_map_of(result.axes, at, sensor) : Matrix6d::Zero();
  SE3d seen = observed.pose * component.offset.inverse();
  if (!sensor.symmetries.is_trivial()) {
    // The detected angle about an axis of symmetry is any angle.
    result.noise += state.object.adjoint_congruence(sensor.symmetries.unobserved_covariance());
    const Matrix6d local =
        state.object.inverse().adjoint_congruence(Matrix6d(state.difference() + result.noise));
    seen = sensor.symmetries.closest_observed(seen, expected, local.inverse());
  }
  result.residual = (state.camera * seen * state.object.inverse()).log();
  if (state.has_slow) result.residual -= result.slow_map * state.slow;
  return result;
}

/// Log density of N(z; 0, S) [nats], and z^T S^-1 z.
struct Evidence {
  double log_density = -std::numeric_limits<double>::infinity();
  double squared_distance = std::numeric_limits<double>::infinity();
};

/// The object was detected, and so is in the volume that detections are in, that of clutter. A
/// predicted pose that is less certain than this volume, whose log is `log_volume`, is cut off at
/// its border: it has the volume's density at its peak and is as much flatter as it was larger.
Evidence evidence_of(const Vector6d& residual, const Matrix6d& covariance, double log_volume) {
  const Cholesky6 s(covariance);
  if (!s.ok()) return {};
  const double squared = s.whitened(residual).squaredNorm();
  const double of_gaussian = s.log_det() + 6.0 * kLogTwoPi;
  const double larger = 0.5 * of_gaussian - log_volume;
  if (larger <= 0.0) return {-0.5 * (squared + of_gaussian), squared};
  return {-0.5 * squared * std::exp(-larger) - log_volume, squared};
}

/// Evidence of a component: that of the innovation, and for gross errors that with a slow error
/// drawn anew from its stationary distribution.
Evidence evidence_of(const DetectionState& state, const Innovation& seen, double run_length,
                     const std::optional<Matrix6d>& slow, double log_volume) {
  if (run_length == 1.0 || !slow) return evidence_of(seen.residual, seen.covariance, log_volume);
  const Matrix6d anew = seen.slow_map * *slow * seen.slow_map.transpose();
  return evidence_of(seen.residual + seen.slow_map * state.slow,
                     state.difference() + anew + seen.noise, log_volume);
}

}  // namespace

Matrix6d DetectionState::difference() const {
  const Matrix6d cross = covariance.block<6, 6>(kObjectRow, kCameraRow);
  return covariance.block<6, 6>(kCameraRow, kCameraRow) +
         covariance.block<6, 6>(kObjectRow, kObjectRow) - cross - cross.transpose();
}

Matrix6d DetectionState::seen_covariance(const Matrix6d& slow_map) const {
  return has_slow ? times_h(times_ht(covariance, slow_map), slow_map) : difference();
}

WeighedObservation weigh(const Observation& observation, const ObjectSensor& sensor, double share,
                         const ObservationSource& source) {
  const Clutter& clutter = sensor.noise.clutter();
  WeighedObservation result{
      .components = {observation.components.begin(), observation.components.end()},
      .clutter = observation.clutter.value_or(clutter.weight),
      .log_clutter = sensor.noise.log_clutter_density(),
      .log_absence = {},
      .source = source};
  std::erase_if(result.components, [](const auto& component) { return !(component.weight > 0.0); });
  double total = 0.0;
  for (ObservationComponent& component : result.components) {
    component.weight = std::pow(component.weight, share);
    total += component.weight;
  }
  for (ObservationComponent& component : result.components) {
    component.weight /= total;
    // Beside a large variance a mirror image may differ by more than small ones (validate()).
    if (component.covariance) symmetrize(*component.covariance);
  }
  if (observation.clutter) {
    result.object_weight = (1.0 - *observation.clutter) / (1.0 - clutter.weight);
    result.log_clutter = std::log(*observation.clutter) -
                         std::log(8.0 * std::numbers::pi * std::numbers::pi * clutter.volume_m3);
  }
  result.log_absence = result.log_clutter;
  return result;
}

const Innovation& Explanation::inlier() const {
  std::size_t best = 0;
  for (std::size_t i = 0; i < innovations.size(); i += noise_components) {
    if (innovations[i].weight > innovations[best].weight) best = i;
  }
  return innovations[best];
}

double Explanation::probability_of(std::size_t component) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < noise_components; ++i)
    sum += innovations[component * noise_components + i].weight;
  return sum;
}

double Explanation::inlier_probability() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < innovations.size(); i += noise_components)
    sum += innovations[i].weight;
  return sum;
}

Matrix6d white_covariance(const DetectionState& state, const ObservationComponent& seen,
                          const NoiseComponent& component, const ObjectSensor& sensor) {
  const SE3d expected = state.camera_object();
  const NoiseAtPose at = noise_at(component, expected);
  return (state.camera * at.axes)
      .adjoint_congruence(white_along(at, expected, seen, component, sensor));
}

Matrix6d slow_error_map(const DetectionState& state, const NoiseComponent& component,
                        const ObjectSensor& sensor) {
  const NoiseAtPose at = noise_at(component, state.camera_object());
  return slow_map_of(state.camera * at.axes, at, sensor);
}

namespace {

/// The innovation of one detection, with S.
Innovation innovation_alone(const DetectionState& state, const ObservationComponent& observed,
                            const NoiseComponent& component, const ObjectSensor& sensor) {
  Innovation seen = innovation(state, observed, component, sensor);
  seen.covariance = seen.noise + state.seen_covariance(seen.slow_map);
  return seen;
}

/// The detections of a run have the information of one.
void widen_by_run(double run_length, Innovation& seen) {
  const Matrix6d run = (run_length - 1.0) * seen.noise;
  seen.noise += run;
  seen.covariance += run;
}

/// No detection tells the angle about an axis of symmetry: as that of a uniform angle, which is
/// right for the weight of one detection, the information of many would add up. Beside a variance
/// that is 1e12 times larger a sharp one is still told from rounding.
void leave_unobserved(const DetectionState& state, const SymmetryGroup& symmetries,
                      Innovation& seen) {
  constexpr double kMost = 1e3;
  constexpr double kOverSharpest = 1e12;
  if (symmetries.axes().empty()) return;
  const double larger = std::min(kMost, kOverSharpest * seen.white.diagonal().minCoeff()) - 1.0;
  if (!(larger > 0.0)) return;
  const Matrix6d free =
      larger * state.object.adjoint_congruence(symmetries.unobserved_covariance());
  seen.noise += free;
  seen.covariance += free;
}

/// The innovation of one component of an observation under one of the noise, with its evidence,
/// eq. (3): e_c = log w_c + log N(z_c; 0, S_c).
Evidence add_innovation(const DetectionState& state, const ObservationComponent& observed,
                        const NoiseComponent& component, const ObjectSensor& sensor,
                        const std::optional<Matrix6d>& slow, KeptVector<Innovation>& innovations) {
  innovations.push_back(innovation_alone(state, observed, component, sensor));
  Innovation& seen = innovations.back();
  const double log_volume =
      std::log(8.0 * std::numbers::pi * std::numbers::pi * sensor.noise.clutter().volume_m3);
  const Evidence evidence = evidence_of(state, seen, component.run_length, slow, log_volume);
  widen_by_run(component.run_length, seen);
  leave_unobserved(state, sensor.symmetries, seen);
  return evidence;
}

/// The part of the evidence that the weights tell. Those of `seen` are logarithmic terms, by
/// component of the observation, then of the noise.
double weight_evidence(const WeighedObservation& observation, const Explanation& seen) {
  if (observation.components.size() < 2) return 0.0;
  const auto& terms = seen.innovations;
  const double log_seen = log_sum_exp(terms.size(), [&](std::size_t i) { return terms[i].weight; });
  if (!std::isfinite(log_seen)) return 0.0;
  const auto count = static_cast<double>(observation.components.size());
  const auto without_weight = [&](std::size_t i) {
    return terms[i].weight -
           std::log(count * observation.components[i / seen.noise_components].weight);
  };
  return log_seen - log_sum_exp(terms.size(), without_weight);
}

/// Logarithmic terms become probabilities, without components that hardly count.
void set_probabilities(double log_clutter, Explanation& seen) {
  double most = log_clutter;
  for (const Innovation& one : seen.innovations) most = std::max(most, one.weight);
  const auto probability = [&](double term) {
    return term < most + kLeastLogRatio ? 0.0 : std::exp(term - seen.log_evidence);
  };
  double kept = 0.0;
  for (Innovation& one : seen.innovations) kept += one.weight = probability(one.weight);
  const double of_clutter = probability(log_clutter);
  kept += of_clutter;
  for (Innovation& one : seen.innovations) one.weight /= kept;
  seen.clutter_probability = of_clutter / kept;
}

}  // namespace

Innovation innovation_of(const DetectionState& state, const ObservationComponent& observed,
                         const NoiseComponent& component, const ObjectSensor& sensor) {
  Innovation seen = innovation_alone(state, observed, component, sensor);
  widen_by_run(component.run_length, seen);
  leave_unobserved(state, sensor.symmetries, seen);
  return seen;
}

Explanation explain(const DetectionState& state, const WeighedObservation& observation,
                    const ObjectSensor& sensor) {
  const auto& components = sensor.noise.components();
  const std::optional<Matrix6d> slow = sensor.slow_covariance();
  Explanation result;
  result.noise_components = components.size();
  const std::size_t pairs = components.size() * observation.components.size();
  result.innovations.reserve(pairs);
  result.squared_distances.reserve(observation.components.size());
  for (const ObservationComponent& observed : observation.components) {
    double least = std::numeric_limits<double>::infinity();
    for (const NoiseComponent& component : components) {
      const Evidence evidence =
          add_innovation(state, observed, component, sensor, slow, result.innovations);
      result.innovations.back().weight =
          std::log(component.weight * observation.object_weight * observed.weight) +
          evidence.log_density;
      least = std::min(least, evidence.squared_distance);
    }
    result.squared_distances.push_back(least);
  }
  const double log_weights = weight_evidence(observation, result);
  result.log_evidence = log_sum_exp(pairs + 1, [&](std::size_t i) {
    return i < pairs ? result.innovations[i].weight : observation.log_clutter;
  });
  set_probabilities(observation.log_clutter, result);
  if (log_weights != 0.0) result.log_weights = (1.0 - result.clutter_probability) * log_weights;
  return result;
}

}  // namespace posemix::internal
