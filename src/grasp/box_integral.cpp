// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "grasp/box_integral.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "posemix/base/error.hpp"
#include "posemix/base/sobol.hpp"
#include "posemix/density/projected_operations.hpp"
#include "posemix/divergence/conversion.hpp"

namespace posemix::internal {
namespace {

using Concentrated = ConcentratedGaussian<SE3d>;
using Projected = ProjectedGaussian<SE3d>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Projected as_projected(const Projected& density) { return density; }
Projected as_projected(const Concentrated& density) {
  return to_projected(density, ConversionRule::linear).density;
}

/// Largest standard deviation of the rotation [rad].
double rotation_spread(const Projected& density) {
  const Matrix6d covariance = change_chart_to_mode(density).covariance();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
      Eigen::Matrix3d(covariance.topLeftCorner<3, 3>()), Eigen::EigenvaluesOnly);
  return 2.0 * std::sqrt(eigen.eigenvalues()[2]);
}

SE3d::Tangent tangent_mean(const Concentrated& /*density*/) { return SE3d::Tangent::Zero(); }
SE3d::Tangent tangent_mean(const Projected& density) { return density.tangent_mean(); }

SE3d element(const Concentrated& density, const Vector6d& y) {
  return SE3d::exp(y) * density.mean();
}
SE3d element(const Projected& density, const Vector6d& y) { return density.element(y); }

/// Whether a draw y is so far that the pose is a nearer one as well, whose density counts there.
bool wrapped(const Concentrated& /*density*/, const Vector6d& y) {
  return y.head<3>().norm() > std::numbers::pi;
}
bool wrapped(const Projected& /*density*/, const Vector6d& /*y*/) { return false; }

/// Log of the density of the poses that are drawn, by that of the component.
double log_drawn(const Concentrated& /*density*/, const SE3d& /*pose*/, double log_density) {
  return log_density;
}
double log_drawn(const Projected& density, const SE3d& pose, double log_density) {
  const Eigen::Vector3d u = density.coordinates(pose).head<3>();
  return log_density + density.log_normalizer() + 2.0 * std::log1p(u.squaredNorm());
}

/// The integral of f by points from the mixture q of g and h, with a fraction of h, and g as the
/// control variate: the mean of f/q - b (g/q - 1) with b from the regression of f/q on g/q.
class ControlledMean {
 public:
  explicit ControlledMean(double fraction_of_h) : of_h_(fraction_of_h) {}

  /// A point where f and g are zero.
  void add_nothing() { ++count_; }
  /// A point by the logs of f, g and h, of which one is not -inf.
  void add(double log_f, double log_g, double log_h) {
    ++count_;
    const double largest = std::max(log_g, log_h);
    const double q = (1.0 - of_h_) * std::exp(log_g - largest) + of_h_ * std::exp(log_h - largest);
    const double f = std::exp(log_f - largest) / q;
    const double g = std::exp(log_g - largest) / q;
    f_ += f;
    g_ += g;
    fg_ += f * g;
    gg_ += g * g;
  }
  double value() const {
    const double n = static_cast<double>(count_);
    const double variance = gg_ - g_ * g_ / n;
    const double slope = variance > 0.0 ? (fg_ - f_ * g_ / n) / variance : 0.0;
    return f_ / n - slope * (g_ / n - 1.0);
  }

 private:
  double of_h_;
  std::size_t count_ = 0;
  double f_ = 0.0, g_ = 0.0, fg_ = 0.0, gg_ = 0.0;
};

/// Log of the Haar measure in a gnomonic chart, 8 (1 + u.u)^-2 du dt.
double log_haar(const Vector6d& y) {
  return gnomonic::kLogHaarPerHalfSphere - 2.0 * std::log1p(y.head<3>().squaredNorm());
}

SE3d element_at(const SE3d& chart, const Vector6d& y) {
  return chart * SE3d(gnomonic::project(SO3d(), y.head<3>()), y.tail<3>());
}

Vector6d coordinates_at(const SE3d& chart, const SE3d& pose) {
  const SE3d seen = chart.inverse() * pose;
  Vector6d y;
  y << gnomonic::lift(SO3d(), seen.rotation()), seen.translation();
  return y;
}

/// How many of the points are draws from the component.
std::size_t drawn_of(std::size_t points) { return (points + 1) / 2; }

SE3d half_turn(Eigen::Index axis) {
  Eigen::Quaterniond q(0.0, 0.0, 0.0, 0.0);
  q.coeffs()[axis] = 1.0;
  return SE3d(SO3d::from_quaternion(q), Eigen::Vector3d::Zero());
}

}  // namespace

