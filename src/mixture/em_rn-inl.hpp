// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Gaussians on R^n under EM. Included once for every set of vector instructions.
#if defined(POSEMIX_EM_RN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_EM_RN_INL
#undef POSEMIX_EM_RN_INL
#else
#define POSEMIX_EM_RN_INL
#endif

#include <array>
#include <iterator>

#include "em_moments-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

/// Coordinates of samples less the mean's. They are computed where they are used: rows of their own
/// for every component would not stay in the first cache.
struct CentredRows {
  const EmRow* samples;
  const double* mean;

  HWY_INLINE V at(std::size_t j, std::size_t i) const {
    return hn::Sub(load(samples[j], i), set(mean[j]));
  }
};

HWY_INLINE V rn_log(V squared, double log_constant) {
  return hn::NegMulAdd(set(0.5), squared, set(log_constant));
}

/// In kN dimensions: factor and mean are copied to vectors, which the compiler keeps in registers
/// as far as there are any.
template <int kN>
void rn_log_density_of(const EmRow* samples, std::size_t count, const RnKernel& density,
                       EmRow& out) {
  V factor[kN * (kN + 1) / 2];
  V mean[kN];
  for (std::size_t j = 0; j < std::size(factor); ++j) factor[j] = set(density.factor[j]);
  for (std::size_t j = 0; j < kN; ++j) mean[j] = set(density.mean[j]);
  const double log_constant = density.log_constant;
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    V y[kN];
    POSEMIX_UNROLL
    for (std::size_t j = 0; j < kN; ++j) y[j] = hn::Sub(load(samples[j], i), mean[j]);
    V squared = hn::Zero(D());
    POSEMIX_UNROLL
    for (int row = 0; row < kN; ++row) {
      const V* entries = factor + row * (row + 1) / 2;
      V white = hn::Mul(entries[0], y[0]);
      POSEMIX_UNROLL
      for (int j = 1; j <= row; ++j) white = hn::MulAdd(entries[j], y[j], white);
      squared = hn::MulAdd(white, white, squared);
    }
    store(rn_log(squared, log_constant), out, i);
  }
}

void rn_log_density_of_many(const EmRow* samples, std::size_t count, const RnKernel& density,
                            EmRow& out) {
  const CentredRows y{samples, density.mean.data()};
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    V squared = hn::Zero(D());
    const double* entries = density.factor.data();
    for (std::size_t row = 0; row < density.mean.size(); entries += ++row) {
      V white = hn::Mul(set(entries[0]), y.at(0, i));
      for (std::size_t j = 1; j <= row; ++j) white = hn::MulAdd(set(entries[j]), y.at(j, i), white);
      squared = hn::MulAdd(white, white, squared);
    }
    store(rn_log(squared, density.log_constant), out, i);
  }
}

void rn_log_density(const EmRow* samples, std::size_t count, const RnKernel& density, EmRow& out) {
  constexpr std::array kOf = {rn_log_density_of<1>, rn_log_density_of<2>, rn_log_density_of<3>,
                              rn_log_density_of<4>, rn_log_density_of<5>, rn_log_density_of<6>};
  const std::size_t n = density.mean.size();
  const auto of = n - 1 < kOf.size() ? kOf[n - 1] : rn_log_density_of_many;
  of(samples, count, density, out);
}

/// The second moments of coordinate `row` with kColumns coordinates from `column` on.
template <std::size_t kColumns>
void add_part_of_row(std::size_t row, std::size_t column, std::size_t n, const CentredRows& y,
                     const EmRow& shares, std::size_t count, double* sums) {
  V total[kColumns];
  const std::size_t begin = em_second_moment(n, row, column);
  for (std::size_t j = 0; j < kColumns; ++j) total[j] = load_sum(sums, begin + j);
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const V shared = hn::Mul(load(shares, i), y.at(row, i));
    POSEMIX_UNROLL
    for (std::size_t j = 0; j < kColumns; ++j)
      total[j] = hn::MulAdd(shared, y.at(column + j, i), total[j]);
  }
  for (std::size_t j = 0; j < kColumns; ++j) store_sum(total[j], sums, begin + j);
}

/// In more dimensions than there are registers for: row by row, four columns at a time.
void add_moments_of_many(std::size_t n, const CentredRows& y, const EmRow& shares,
                         std::size_t count, double* sums) {
  constexpr std::size_t kColumns = 4;
  V weight = load_sum(sums, 0);
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) weight = hn::Add(weight, load(shares, i));
  store_sum(weight, sums, 0);
  for (std::size_t row = 0; row < n; ++row) {
    V first = load_sum(sums, 1 + row);
    for (std::size_t i = 0; i < count; i += hn::Lanes(D()))
      first = hn::Add(first, hn::Mul(load(shares, i), y.at(row, i)));
    store_sum(first, sums, 1 + row);
    std::size_t column = 0;
    for (; column + kColumns <= row + 1; column += kColumns)
      add_part_of_row<kColumns>(row, column, n, y, shares, count, sums);
    for (; column <= row; ++column) add_part_of_row<1>(row, column, n, y, shares, count, sums);
  }
}

void add_rn_moments(const EmRow* samples, const EmRow& shares, std::size_t count,
                    const RnKernel& density, double* sums) {
  constexpr std::array kOf = {add_moments_of<1, CentredRows>, add_moments_of<2, CentredRows>,
                              add_moments_of<3, CentredRows>, add_moments_of<4, CentredRows>,
                              add_moments_of<5, CentredRows>, add_moments_of<6, CentredRows>};
  const CentredRows y{samples, density.mean.data()};
  const std::size_t n = density.mean.size();
  n - 1 < kOf.size() ? kOf[n - 1](y, shares, count, sums)
                     : add_moments_of_many(n, y, shares, count, sums);
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
