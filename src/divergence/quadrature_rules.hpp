// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>

namespace posemix::internal {

/// Gauss-Kronrod rule with 7 and 15 points on [-1, 1].
struct KronrodRule {
  struct Node {
    double at;
    double weight;
    /// Weight less the weight in the rule with 7 points, for the error estimate.
    double difference;
  };
  std::array<Node, 15> nodes;

  static const KronrodRule& instance();
};

/// Two Gauss-Legendre rules on [-1, 1] for tensor products.
struct PatchRules {
  static constexpr std::size_t kFine = 8;
  static constexpr std::size_t kCoarse = 6;
  struct Node {
    double at;
    double weight;
  };
  std::array<Node, kFine> fine;
  std::array<Node, kCoarse> coarse;
  std::array<double, kFine> top_mode;  ///< the Legendre polynomial of degree kFine - 2 at `fine`

  static const PatchRules& instance();
};

/// The trapezoidal rule for functions on a plane that depend on the distance from the origin alone
/// and are smooth there: sum_k weight_k f(h at_k) h^2 for the integral over the plane, with the
/// zeros of the Bessel function J_0 over pi. It converges exponentially with 1/h, as on a line
/// \cite ogata2005bessel.
struct DiscRule {
  struct Node {
    double at;
    double weight;
  };
  std::array<Node, 128> nodes;  ///< nearly at 3/4, 7/4, 11/4, ...

  static const DiscRule& instance();
};

}  // namespace posemix::internal
