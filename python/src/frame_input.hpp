// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <map>
#include <string>
#include <variant>
#include <vector>

#include "slam.hpp"

namespace posemix::python {

/// Detections of one frame, by the objects' ids or one entry per object model.
using Detections = std::variant<std::map<std::string, SE3d>, MaybePoses>;

/// `FrameInput` as Python gives it.
struct NamedInput {
  double dt = 0.0;
  std::optional<SE3d> motion = {};
  Detections detections = {};
  std::vector<Candidate> candidates = {};
  std::vector<Observation> observations = {};
  std::vector<std::string> images = {};
  std::optional<SE3d> camera = {};
  std::vector<std::optional<KnownFrame>> frames = {};

  /// @throws InvalidInput where a detection is of no object of the models
  FrameInput of(const std::vector<ObjectModel>& models) const;
};

}  // namespace posemix::python