Vector6d checked_limits(const ToleranceBox& box) {
  constexpr double kPi = std::numbers::pi;
  constexpr double kRounding = 1e-12;
  Vector6d limit;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double turn = box.rotation[i];
    if (!(turn > 0.0 && turn <= kPi + kRounding)) {
      throw InvalidInput(fmt::format(
          "tolerance box: rotation {} is {} rad, expected more than 0 and at most pi", i, turn));
    }
    if (!(box.translation[i] > 0.0 && std::isfinite(box.translation[i]))) {
      throw InvalidInput(fmt::format("tolerance box: translation {} is {} m, expected more than 0",
                                     i, box.translation[i]));
    }
    limit[i] = turn >= kPi - kRounding ? kInfinity : std::tan(0.5 * turn);
    limit[i + 3] = box.translation[i];
  }
  return limit;
}

template <class D>
BoxIntegral<D>::BoxIntegral(const Mixture<D>& mixture, const ToleranceBox& box)
    : limit_(checked_limits(box)), reach_(2.0 * std::atan(limit_.head<3>().norm())) {
  parts_.reserve(mixture.size());
  for (std::size_t k = 0; k < mixture.size(); ++k) {
    const D& density = mixture[k].density;
    const Projected projected = as_projected(density);
    parts_.push_back({std::isinf(mixture[k].log_weight) ? 0.0 : mixture.weight(k), &density,
                      projected, typename D::Evaluator(density),
                      density.covariance().llt().matrixL(), rotation_spread(projected)});
  }
}

/// The chart at the centre of the box where it is good, otherwise the one of those that the box
/// reaches whose centre is nearest to the mode.
template <class D>
typename BoxIntegral<D>::Choice BoxIntegral<D>::choose(const Part& part, const SE3d& m) const {
  constexpr double kNone = 6.0;  // standard deviations with nothing beyond
  constexpr double kMost = 4.0;  // with next to nothing beyond
  constexpr double kLinear = std::numbers::pi / 2.0;
  constexpr double kModes = 2.0 * std::numbers::pi / 3.0;
  const SO3d mode = (m.inverse() * part.projected.mean()).rotation();
  const double angle = mode.angle();
  const bool apart = angle - reach_ > kNone * part.spread;
  const double common = std::min(reach_, angle + kMost * part.spread);
  if (apart || (angle <= kModes && common <= kLinear)) return {std::nullopt, true};

  const Eigen::Vector4d q = mode.quaternion().coeffs().cwiseAbs();
  Choice choice{std::nullopt, false};
  double nearest = q[3];
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (limit_[i] <= 1.0 || q[i] <= nearest) continue;
    choice.half_turn = i;
    nearest = q[i];
  }
  choice.linear = 2.0 * std::acos(std::min(nearest, 1.0)) + kMost * part.spread <= kLinear;
  return choice;
}

template <class D>
typename BoxIntegral<D>::Proposal BoxIntegral<D>::proposal(const Part& part, const SE3d& m,
                                                           std::optional<Eigen::Index> axis) const {
  const SE3d chart = axis ? m * half_turn(*axis) : m;
  const BoxRegion region = axis ? BoxRegion(limit_, *axis) : BoxRegion(limit_);
  const Projected seen = transform(chart.inverse(), part.projected);
  const Eigen::Vector3d mode = gnomonic::lift(SO3d(), seen.mean().rotation());
  constexpr double kFar = 1e3;
  if (!mode.allFinite() || mode.norm() > kFar) {  // the mode is by pi from every chart's centre
    Vector6d mean = Vector6d::Zero();
    mean.tail<3>() = seen.tangent_mean().tail<3>();
    Matrix6d covariance = Matrix6d::Identity();
    covariance.bottomRightCorner<3, 3>() = seen.covariance().bottomRightCorner<3, 3>();
    return {chart, {mean, covariance, region}};
  }
  const Projected moved = change_chart(seen, SO3d());
  return {chart, {moved.tangent_mean(), moved.covariance(), region}};
}

