// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

namespace posemix {

/// A number found by numerical integration.
struct DivergenceEstimate {
  double value;  ///< nats, or the inverse of the unit of volume for an integral square distance
  /// Estimated absolute error: the error of the quadrature rule, or one standard error of Monte
  /// Carlo.
  double error;
  std::size_t evaluations;  ///< points at which the densities were evaluated
  bool converged;           ///< whether the tolerance was met; always true for Monte Carlo
};

}  // namespace posemix
