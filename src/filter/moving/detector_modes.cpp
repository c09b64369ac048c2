// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detector_modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "posemix/filter/object_prior.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix::internal {
namespace {

/// Offsets nearer to each other than this are one mode.
constexpr double kSameOffset = 1e-9;
constexpr double kNever = -std::numeric_limits<double>::infinity();

const double kLogRotations = std::log(8.0 * std::numbers::pi * std::numbers::pi);

/// The density of a turned detection and its innovation: the difference of the origins in the
/// world.
struct PositionInnovation {
  double log_density = kNever;
  Innovation innovation = {};
};

PositionInnovation position_innovation(const DetectionState& state, const SE3d& seen,
                                       const Innovation& inlier) {
  const SE3d at(SO3d(), state.object.translation());
  Matrix6d s = at.inverse().adjoint_congruence(inlier.covariance);
  const Eigen::Matrix3d of_position = s.bottomRightCorner<3, 3>();
  const Eigen::LLT<Eigen::Matrix3d> factor(of_position);
  PositionInnovation result;
  if (factor.info() != Eigen::Success) return result;
  Vector6d z = Vector6d::Zero();
  z.tail<3>() = (state.camera * seen).translation() - state.object.translation();
  result.log_density = log_normal(factor, Eigen::Vector3d(z.tail<3>())) - kLogRotations;
  // Nothing is told of the orientation.
  s.topLeftCorner<3, 3>().diagonal().array() += kUniformRotationVariance;
  result.innovation = inlier;
  result.innovation.residual = at.adjoint_blocks().times(z);
  result.innovation.covariance = at.adjoint_congruence(s);
  return result;
}

/// Wrong detections: anywhere, or at this place in any orientation.
void add_wrong(const DetectionState& state, const WeighedObservation& observation,
               const ObjectSensor& sensor, double turned, ModeEvidence& evidence) {
  const double anywhere =
      std::log1p(-turned) - kLogRotations - std::log(sensor.noise.clutter().volume_m3);
  std::vector<double> here;
  const std::size_t n = sensor.noise.components().size();
  for (std::size_t k = 0; k < observation.components.size(); ++k) {
    const SE3d seen =
        observation.components[k].pose * sensor.noise.components().front().offset.inverse();
    PositionInnovation at =
        position_innovation(state, seen, evidence.explanation.innovations[k * n]);
    evidence.log_here.push_back(at.log_density);
    here.push_back(std::log(turned * observation.components[k].weight) + at.log_density);
    if (k == 0 || here.back() > *std::max_element(here.begin(), here.end() - 1))
      evidence.position = std::move(at.innovation);
  }
  const double both[] = {anywhere, log_sum_exp(here)};
  evidence.log_wrong = log_sum_exp(both);
  evidence.turned = std::exp(both[1] - evidence.log_wrong);
}

}  // namespace

DetectorModes::DetectorModes(const DetectorNoise& noise)
    : mode_time_s_(noise.dependence().mode_time_s) {
  const auto& components = noise.components();
  for (std::size_t c = 0; c < components.size(); ++c) {
    const auto same = std::find_if(first_.begin(), first_.end(), [&](std::size_t other) {
      return (components[other].offset.inverse() * components[c].offset).log().norm() < kSameOffset;
    });
    mode_of_.push_back(static_cast<std::size_t>(same - first_.begin()));
    if (same == first_.end()) {
      first_.push_back(c);
      weights_.push_back(0.0);
    }
    weights_[mode_of_.back()] += components[c].weight;
    total_ += components[c].weight;
    run_length_ = std::max(run_length_, components[c].run_length);
  }
}

double DetectorModes::persistence(double dt) const {
  const double by_time = mode_time_s_ > 0.0 ? std::exp(-dt / mode_time_s_) : 0.0;
  return std::max(by_time, 1.0 - 1.0 / run_length_);
}

WrongShares wrong_shares(double clutter, double isolated) {
  const double alone = isolated * clutter;
  return {alone, (clutter - alone) / (1.0 - alone)};
}

ModeEvidence mode_evidence(const DetectionState& state, const WeighedObservation& observation,
                           const ObjectSensor& sensor, const DetectorModes& modes, double turned) {
  ModeEvidence result;
  result.explanation = explain(state, observation, sensor);
  const auto& innovations = result.explanation.innovations;
  const std::size_t n = sensor.noise.components().size();
  std::vector<double> parts(modes.count(), 0.0);
  for (std::size_t i = 0; i < innovations.size(); ++i)
    parts[modes.mode_of(i % n)] += innovations[i].weight;
  for (std::size_t m = 0; m < modes.count(); ++m) {
    const bool any = parts[m] > 0.0 && std::isfinite(result.explanation.log_evidence);
    result.log_right.push_back(
        any ? result.explanation.log_evidence +
                  std::log(parts[m] / (modes.weight(m) * observation.object_weight))
            : kNever);
  }
  for (std::size_t k = 0; k < observation.components.size(); ++k) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m < modes.count(); ++m) {
      const Innovation& seen = innovations[k * n + modes.first(m)];
      const Eigen::LLT<Matrix6d> s(seen.covariance);
      if (s.info() == Eigen::Success)
        least = std::min(least, s.matrixL().solve(seen.residual).squaredNorm());
    }
    result.squared_distances.push_back(least);
  }
  add_wrong(state, observation, sensor, turned, result);
  return result;
}

}  // namespace posemix::internal
