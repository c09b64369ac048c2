// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "ball_integral.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <Eigen/SVD>

#include "quadrature_rules.hpp"
#include "smooth_ball.hpp"

namespace posemix::internal {
namespace {

/// The share of the tolerance for the integrals along the rays.
constexpr double kInnerShare = 0.1;
constexpr double kNoiseShare = 0.25;
constexpr std::size_t kMaxPieces = 400;

}  // namespace

BallIntegral::BallIntegral(const RotationPair& pair, const Integrand& integrand, Centres centres,
                           const std::optional<Eigen::Vector3d>& axis, double tolerance)
    : pair_(pair),
      integrand_(integrand),
      inner_tolerance_(std::max(1e-13, kInnerShare * tolerance)),
      ray_(pair),
      cubature_([this](std::size_t k, const Eigen::Vector3d& u) { return along_ray(k, u); },
                axis.has_value()) {
  const auto add = [&](const std::vector<RotationPeak>& peaks, double share) {
    for (const RotationPeak& peak : peaks) {
      centres_.push_back({&peak, share, axis ? symmetric_root(peak, *axis) : peak.root});
    }
  };
  add(pair.p, centres == Centres::mean ? 0.5 : 1.0);
  if (centres != Centres::of_p) add(pair.q, centres == Centres::mean ? 0.5 : -1.0);
  add_balls(axis.has_value(), tolerance);
}

void BallIntegral::add_balls(bool axisymmetric, double tolerance) {
  const double radius = trapezoidal_radius(tolerance);
  std::vector<std::size_t> others;
  for (std::size_t k = 0; k < centres_.size(); ++k) {
    const double narrowest = narrowest_feature(pair_, integrand_, centres_[k], radius);
    if (TrapezoidalBall::can_resolve(narrowest, axisymmetric)) {
      smooth_.push_back({k, {pair_, integrand_, centres_[k], axisymmetric, radius, narrowest}});
    } else {
      others.push_back(k);
    }
  }
  sum_up();
  for (const std::size_t k : others) cubature_.add_sphere(k, features(k));
  sum_up();
}

void BallIntegral::sum_up() {
  total_ = cubature_.total();
  total_.evaluations += abandoned_;
  for (const SmoothBall& ball : smooth_) total_.add(ball.rule.total(), 1.0);
  ray_tolerance_ = inner_tolerance_ * total_.absolute / solid_weight();
}

void BallIntegral::refine(double error) {
  const auto worst = std::ranges::max_element(
      smooth_, {}, [](const SmoothBall& ball) { return ball.rule.total().error; });
  if (worst == smooth_.end() || worst->rule.total().error < cubature_.total().error) {
    cubature_.refine();
  } else if (!worst->rule.refine(error / static_cast<double>(centres_.size()))) {
    const std::size_t k = worst->k;
    abandoned_ += worst->rule.total().evaluations;
    smooth_.erase(worst);
    cubature_.add_sphere(k, features(k));
  }
  sum_up();
}

/// The square root of a peak's covariance whose third axis is the axis of symmetry.
Eigen::Matrix3d BallIntegral::symmetric_root(const RotationPeak& peak,
                                             const Eigen::Vector3d& axis) {
  const Eigen::Matrix3d covariance = peak.root * peak.root.transpose();
  const double along = axis.dot(covariance * axis);
  const Eigen::Vector3d first = axis.unitOrthogonal();
  const double across = std::sqrt(0.5 * (covariance.trace() - along));
  Eigen::Matrix3d root;
  root << across * first, across * axis.cross(first), std::sqrt(along) * axis;
  return root;
}

double BallIntegral::solid_weight() const {
  double sum = 0.0;
  for (const BallCentre& centre : centres_) sum += std::abs(centre.share) * centre.peak->weight;
  return sum * 4.0 * std::numbers::pi * std::exp(-1.5 * kLogTwoPi);
}

/// The directions of those other peaks that are narrow as seen from peak k.
std::vector<SphereFeature> BallIntegral::features(std::size_t k) const {
  constexpr double kWidth = 4.0;    // standard deviations
  constexpr double kNarrow = 0.5;   // rad
  constexpr double kFinest = 1e-3;  // rad
  std::vector<SphereFeature> found;
  const Eigen::Matrix3d whiten = centres_[k].root.inverse();
  for (const auto* side : {&pair_.p, &pair_.q}) {
    for (const RotationPeak& other : *side) {
      const Eigen::Quaterniond step = other.mean * centres_[k].peak->mean.conjugate();
      const Eigen::Vector3d offset = SO3d::from_quaternion(step).log();
      const Eigen::Matrix3d spread = whiten * other.root;
      const double width = kWidth * spread.jacobiSvd().singularValues()[2];
      for (const double turn : {0.0, 2.0 * std::numbers::pi}) {
        if (offset.norm() == 0.0) continue;
        const Eigen::Vector3d white = whiten * (offset - turn * offset.normalized());
        const double distance = white.norm();
        const bool reached = distance - 3.0 * width < kRadius &&
                             (turn == 0.0 || offset.norm() > 0.5 * std::numbers::pi);
        if (!reached || width > kNarrow * distance) continue;
        found.push_back({white / distance, std::max(kFinest, width / distance)});
      }
    }
  }
  return found;
}

RayIntegral BallIntegral::piece(double stretch, double from, double to) {
  const double centre = 0.5 * (from + to);
  const double half = 0.5 * (to - from);
  const auto& nodes = KronrodRule::instance().nodes;
  static_assert(std::tuple_size_v<decltype(KronrodRule::nodes)> < kRayPoints);
  RayBlock block;
  std::ranges::fill(block.rho, centre);
  for (std::size_t i = 0; i < nodes.size(); ++i) block.rho[i] = centre + half * nodes[i].at;
  ray_.evaluate(stretch, block);
  RayIntegral sum;
  double difference = 0.0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double value = half * block.mass[i] * integrand_.factor(block.log_p[i], block.log_q[i]);
    sum.value += nodes[i].weight * value;
    sum.absolute += nodes[i].weight * std::abs(value);
    difference += nodes[i].difference * value;
  }
  sum.error = std::abs(difference);
  sum.evaluations = nodes.size();
  return sum;
}

