// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <memory>

#include <Eigen/Core>

#include "posemix/base/random.hpp"

namespace posemix {

/// Points of a Sobol sequence in the open unit cube under a random digital shift \cite
/// lecuyer2002randomized: each point is uniformly distributed, and together they cover the cube
/// evenly.
class ShiftedSobol {
 public:
  /// @throws InvalidInput for no dimension, or more than there are direction numbers (3667)
  ShiftedSobol(std::size_t dimension, RandomStream& stream);
  ShiftedSobol(const ShiftedSobol&) = delete;
  ShiftedSobol& operator=(const ShiftedSobol&) = delete;
  ShiftedSobol(ShiftedSobol&&) noexcept;
  ShiftedSobol& operator=(ShiftedSobol&&) noexcept;
  ~ShiftedSobol();

  /// The next point.
  /// @throws InvalidInput unless `uniform` has the size of the dimension
  void next(Eigen::Ref<Eigen::VectorXd> uniform);

 private:
  struct Sequence;
  std::unique_ptr<Sequence> sequence_;
};

}  // namespace posemix
