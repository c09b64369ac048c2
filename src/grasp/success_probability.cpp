// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/grasp/success_probability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlopt.hpp>

#include "grasp/box_probability.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/sobol.hpp"
#include "posemix/density/projected_operations.hpp"
#include "posemix/divergence/conversion.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix {
namespace {

using Projected = ProjectedGaussian<SE3d>;

Projected as_projected(const Projected& density) { return density; }
Projected as_projected(const ConcentratedGaussian<SE3d>& density) {
  return to_projected(density, ConversionRule::linear).density;
}

/// A Gaussian in the coordinates [u; t] of the box at m, like the density.
internal::BoxedGaussian proposal(const Projected& density, const SE3d& m, const Vector6d& limit) {
  const Projected seen = transform(m.inverse(), density);
  const Eigen::Vector3d mode = gnomonic::lift(SO3d(), seen.mean().rotation());
  constexpr double kFar = 1e3;
  if (!mode.allFinite() || mode.norm() > kFar) {  // the box is by pi from the mode
    Vector6d mean = Vector6d::Zero();
    mean.tail<3>() = seen.tangent_mean().tail<3>();
    return {mean, seen.covariance(), limit};
  }
  const Projected moved = change_chart(seen, SO3d());
  return {moved.tangent_mean(), moved.covariance(), limit};
}

Vector6d checked_limits(const ToleranceBox& box) {
  Vector6d limit;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double turn = box.rotation[i];
    if (!(turn > 0.0 && turn < std::numbers::pi)) {
      throw InvalidInput(fmt::format(
          "tolerance box: rotation {} is {} rad, expected more than 0 and less than pi", i, turn));
    }
    if (!(box.translation[i] > 0.0 && std::isfinite(box.translation[i]))) {
      throw InvalidInput(fmt::format("tolerance box: translation {} is {} m, expected more than 0",
                                     i, box.translation[i]));
    }
    limit[i] = std::tan(0.5 * turn);
    limit[i + 3] = box.translation[i];
  }
  return limit;
}

/// The probability of boxes of one shape under a mixture.
template <class D>
class BoxIntegral {
 public:
  BoxIntegral(const Mixture<D>& mixture, const ToleranceBox& box)
      : mixture_(&mixture), limit_(checked_limits(box)) {
    for (const auto& component : mixture.components()) {
      projected_.push_back(as_projected(component.density));
      evaluators_.emplace_back(component.density);
    }
  }

  /// With one randomisation of the points.
  double operator()(const SE3d& m, std::size_t points, RandomStream& stream) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < projected_.size(); ++k) {
      if (std::isinf((*mixture_)[k].log_weight)) continue;
      const internal::BoxedGaussian gaussian = proposal(projected_[k], m, limit_);
      ShiftedSobol sobol(6, stream);
      Vector6d uniform;
      double mean = 0.0;
      for (std::size_t i = 0; i < points; ++i) {
        sobol.next(uniform);
        const internal::BoxedGaussian::Point point = gaussian.at(uniform);
        mean += std::exp(point.log_weight + log_density(k, m, point.y) - point.log_density);
      }
      sum += mixture_->weight(k) * mean / static_cast<double>(points);
    }
    return sum;
  }

 private:
  /// Log density of a component in the coordinates of the box: Haar measure 8 (1 + u.u)^-2 du dt.
  double log_density(std::size_t k, const SE3d& m, const Vector6d& y) const {
    const Eigen::Vector3d u = y.head<3>();
    const SE3d pose = m * SE3d(gnomonic::project(SO3d(), u), y.tail<3>());
    return evaluators_[k].log_density(pose) + gnomonic::kLogHaarPerHalfSphere -
           2.0 * std::log1p(u.squaredNorm());
  }

  const Mixture<D>* mixture_;
  Vector6d limit_;
  std::vector<Projected> projected_;
  std::vector<typename D::Evaluator> evaluators_;
};

template <class D>
SuccessEstimate estimate(const BoxIntegral<D>& integral, std::size_t components, const SE3d& m,
                         RandomStream& stream, const SuccessSettings& settings) {
  Eigen::ArrayXd values(static_cast<Eigen::Index>(settings.replicates));
  for (double& value : values) value = integral(m, settings.points, stream);
  const double n = static_cast<double>(settings.replicates);
  const double variance = (values - values.mean()).square().sum() / (n - 1.0);
  return {values.mean(), std::sqrt(variance / n),
          settings.points * settings.replicates * components};
}

void check(const SuccessSettings& settings) {
  require(settings.replicates >= 2, "success probability: expected at least 2 replicates");
  require(settings.points >= 1, "success probability: expected at least 1 point");
}

/// The box at `start` moved by x, in units of its sides.
SE3d moved(const SE3d& start, const ToleranceBox& box, std::span<const double> x) {
  const Eigen::Map<const Vector6d> step(x.data());
  return start * SE3d(SO3d::exp(step.head<3>().cwiseProduct(box.rotation)),
                      step.tail<3>().cwiseProduct(box.translation));
}

