// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <limits>
#include <sstream>
#include <string>
#include <type_traits>

#include <rapidcheck.h>
#include <Eigen/Core>

#include "posemix/lie/lie.hpp"

/// Comparisons for property tests; a failure prints expected, actual and their distance.
namespace posemix::testing {

/// `G` over another scalar type.
template <typename G, typename S>
struct Rebind;
template <template <typename> class Group, typename T, typename S>
struct Rebind<Group<T>, S> {
  using type = Group<S>;
};
template <int N, typename T, typename S>
struct Rebind<Rn<N, T>, S> {
  using type = Rn<N, S>;
};

/// A scalar wide enough to differentiate `S` numerically.
template <typename S>
using WideScalar =
    std::conditional_t<(std::numeric_limits<S>::digits < std::numeric_limits<long double>::digits),
                       long double, S>;
template <typename G>
using Wide = typename Rebind<G, WideScalar<typename G::Scalar>>::type;

/// A matrix or vector of dynamic size, so that one function prints all sizes.
using Shown = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

inline std::string show_matrix(const Shown& m, int digits) {
  std::ostringstream text;
  text.precision(digits);
  if (m.cols() == 1) {
    text << "  [" << m.transpose() << "]";
  } else {
    text << m;
  }
  return text.str();
}

template <typename Scalar, int Rows, int Cols>
std::string show(const Eigen::Matrix<Scalar, Rows, Cols>& m) {
  return show_matrix(m.template cast<long double>(), std::numeric_limits<Scalar>::max_digits10);
}

/// A group element is printed as its logarithm.
template <LieGroup G>
std::string show(const G& x) {
  return "  Exp" + show(x.log());
}

/// Norm of the tangent vector from `x` to `y` (rad, m).
template <LieGroup G>
typename G::Scalar distance(const G& x, const G& y) {
  return (x.inverse() * y).log().norm();
}

/// Frobenius norm of the difference.
template <typename Scalar, int Rows, int Cols>
Scalar distance(const Eigen::Matrix<Scalar, Rows, Cols>& x,
                const Eigen::Matrix<Scalar, Rows, Cols>& y) {
  return (x - y).norm();
}

/// Fails the property and prints the compared values.
[[noreturn]] inline void fail_comparison(const char* what, const std::string& expected,
                                         const std::string& actual, double distance,
                                         double tolerance) {
  std::ostringstream text;
  text << what << "\nexpected\n"
       << expected << "\nactual\n"
       << actual << "\ndistance " << distance << ", at most " << tolerance;
  RC_FAIL(text.str());
}

/// Fails the property unless `actual` is within 300 units of rounding, times `scale`, of
/// `expected`. `Value` is a group, or a matrix or vector type (state it where the arguments are
/// expressions).
template <typename Value>
void expect_close(const char* what, const std::type_identity_t<Value>& actual,
                  const Value& expected, const typename Value::Scalar& scale) {
  using Scalar = typename Value::Scalar;
  const Scalar tolerance = Scalar(300) * std::numeric_limits<Scalar>::epsilon() * scale;
  const Scalar gap = distance(actual, expected);
  if (gap <= tolerance) return;
  fail_comparison(what, show(expected), show(actual), static_cast<double>(gap),
                  static_cast<double>(tolerance));
}

/// df/ds at s = 0, by the five-point rule.
template <typename Scalar, typename Function>
auto derivative_at_zero(const Function& f) {
  const Scalar h = Scalar(1) / Scalar(4096);
  using Value = std::decay_t<decltype(f(h))>;
  const Value near = f(h) - f(-h);
  const Value far = f(Scalar(2) * h) - f(Scalar(-2) * h);
  return Value((Scalar(8) * near - far) / (Scalar(12) * h));
}

}  // namespace posemix::testing
