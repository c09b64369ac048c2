// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "grasp/box_probability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <boost/math/special_functions/erf.hpp>

#include "base/in_double.hpp"

namespace posemix::internal {

double normal_quantile(double p) {
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * p, InDouble());
}

namespace {

/// Probability below x of a standard normal.
double normal_below(double x) { return 0.5 * std::erfc(-x * std::numbers::sqrt2 / 2.0); }

/// A standard normal cut to [low, high]. By the lower tail, where probabilities keep their digits.
struct Cut {
  double low, high;
  bool upper = low > 0.0;
  double below = normal_below(upper ? -high : low);
  double probability = normal_below(upper ? -low : high) - below;

  /// The point at a uniform deviate.
  double point(double uniform) const {
    constexpr double kLeast = 1e-300;
    const double fraction = upper ? 1.0 - uniform : uniform;
    const double z = normal_quantile(std::max(below + fraction * probability, kLeast));
    return std::clamp(upper ? -z : z, low, high);
  }
};

/// A standard normal outside of (low, high).
struct TwoTails {
  double low, high;
  double lower = normal_below(low);
  double upper = normal_below(-high);
  double probability = lower + upper;

  double point(double uniform) const {
    constexpr double kUnbounded = std::numeric_limits<double>::infinity();
    const double share = uniform * probability;
    if (share < lower) return Cut{-kUnbounded, low}.point(share / lower);
    const double above = upper > 0.0 ? std::min((share - lower) / upper, 1.0) : 0.0;
    return Cut{high, kUnbounded}.point(above);
  }
};

}  // namespace

BoxRegion::BoxRegion(const Vector6d& limits, Eigen::Index axis)
    : limit(limits), turned(axis), least(1.0 / limits[axis]) {
  // The half turn about k takes (q_i, q_j) to (-q_j, q_i), the other way round for q_k and w.
  std::swap(limit[(axis + 1) % 3], limit[(axis + 2) % 3]);
}

BoxedGaussian::BoxedGaussian(const Vector6d& mean, const Matrix6d& covariance,
                             const BoxRegion& region)
    : order_{0, 1, 2, 3, 4, 5}, turned_(region.turned.has_value()), least_(region.least) {
  const Eigen::Index axis = region.turned.value_or(-1);
  const double scale =
      turned_ ? std::max(least_, std::hypot(mean[axis], std::sqrt(covariance(axis, axis)))) : 1.0;
  const auto tightness = [&](Eigen::Index i) {
    if (i == axis) return 0.0;
    return (i < 3 ? scale : 1.0) * region.limit[i] / std::sqrt(covariance(i, i));
  };
  std::stable_sort(order_.begin(), order_.end(),
                   [&](auto a, auto b) { return tightness(a) < tightness(b); });
  Matrix6d ordered;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Eigen::Index from = order_[static_cast<std::size_t>(i)];
    mean_[i] = mean[from];
    limit_[i] = region.limit[from];
    for (Eigen::Index j = 0; j < 6; ++j) {
      ordered(i, j) = covariance(from, order_[static_cast<std::size_t>(j)]);
    }
  }
  const Eigen::LLT<Matrix6d> factor(ordered);
  factor_ = factor.matrixL();
  log_constant_ = -0.5 * (log_det(factor) + 6.0 * kLogTwoPi);
}

double BoxedGaussian::limit(Eigen::Index i, double turned) const {
  const bool scaled = turned_ && order_[static_cast<std::size_t>(i)] < 3;
  return scaled && std::isfinite(limit_[i]) ? limit_[i] * std::abs(turned) : limit_[i];
}

BoxedGaussian::Point BoxedGaussian::at(const Vector6d& uniform) const {
  Vector6d z = Vector6d::Zero();
  Point point{Vector6d::Zero(), 0.0, 0.0};
  double probability = 1.0;
  double first = 0.0;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double centre = mean_[i] + factor_.row(i).head(i).dot(z.head(i));
    const double sd = factor_(i, i);
    if (turned_ && i == 0) {
      const TwoTails tails{(-least_ - centre) / sd, (least_ - centre) / sd};
      probability *= tails.probability;
      z[i] = tails.point(uniform[i]);
      first = centre + sd * z[i];
    } else {
      const double bound = limit(i, first);
      const Cut cut{(-bound - centre) / sd, (bound - centre) / sd};
      probability *= cut.probability;
      z[i] = cut.point(uniform[i]);
    }
    point.y[order_[static_cast<std::size_t>(i)]] = centre + sd * z[i];
  }
  point.log_weight = std::log(probability);
  point.log_density = log_constant_ - 0.5 * z.squaredNorm();
  return point;
}

double BoxedGaussian::log_density_of_points(const Vector6d& y) const {
  Vector6d z = Vector6d::Zero();
  double probability = 1.0;
  const double first = y[order_[0]];
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double centre = mean_[i] + factor_.row(i).head(i).dot(z.head(i));
    const double sd = factor_(i, i);
    z[i] = (y[order_[static_cast<std::size_t>(i)]] - centre) / sd;
    const double bound = limit(i, first);
    probability *= turned_ && i == 0
                       ? TwoTails{(-least_ - centre) / sd, (least_ - centre) / sd}.probability
                       : Cut{(-bound - centre) / sd, (bound - centre) / sd}.probability;
  }
  if (!(probability > 0.0)) return -std::numeric_limits<double>::infinity();
  return log_constant_ - 0.5 * z.squaredNorm() - std::log(probability);
}

}  // namespace posemix::internal
