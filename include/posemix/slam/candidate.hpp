// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>

#include "posemix/detector/observation.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix {

/// A detection that names the class of the object, not which one of several it is.
struct Candidate {
  std::string class_id;
  SE3d camera_object;  ///< T_camera_object as detected
  double score = 0.0;  ///< the detector's confidence, larger is surer
};

/// The candidate as an observation of one pose.
Observation observation_of(const Candidate& candidate);

}  // namespace posemix
