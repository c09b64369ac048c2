// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/filter/update.hpp"

namespace posemix::internal {

/// How a detection fits a hypothesis under one noise component.
struct InnovationScore {
  double squared;         ///< z^T S^-1 z; infinite where S is numerically not positive definite
  double log_likelihood;  ///< log N(z; 0, S) [nats]; then -inf
};

InnovationScore innovation_score(const Hypothesis& hypothesis, const Detection& detection,
                                 const NoiseComponent& noise);

}  // namespace posemix::internal
