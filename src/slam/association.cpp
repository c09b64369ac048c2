// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/association.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "association_gates.hpp"
#include "posemix/base/error.hpp"

namespace posemix {

using namespace internal;

namespace {

/// Above every sum of possible costs: pairs beyond the gate are never taken.
constexpr double kImpossible = 1e6;

/// One instance and what a detection of it looks like.
class Predicted {
 public:
  /// Covariance of e = [theta; t_Y - t_X] along the camera's axes: the position moves by
  /// rho + phi x t under Exp([phi; rho]).
  Predicted(const ConcentratedGaussian<SE3d>& instance, const NoiseComponent& noise)
      : pose_(instance.mean()) {
    Matrix6d to_position = Matrix6d::Identity();
    to_position.bottomLeftCorner<3, 3>() = -SO3d::hat(pose_.translation());
    Matrix6d to_camera = Matrix6d::Identity();
    const NoiseComponent along = along_camera(noise, pose_);
    const Eigen::Matrix3d rotation = pose_.rotation().matrix();
    Matrix6d to_object = Matrix6d::Zero();
    to_object.topLeftCorner<3, 3>() = rotation;
    to_object.bottomRightCorner<3, 3>() = rotation;
    if (along.frame == NoiseFrame::object) to_camera = to_object;
    const Matrix6d covariance =
        mirror_upper(Matrix6d(to_position * instance.covariance() * to_position.transpose() +
                              to_camera * along.covariance * to_camera.transpose()));
    pose_factor_.compute(covariance);
    position_factor_.compute(covariance.bottomRightCorner<3, 3>());
    log_volume_ = 2.0 * pose_factor_.matrixLLT().diagonal().array().log().sum();
    information_ = mirror_upper(Matrix6d(to_object.transpose() * pose_factor_.solve(to_object)));
  }

  const SE3d& pose() const { return pose_; }
  /// Log determinant of the covariance of the error.
  double log_volume() const { return log_volume_; }
  SE3d nearest(const SE3d& detection, const SymmetryGroup& symmetries) const {
    return symmetries.closest_observed(detection, pose_, information_);
  }
  double squared_position(const SE3d& detection) const {
    return position_factor_.matrixL()
        .solve(Eigen::Vector3d(detection.translation() - pose_.translation()))
        .squaredNorm();
  }
  double squared_pose(const SE3d& detection) const {
    Vector6d error;
    error << (detection.rotation() * pose_.rotation().inverse()).log(),
        detection.translation() - pose_.translation();
    return pose_factor_.matrixL().solve(error).squaredNorm();
  }

 private:
  SE3d pose_;
  Eigen::LLT<Matrix6d> pose_factor_;
  Eigen::LLT<Eigen::Matrix3d> position_factor_;
  double log_volume_;
  Matrix6d information_;  ///< along the object's axes
};

/// A pair of an instance and an observation.
struct Pair {
  double cost = kImpossible;
  SE3d nearest = {};  ///< of the cheapest component, the equivalent pose nearest to the instance
};

Pair cheapest(const Predicted& instance, const Observation& observation,
              const SymmetryGroup& symmetries, const AssociationGates& gates) {
  const double most = observation.components[best_component(observation)].weight;
  Pair best;
  for (const ObservationComponent& component : observation.components) {
    const SE3d nearest = instance.nearest(component.pose, symmetries);
    const double position = instance.squared_position(nearest);
    if (position > gates.position || component.weight <= 0.0) continue;
    const double cost = std::min(instance.squared_pose(nearest), position + gates.rotation) -
                        2.0 * std::log(component.weight / most);
    if (cost < best.cost) best = {cost, nearest};
  }
  return best;
}

/// Costs of the pairs, then for each observation a column of its own for having no instance: with
/// columns for all of them one assignment would be many.
Eigen::MatrixXd cost_matrix(const std::vector<Predicted>& instances,
                            std::span<const Observation> candidates,
                            const SymmetryGroup& symmetries, const AssociationGates& gates) {
  const auto rows = static_cast<Eigen::Index>(candidates.size());
  const auto columns = static_cast<Eigen::Index>(instances.size());
  Eigen::MatrixXd cost(rows, columns + rows);
  cost.setConstant(kImpossible);
  cost.rightCols(rows).diagonal().setConstant(gates.position + gates.rotation);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      cost(i, j) = cheapest(instances[static_cast<std::size_t>(j)],
                            candidates[static_cast<std::size_t>(i)], symmetries, gates)
                       .cost;
    }
  }
  return cost;
}

