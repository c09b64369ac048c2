// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "observed_cases.hpp"

#include <algorithm>

namespace posemix::internal {
namespace {

/// Cases of a Gaussian below this probability do not move it.
constexpr double kLeastCase = 1e-5;

using Columns = Eigen::Matrix<double, 18, 6>;

/// P H^T with H = [I 0 A].
Columns times_ht(const PlacedObject& object, const Innovation& seen) {
  Columns d = object.covariance.leftCols<6>();
  d.noalias() += object.covariance.rightCols<6>() * seen.slow_map.transpose();
  return d;
}

/// A of the slow error, at a pose.
Matrix6d slow_map_at(const PlacedObject& object, const NoiseComponent& noise,
                     const CaseInput& input) {
  if (!input.sensor.noise.dependence().slow) return Matrix6d::Zero();
  return slow_error_map(object.seen_from(input.camera), noise, input.sensor);
}

/// Eq. (13a). Moves the mean, and the covariance to the tangent space there: the inverse of
/// PlacedObject::transported. What detections do not tell, xi + A b = 0, stays what they do not
/// tell: else the filter would learn the slow error from turning its own mean.
void move_with_covariance(PlacedObject& object, const Vector18d& by, const NoiseComponent& noise,
                          const CaseInput& input) {
  const Matrix6d before = slow_map_at(object, noise, input);
  object.move(by);
  Matrix18d f = Matrix18d::Identity();
  const Matrix6d jacobian = SE3d::left_jacobian(Vector6d(by.head<6>()));
  f.topLeftCorner<6, 6>() = jacobian;
  f.topRightCorner<6, 6>() = jacobian * before - slow_map_at(object, noise, input);
  object.transform(f);
}

/// The correction by one innovation, whose residual is for the mean plus `ahead`.
PlacedObject corrected(PlacedObject object, Innovation seen, const NoiseComponent& noise,
                       const Vector6d& ahead, const CaseInput& input) {
  const Columns d = times_ht(object, seen);
  seen.weight = 1.0;
  seen.residual -= ahead;
  Vector18d by;
  GaussianUpdate<Vector18d, Matrix18d> update(input.gain, by, object.covariance);
  update.add(seen, d);
  update.finish();
  by.head<6>() += ahead;
  move_with_covariance(object, by, noise, input);
  return object;
}

/// The correction of the pose by one innovation.
Vector6d correction(const PlacedObject& object, const Innovation& seen) {
  const Cholesky6 s(seen.covariance);
  const Columns whitened = s.whitened_rows(times_ht(object, seen));
  return whitened.topRows<6>() * s.whitened(seen.residual);
}

/// The update by one component of the observation under one of the noise, linearised where it takes
/// the pose (one step of Gauss and Newton): there the noise is known, and a small error of the
/// detection is one of the pose.
PlacedObject corrected_there(const PlacedObject& object, const Innovation& seen,
                             const ObservationComponent& component, const NoiseComponent& noise,
                             const CaseInput& input) {
  const Vector6d way = correction(object, seen);
  PlacedObject there = object;
  Vector18d by = Vector18d::Zero();
  by.head<6>() = way;
  move_with_covariance(there, by, noise, input);
  const Innovation again =
      innovation_of(there.seen_from(input.camera), component, noise, input.sensor);
  return corrected(std::move(there), again, noise, -way, input);
}

/// A wrong detection: it tells the position, or nothing.
std::optional<ObservedCase> wrong_case(const PlacedObject& object, const ModeEvidence& evidence,
                                       double weight, const CaseInput& input) {
  if (!(weight > kLeastCase)) return std::nullopt;
  const double turned = evidence.position.weight;
  if (!(turned > kLeastCase)) return ObservedCase{std::nullopt, weight, object};
  const PlacedObject moved = corrected(
      object, evidence.position, input.sensor.noise.components().front(), Vector6d::Zero(), input);
  const WeightedObject parts[] = {{turned, &moved}, {weight - turned, &object}};
  if (!(weight - turned > kLeastCase)) return ObservedCase{std::nullopt, weight, moved};
  return ObservedCase{std::nullopt, weight, mixed(parts)};
}

}  // namespace

std::vector<ObservedCase> observed_cases(const PlacedObject& object, const ModeEvidence& evidence,
                                         const CaseInput& input) {
  std::vector<ObservedCase> cases;
  const auto& innovations = evidence.explanation.innovations;
  const auto& noise = input.sensor.noise.components();
  double wrong = 1.0;
  for (std::size_t i = 0; i < innovations.size(); ++i) {
    wrong -= innovations[i].weight;
    if (!(innovations[i].weight > kLeastCase)) continue;
    cases.push_back(
        {i, innovations[i].weight,
         corrected_there(object, innovations[i], input.observation.components[i / noise.size()],
                         noise[i % noise.size()], input)});
  }
  if (auto of_wrong = wrong_case(object, evidence, wrong, input))
    cases.push_back(std::move(*of_wrong));
  std::stable_sort(cases.begin(), cases.end(),
                   [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return cases;
}

bool fit_one_gaussian(const WeightedObject& a, const WeightedObject& b) {
  constexpr double kMostWidening = 1.5;
  const SE3d to_place = a.object->pose.inverse();  // along its own axes, as the world has none
  const Vector6d apart =
      to_place.adjoint_blocks().times((b.object->pose * a.object->pose.inverse()).log());
  const auto variances = [&](const PlacedObject& object) -> Vector6d {
    return to_place.adjoint_congruence(object.pose_covariance()).diagonal();
  };
  const Vector6d of_a = variances(*a.object);
  const Vector6d of_b = variances(*b.object);
  const double share = b.weight / (a.weight + b.weight);
  const Vector6d both =
      (1.0 - share) * of_a + share * of_b + share * (1.0 - share) * apart.cwiseAbs2();
  return (both.array() <= kMostWidening * of_a.array().min(of_b.array())).all();
}

bool CaseGroup::has(std::size_t innovation) const {
  return std::find(innovations.begin(), innovations.end(), innovation) != innovations.end();
}

bool CaseGroup::has(const ObservedCase& one) const {
  return one.innovation ? has(*one.innovation) : has_wrong;
}

std::vector<CaseGroup> groups_of(const std::vector<ObservedCase>& cases) {
  std::vector<CaseGroup> groups;
  std::vector<const ObservedCase*> first;
  for (const ObservedCase& one : cases) {
    std::size_t g = 0;
    while (g < groups.size() &&
           !fit_one_gaussian({first[g]->weight, &first[g]->object}, {one.weight, &one.object}))
      ++g;
    if (g == groups.size()) {
      groups.emplace_back();
      first.push_back(&one);
    }
    if (one.innovation) {
      groups[g].innovations.push_back(*one.innovation);
    } else {
      groups[g].has_wrong = true;
    }
  }
  return groups;
}

}  // namespace posemix::internal
