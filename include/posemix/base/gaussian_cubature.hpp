// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Core>

namespace posemix {

/// A cubature rule: points z (in columns) and weights for integrals over N(z; 0, I) in N
/// dimensions.
template <int N>
struct GaussianCubature {
  Eigen::Matrix<double, N, Eigen::Dynamic> points;
  Eigen::VectorXd weights;

  /// The 2N points +-sqrt(N) e_i: exact for polynomials up to degree three.
  static GaussianCubature third_degree() {
    GaussianCubature rule(2 * N);
    for (int i = 0; i < N; ++i) rule.add_axis(i, std::sqrt(N), 1.0 / (2 * N));
    return rule;
  }

  /// The origin, +-sqrt(N + 2) e_i and sqrt((N + 2) / 2) (+-e_i +- e_j): exact for polynomials up
  /// to degree five \cite stroud1971. For N > 4 the weights of the points +-sqrt(N + 2) e_i are
  /// negative.
  static GaussianCubature fifth_degree() {
    GaussianCubature rule(1 + 2 * N * N);
    constexpr double m = N + 2.0;
    rule.add(Point::Zero(), 2.0 / m);
    for (int i = 0; i < N; ++i) {
      rule.add_axis(i, std::sqrt(m), (4.0 - N) / (2.0 * m * m));
      for (int j = 0; j < i; ++j) rule.add_diagonals(i, j, std::sqrt(0.5 * m), 1.0 / (m * m));
    }
    return rule;
  }

  /// The origin and the twelve corners of an icosahedron of radius sqrt(5): exact for polynomials
  /// up to degree five in three dimensions \cite stroud1971.
  static GaussianCubature icosahedron() requires(N == 3) {
    GaussianCubature rule(13);
    rule.add(Point::Zero(), 0.4);
    const double one = std::sqrt(5.0 / (1.0 + std::numbers::phi * std::numbers::phi));
    const double other = std::numbers::phi * one;
    for (int axis = 0; axis < 3; ++axis) {
      const Point a = one * Point::Unit((axis + 1) % 3);
      const Point b = other * Point::Unit((axis + 2) % 3);
      for (const Point& point : {Point(a + b), Point(a - b), Point(b - a), Point(-a - b)}) {
        rule.add(point, 0.05);
      }
    }
    return rule;
  }

 private:
  using Point = Eigen::Matrix<double, N, 1>;

  explicit GaussianCubature(Eigen::Index size) : points(N, size), weights(size) {}

  void add(const Point& point, double weight) {
    points.col(used_) = point;
    weights[used_] = weight;
    ++used_;
  }
  void add_axis(int i, double radius, double weight) {
    add(radius * Point::Unit(i), weight);
    add(-radius * Point::Unit(i), weight);
  }
  void add_diagonals(int i, int j, double radius, double weight) {
    for (const double a : {radius, -radius}) {
      for (const double b : {radius, -radius}) add(a * Point::Unit(i) + b * Point::Unit(j), weight);
    }
  }

  Eigen::Index used_ = 0;
};

}  // namespace posemix
