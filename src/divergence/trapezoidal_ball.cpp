// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "trapezoidal_ball.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "trapezoidal_points.hpp"

namespace posemix::internal {
namespace {

/// More mass lies in the outermost shell of this thickness than beyond the ball.
constexpr double kShell = 0.25;
/// The share of the change before the last that the error is not believed to be below.
constexpr double kLeastShare = 0.1;
/// Levels that are needed for an error.
constexpr int kFirstLevels = 3;
/// The first spacing in widths of the narrowest feature, all of which are seen.
constexpr double kWidestStep = 2.0;

/// The finest rule has about as many points as the cubature along rays evaluates.
int level_count(bool axisymmetric) { return axisymmetric ? 9 : 7; }

int first_level(double narrowest) {
  const double steps = 2.0 * std::log2(trapezoidal_spacing(0) / (kWidestStep * narrowest));
  return static_cast<int>(std::clamp(std::ceil(steps), 0.0, 99.0));
}

}  // namespace

TangentPeak tangent_peak(const BallCentre& centre, const RotationPeak& peak) {
  const Eigen::Quaterniond a = centre.peak->mean * peak.mean.conjugate();
  Eigen::Matrix3d turn;  // v -> a_w v + v x a
  turn << a.w(), a.z(), -a.y(), -a.z(), a.w(), a.x(), a.y(), -a.x(), a.w();
  TangentPeak seen;
  Eigen::Map<Eigen::Vector4d>(seen.scalar) << a.w(), -centre.root.transpose() * a.vec();
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(seen.white[0]) << peak.whiten * a.vec(),
      peak.whiten * turn * centre.root;
  seen.log_scale = peak.log_scale;
  return seen;
}

double trapezoidal_radius(double tolerance) {
  constexpr double kMargin = 8.0;
  constexpr double kSmallest = 4.0;
  return std::clamp(std::sqrt(2.0 * std::max(0.0, kMargin - std::log(tolerance))), kSmallest, 9.0);
}

TrapezoidalBall::TrapezoidalBall(const RotationPair& pair, const Integrand& integrand,
                                 const BallCentre& centre, bool axisymmetric, double radius,
                                 double narrowest)
    : factor_(integrand.factor),
      scale_(centre.factor()),
      axisymmetric_(axisymmetric),
      radius_(radius),
      level_(first_level(narrowest)) {
  for (const auto* side : {&pair.p, &pair.q}) {
    for (const RotationPeak& peak : *side) peaks_.push_back(tangent_peak(centre, peak));
  }
  view_ = {{}, peaks_.data(), pair.p.size(), peaks_.size()};
  Eigen::Map<Eigen::RowVector3d>(view_.variances) = centre.root.colwise().squaredNorm();
  scratch_.resize(2 * kTangentPoints * peaks_.size());
  for (int i = 0; i < kFirstLevels; ++i) add_level();
}

bool TrapezoidalBall::can_resolve(double narrowest, bool axisymmetric) {
  return first_level(narrowest) + kFirstLevels <= level_count(axisymmetric);
}

void TrapezoidalBall::add_level() {
  value_ = absolute_ = shell_ = 0.0;
  const auto add = [this](double x, double y, double z, double w) { add_point(x, y, z, w); };
  if (axisymmetric_) {
    visit_half_plane(level_, radius_, add);
  } else {
    visit_lattice(level_, radius_, add);
  }
  add_block();
  ++level_;
  step_before_ = step_;
  step_ = std::abs(scale_ * value_ - total_.value);
  total_.value = scale_ * value_;
  total_.absolute = std::abs(scale_) * absolute_;
  total_.error = std::max(step_, kLeastShare * step_before_) + std::abs(scale_) * shell_;
}

void TrapezoidalBall::add_point(double x, double y, double z, double weight) {
  block_.x[0][waiting_] = x;
  block_.x[1][waiting_] = y;
  block_.x[2][waiting_] = z;
  weights_[waiting_] = weight;
  if (++waiting_ == kTangentPoints) add_block();
}

void TrapezoidalBall::add_block() {
  using Values = Eigen::Array<double, kTangentPoints, 1>;
  using Row = Eigen::Map<Values, Eigen::Aligned64>;
  for (auto& x : block_.x) std::fill(x + waiting_, x + kTangentPoints, 0.0);
  weights_.tail(kTangentPoints - waiting_).setZero();
  tangent_log_densities(view_, block_, scratch_.data());
  Values factors = Row(block_.log_p) - Row(block_.log_q);
  if (factor_ != log_ratio) {
    for (std::size_t i = 0; i < kTangentPoints; ++i)
      factors[i] = factor_(block_.log_p[i], block_.log_q[i]);
  }
  // Sums of sums: the rounding errors of millions of points do not add up.
  const Values terms = weights_ * Row(block_.mass) * factors;
  const double inner = (radius_ - kShell) * (radius_ - kShell);
  value_ += terms.sum();
  absolute_ += terms.abs().sum();
  shell_ += (Row(block_.squared) > inner).select(terms.abs(), 0.0).sum();
  total_.evaluations += waiting_;
  waiting_ = 0;
}

bool TrapezoidalBall::refine(double error) {
  if (!may_reach(error)) return false;
  add_level();
  return true;
}

bool TrapezoidalBall::may_reach(double error) const {
  if (std::abs(scale_) * shell_ > 0.5 * error) return false;
  // Errors are about exp(-c / spacing): the logarithm of their ratio grows by sqrt(2) every time.
  double step = step_;
  double ratio = step_ < step_before_ ? step_ / step_before_ : 1.0;
  for (int level = level_; level < level_count(axisymmetric_); ++level) {
    ratio = std::pow(ratio, std::numbers::sqrt2);
    const double before = step;
    step *= ratio;
    if (std::max(step, kLeastShare * before) < error) return true;
  }
  return false;
}

}  // namespace posemix::internal
