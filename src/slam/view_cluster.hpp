// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posemix/slam/fuse_views.hpp"
#include "slam/view_stack.hpp"

/// Observations that may be of one object.
namespace posemix::internal {

/// One observation of a group of views.
struct ViewMember {
  std::size_t view = 0;
  std::size_t index = 0;  ///< in the view
  const Observation* observation = nullptr;
  SE3d world_camera;

  /// Position of the heaviest component in the world [m].
  Eigen::Vector3d position() const;
};

enum class ViewCase : unsigned char {
  clutter,  ///< not of the object
  turned,   ///< at the object's place, in any orientation
  pose      ///< a pose of the object
};

/// One case for each member.
struct CaseHypothesis {
  ViewStack stack;
  std::vector<ViewCase> cases = {};
  double log_prior = 0.0;
  double log_weight = 0.0;  ///< with the evidence of the stack
};

/// What members tell if they are of one object.
struct ClusterBelief {
  double log_object = 0.0;   ///< log density of the members, with one object [nats]
  double log_clutter = 0.0;  ///< without
  std::vector<CaseHypothesis> hypotheses = {};  ///< with the object, the heaviest first

  /// Log of both together.
  double log_evidence() const;
};

/// The positions of an observation's error: covariance of white and slow error in the world, for
/// the gate [m^2].
Eigen::Matrix3d position_covariance(const ViewMember& member, const ViewClass& known);

/// Keeps the `max_hypotheses` of the most weight after every member. `views` is the number of views
/// of the group: in the others the object is missed.
ClusterBelief cluster_belief(std::span<const ViewMember> members, const ViewClass& known,
                             const FuseViewsSettings& settings, std::size_t views,
                             std::size_t max_hypotheses);

/// The instance that members are of.
FusedInstance fused_instance(std::span<const ViewMember> members, const ViewClass& known,
                             const FuseViewsSettings& settings, std::size_t views);

}  // namespace posemix::internal
