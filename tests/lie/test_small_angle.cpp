// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <functional>

#include <gtest/gtest.h>

#include "oracle.hpp"
#include "posemix/lie/small_angle.hpp"
#include "worst_errors.hpp"

// Every coefficient function against its closed form in 200 digits; derivatives against central
// differences of that closed form.
namespace posemix {
namespace {

using oracle::Real;
using Wide = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<200>,
                                           boost::multiprecision::et_off>;
using Function = std::function<Wide(const Wide&)>;

const std::array<Function, 5> kClosedForms{
    [](const Wide& u) { return Wide(sin(sqrt(u)) / sqrt(u)); },
    [](const Wide& u) { return Wide((1 - cos(sqrt(u))) / u); },
    [](const Wide& u) { return Wide((sqrt(u) - sin(sqrt(u))) / (u * sqrt(u))); },
    [](const Wide& u) { return Wide(sqrt(u) / 2 / tan(Wide(sqrt(u) / 2))); },
    [](const Wide& u) { return Wide((1 - sqrt(u) / 2 / tan(Wide(sqrt(u) / 2))) / u); }};

Wide slope(const Function& f, const Wide& u) {
  const Wide h = u * Wide("1e-40");
  return (f(u + h) - f(u - h)) / (2 * h);
}

template <typename Scalar>
std::array<Scalar, 5> values(const Scalar& u) {
  const auto c = small_angle::jacobian_coefficients(u);
  const auto inverse = small_angle::inverse_jacobian_coefficients(u);
  return {c.a, c.b, c.c, inverse.half_cot, inverse.d};
}

template <typename Scalar>
std::array<Scalar, 5> slopes(const Scalar& u) {
  const auto c = small_angle::jacobian_coefficients(u);
  const auto d = small_angle::jacobian_coefficient_slopes(u, c);
  const auto inverse = small_angle::inverse_jacobian_coefficients(u);
  const auto d_inverse = small_angle::inverse_jacobian_coefficient_slopes(u, inverse);
  return {d.a, d.b, d.c, d_inverse.half_cot, d_inverse.d};
}

template <typename Scalar>
std::vector<Scalar> squared_angles() {
  std::vector<Scalar> us;
  for (const double u : {1e-16, 1e-12, 1e-8, 1e-4, 0.01, 0.1, 0.5, 1.0, 1.7, 2.5, 3.0, 3.5, 3.9}) {
    us.push_back(Scalar(u));
  }
  for (const int k : {-16, -4, -2, -1, 0, 1, 2, 4, 16}) {
    us.push_back(Scalar(4) + Scalar(k) * std::numeric_limits<Scalar>::epsilon());
  }
  for (const double u : {4.1, 5.0, 7.0, 9.0, 9.8, 9.87, 12.0, 16.0, 20.0, 22.2})
    us.push_back(Scalar(u));
  return us;
}

template <typename S>
class SmallAngle : public ::testing::Test {};
using Scalars =
    ::testing::Types<float, double, long double, boost::multiprecision::cpp_bin_float_50>;
TYPED_TEST_SUITE(SmallAngle, Scalars);

TYPED_TEST(SmallAngle, AgreesWithTheClosedForms) {
  auto worst = oracle::WorstErrors::of<TypeParam>();
  const std::array<std::string, 5> names{"A", "B", "C", "half_cot", "D"};
  for (const auto& u : squared_angles<TypeParam>()) {
    const auto got = values(u);
    const auto got_slopes = slopes(u);
    const auto where = oracle::as_matrix(u);
    for (std::size_t i = 0; i < names.size(); ++i) {
      // Next to the zeros of sinc, half_cot (pi) and d_sinc (4.49 rad), rounding the angle is an
      // absolute error.
      const Real value_scale = i == 0 || i == 3 ? Real(1) : Real(0);
      const Real slope_scale = i == 0 ? Real(0.03) : Real(0);
      const Real value(kClosedForms[i](Wide(u)));
      const Real rate(slope(kClosedForms[i], Wide(u)));
      worst.add(names[i], oracle::as_matrix(got[i]), oracle::as_matrix(value), where, value_scale);
      worst.add("d_" + names[i], oracle::as_matrix(got_slopes[i]), oracle::as_matrix(rate), where,
                slope_scale);
    }
  }
  worst.check();
}

TYPED_TEST(SmallAngle, LimitsAtZero) {
  using S = TypeParam;
  EXPECT_EQ(values(S(0)), (std::array<S, 5>{S(1), S(1) / S(2), S(1) / S(6), S(1), S(1) / S(12)}));
  const auto got = slopes(S(0));
  const std::array<S, 5> want{-S(1) / S(6), -S(1) / S(24), -S(1) / S(120), -S(1) / S(12),
                              S(1) / S(720)};
  for (std::size_t i = 0; i < want.size(); ++i) {
    EXPECT_LE(abs((got[i] - want[i]) / want[i]), S(4) * std::numeric_limits<S>::epsilon()) << i;
  }
  EXPECT_EQ(small_angle::log_abs_sinc(S(0)), S(0));
}

TEST(SmallAngle, SeriesAreAsLongAsTheScalarNeeds) {
  EXPECT_EQ(small_angle::detail::kSineTerms<float>, 8u);
  EXPECT_EQ(small_angle::detail::kSineTerms<double>, 13u);
  EXPECT_EQ(small_angle::detail::kCotangentTerms<float>, 11u);
  EXPECT_EQ(small_angle::detail::kCotangentTerms<double>, 20u);
}

}  // namespace
}  // namespace posemix
