// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

/// The trigonometric coefficients of Exp, Log and their Jacobians, as functions of u = theta^2.
///
/// Below kSeriesBelow, where the closed forms cancel, every function is its Taylor series in u,
/// with as many terms as the scalar type has digits for; above it, the closed form. Relative error:
/// a few units in the last place on [0, (2 pi)^2), away from the zeros of the function.
namespace posemix::small_angle {

/// Squared angle (rad^2) below which the Taylor series are used.
inline constexpr int kSeriesBelow = 4;

namespace detail {

/// Terms after which 4^k / (2k+1)! is below half a unit in the last place.
constexpr std::size_t sine_terms(int digits) {
  long double term = 1.0L;
  long double unit = 0.5L;
  for (int i = 0; i < digits; ++i) unit /= 2.0L;
  std::size_t k = 0;
  for (; term > unit; ++k) {
    const auto next = static_cast<long double>(2 * (k + 1));
    term *= static_cast<long double>(kSeriesBelow) / (next * (next + 1.0L));
  }
  return k + 1;
}

/// Terms after which k (4 / (2 pi)^2)^k is below half a unit in the last place.
constexpr std::size_t cotangent_terms(int digits) {
  constexpr long double kRatio = static_cast<long double>(kSeriesBelow) / 39.0L;
  long double power = 1.0L;
  long double unit = 0.5L;
  for (int i = 0; i < digits; ++i) unit /= 2.0L;
  std::size_t k = 1;
  for (; static_cast<long double>(k) * power > unit; ++k) power *= kRatio;
  return k + 1;
}

template <typename Scalar>
inline constexpr std::size_t kSineTerms = sine_terms(std::numeric_limits<Scalar>::digits);
template <typename Scalar>
inline constexpr std::size_t kCotangentTerms = cotangent_terms(std::numeric_limits<Scalar>::digits);

/// Taylor coefficients in u of sin(t)/t, (1-cos t)/u, (1 - sin(t)/t)/u and of the u-derivatives of
/// the last two.
template <typename Scalar>
struct SineSeries {
  using Row = std::array<Scalar, kSineTerms<Scalar>>;
  Row sinc{}, cosc{}, rest{}, d_cosc{}, d_rest{};
};

/// Taylor coefficients in u of g = (1 - (t/2) cot(t/2))/u and of its u-derivative.
template <typename Scalar>
struct CotangentSeries {
  using Row = std::array<Scalar, kCotangentTerms<Scalar>>;
  Row rest{}, d_rest{};
};

// Built-in types round their tables once, from long double.
template <typename Scalar>
using TableScalar = std::conditional_t<std::is_floating_point_v<Scalar>, long double, Scalar>;

template <typename Scalar>
constexpr SineSeries<Scalar> make_sine_series() {
  using Work = TableScalar<Scalar>;
  SineSeries<Scalar> series;
  Work inverse_factorial(1);  // (-1)^k / (2k+1)!
  for (std::size_t k = 0; k < kSineTerms<Scalar>; ++k) {
    const int n = 2 * static_cast<int>(k);
    const Work cosc = inverse_factorial / Work(n + 2);
    const Work rest = cosc / Work(n + 3);
    const Work d_cosc = -rest / Work(n + 4) * Work(n + 2) / Work(2);
    const Work d_rest = d_cosc / Work(n + 5);
    series.sinc[k] = static_cast<Scalar>(inverse_factorial);
    series.cosc[k] = static_cast<Scalar>(cosc);
    series.rest[k] = static_cast<Scalar>(rest);
    series.d_cosc[k] = static_cast<Scalar>(d_cosc);
    series.d_rest[k] = static_cast<Scalar>(d_rest);
    inverse_factorial = -rest;
  }
  return series;
}

/// x cot x = 1 - sum d_k x^(2k) solves x f' = f - f^2 - x^2, hence (2k+1) d_k = sum_(0<j<k) d_j
/// d_(k-j) + [k=1]: all terms are positive. With x = t/2: g(u) = sum d_k u^(k-1) / 4^k.
template <typename Scalar>
constexpr CotangentSeries<Scalar> make_cotangent_series() {
  using Work = TableScalar<Scalar>;
  constexpr std::size_t kTerms = kCotangentTerms<Scalar>;
  std::array<Work, kTerms + 2> d{};
  for (std::size_t k = 1; k < d.size(); ++k) {
    Work sum(k == 1 ? 1 : 0);
    for (std::size_t j = 1; j < k; ++j) sum += d[j] * d[k - j];
    d[k] = sum / Work(2 * static_cast<int>(k) + 1);
  }
  CotangentSeries<Scalar> series;
  Work scale(0.25);
  for (std::size_t k = 0; k < kTerms; ++k) {
    series.rest[k] = static_cast<Scalar>(d[k + 1] * scale);
    scale /= Work(4);
    series.d_rest[k] = static_cast<Scalar>(Work(static_cast<int>(k) + 1) * d[k + 2] * scale);
  }
  return series;
}

template <typename Scalar>
const SineSeries<Scalar>& sine_series() {
  if constexpr (std::is_floating_point_v<Scalar>) {
    static constexpr SineSeries<Scalar> kSeries = make_sine_series<Scalar>();
    return kSeries;
  } else {
    static const SineSeries<Scalar> series = make_sine_series<Scalar>();
    return series;
  }
}

template <typename Scalar>
const CotangentSeries<Scalar>& cotangent_series() {
  if constexpr (std::is_floating_point_v<Scalar>) {
    static constexpr CotangentSeries<Scalar> kSeries = make_cotangent_series<Scalar>();
    return kSeries;
  } else {
    static const CotangentSeries<Scalar> series = make_cotangent_series<Scalar>();
    return series;
  }
}

/// The polynomial with these coefficients, lowest power first, by Estrin's scheme: pairs of terms,
/// then pairs of pairs in u^2, so that few operations wait for each other.
template <typename Scalar, std::size_t N>
Scalar polynomial(const std::array<Scalar, N>& coefficients, const Scalar& u) {
  if constexpr (N == 1) {
    return coefficients[0];
  } else {
    std::array<Scalar, (N + 1) / 2> pairs;
    for (std::size_t k = 0; k < N / 2; ++k) {
      pairs[k] = coefficients[2 * k] + coefficients[2 * k + 1] * u;
    }
    if constexpr (N % 2 == 1) pairs[N / 2] = coefficients[N - 1];
    return polynomial(pairs, Scalar(u * u));
  }
}

}  // namespace detail

/// sin(theta)/theta.
template <typename Scalar>
Scalar sinc(const Scalar& u) {
  using std::sin;
  using std::sqrt;
  if (u < Scalar(kSeriesBelow)) return detail::polynomial(detail::sine_series<Scalar>().sinc, u);
  const Scalar theta = sqrt(u);
  return sin(theta) / theta;
}

/// cos(theta) and sin(theta)/theta.
template <typename Scalar>
struct CosineAndSinc {
  Scalar cosine;
  Scalar sinc;
};

template <typename Scalar>
CosineAndSinc<Scalar> cosine_and_sinc(const Scalar& u) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  if (u < Scalar(kSeriesBelow)) {
    const auto& series = detail::sine_series<Scalar>();
    return {Scalar(1) - u * detail::polynomial(series.cosc, u), detail::polynomial(series.sinc, u)};
  }
  const Scalar theta = sqrt(u);
  return {cos(theta), sin(theta) / theta};
}

