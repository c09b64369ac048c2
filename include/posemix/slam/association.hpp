// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/observation.hpp"
#include "posemix/detector/symmetry.hpp"
#include "posemix/slam/candidate.hpp"

/// Which instance of a class of objects a detection is of.
namespace posemix {

struct AssociationSettings {
  /// Part of the distribution of the position's error (chi-square, 3 degrees of freedom) within
  /// which a detection can be of an instance.
  double gate_probability = 0.999;
  /// The rotation costs at most as much as an error at this part of its distribution (chi-square, 3
  /// degrees of freedom): a detection at the place of an instance is of that instance even where it
  /// shows a wrong mode, for no other object can be there.
  double rotation_cap_probability = 0.99;
  /// Candidates without an instance begin a new one from this score on, ...
  double least_new_score = 0.0;
  /// ... unless they lie nearer than this to an instance or to a better candidate [m]. Two
  /// instances of one class that come nearer than this are one.
  double least_separation_m = 0.02;
  /// An instance that has its detection with less than this probability takes in all that may be
  /// of it, by their probabilities.
  double certain_probability = 0.99;
  /// Largest number of assignments over which these probabilities are.
  std::size_t joint_assignments = 50;
};

enum class CandidateStatus {
  assigned,  ///< of a known instance
  fresh,     ///< of an instance not known so far
  rejected,  ///< of none: a second detection of one object, or below the score of a new one
  dropped    ///< fresh, but there is no model of its class, or none is free (ObjectSlam)
};

/// What a candidate is.
struct Association {
  CandidateStatus status = CandidateStatus::rejected;
  std::size_t instance = 0;  ///< where assigned: index among the instances
  /// Where assigned: the equivalent pose nearest to the instance; elsewhere as detected.
  SE3d camera_object;
  double cost = 0.0;  ///< where assigned: its part of the total cost
};

/// The one-to-one assignment with the least total cost of the candidates of one class in one frame
/// to the instances of that class; exact.
///
/// A pair costs the squared Mahalanobis distance of the pose error e = [Log(R_Y R_X^T); t_Y - t_X],
/// along the camera's axes, under the instance's covariance and the detector's; where that is less,
/// the distance of the position alone plus the cap of the rotation. Y is the detection's equivalent
/// pose nearest to the instance X. A candidate without an instance costs the sum of gate and cap,
/// and no pair beyond the gate of the position is possible.
///
/// `instances` are the predicted densities of T_camera_object (perturbation on the left), `noise`
/// the detector's error on this class; its offset is not used.
/// @throws InvalidInput when a probability is not in (0, 1)
std::vector<Association> associate(std::span<const ConcentratedGaussian<SE3d>> instances,
                                   std::span<const Candidate> candidates,
                                   const NoiseComponent& noise, const SymmetryGroup& symmetries,
                                   const AssociationSettings& settings = {});

/// The same for observations: a pair costs as much as the cheapest of the observation's components,
/// each with -2 log of its weight, relative to the largest, added. An assigned pose is that
/// component.
std::vector<Association> associate_observations(
    std::span<const ConcentratedGaussian<SE3d>> instances,
    std::span<const Observation> observations, const NoiseComponent& noise,
    const SymmetryGroup& symmetries, const AssociationSettings& settings = {});

/// What the detections of one class in one image are, with probabilities.
struct JointAssociation {
  std::vector<Association> best;  ///< as by associate_observations
  /// Probability that the observation of the row is of the instance of the column, over the best
  /// assignments (joint probabilistic data association, Fortmann et al. 1983).
  Eigen::MatrixXd probabilities;
  /// Log of that probability without the density of the observation given the instance, up to a
  /// constant for every instance: what a filter that has the density itself is told [nats]. Minus
  /// infinity where the pair is not possible.
  Eigen::MatrixXd log_priors;
};

/// The same with the probability of every pair (docs/existence.md, eq. 6 to 8).
JointAssociation associate_jointly(std::span<const ConcentratedGaussian<SE3d>> instances,
                                   std::span<const Observation> observations,
                                   const NoiseComponent& noise, const SymmetryGroup& symmetries,
                                   const AssociationSettings& settings = {});

/// For each row of a cost matrix its own column so that the sum of the chosen entries is least;
/// exact, in O(rows^2 columns) (Hungarian algorithm with shortest augmenting paths).
/// @throws InvalidInput when there are more rows than columns or an entry is not finite
std::vector<Eigen::Index> least_cost_assignment(const Eigen::MatrixXd& cost);

/// The column of every row, and the sum of the entries.
struct Assignment {
  std::vector<Eigen::Index> columns;
  double cost = 0.0;
};

/// The `count` assignments of least cost, the best first, of which there may be fewer; an entry
/// from `impossible` on is never chosen (Murty, 1968). O(count rows^3 columns).
/// @throws InvalidInput as least_cost_assignment, when `count` is zero, and when `impossible` is
/// NaN
std::vector<Assignment> best_assignments(const Eigen::MatrixXd& cost, std::size_t count,
                                         double impossible);

/// Probability of every pair of a row and one of the first `columns` columns, where an assignment
/// has the log probability -cost / 2, up to a constant: that of joint probabilistic data
/// association over the assignments that are given.
/// @throws InvalidInput when a column is negative, or assignments are not of as many rows
Eigen::MatrixXd association_probabilities(std::span<const Assignment> assignments,
                                          Eigen::Index columns);

}  // namespace posemix
