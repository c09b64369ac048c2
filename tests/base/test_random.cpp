// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/random.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace posemix {
namespace {

static_assert(std::uniform_random_bit_generator<RandomStream>);

using Block = std::array<std::uint32_t, 4>;
using Key = std::array<std::uint32_t, 2>;

// Philox4x32-10 written from the paper's definition (Salmon et al. 2011, section 3.3).
constexpr Block philox(Block c, Key k) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53} * c[0];
    const std::uint64_t p1 = std::uint64_t{0xCD9E8D57} * c[2];
    c = {static_cast<std::uint32_t>(p1 >> 32) ^ c[1] ^ k[0], static_cast<std::uint32_t>(p1),
         static_cast<std::uint32_t>(p0 >> 32) ^ c[3] ^ k[1], static_cast<std::uint32_t>(p0)};
    k[0] += 0x9E3779B9;
    k[1] += 0xBB67AE85;
  }
  return c;
}

// The known answers that the authors of Random123 publish (kat_vectors, philox 4x32 10).
static_assert(philox({0, 0, 0, 0}, {0, 0}) ==
              Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
static_assert(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}) ==
              Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
static_assert(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
              Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});

struct Moments {
  double mean, variance, skewness, kurtosis;
};

Moments moments(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double v : values) mean += v / n;
  double m2 = 0.0, m3 = 0.0, m4 = 0.0;
  for (const double v : values) {
    const double d = v - mean;
    m2 += d * d / n;
    m3 += d * d * d / n;
    m4 += d * d * d * d / n;
  }
  return {mean, m2, m3 / std::pow(m2, 1.5), m4 / (m2 * m2)};
}

std::vector<double> normals(std::uint64_t seed, std::uint64_t stream, std::size_t count) {
  RandomStream random(seed, stream);
  std::vector<double> values(count);
  for (double& v : values) v = random.normal();
  return values;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum / static_cast<double>(a.size());
}

TEST(RandomStream, FirstBlockOfStreamZeroIsThePublishedAnswer) {
  RandomStream random(0, 0);
  for (const std::uint32_t expected : {0x6627e8d5U, 0xe169c58dU, 0xbc57ac4cU, 0x9b00dbd8U}) {
    EXPECT_EQ(random(), expected);
  }
}

RC_GTEST_PROP(RandomStream, IsPhiloxWithSeedAsKeyAndStreamInTheUpperCounter,
              (std::uint64_t seed, std::uint64_t stream)) {
  RandomStream random(seed, stream);
  for (std::uint32_t block = 0; block < 5; ++block) {
    const Block expected = philox(
        {block, 0, static_cast<std::uint32_t>(stream), static_cast<std::uint32_t>(stream >> 32)},
        {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
    for (const std::uint32_t word : expected) RC_ASSERT(random() == word);
  }
}

RC_GTEST_PROP(RandomStream, UniformIsBuiltFromTheTop53BitsOfTwoWords, (std::uint64_t seed)) {
  RandomStream words(seed), uniforms(seed);
  for (int i = 0; i < 10; ++i) {
    const double high = words() >> 5;
    const double low = words() >> 6;
    const double value = uniforms.uniform();
    RC_ASSERT(value == (high * 67108864.0 + low) / 9007199254740992.0);
    RC_ASSERT(value >= 0.0);
    RC_ASSERT(value < 1.0);
  }
}

TEST(RandomStream, UniformHasTheMomentsOfTheUnitInterval) {
  RandomStream random(42);
  std::vector<double> values(1'000'000);
  for (double& v : values) v = random.uniform();
  const Moments m = moments(values);
  EXPECT_NEAR(m.mean, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / 1e6));
  EXPECT_NEAR(m.variance, 1.0 / 12.0, 5.0 * std::sqrt(1.0 / 180.0 / 1e6));
  EXPECT_LT(*std::max_element(values.begin(), values.end()), 1.0);
  EXPECT_GE(*std::min_element(values.begin(), values.end()), 0.0);
}

TEST(RandomStream, NormalHasTheMomentsOfTheStandardNormal) {
  const Moments m = moments(normals(42, 0, 1'000'000));
  EXPECT_NEAR(m.mean, 0.0, 5.0 * std::sqrt(1.0 / 1e6));
  EXPECT_NEAR(m.variance, 1.0, 5.0 * std::sqrt(2.0 / 1e6));
  EXPECT_NEAR(m.skewness, 0.0, 5.0 * std::sqrt(6.0 / 1e6));
  EXPECT_NEAR(m.kurtosis, 3.0, 5.0 * std::sqrt(24.0 / 1e6));
}

TEST(RandomStream, NormalFollowsItsDistributionFunction) {
  std::vector<double> values = normals(7, 3, 200'000);
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double phi = 0.5 * std::erfc(-values[i] / std::sqrt(2.0));
    distance = std::max(
        {distance, phi - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - phi});
  }
  // Kolmogorov's bound at significance 1e-4.
  EXPECT_LT(distance, std::sqrt(-0.5 * std::log(0.5e-4) / n));
}

TEST(RandomStream, NeighbouringNamesAreUncorrelated) {
  constexpr std::size_t count = 200'000;
  const double bound = 5.0 / std::sqrt(static_cast<double>(count));
  const std::vector<double> reference = normals(1, 0, count);
  for (const std::uint64_t stream : {std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{1} << 32}) {
    EXPECT_LT(std::abs(correlation(reference, normals(1, stream, count))), bound)
        << "stream " << stream;
  }
  for (const std::uint64_t seed :
       {std::uint64_t{0}, std::uint64_t{2}, (std::uint64_t{1} << 32) + 1}) {
    EXPECT_LT(std::abs(correlation(reference, normals(seed, 0, count))), bound) << "seed " << seed;
  }
}

TEST(RandomStream, SuccessiveNormalsAreUncorrelated) {
  const std::vector<double> values = normals(5, 0, 400'000);
  for (const std::size_t lag : {1U, 2U, 3U, 4U}) {
    const std::vector<double> head(values.begin(), values.end() - static_cast<std::ptrdiff_t>(lag));
    const std::vector<double> tail(values.begin() + static_cast<std::ptrdiff_t>(lag), values.end());
    EXPECT_LT(std::abs(correlation(head, tail)), 5.0 / std::sqrt(4e5)) << "lag " << lag;
  }
}

RC_GTEST_PROP(RandomStream, FillNormalDrawsTheSameNumbersInOrder, (std::uint64_t seed)) {
  RandomStream one_by_one(seed), filled(seed);
  Eigen::VectorXd values(17);
  filled.fill_normal(values);
  for (const double value : values) RC_ASSERT(value == one_by_one.normal());
}

TEST(RandomStream, CopyContinuesFromTheSamePosition) {
  RandomStream original(9, 4);
  for (int i = 0; i < 6; ++i) original();
  RandomStream copy = original;
  for (int i = 0; i < 20; ++i) EXPECT_EQ(copy(), original());
}

}  // namespace
}  // namespace posemix