/// Observations without an instance begin one, the best first, where there is room.
void admit_fresh(const std::vector<Predicted>& instances, std::span<const Observation> candidates,
                 const AssociationSettings& settings, std::vector<Association>& associations) {
  std::vector<Eigen::Vector3d> taken;
  taken.reserve(instances.size() + candidates.size());
  for (const Predicted& instance : instances) taken.push_back(instance.pose().translation());
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return candidates[a].score.value_or(0.0) > candidates[b].score.value_or(0.0);
  });
  for (const std::size_t i : order) {
    if (associations[i].status == CandidateStatus::assigned) continue;
    const Eigen::Vector3d& place = associations[i].camera_object.translation();
    const bool has_room = std::none_of(taken.begin(), taken.end(), [&](const Eigen::Vector3d& t) {
      return (t - place).norm() < settings.least_separation_m;
    });
    if (!has_room || candidates[i].score.value_or(0.0) < settings.least_new_score) continue;
    associations[i].status = CandidateStatus::fresh;
    taken.push_back(place);
  }
}

/// The log volumes of the instances relative to their mean: an instance that is known better than
/// the others explains the same error as well with a higher density.
Eigen::VectorXd relative_volumes(const std::vector<Predicted>& instances) {
  Eigen::VectorXd volumes(static_cast<Eigen::Index>(instances.size()));
  for (std::size_t j = 0; j < instances.size(); ++j)
    volumes[static_cast<Eigen::Index>(j)] = instances[j].log_volume();
  if (instances.empty()) return volumes;
  return volumes.array() - volumes.mean();
}

/// Whether an observation may be of two instances, or an instance have two observations.
bool compete(const Eigen::MatrixXd& pairs) {
  const auto possible = pairs.array() < kImpossible;
  return (possible.rowwise().count() > 1).any() || (possible.colwise().count() > 1).any();
}

/// Probabilities of the pairs over the best assignments, eq. (6) and (7). Returns the best one.
std::vector<Eigen::Index> weigh(const Eigen::MatrixXd& cost, const Eigen::VectorXd& volumes,
                                const AssociationSettings& settings, JointAssociation& result) {
  const Eigen::Index instances = volumes.size();
  const Eigen::MatrixXd pairs = cost.leftCols(instances);
  result.probabilities = Eigen::MatrixXd::Zero(cost.rows(), instances);
  std::vector<Eigen::Index> best;
  if (compete(pairs)) {
    Eigen::MatrixXd full = cost;
    full.leftCols(instances).rowwise() += volumes.transpose();
    const auto assignments = best_assignments(full, settings.joint_assignments, 0.5 * kImpossible);
    result.probabilities = association_probabilities(assignments, instances);
    best = assignments.front().columns;
  } else {
    best = least_cost_assignment(cost);
    for (Eigen::Index i = 0; i < cost.rows(); ++i)
      if (best[static_cast<std::size_t>(i)] < instances)
        result.probabilities(i, best[static_cast<std::size_t>(i)]) = 1.0;
  }
  // Eq. (8).
  result.log_priors = result.probabilities.array().log().matrix();
  result.log_priors += 0.5 * (pairs.rowwise() + volumes.transpose());
  return best;
}

}  // namespace

std::vector<Association> associate_observations(
    std::span<const ConcentratedGaussian<SE3d>> instances, std::span<const Observation> candidates,
    const NoiseComponent& noise, const SymmetryGroup& symmetries,
    const AssociationSettings& settings) {
  return associate_jointly(instances, candidates, noise, symmetries, settings).best;
}

JointAssociation associate_jointly(std::span<const ConcentratedGaussian<SE3d>> instances,
                                   std::span<const Observation> candidates,
                                   const NoiseComponent& noise, const SymmetryGroup& symmetries,
                                   const AssociationSettings& settings) {
  const AssociationGates gates = gates_of(settings);
  std::vector<Predicted> predicted;
  predicted.reserve(instances.size());
  for (const auto& instance : instances) predicted.emplace_back(instance, noise);
  const Eigen::MatrixXd cost = cost_matrix(predicted, candidates, symmetries, gates);
  JointAssociation result;
  const std::vector<Eigen::Index> columns =
      weigh(cost, relative_volumes(predicted), settings, result);
  std::vector<Association>& associations = result.best;
  associations.resize(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    Association& association = associations[i];
    association.camera_object = candidates[i].components[best_component(candidates[i])].pose;
    const auto column = static_cast<std::size_t>(columns[i]);
    if (column >= instances.size()) continue;
    association.status = CandidateStatus::assigned;
    association.instance = column;
    association.camera_object =
        cheapest(predicted[column], candidates[i], symmetries, gates).nearest;
    association.cost = cost(static_cast<Eigen::Index>(i), columns[i]);
  }
  admit_fresh(predicted, candidates, settings, associations);
  return result;
}

Observation observation_of(const Candidate& candidate) {
  Observation observation = observation_of(candidate.camera_object);
  observation.class_id = candidate.class_id;
  observation.score = candidate.score;
  return observation;
}

std::vector<Association> associate(std::span<const ConcentratedGaussian<SE3d>> instances,
                                   std::span<const Candidate> candidates,
                                   const NoiseComponent& noise, const SymmetryGroup& symmetries,
                                   const AssociationSettings& settings) {
  std::vector<Observation> observations;
  observations.reserve(candidates.size());
  for (const Candidate& candidate : candidates) observations.push_back(observation_of(candidate));
  return associate_observations(instances, observations, noise, symmetries, settings);
}

}  // namespace posemix