void BallIntegral::begin_pieces(double stretch, double end) {
  constexpr double kMiddle = 4.0;  // most of the mass lies inside
  constexpr double kSliver = 1e-12;
  breaks_.assign(1, 0.0);
  ray_.append_breaks(end * stretch, stretch, breaks_);
  for (double& at : breaks_) at /= stretch;
  if (end > kMiddle) breaks_.push_back(kMiddle);
  breaks_.push_back(end);
  std::ranges::sort(breaks_);
  pieces_.clear();
  for (std::size_t i = 0; i + 1 < breaks_.size(); ++i) {
    if (breaks_[i + 1] - breaks_[i] < kSliver) continue;
    pieces_.push_back({breaks_[i], breaks_[i + 1], piece(stretch, breaks_[i], breaks_[i + 1])});
  }
}

RayIntegral BallIntegral::along_ray(std::size_t k, const Eigen::Vector3d& u) {
  const BallCentre& centre = centres_[k];
  const Eigen::Vector3d along = centre.root * u;
  const double stretch = along.norm();
  const double end = std::min(kRadius, std::numbers::pi / stretch);
  ray_.begin(centre.peak->mean, along / stretch);
  begin_pieces(stretch, end);
  RayIntegral sum;
  for (const Piece& part : pieces_) sum.add(part.integral, 1.0);
  // Smaller errors are noise, which no finer pieces remove.
  const double noise = kNoiseShare * integrand_.rounding(sum.absolute);
  const double tolerance = std::max({ray_tolerance_, inner_tolerance_ * sum.absolute, noise});
  while (sum.error > tolerance && pieces_.size() < kMaxPieces) {
    const auto worst =
        std::ranges::max_element(pieces_, {}, [](const Piece& p) { return p.integral.error; });
    const double middle = 0.5 * (worst->from + worst->to);
    const Piece left{worst->from, middle, piece(stretch, worst->from, middle)};
    const Piece right{middle, worst->to, piece(stretch, middle, worst->to)};
    const std::size_t evaluations = sum.evaluations;
    sum.add(worst->integral, -1.0);
    sum.evaluations = evaluations;
    sum.add(left.integral, 1.0).add(right.integral, 1.0);
    *worst = left;
    pieces_.push_back(right);
  }
  RayIntegral weighted;
  weighted.add(sum, std::abs(centre.factor()));
  weighted.value = std::copysign(1.0, centre.share) * weighted.value;
  return weighted;
}

RayIntegral missing_mass_gap(const RotationPair& pair, double tolerance) {
  const auto peak_at = [&](std::size_t k) -> const RotationPeak& {
    return k < pair.p.size() ? pair.p[k] : pair.q[k - pair.p.size()];
  };
  SphereCubature cubature(
      [&](std::size_t k, const Eigen::Vector3d& u) {
        const double x = std::numbers::pi / (peak_at(k).root * u).norm();
        const double beyond = std::erfc(x * std::numbers::sqrt2 / 2.0) +
                              std::sqrt(2.0 / std::numbers::pi) * x * std::exp(-0.5 * x * x);
        const double value = peak_at(k).weight * beyond / (4.0 * std::numbers::pi);
        return RayIntegral{k < pair.p.size() ? -value : value, 0.0, value, 1};
      },
      false);
  for (std::size_t k = 0; k < pair.p.size() + pair.q.size(); ++k) {
    if (peak_at(k).root.colwise().norm().maxCoeff() * kRadius > std::numbers::pi) {
      cubature.add_sphere(k, {});
    }
  }
  constexpr std::size_t kMaxPoints = 2'000'000;
  while (cubature.total().error > tolerance && cubature.total().evaluations < kMaxPoints) {
    cubature.refine();
  }
  return cubature.total();
}

}  // namespace posemix::internal