/// (1 - sin(theta)/theta)/u.
template <typename Scalar>
Scalar sinc_rest(const Scalar& u) {
  if (u < Scalar(kSeriesBelow)) return detail::polynomial(detail::sine_series<Scalar>().rest, u);
  return (Scalar(1) - sinc(u)) / u;
}

/// Coefficients of J_l = sinc I + cosc phi^ + rest phi phi^T, rotation vector phi, u = |phi|^2.
template <typename Scalar>
struct JacobianCoefficients {
  Scalar sinc;  ///< sin(theta)/theta
  Scalar cosc;  ///< (1 - cos(theta))/u
  Scalar rest;  ///< (1 - sin(theta)/theta)/u = (theta - sin(theta))/theta^3
};

template <typename Scalar>
JacobianCoefficients<Scalar> jacobian_coefficients(const Scalar& u) {
  using std::sin;
  using std::sqrt;
  if (u < Scalar(kSeriesBelow)) {
    const auto& series = detail::sine_series<Scalar>();
    const Scalar rest = detail::polynomial(series.rest, u);
    return {Scalar(1) - u * rest, detail::polynomial(series.cosc, u), rest};
  }
  const Scalar theta = sqrt(u);
  const Scalar half_sine = sin(theta / Scalar(2));
  const Scalar sinc = sin(theta) / theta;
  return {sinc, Scalar(2) * half_sine * half_sine / u, (Scalar(1) - sinc) / u};
}