/// Ascends from one start with the same points for every m, so that the function is smooth.
template <class D>
class Ascent {
 public:
  Ascent(const BoxIntegral<D>& integral, const ToleranceBox& box, const SE3d& start,
         const RandomStream& stream, const BestGraspSettings& settings)
      : integral_(integral), box_(box), start_(start), stream_(stream), settings_(settings) {}

  SE3d run() {
    nlopt::opt search(nlopt::LD_LBFGS, 6);
    search.set_max_objective(
        [](const std::vector<double>& x, std::vector<double>& gradient, void* self) {
          return static_cast<Ascent*>(self)->value(x, gradient);
        },
        this);
    search.set_ftol_rel(settings_.tolerance);
    search.set_maxeval(settings_.max_evaluations);
    std::vector<double> x(6, 0.0);
    best_ = x;
    try {
      double reached = 0.0;
      search.optimize(x, reached);
    } catch (const std::runtime_error&) {  // rounding stopped progress: the best point stands
    }
    return moved(start_, box_, best_);
  }

  int evaluations = 0;

 private:
  double log_probability(std::span<const double> x) {
    ++evaluations;
    RandomStream same = stream_;
    constexpr double kLeast = 1e-300;
    return std::log(std::max(integral_(moved(start_, box_, x), settings_.points, same), kLeast));
  }

  double value(const std::vector<double>& x, std::vector<double>& gradient) {
    const double here = log_probability(x);
    if (here > best_value_) {
      best_value_ = here;
      best_ = x;
    }
    constexpr double kStep = 1e-4;
    std::vector<double> near = x;
    for (std::size_t i = 0; i < gradient.size(); ++i) {
      near[i] = x[i] + kStep;
      const double up = log_probability(near);
      near[i] = x[i] - kStep;
      gradient[i] = (up - log_probability(near)) / (2.0 * kStep);
      near[i] = x[i];
    }
    return here;
  }

  const BoxIntegral<D>& integral_;
  const ToleranceBox& box_;
  SE3d start_;
  RandomStream stream_;
  const BestGraspSettings& settings_;
  std::vector<double> best_;
  double best_value_ = -std::numeric_limits<double>::infinity();
};

/// Indices of the heaviest components, heaviest first.
template <class D>
std::vector<std::size_t> heaviest(const Mixture<D>& mixture, std::size_t count) {
  std::vector<std::size_t> order =
      heaviest_first(mixture.size(), [&](std::size_t i) { return mixture[i].log_weight; });
  order.resize(std::min(count, order.size()));
  return order;
}

}  // namespace

template <class D>
SuccessEstimate success_probability(const Mixture<D>& mixture, const ToleranceBox& box,
                                    const SE3d& m, RandomStream& stream,
                                    const SuccessSettings& settings) {
  check(settings);
  return estimate(BoxIntegral<D>(mixture, box), mixture.size(), m, stream, settings);
}

template <class D>
BestGrasp best_grasp(const Mixture<D>& mixture, const ToleranceBox& box, RandomStream& stream,
                     const BestGraspSettings& settings) {
  check(settings.final);
  require(settings.starts > 0, "best_grasp: expected at least 1 start");
  require(settings.points > 0, "best_grasp: expected at least 1 point");
  const BoxIntegral<D> integral(mixture, box);
  BestGrasp best{{}, {}, {}, 0};
  for (const std::size_t k : heaviest(mixture, settings.starts)) {
    const SE3d start = mixture[k].density.mean();
    Ascent<D> ascent(integral, box, start, stream, settings);
    const SE3d reached = ascent.run();
    best.evaluations += ascent.evaluations;
    RandomStream same = stream;
    best.candidates.push_back(
        {start, reached, estimate(integral, mixture.size(), reached, same, settings.final)});
  }
  std::stable_sort(best.candidates.begin(), best.candidates.end(),
                   [](const GraspCandidate& a, const GraspCandidate& b) {
                     return a.success.probability > b.success.probability;
                   });
  best.pose = best.candidates.front().pose;
  best.success = best.candidates.front().success;
  return best;
}

template SuccessEstimate success_probability(const Mixture<ConcentratedGaussian<SE3d>>&,
                                             const ToleranceBox&, const SE3d&, RandomStream&,
                                             const SuccessSettings&);
template SuccessEstimate success_probability(const Mixture<ProjectedGaussian<SE3d>>&,
                                             const ToleranceBox&, const SE3d&, RandomStream&,
                                             const SuccessSettings&);
template BestGrasp best_grasp(const Mixture<ConcentratedGaussian<SE3d>>&, const ToleranceBox&,
                              RandomStream&, const BestGraspSettings&);
template BestGrasp best_grasp(const Mixture<ProjectedGaussian<SE3d>>&, const ToleranceBox&,
                              RandomStream&, const BestGraspSettings&);

}  // namespace posemix
