// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "dense_lie.hpp"
#include "jobs.hpp"

/// The divergence of a mixture of two Gaussians on SO(3) from one by the trapezoid rule, in the
/// coordinates that whiten the component that is integrated over. For smooth integrands on all of
/// space the error of that rule falls faster than any power of the step; it does not know where a
/// density has a cut locus, nor how large its error is.
namespace dense {

template <class S>
struct RotationGaussian {
  Matrix3<S> mean, root, inverse_root;
  S log_factor;  ///< log of the density at the mean

  RotationGaussian(const Vector3<S>& log_mean, const Matrix3<S>& covariance)
      : mean(exp_rotation(log_mean)) {
    using std::log;
    const Eigen::LLT<Matrix3<S>> factor(covariance);
    root = factor.matrixL();
    inverse_root = root.inverse();
    log_factor = -S(1.5) * log(2 * std::numbers::pi_v<S>) - root.diagonal().array().log().sum();
  }

  /// With respect to the Haar measure |det J_l| dxi.
  S log_density(const Matrix3<S>& x) const {
    using std::log;
    const Vector3<S> xi = log_rotation<S>(x * mean.transpose());
    const S volume = log(2 * Coefficients<S>(xi.squaredNorm()).b);
    return log_factor - (inverse_root * xi).squaredNorm() / 2 - volume;
  }
};

/// Two Gaussians of equal weights, and the one that stands for them.
template <class S>
std::array<RotationGaussian<S>, 3> gaussians(const bench::Jobs& jobs, const std::string& name) {
  const auto means = jobs.input(name + "_means");
  const auto covariances = matrices_of<S, 3>(jobs.input(name + "_covariances"));
  const auto one = [&](std::size_t i) {
    return RotationGaussian<S>(Eigen::Map<const Vector3<double>>(&means[3 * i]).template cast<S>(),
                               covariances[i]);
  };
  return {one(0), one(1), one(2)};
}

/// D(p || q) with a step in standard deviations, out to nine of them.
template <class S>
S kl_of_step(const std::array<RotationGaussian<S>, 3>& g, S step) {
  using std::exp;
  using std::log;
  const int reach = static_cast<int>(9 / step);
  S sum(0);
  for (int part = 0; part < 2; ++part) {
    for (int i = -reach; i <= reach; ++i) {
      for (int j = -reach; j <= reach; ++j) {
        for (int k = -reach; k <= reach; ++k) {
          const Vector3<S> u = step * Vector3<S>(S(i), S(j), S(k));
          const S square = u.squaredNorm();
          if (square > 81) continue;
          const auto& from = g[static_cast<std::size_t>(part)];
          const Matrix3<S> x = exp_rotation<S>(from.root * u) * from.mean;
          const S p = log((exp(g[0].log_density(x)) + exp(g[1].log_density(x))) / 2);
          sum += exp(-square / 2) * (p - g[2].log_density(x));
        }
      }
    }
  }
  const S volume = step / std::sqrt(2 * std::numbers::pi_v<S>);
  return sum * volume * volume * volume / 2;
}

/// The step is halved until two results agree to 1e-6.
inline double kl_to_tolerance(const std::array<RotationGaussian<double>, 3>& g) {
  double step = 1.0;
  double before = kl_of_step(g, step);
  while (true) {
    step /= 2;
    const double now = kl_of_step(g, step);
    if (std::abs(now - before) <= 1e-6 * std::abs(now)) return now;
    before = now;
  }
}

}  // namespace dense
