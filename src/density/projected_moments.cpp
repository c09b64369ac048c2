// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/density/projected_moments.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "far_tangent.hpp"
#include "mean_rotation.hpp"
#include "posemix/base/linear.hpp"

namespace posemix {
namespace {

constexpr int kNodes = 64;
constexpr double kFirst = -2.85;
constexpr double kLast = 3.65;
using Nodes = Eigen::Array<double, kNodes, 1>;

/// The double exponential rule s = exp(v - exp(-v)), trapezoids in v: sum weight g(s) is the
/// integral of s exp(-s) g(s) from 0 to infinity.
struct Rule {
  Nodes s;
  Nodes weight;

  Rule() {
    const Nodes v = Nodes::LinSpaced(kFirst, kLast);
    const Nodes inner = (-v).exp();
    s = (v - inner).exp();
    weight = ((kLast - kFirst) / (kNodes - 1)) * s.square() * (1.0 + inner) * (-s).exp();
  }
};

const Rule& rule() {
  static const Rule instance;
  return instance;
}

Eigen::Matrix3d adjugate(const Eigen::Matrix3d& s) {
  Eigen::Matrix3d a;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      a(j, i) = s(i1, j1) * s(i2, j2) - s(i1, j2) * s(i2, j1);
    }
  }
  return a;
}

/// Parts of the integrand, with a = 2 s:
///   |I + a S| = 1 + a tr S + a^2 tr adj S + a^3 det S,
///   |I + a S| (I + a S)^-1 = I + a D + a^2 adj S, D = tr S I - S.
struct Integrand {
  Eigen::Matrix3d adjugate_s;
  Eigen::Matrix3d complement;  ///< D
  double determinant;
  Nodes a;
  Nodes inverse_det;  ///< 1 / |I + a S|
  Nodes value;        ///< weight times the factor of s exp(-s) in the integral for C

  Integrand(const Eigen::Vector3d& m, const Eigen::Matrix3d& s)
      : adjugate_s(adjugate(s)),
        complement(s.trace() * Eigen::Matrix3d::Identity() - s),
        determinant(s.row(0).dot(adjugate_s.col(0))),
        a(2.0 * rule().s) {
    inverse_det = (1.0 + a * (s.trace() + a * (adjugate_s.trace() + a * determinant))).inverse();
    value = rule().weight * inverse_det.sqrt();
    const double squared = m.squaredNorm();
    if (squared == 0.0) return;
    const double linear = m.dot(complement * m);
    const double quadratic = m.dot(adjugate_s * m);
    value *= (-0.5 * a * (squared + a * (linear + a * quadratic)) * inverse_det).exp();
  }
};

/// sum_k f_k E[u | s_k] and sum_k f_k E[u u^T | s_k]; given s, u is Gaussian with mean
/// (I + a S)^-1 m and covariance S (I + a S)^-1.
struct RawMoments {
  Eigen::Vector3d first;
  Eigen::Matrix3d second;

  RawMoments(const Integrand& at, const Nodes& f, const Eigen::Vector3d& m,
             const Eigen::Matrix3d& s) {
    const Nodes& a = at.a;
    const Nodes once = f * at.inverse_det;
    const Eigen::Matrix3d step = s * at.complement;
    second = once.sum() * s + (once * a).sum() * step +
             (once * a.square()).sum() * at.determinant * Eigen::Matrix3d::Identity();
    first.setZero();
    if (m.squaredNorm() == 0.0) return;
    const std::array<Eigen::Vector3d, 3> b{m, at.complement * m, at.adjugate_s * m};
    first = once.sum() * b[0] + (once * a).sum() * b[1] + (once * a.square()).sum() * b[2];
    Nodes twice = once * at.inverse_det;
    std::array<double, 5> power;
    for (double& sum : power) {
      sum = twice.sum();
      twice *= a;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) second += power[i + j] * b[i] * b[j].transpose();
    }
  }
};

/// Whether the mean is farther from the tangent point than the double exponential rule has nodes
/// for. At this limit both rules agree to 1e-12.
bool is_far(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance) {
  constexpr double kFar = 10.0;
  return mean.squaredNorm() > kFar * kFar && mean.allFinite() && covariance.allFinite();
}

}  // namespace

double projected_log_normalizer(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance) {
  if (is_far(mean, covariance)) return internal::FarTangent(mean, covariance).log_normalizer();
  return std::log(Integrand(mean, covariance).value.sum());
}