/// Derivatives of JacobianCoefficients with respect to u; `value` are the coefficients at u.
template <typename Scalar>
JacobianCoefficients<Scalar> jacobian_coefficient_slopes(
    const Scalar& u, const JacobianCoefficients<Scalar>& value) {
  const Scalar d_sinc = (value.rest - value.cosc) / Scalar(2);
  if (u < Scalar(kSeriesBelow)) {
    const auto& series = detail::sine_series<Scalar>();
    return {d_sinc, detail::polynomial(series.d_cosc, u), detail::polynomial(series.d_rest, u)};
  }
  const Scalar twice_u = Scalar(2) * u;
  return {d_sinc, (value.sinc - Scalar(2) * value.cosc) / twice_u,
          (value.cosc - Scalar(3) * value.rest) / twice_u};
}

/// Coefficients of J_l^-1 = half_cot I - phi^/2 + rest phi phi^T; singular at theta = 2 pi, 4 pi,
/// ...
template <typename Scalar>
struct InverseJacobianCoefficients {
  Scalar half_cot;  ///< (theta/2) cot(theta/2)
  Scalar rest;      ///< (1 - (theta/2) cot(theta/2))/u
};

template <typename Scalar>
InverseJacobianCoefficients<Scalar> inverse_jacobian_coefficients(const Scalar& u) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  if (u < Scalar(kSeriesBelow)) {
    const Scalar rest = detail::polynomial(detail::cotangent_series<Scalar>().rest, u);
    return {Scalar(1) - u * rest, rest};
  }
  const Scalar half = sqrt(u) / Scalar(2);
  const Scalar half_cot = half * cos(half) / sin(half);
  return {half_cot, (Scalar(1) - half_cot) / u};
}

/// Derivatives of InverseJacobianCoefficients with respect to u; `value` are the coefficients at u.
template <typename Scalar>
InverseJacobianCoefficients<Scalar> inverse_jacobian_coefficient_slopes(
    const Scalar& u, const InverseJacobianCoefficients<Scalar>& value) {
  if (u < Scalar(kSeriesBelow)) {
    const Scalar d_rest = detail::polynomial(detail::cotangent_series<Scalar>().d_rest, u);
    return {-value.rest - u * d_rest, d_rest};
  }
  const Scalar& h = value.half_cot;
  const Scalar d_half_cot = (h - h * h - u / Scalar(4)) / (Scalar(2) * u);
  return {d_half_cot, (-d_half_cot - value.rest) / u};
}

/// log |sin(theta)/theta|, without cancellation at small angles; -infinity at the zeros theta = pi,
/// 2 pi, ...
template <typename Scalar>
Scalar log_abs_sinc(const Scalar& u) {
  using std::abs;
  using std::log;
  using std::log1p;
  const Scalar defect = u * sinc_rest(u);
  if (defect < Scalar(0.5)) return log1p(Scalar(-defect));
  return log(Scalar(abs(sinc(u))));
}

}  // namespace posemix::small_angle
