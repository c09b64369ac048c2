// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <vector>

#include "base/kept_memory.hpp"
#include "posemix/filter/update.hpp"

namespace posemix::internal {

/// The noises under which the detections of a frame are taken, each of which has one component for
/// every detection.
struct FrameNoises {
  std::vector<const NoiseComponent*> components;  ///< by noise, then by detection
  std::vector<double> log_dets;                   ///< of their covariances

  explicit FrameNoises(std::span<const NoiseComponent* const> given);
};

/// `update` of one hypothesis under each of the noises. They share all that does not depend on it.
KeptVector<UpdateResult> linearized_updates(const Hypothesis& prior,
                                            std::span<const Detection> detections,
                                            const FrameNoises& noises);

}  // namespace posemix::internal