template <class D>
bool BoxIntegral<D>::inside(const SE3d& in_box) const {
  const Eigen::Quaterniond& q = in_box.rotation().quaternion();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const bool turned =
        std::isinf(limit_[i]) || std::abs(q.coeffs()[i]) <= limit_[i] * std::abs(q.w());
    if (!turned || std::abs(in_box.translation()[i]) > limit_[i + 3]) return false;
  }
  return true;
}

/// Genz's points alone.
template <class D>
double BoxIntegral<D>::within_chart(const Part& part, const Proposal& proposal, std::size_t points,
                                    RandomStream& stream) const {
  ShiftedSobol sobol(6, stream);
  Vector6d uniform;
  double sum = 0.0;
  for (std::size_t i = 0; i < points; ++i) {
    sobol.next(uniform);
    const BoxedGaussian::Point point = proposal.gaussian.at(uniform);
    const double log_density =
        part.evaluator.log_density(element_at(proposal.chart, point.y)) + log_haar(point.y);
    sum += std::exp(point.log_weight + log_density - point.log_density);
  }
  return sum / static_cast<double>(points);
}

/// Genz's points and draws from the component, half and half, with the density g of Genz's points,
/// whose integral is known to be one, as the control variate.
template <class D>
double BoxIntegral<D>::everywhere(const Part& part, const Proposal& proposal, const SE3d& m,
                                  std::size_t points, RandomStream& stream) const {
  const std::size_t drawn = drawn_of(points);
  ControlledMean mean(static_cast<double>(drawn) / static_cast<double>(points));
  Vector6d uniform;
  ShiftedSobol in_box(6, stream);
  for (std::size_t i = drawn; i < points; ++i) {
    in_box.next(uniform);
    const BoxedGaussian::Point point = proposal.gaussian.at(uniform);
    if (point.log_weight == -kInfinity) {
      mean.add_nothing();
      continue;
    }
    const SE3d pose = element_at(proposal.chart, point.y);
    const double log_density = part.evaluator.log_density(pose);
    mean.add(log_density, point.log_density - point.log_weight - log_haar(point.y),
             log_drawn(*part.density, pose, log_density));
  }
  ShiftedSobol anywhere(6, stream);
  const SE3d to_box = m.inverse();
  for (std::size_t i = 0; i < drawn; ++i) {
    anywhere.next(uniform);
    const Vector6d y =
        tangent_mean(*part.density) + part.factor * uniform.unaryExpr(&normal_quantile);
    const SE3d pose = element(*part.density, y);
    if (!inside(to_box * pose)) {
      mean.add_nothing();
      continue;
    }
    const double log_density = part.evaluator.log_density(pose);
    const Vector6d seen = coordinates_at(proposal.chart, pose);
    const bool in_chart = !wrapped(*part.density, y) && seen.allFinite();
    mean.add(log_density,
             in_chart ? proposal.gaussian.log_density_of_points(seen) - log_haar(seen) : -kInfinity,
             log_drawn(*part.density, pose, log_density));
  }
  return mean.value();
}

template <class D>
double BoxIntegral<D>::operator()(const SE3d& m, std::size_t points, RandomStream& stream,
                                  Cover cover) const {
  double sum = 0.0;
  for (const Part& part : parts_) {
    if (part.weight == 0.0) continue;
    const Choice choice = choose(part, m);
    const Proposal chosen = proposal(part, m, choice.half_turn);
    sum += part.weight * (choice.linear || cover == Cover::smooth
                              ? within_chart(part, chosen, points, stream)
                              : everywhere(part, chosen, m, points, stream));
  }
  return sum;
}

template <class D>
double BoxIntegral<D>::one_draw(const SE3d& m, std::size_t points) const {
  double squares = 0.0;
  for (const Part& part : parts_) {
    if (!choose(part, m).linear) squares += part.weight * part.weight;
  }
  return std::sqrt(squares) / static_cast<double>(drawn_of(points));
}

template class BoxIntegral<ConcentratedGaussian<SE3d>>;
template class BoxIntegral<ProjectedGaussian<SE3d>>;

}  // namespace posemix::internal
