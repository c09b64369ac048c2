// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

/// The trigonometric coefficients of Exp, Log and their Jacobians, as functions of u = theta^2,
/// with the letters of \cite eade2017lie. For a rotation vector phi of angle theta:
///   Exp    = cos(theta) I + A phi^ + B phi phi^T,
///   J_l    = A I + B phi^ + C phi phi^T,
///   J_l^-1 = half_cot I - phi^/2 + D phi phi^T,
///   A = sin(theta)/theta,      B = (1 - cos(theta))/theta^2,  C = (1 - A)/theta^2,
///   half_cot = (theta/2) cot(theta/2),                        D = (1 - half_cot)/theta^2.
///
/// Below kSeriesBelow, where the closed forms cancel, every function is its Taylor series in u,
/// with as many terms as the scalar type has digits for; above it, the closed form. Relative error:
/// a few units in the last place on [0, (2 pi)^2), away from the zeros of the function.
namespace posemix::small_angle {

/// Squared angle (rad^2) below which the Taylor series are used.
inline constexpr int kSeriesBelow = 4;

namespace detail {

/// The number of terms after which 4^k / (2k+1)! is below half a unit in the last place.
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

/// The number of terms after which k (4 / (2 pi)^2)^k is below half a unit in the last place.
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

/// Taylor coefficients in u of A, B, C and of the u-derivatives of B and C.
template <typename Scalar>
struct SineSeries {
  using Row = std::array<Scalar, kSineTerms<Scalar>>;
  Row a{}, b{}, c{}, d_b{}, d_c{};
};

/// Taylor coefficients in u of D and of its u-derivative.
template <typename Scalar>
struct CotangentSeries {
  using Row = std::array<Scalar, kCotangentTerms<Scalar>>;
  Row d{}, slope{};
};

// Tables of built-in types are computed in long double and rounded once.
template <typename Scalar>
using TableScalar = std::conditional_t<std::is_floating_point_v<Scalar>, long double, Scalar>;

template <typename Scalar>
constexpr SineSeries<Scalar> make_sine_series() {
  using Work = TableScalar<Scalar>;
  SineSeries<Scalar> series;
  Work inverse_factorial(1);  // (-1)^k / (2k+1)!
  for (std::size_t k = 0; k < kSineTerms<Scalar>; ++k) {
    const int n = 2 * static_cast<int>(k);
    const Work b = inverse_factorial / Work(n + 2);
    const Work c = b / Work(n + 3);
    const Work d_b = -c / Work(n + 4) * Work(n + 2) / Work(2);
    const Work d_c = d_b / Work(n + 5);
    series.a[k] = static_cast<Scalar>(inverse_factorial);
    series.b[k] = static_cast<Scalar>(b);
    series.c[k] = static_cast<Scalar>(c);
    series.d_b[k] = static_cast<Scalar>(d_b);
    series.d_c[k] = static_cast<Scalar>(d_c);
    inverse_factorial = -c;
  }
  return series;
}

/// x cot x = 1 - sum d_k x^(2k) solves x f' = f - f^2 - x^2, hence (2k+1) d_k = sum_(0<j<k) d_j
/// d_(k-j) + [k=1]: all terms are positive. With x = theta/2: D = sum d_k u^(k-1) / 4^k.
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
    series.d[k] = static_cast<Scalar>(d[k + 1] * scale);
    scale /= Work(4);
    series.slope[k] = static_cast<Scalar>(Work(static_cast<int>(k) + 1) * d[k + 2] * scale);
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
  if (u < Scalar(kSeriesBelow)) return detail::polynomial(detail::sine_series<Scalar>().a, u);
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
    return {Scalar(1) - u * detail::polynomial(series.b, u), detail::polynomial(series.a, u)};
  }
  const Scalar theta = sqrt(u);
  return {cos(theta), sin(theta) / theta};
}

/// C = (1 - sin(theta)/theta)/u.
template <typename Scalar>
Scalar coefficient_c(const Scalar& u) {
  if (u < Scalar(kSeriesBelow)) return detail::polynomial(detail::sine_series<Scalar>().c, u);
  return (Scalar(1) - sinc(u)) / u;
}

/// Coefficients of J_l = A I + B phi^ + C phi phi^T, rotation vector phi, u = |phi|^2.
template <typename Scalar>
struct JacobianCoefficients {
  Scalar a;  ///< sin(theta)/theta
  Scalar b;  ///< (1 - cos(theta))/u
  Scalar c;  ///< (1 - sin(theta)/theta)/u = (theta - sin(theta))/theta^3
};

template <typename Scalar>
JacobianCoefficients<Scalar> jacobian_coefficients(const Scalar& u) {
  using std::sin;
  using std::sqrt;
  if (u < Scalar(kSeriesBelow)) {
    const auto& series = detail::sine_series<Scalar>();
    const Scalar c = detail::polynomial(series.c, u);
    return {Scalar(1) - u * c, detail::polynomial(series.b, u), c};
  }
  const Scalar theta = sqrt(u);
  const Scalar half_sine = sin(theta / Scalar(2));
  const Scalar a = sin(theta) / theta;
  return {a, Scalar(2) * half_sine * half_sine / u, (Scalar(1) - a) / u};
}

/// Derivatives of JacobianCoefficients with respect to u; `value` are the coefficients at u.
template <typename Scalar>
JacobianCoefficients<Scalar> jacobian_coefficient_slopes(
    const Scalar& u, const JacobianCoefficients<Scalar>& value) {
  const Scalar d_a = (value.c - value.b) / Scalar(2);
  if (u < Scalar(kSeriesBelow)) {
    const auto& series = detail::sine_series<Scalar>();
    return {d_a, detail::polynomial(series.d_b, u), detail::polynomial(series.d_c, u)};
  }
  const Scalar twice_u = Scalar(2) * u;
  return {d_a, (value.a - Scalar(2) * value.b) / twice_u,
          (value.b - Scalar(3) * value.c) / twice_u};
}

/// Coefficients of J_l^-1 = half_cot I - phi^/2 + D phi phi^T, singular at theta = 2 pi, 4 pi, ...
template <typename Scalar>
struct InverseJacobianCoefficients {
  Scalar half_cot;  ///< (theta/2) cot(theta/2)
  Scalar d;         ///< (1 - (theta/2) cot(theta/2))/u
};

template <typename Scalar>
InverseJacobianCoefficients<Scalar> inverse_jacobian_coefficients(const Scalar& u) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  if (u < Scalar(kSeriesBelow)) {
    const Scalar d = detail::polynomial(detail::cotangent_series<Scalar>().d, u);
    return {Scalar(1) - u * d, d};
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
    const Scalar slope = detail::polynomial(detail::cotangent_series<Scalar>().slope, u);
    return {-value.d - u * slope, slope};
  }
  const Scalar& h = value.half_cot;
  const Scalar d_half_cot = (h - h * h - u / Scalar(4)) / (Scalar(2) * u);
  return {d_half_cot, (-d_half_cot - value.d) / u};
}

/// log |sin(theta)/theta|, without cancellation at small angles; -infinity at theta = pi, 2 pi, ...
template <typename Scalar>
Scalar log_abs_sinc(const Scalar& u) {
  using std::abs;
  using std::log;
  using std::log1p;
  const Scalar defect = u * coefficient_c(u);
  if (defect < Scalar(0.5)) return log1p(Scalar(-defect));
  return log(Scalar(abs(sinc(u))));
}

}  // namespace posemix::small_angle
