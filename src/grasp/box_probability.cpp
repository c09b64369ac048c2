// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "grasp/box_probability.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <boost/math/special_functions/erf.hpp>

namespace posemix::internal {
namespace {

/// Probability below x of a standard normal.
double normal_below(double x) { return 0.5 * std::erfc(-x * std::numbers::sqrt2 / 2.0); }

/// The point with probability p below it, 0 < p < 1.
double normal_quantile(double p) { return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * p); }

/// A standard normal cut to [low, high]: its probability, and its point at a uniform deviate. By
/// the lower tail, where probabilities keep their digits.
struct Cut {
  double probability;
  double point;

  Cut(double low, double high, double uniform) {
    const bool upper = low > 0.0;
    const double below = normal_below(upper ? -high : low);
    probability = normal_below(upper ? -low : high) - below;
    constexpr double kLeast = 1e-300;
    const double fraction = upper ? 1.0 - uniform : uniform;
    const double z = normal_quantile(std::max(below + fraction * probability, kLeast));
    point = std::clamp(upper ? -z : z, low, high);
  }
};

}  // namespace

BoxedGaussian::BoxedGaussian(const Vector6d& mean, const Matrix6d& covariance,
                             const Vector6d& limit)
    : order_{0, 1, 2, 3, 4, 5} {
  const auto tightness = [&](Eigen::Index i) { return limit[i] / std::sqrt(covariance(i, i)); };
  std::stable_sort(order_.begin(), order_.end(),
                   [&](auto a, auto b) { return tightness(a) < tightness(b); });
  Matrix6d ordered;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Eigen::Index from = order_[static_cast<std::size_t>(i)];
    mean_[i] = mean[from];
    limit_[i] = limit[from];
    for (Eigen::Index j = 0; j < 6; ++j) {
      ordered(i, j) = covariance(from, order_[static_cast<std::size_t>(j)]);
    }
  }
  const Eigen::LLT<Matrix6d> factor(ordered);
  factor_ = factor.matrixL();
  log_constant_ = -0.5 * (log_det(factor) + 6.0 * kLogTwoPi);
}

BoxedGaussian::Point BoxedGaussian::at(const Vector6d& uniform) const {
  Vector6d z = Vector6d::Zero();
  Point point{Vector6d::Zero(), 0.0, 0.0};
  double probability = 1.0;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double centre = mean_[i] + factor_.row(i).head(i).dot(z.head(i));
    const Cut cut((-limit_[i] - centre) / factor_(i, i), (limit_[i] - centre) / factor_(i, i),
                  uniform[i]);
    probability *= cut.probability;
    z[i] = cut.point;
    point.y[order_[static_cast<std::size_t>(i)]] = centre + factor_(i, i) * z[i];
  }
  point.log_weight = std::log(probability);
  point.log_density = log_constant_ - 0.5 * z.squaredNorm();
  return point;
}

}  // namespace posemix::internal