ProjectedMoments projected_moments(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance) {
  if (is_far(mean, covariance)) return internal::FarTangent(mean, covariance).moments();
  const Integrand integrand(mean, covariance);
  const double c = integrand.value.sum();
  const RawMoments moments(integrand, integrand.value / c, mean, covariance);

  // One more factor 1 / (1 + u.u), for which (1 + x)^-3 = int_0^inf s^2 / 2 exp(-s (1 + x)) ds.
  const Nodes third = integrand.value * rule().s / (2.0 * c);
  const RawMoments of_third(integrand, third, mean, covariance);
  return {std::log(c), moments.first, moments.second,
          internal::mean_rotation(third.sum(), of_third.first, of_third.second)};
}

namespace {

/// The distributions with diagonal covariance as an exponential family in lambda = 1 / l: the
/// function ln C(l) + sum (ln l + T lambda) / 2 is convex in lambda, with its minimum where
/// E[u_i^2] = T_i.
struct DiagonalFamily {
  double log_partition;     ///< ln C + sum ln l / 2
  Eigen::Vector3d moments;  ///< E[u_i^2]
  Eigen::Matrix3d hessian;  ///< Hessian of the log partition: Cov(u_i^2, u_j^2) / 4

  explicit DiagonalFamily(const Eigen::Vector3d& l) {
    const Nodes a = 2.0 * rule().s;
    Eigen::Array<double, kNodes, 3> spread;
    Nodes f = rule().weight;
    for (int i = 0; i < 3; ++i) {
      spread.col(i) = l[i] / (1.0 + a * l[i]);
      f *= (spread.col(i) / l[i]).sqrt();
    }
    const double c = f.sum();
    f /= c;
    log_partition = std::log(c) + 0.5 * l.array().log().sum();
    moments = (spread.colwise() * f).colwise().sum().transpose();
    hessian = spread.matrix().transpose() * f.matrix().asDiagonal() * spread.matrix();
    hessian.diagonal() *= 3.0;
    hessian = 0.25 * (hessian - moments * moments.transpose()).eval();
  }
};

}  // namespace

ProjectedVariances projected_variances_of_moments(const Eigen::Vector3d& moments,
                                                  const Eigen::Vector3d& lower,
                                                  const Eigen::Vector3d& upper) {
  const Eigen::Vector3d target = moments.cwiseMax(std::numeric_limits<double>::min());
  const Eigen::Vector3d least = upper.cwiseInverse();
  const Eigen::Vector3d most = lower.cwiseInverse();  // infinite for no bound
  const auto cost = [&](const DiagonalFamily& at, const Eigen::Vector3d& lambda) {
    return at.log_partition + 0.5 * target.dot(lambda);
  };
  Eigen::Vector3d lambda = target.cwiseInverse().cwiseMax(least).cwiseMin(most);
  DiagonalFamily at(lambda.cwiseInverse());
  for (int iteration = 0; iteration < 100; ++iteration) {
    // Newton's method in all coordinates but those that the gradient pushes against a bound.
    Eigen::Vector3d slope = 0.5 * (target - at.moments);
    Eigen::Matrix3d hessian = at.hessian;
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (slope[i] > 0.0 ? lambda[i] > least[i] : lambda[i] < most[i]) continue;
      slope[i] = 0.0;
      hessian.row(i).setZero();
      hessian.col(i).setZero();
      hessian(i, i) = 1.0;
    }
    if ((slope.array().abs() <= 1e-14 * target.array()).all()) break;
    const Eigen::Vector3d newton = hessian.ldlt().solve(-slope);
    bool moved = false;
    for (double step = 1.0; step > 1e-10 && !moved; step *= 0.5) {
      const Eigen::Vector3d next =
          (lambda + step * newton).cwiseMax(0.2 * lambda).cwiseMax(least).cwiseMin(most);
      const DiagonalFamily there(next.cwiseInverse());
      if (!(cost(there, next) <= cost(at, lambda)) || next == lambda) continue;
      lambda = next;
      at = there;
      moved = true;
    }
    if (!moved) break;
  }
  const bool met = ((target - at.moments).array().abs() <= 1e-9 * target.array()).all();
  return {lambda.cwiseInverse(), met};
}

ProjectedCovariance projected_covariance_of_moment(const Eigen::Matrix3d& second_moment,
                                                   double limit) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(second_moment);
  const ProjectedVariances fit = projected_variances_of_moments(
      eigen.eigenvalues(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(limit));
  const Eigen::Matrix3d& v = eigen.eigenvectors();
  Eigen::Matrix3d covariance = v * fit.variances.asDiagonal() * v.transpose();
  symmetrize(covariance);
  return {covariance, fit.converged};
}

}  // namespace posemix
