// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/sobol.hpp"

#include <cstdint>
#include <vector>

#include <fmt/format.h>
#include <boost/random/sobol.hpp>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

/// Of which there are direction numbers.
constexpr std::size_t kMostDimensions = 3667;

}  // namespace

struct ShiftedSobol::Sequence {
  boost::random::sobol points;
  std::vector<std::uint64_t> shift;

  Sequence(std::size_t dimension, RandomStream& stream) : points(dimension), shift(dimension) {
    for (std::uint64_t& bits : shift) {
      bits = (static_cast<std::uint64_t>(stream()) << 32U) | stream();
    }
  }
};

ShiftedSobol::ShiftedSobol(std::size_t dimension, RandomStream& stream) {
  if (dimension == 0 || dimension > kMostDimensions)
    throw InvalidInput(
        fmt::format("dimension is {}, expected 1 to {}", dimension, kMostDimensions));
  sequence_ = std::make_unique<Sequence>(dimension, stream);
}
ShiftedSobol::ShiftedSobol(ShiftedSobol&&) noexcept = default;
ShiftedSobol& ShiftedSobol::operator=(ShiftedSobol&&) noexcept = default;
ShiftedSobol::~ShiftedSobol() = default;

void ShiftedSobol::next(Eigen::Ref<Eigen::VectorXd> uniform) {
  if (uniform.size() != static_cast<Eigen::Index>(sequence_->shift.size()))
    throw InvalidInput(fmt::format("a point of {} coordinates, expected {}", uniform.size(),
                                   sequence_->shift.size()));
  for (std::size_t i = 0; i < sequence_->shift.size(); ++i) {
    const std::uint64_t bits = (sequence_->points() ^ sequence_->shift[i]) >> 12U;
    uniform[static_cast<Eigen::Index>(i)] = (static_cast<double>(bits) + 0.5) * 0x1p-52;
  }
}

}  // namespace posemix
