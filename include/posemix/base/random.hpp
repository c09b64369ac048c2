// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include <Eigen/Core>

namespace posemix {

/// A counter-based random stream (Philox4x32-10 \cite salmon2011random).
///
/// A stream is identified by two numbers, the seed and the stream index; streams that differ in one
/// of them are independent. The output depends only on these two and the position in the stream, so
/// work items with streams of their own give the same result on any number of threads or ranks. The
/// integers are the same on every machine; normal deviates use the ziggurat method and differ
/// between machines at most in the rare tail draws, by one unit in the last place. Meets the
/// requirements of a uniform random bit generator.
class RandomStream {
 public:
  using result_type = std::uint32_t;

  explicit RandomStream(std::uint64_t seed, std::uint64_t stream = 0);

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  result_type operator()();

  /// A uniform deviate in [0, 1) with 53 random bits.
  double uniform();
  /// A standard normal deviate.
  double normal();
  /// Fills `values` with independent standard normal deviates.
  void fill_normal(Eigen::Ref<Eigen::VectorXd> values);

 private:
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> block_;
  int used_ = 4;
};

}  // namespace posemix
