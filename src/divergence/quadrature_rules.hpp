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

}  // namespace posemix::internal
