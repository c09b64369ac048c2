// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/random.hpp"

#include <Random123/philox.h>

#include <boost/random/normal_distribution.hpp>

namespace posemix {

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t stream)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
      counter_{0, 0, static_cast<std::uint32_t>(stream), static_cast<std::uint32_t>(stream >> 32)},
      block_{} {}

RandomStream::result_type RandomStream::operator()() {
  if (used_ == 4) {
    const auto out = r123::Philox4x32()({{counter_[0], counter_[1], counter_[2], counter_[3]}},
                                        {{key_[0], key_[1]}});
    for (int i = 0; i < 4; ++i)
      block_[static_cast<std::size_t>(i)] = out[static_cast<std::size_t>(i)];
    if (++counter_[0] == 0) ++counter_[1];
    used_ = 0;
  }
  return block_[static_cast<std::size_t>(used_++)];
}

double RandomStream::uniform() {
  const std::uint64_t high = (*this)() >> 5;
  const std::uint64_t low = (*this)() >> 6;
  return static_cast<double>((high << 26) | low) * 0x1p-53;
}

double RandomStream::normal() { return boost::random::normal_distribution<double>()(*this); }

void RandomStream::fill_normal(Eigen::Ref<Eigen::VectorXd> values) {
  for (double& value : values) value = normal();
}

}  // namespace posemix
