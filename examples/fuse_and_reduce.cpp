// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
//
// Two looks at one object, fused, and the result reduced to two peaks.
//
//   X        in SE(3), T_camera_mug: what is asked for
//   p_i(X)   = a_i N(X; M_i, P) + (1 - a_i) N(X; M_i F, P): look i = 1, 2; it may be turned
//   N        a Gaussian in the exponential chart, X = Exp(xi) M, xi ~ N(0, P)
//   F        half a turn about the mug's z axis
//   q(X)     = p_1(X) p_2(X) / c: both looks, four peaks
//   r(X)     q with the two peaks that are left when those without weight are merged away
//
// The peaks that agree keep a_1 a_2 and (1 - a_1)(1 - a_2) of the weight, up to a common factor,
// and half of the covariance.
#include <cmath>
#include <cstdio>
#include <numbers>

#include <posemix/mixture/operations.hpp>
#include <posemix/reduction/reduce.hpp>

using namespace posemix;
using Gaussian = ConcentratedGaussian<SE3d>;

int main() {
  const Matrix6d P = 1e-3 * Matrix6d::Identity();
  const SE3d F(SO3d::exp({0.0, 0.0, std::numbers::pi}), Eigen::Vector3d::Zero());
  const auto look = [&](double a, const SE3d& M) {
    const double weights[] = {a, 1.0 - a};
    return Mixture<Gaussian>::from_weights(weights, {Gaussian(M, P), Gaussian(M * F, P)});
  };
  const double a_1 = 0.7;
  const double a_2 = 0.6;
  const auto p_1 = look(a_1, SE3d(SO3d(), {0.0, 0.0, 0.80}));
  const auto p_2 = look(a_2, SE3d(SO3d(), {0.0, 0.0, 0.82}));

  const auto q = fuse(p_1, p_2).density;
  ReductionSettings settings;
  settings.max_components = 2;
  const auto r = reduce(q, settings).mixture;

  std::printf("%zu peaks, reduced to %zu\n", q.size(), r.size());
  for (std::size_t i = 0; i < r.size(); ++i) {
    std::printf("  weight %.3f, z %.3f m, sd along z %.4f m\n", r.weight(i),
                r[i].density.mean().translation().z(), std::sqrt(r[i].density.covariance()(5, 5)));
  }
  const double expected = a_1 * a_2 / (a_1 * a_2 + (1.0 - a_1) * (1.0 - a_2));
  const bool good = r.size() == 2 && std::abs(r.weight(0) - expected) < 1e-3 &&
                    std::abs(r[0].density.covariance()(5, 5) - 0.5e-3) < 1e-5;
  std::printf("%s: expected weight %.3f and half of the covariance\n", good ? "good" : "not good",
              expected);
  return good ? 0 : 1;
}
