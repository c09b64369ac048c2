// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <boost/random/sobol.hpp>

#include "posemix/base/random.hpp"

namespace posemix {

/// Points of a Sobol sequence in the open unit cube under a random digital shift: each is uniform,
/// together they are spread evenly.
class ShiftedSobol {
 public:
  ShiftedSobol(std::size_t dimension, RandomStream& stream)
      : points_(dimension), shift_(dimension) {
    for (std::uint64_t& bits : shift_) {
      bits = (static_cast<std::uint64_t>(stream()) << 32U) | stream();
    }
  }

  void next(Eigen::Ref<Eigen::VectorXd> uniform) {
    for (std::size_t i = 0; i < shift_.size(); ++i) {
      const std::uint64_t bits = (points_() ^ shift_[i]) >> 12U;
      uniform[static_cast<Eigen::Index>(i)] = (static_cast<double>(bits) + 0.5) * 0x1p-52;
    }
  }

 private:
  boost::random::sobol points_;
  std::vector<std::uint64_t> shift_;
};

}  // namespace posemix
